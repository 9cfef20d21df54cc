"""What is believed: held-out recordings judge only, folds bear out, sessions widen intervals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from bench.concealed.build import make_study
from bench.concealed.spec import WorldSpec

from pdoik.sim2real import Diagnosis, Evidence, Finding, Study, diagnose, load_study
from pdoik.sim2real.confirm.event_support import event_support
from pdoik.sim2real.confirm.sessions import borne_out, support_of
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.effects.external_contact import ExternalContact
from pdoik.sim2real.motion.balances import Balances
from pdoik.sim2real.motion.place import Place
from pdoik.sim2real.regression.estimate import estimates
from pdoik.sim2real.regression.fit import Fit, Term, term_of
from pdoik.sim2real.regression.refine import refined
from pdoik.sim2real.regression.trial import Search
from pdoik.sim2real.study.recording import FloatArray, Recording
from pdoik.sim2real.thresholds import Thresholds
from sim2real_channels import study as small_study
from sim2real_motions import moved

NONE = Evidence(validation_gain=0.0, interval95=(0.0, 0.0))


def shuffled(recording: Recording) -> Recording:
    """Torques in another order."""
    assert recording.tau is not None
    order = np.random.default_rng(5).permutation(len(recording.time))
    return replace(recording, tau=recording.tau[order])


def inverted(recording: Recording) -> Recording:
    """Torques of another sign and size."""
    assert recording.tau is not None
    return replace(recording, tau=-3.0 * recording.tau)


def learnt(findings: tuple[Finding, ...]) -> list[Finding]:
    """Findings without what held-out recordings say of them, and what only these show."""
    return [replace(f, evidence=NONE) for f in findings if not f.held_out_only]


@pytest.fixture(scope="module")
def concealed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Study, Diagnosis]:
    folder = tmp_path_factory.mktemp("judge") / "study"
    make_study(folder, WorldSpec(seed=31, effect="coulomb_friction", hide="second", robot="h1_arm"))
    study = load_study(folder / "study.yaml")
    return study, diagnose(study)


@pytest.mark.parametrize("corrupt", [shuffled, inverted])
def test_held_out_recordings_change_no_finding(
    concealed: tuple[Study, Diagnosis], corrupt: object
) -> None:
    study, before = concealed
    assert before.findings
    recordings = tuple(
        corrupt(r) if r.role == "validate" else r  # type: ignore[operator]
        for r in study.recordings
    )
    after = diagnose(replace(study, recordings=recordings))
    assert learnt(after.findings) == learnt(before.findings)
    assert learnt(after.suspected) == learnt(before.suspected)
    gains = [f.evidence.validation_gain for f in before.findings]
    assert [f.evidence.validation_gain for f in after.findings] != gains
    assert {n: j.after for n, j in after.joints.items()} != {
        n: j.after for n, j in before.joints.items()
    }


def test_what_little_speaks_for_is_suspected_and_not_in_the_model(
    concealed: tuple[Study, Diagnosis],
) -> None:
    study, before = concealed
    strict = diagnose(study, thresholds=Thresholds().changed({"confidence.suspected": 1.0}))
    assert strict.findings == ()
    names = {(f.effect, f.joints, f.links) for f in strict.suspected}
    assert {(f.effect, f.joints, f.links) for f in before.findings} <= names
    assert strict.verdict == "mismatch_unexplained"
    assert strict.thresholds["confidence"]["suspected"] == 1.0
    assert Diagnosis.from_json(strict.to_json()) == strict


def balances(folder: Path, added: FloatArray | None = None, noise: float = 0.1) -> Balances:
    """Four recordings of an arm at whose second joint something acts, per recording or not."""
    motion = moved(folder, 2, seconds=30.0, tau_cmd=None, q_des=None, dq_des=None)
    motions = []
    for k in range(4):
        rng = np.random.default_rng([7, k])
        torque = motion.tau + noise * rng.standard_normal(motion.tau.shape)
        if added is not None:
            torque[:, 1] += added[k] * motion.dq[:, 1]
        named = replace(motion.recording, name=f"day{k}")
        motions.append(replace(motion, recording=named, torque=torque, cache={}))
    return Balances(motions)


def searched(b: Balances, *terms: Term) -> Search:
    return Search(balances=b, nuisance=(), fit=Fit(b, terms), start=Fit(b, ()))


def joint_term(b: Balances, effect: str, shape: tuple[float, ...] = ()) -> Term:
    term = term_of(b, CATALOGUE[effect], Place(joints=(1,)), shape)
    assert term is not None
    return term


def test_what_is_there_is_borne_out_and_what_noise_suggested_is_not(tmp_path: Path) -> None:
    b = balances(tmp_path, np.full(4, 0.4))
    friction = joint_term(b, "viscous_friction")
    base = Fit(b, [friction])
    pool = [joint_term(b, "position_dependent_spring", (s, x)) for s in (1.0, -1.0) for x in
            np.linspace(-0.5, 1.0, 12)]  # fmt: skip
    springs = [refined(base, each) for each in pool]
    lucky = min(springs, key=lambda each: base.extended(each).cost())
    assert base.extended(lucky).cost() < base.cost()  # it does gain where it was learnt
    state = searched(b, friction, lucky)
    real, chance = support_of(state, friction), support_of(state, lucky)
    assert real.sessions == real.agree == 4
    assert real.t > 8.0
    assert real.gain > 0.9
    assert chance.gain < 0.02
    state, doubtful = borne_out(state)
    assert state.accepted == (friction,)
    assert doubtful == (lucky,)
    assert state.support[friction.key].gain > 0.9


def test_days_that_differ_widen_the_interval(tmp_path: Path) -> None:
    inside, narrow = [], []
    rng = np.random.default_rng(3)
    for _ in range(30):
        b = balances(tmp_path, 1.0 + 0.1 * rng.standard_normal(4), noise=0.05)
        term = joint_term(b, "viscous_friction")
        fit = Fit(b, [term])
        found = estimates(fit, (term,), 0)[0]["coefficient"]
        inside.append(found.interval95[0] <= 1.0 <= found.interval95[1])
        narrow.append(abs(found.value - 1.0) <= 1.96 * fit.bootstrap(rng, 100)[:, 0].std())
    assert np.mean(inside) > 0.85
    assert np.mean(narrow) < 0.7  # blocks alone know nothing of days


def test_days_that_are_alike_leave_it_as_blocks_have_it(tmp_path: Path) -> None:
    b = balances(tmp_path, np.ones(4))
    term = joint_term(b, "viscous_friction")
    fit = Fit(b, [term])
    found = estimates(fit, (term,), 0)[0]["coefficient"]
    blocks = float(fit.bootstrap(np.random.default_rng(0), 300)[:, 0].std())
    half = 0.5 * (found.interval95[1] - found.interval95[0])
    assert half < 3.5 * 1.96 * float(np.hypot(blocks, 0.0015))


@pytest.mark.parametrize(("force", "least", "most"), [(8.0, 0.8, 1.0), (0.0, 0.0, 0.15)])
def test_an_event_is_scored_where_it_was_not_learnt(
    tmp_path: Path, force: float, least: float, most: float
) -> None:
    plain = balances(tmp_path)
    place = Place(link=1, recording="day2", window=(10.0, 12.0))
    push = term_of(plain, CATALOGUE[ExternalContact.id], place, ())
    assert push is not None
    motions = []
    for m in plain.motions:
        columns = CATALOGUE[ExternalContact.id].columns(m, place, ())
        torque = m.torque + np.stack(
            [columns["torque", j] @ np.array([force, 0.0, force]) for j in range(2)], axis=1
        )
        motions.append(replace(m, torque=torque, cache={}))
    b = Balances(motions)
    fit = Fit(b, [])
    began = {key: fit.residual(key) for key in push.columns}
    support = event_support(fit, push, began)
    assert support.event
    assert least <= support.weight <= most
    assert (support.gain > 0.9) == (force > 0.0)


def test_what_is_plain_is_sure(tmp_path: Path) -> None:
    found = diagnose(small_study(tmp_path, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    assert {f.effect for f in found.findings} == {"coulomb_friction"}
    assert all(f.confidence > 0.9 for f in found.findings)
