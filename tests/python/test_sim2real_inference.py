"""What is believed: held-out recordings judge only, folds bear out, sessions widen intervals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from pdoik.sim2real import Diagnosis, Estimate, Evidence, Finding, Study, diagnose, load_study
from pdoik.sim2real.confirm.event_support import event_support
from pdoik.sim2real.confirm.ordinary_looks import Ordinary
from pdoik.sim2real.confirm.sessions import borne_out, support_of
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.effects.external_contact import ExternalContact
from pdoik.sim2real.effects.torque_channel import OF_BOTH, OF_DRIVE, OF_REPORT
from pdoik.sim2real.infer.changing_friction import spreads_of
from pdoik.sim2real.infer.torque_scale import with_torque_scale
from pdoik.sim2real.infer.unnamed_ordinary import beside_the_unnamed, holding
from pdoik.sim2real.motion.balances import Balances
from pdoik.sim2real.motion.motion import Motion, motion_of
from pdoik.sim2real.motion.place import Place
from pdoik.sim2real.motion.rigid_body import RigidBody
from pdoik.sim2real.regression.background import background
from pdoik.sim2real.regression.estimate import estimates
from pdoik.sim2real.regression.fit import Fit, Term, term_of
from pdoik.sim2real.regression.refine import refined
from pdoik.sim2real.regression.trial import Search
from pdoik.sim2real.regression.wald import wald
from pdoik.sim2real.select.joint_sets import with_joint_sets
from pdoik.sim2real.select.rivals import swapped
from pdoik.sim2real.study.recording import FloatArray, Recording
from pdoik.sim2real.study.study import Trust
from pdoik.sim2real.thresholds import Thresholds
from sim2real_channels import study as small_study
from sim2real_motions import PERIOD, moved, recording, wave, write_arm

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


@pytest.mark.parametrize("corrupt", [shuffled, pytest.param(inverted, marks=pytest.mark.long)])
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


DRY = ("coulomb_friction", (0.0,))


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


def test_the_shape_of_friction_is_borne_out_though_its_size_is_another_each_day(
    tmp_path: Path,
) -> None:
    b = balances(tmp_path, noise=0.05)
    motions = []
    for k, motion in enumerate(b.motions[:2]):
        rubs = 1.0 * motion.sign(1) + 0.5 * motion.dq[:, 1]
        torque = motion.torque.copy()
        torque[:, 1] += (1.0, 1.6)[k] * rubs
        motions.append(replace(motion, torque=torque, cache={}))
    days = Balances(motions)
    dry, wet = joint_term(days, "coulomb_friction", (0.05,)), joint_term(days, "viscous_friction")
    known = joint_term(days, "timestamp_skew", (0.0, 1e-6))
    assert known.fixed  # it has no coefficient of its own
    other = term_of(days, CATALOGUE["timestamp_skew"], Place(joints=(0,)), (0.0, 1e-6))
    assert other is not None
    for before in ((), (known, other)):
        state = searched(days, *before, dry, wet)
        for term in (dry, wet):
            support = support_of(state, term)
            assert support.agree == support.sessions == 2
            assert support.gain > 0.5, term.effect


def logged(
    body: RigidBody, day: int, path: tuple[FloatArray, ...], added: FloatArray, *, noise: float
) -> Motion:
    """Twenty seconds along positions and their derivatives, with torques beyond the body's own."""
    q, dq, ddq = path
    tau = body.dynamics(q, dq, ddq).tau + added
    tau = tau + noise * np.random.default_rng(day).standard_normal(q.shape)
    alone = {"tau_cmd": None, "q_des": None, "dq_des": None}
    run = replace(recording(body, 2, 20.0, q=q, dq=dq, tau=tau, **alone), name=f"day{day}")
    return motion_of(run, body, None, 10.0, np.full(2, 1e-14), None)


def swinging_once(folder: Path, friction: float = 0.0) -> tuple[Balances, Term]:
    """An arm whose last link is heavier and swings in the first of three recordings only."""
    body = RigidBody(write_arm(folder, 2), ("j1", "j2"), None)
    heavier = np.zeros(20)
    heavier[10:14] = 0.6, 0.1, -0.03, 0.05
    motions = []
    for k, part in enumerate((1.0, 0.005, 0.005)):
        time = PERIOD * np.arange(5000)
        q, dq, ddq = (part * wave(time, 2, order) for order in range(3))
        added = body.regressor(q, dq, ddq).reshape(len(q), 2, 20) @ heavier
        added[:, 0] += friction * np.tanh(dq[:, 0] / 2e-4)
        motions.append(logged(body, k, (q, dq, ddq), added, noise=0.03))
    b = Balances(motions)
    term = term_of(b, CATALOGUE["link_inertial_error"], Place(joints=(), link=1), ())
    assert term is not None
    return b, term


def test_a_session_in_which_alone_a_body_swings_judges_it_in_parts(tmp_path: Path) -> None:
    """Where it hardly moves only its weight is learnt; what swings is then any number at all."""
    b, heavier = swinging_once(tmp_path)
    support = support_of(searched(b, heavier), heavier)
    assert support.sessions == support.agree == 2 + 4
    assert support.gain > 0.8


def test_what_one_session_alone_tells_apart_is_borne_out_by_its_parts(tmp_path: Path) -> None:
    """At one speed dry and viscous friction are the same torque: only the second says which."""
    body = RigidBody(write_arm(tmp_path, 2), ("j1", "j2"), None)
    time = PERIOD * np.arange(5000)
    motions = []
    for k, speed in enumerate((0.1, None, -0.1)):
        q, dq, ddq = (wave(time, 2, order) for order in range(3))
        if speed is not None:
            q[:, 1], dq[:, 1], ddq[:, 1] = speed * time, speed, 0.0
        added = np.column_stack([np.zeros(len(q)), 0.3 * np.tanh(dq[:, 1] / 1e-3) + 0.3 * dq[:, 1]])
        motions.append(logged(body, k, (q, dq, ddq), added, noise=0.05))
    b = Balances(motions)
    state = searched(b, *(joint_term(b, *each) for each in (DRY, ("viscous_friction", ()))))
    found, doubtful = borne_out(state)
    assert doubtful == ()
    assert all(each.sessions > 3 and each.agree == each.sessions for each in found.support.values())
    assert all(each.gain > 0.3 for each in found.support.values())


def test_what_others_make_of_a_session_in_which_alone_a_body_swings_judges_nothing(
    tmp_path: Path,
) -> None:
    """The swinging link is beside what is judged: its noise there must not count for that."""
    b, heavier = swinging_once(tmp_path, friction=0.05)
    dry = term_of(b, CATALOGUE["coulomb_friction"], Place(joints=(0,)), (0.0,))
    assert dry is not None
    state = searched(b, heavier, dry)
    support, key = support_of(state, dry), ("torque", 0)
    shown = dry.columns[key][state.fit.rows[key]] * state.fit.beta[-1] / b.sigma[key]
    assert support.agree == support.sessions == 2 + 4
    assert support.size == pytest.approx(float(np.sqrt(np.mean(shown**2))), rel=0.4)


def test_an_offset_is_not_taken_for_friction_of_one_way(tmp_path: Path) -> None:
    """While a joint moves both say the same; the plainer is the name."""
    b = balances(tmp_path, noise=0.05)
    motions = []
    for motion in b.motions:
        torque = motion.torque.copy()
        torque[:, 1] += 0.8 * motion.sign(1) + 0.5 * motion.dq[:, 1] - 0.3
        motions.append(replace(motion, torque=torque, cache={}))
    world = Balances(motions)
    dry = joint_term(world, "coulomb_friction", (0.02,))
    found = {term.effect for term in with_joint_sets(searched(world, dry)).accepted}
    assert found == {"coulomb_friction", "viscous_friction", "torque_offset"}


def test_a_reports_zero_takes_the_place_of_friction_of_one_way_and_a_drives(tmp_path: Path) -> None:
    """One figure in both balances for three that say the same of each alone."""
    b = balances(tmp_path, noise=0.05)
    motions = []
    for motion in b.motions:
        torque, command = motion.torque.copy(), motion.torque.copy()
        torque[:, 1] += 0.3
        motions.append(replace(motion, torque=torque, command=command, cache={}))
    world = Balances(motions)
    one_way = joint_term(world, "asymmetric_friction", ())
    drive = joint_term(world, "torque_offset", (OF_DRIVE,))
    begun = searched(world, one_way)
    begun = begun.fitted([*begun.fit.terms, drive])
    (found,) = with_joint_sets(begun).accepted
    assert (found.effect, found.shape) == ("torque_offset", (OF_REPORT,))


def test_a_reports_zero_is_told_from_a_drives_whatever_was_taken_first(tmp_path: Path) -> None:
    b = balances(tmp_path, noise=0.05)
    for true, (report, drive) in ((OF_REPORT, (0.3, 0.0)), (OF_DRIVE, (0.0, -0.3))):
        motions = []
        for motion in b.motions:
            torque, command = motion.torque.copy(), motion.torque.copy()
            torque[:, 1] += report
            command[:, 1] += drive
            motions.append(replace(motion, torque=torque, command=command, cache={}))
        world = Balances(motions)
        for first in (OF_BOTH, OF_REPORT, OF_DRIVE):
            term = joint_term(world, "torque_offset", (first,))
            assert refined(Fit(world, ()), term).shape == (true,)


def test_what_a_mass_that_is_a_tenth_off_explains_is_not_peculiar(tmp_path: Path) -> None:
    """Half of gravity's torque over a part of the joint's travel looks like a spring."""
    b = balances(tmp_path, noise=0.02)
    spring = joint_term(b, "position_dependent_spring", (1.0, 0.2))
    found = []
    for pull, by in (("mass", 0.08), ("spring", 6.0)):
        motions = []
        for motion in b.motions:
            own = motion.tau[:, 1] if pull == "mass" else column(motion, spring)
            torque = motion.torque.copy()
            torque[:, 1] += by * own
            motions.append(replace(motion, torque=torque, cache={}))
        world = Balances(motions)
        term = joint_term(world, "position_dependent_spring", spring.shape)
        state = searched(world, term)
        assert wald(state.fit, term)[0] > 4.0, pull  # alone, it seems to be there
        found.append([each for each, _ in Ordinary(of=world).without_need(state)] == [term])
    assert found == [True, False]


def column(motion: Motion, term: Term) -> FloatArray:
    made = CATALOGUE[term.effect].columns(motion, term.place, term.shape)
    return np.asarray(made["torque", 1][:, 0])


def test_every_figure_that_torques_tell_has_the_torques_scale_in_its_interval(
    concealed: tuple[Study, Diagnosis],
) -> None:
    study, _ = concealed
    each = {
        "level": Estimate(value=10.0, std=0.1, interval95=(9.8, 10.2), unit="N m"),
        "mass": Estimate(value=2.0, std=0.0, interval95=(2.0, 2.0), unit="kg"),
        "delay": Estimate(value=0.01, std=0.001, interval95=(0.008, 0.012), unit="s"),
    }
    usual = with_torque_scale(study, each)
    assert usual["level"].std == pytest.approx(np.hypot(0.1, 0.4))
    assert usual["mass"].interval95 == pytest.approx((2.0 - 1.96 * 0.08, 2.0 + 1.96 * 0.08))
    assert usual["delay"] == each["delay"]
    assert with_torque_scale(replace(study, trust=Trust(torque=0.0)), each) == each
    wide = with_torque_scale(replace(study, trust=Trust(torque=0.1)), each)
    assert wide["level"].std == pytest.approx(np.hypot(0.1, 1.0))


@pytest.mark.parametrize("friction", [0.0, 0.8])
def test_a_zero_beside_friction_may_be_friction_that_differs_by_direction(
    tmp_path: Path, friction: float
) -> None:
    """While a joint moves one says what the other does; without friction there is no difference."""
    b = balances(tmp_path, noise=0.02)
    motions = []
    for motion in b.motions:
        torque = motion.torque.copy()
        torque[:, 1] += friction * motion.sign(1) + 0.3
        motions.append(replace(motion, torque=torque, cache={}))
    world = Balances(motions)
    zero = joint_term(world, "torque_offset", (OF_REPORT,))
    dry = (joint_term(world, *DRY),) if friction else ()
    state = swapped(searched(world, *dry, zero))
    others = {each.term.effect for each in state.level[zero.key]}
    assert ("asymmetric_friction" in others) == (friction > 0.0)


def test_a_coarser_law_that_explains_nearly_the_same_is_listed(tmp_path: Path) -> None:
    b = balances(tmp_path, noise=0.02)
    shape = (0.002,)
    motions = []
    for motion in b.motions:
        torque = motion.torque.copy()
        made = CATALOGUE["presliding_hysteresis"].columns(motion, Place(joints=(1,)), shape)
        torque[:, 1] += 3.0 * made["torque", 1][:, 0]
        motions.append(replace(motion, torque=torque, cache={}))
    world = Balances(motions)
    term = joint_term(world, "presliding_hysteresis", shape)
    state = swapped(searched(world, term))
    (kept,) = state.accepted
    assert kept.effect == "presliding_hysteresis"
    assert "coulomb_friction" in {each.term.effect for each in state.level[kept.key]}


def test_a_recording_that_moves_one_way_says_nothing_of_frictions_change(tmp_path: Path) -> None:
    """There the torque's zero is as good: another one that day is no other friction."""
    body = RigidBody(write_arm(tmp_path, 2), ("j1", "j2"), None)
    time, motions = PERIOD * np.arange(5000), []
    for k in range(4):
        q, dq, ddq = (wave(time, 2, order) for order in range(3))
        if k == 3:
            q[:, 1], dq[:, 1], ddq[:, 1] = 0.05 * time, 0.05, 0.0
        added = 0.8 * np.tanh(dq / 0.01) + (0.4 if k == 3 else 0.0)
        motions.append(logged(body, k, (q, dq, ddq), added, noise=0.02))
    noisy, terms = background(Balances(motions))
    assert spreads_of(Fit(noisy, terms))[1] < 0.05


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


@pytest.mark.parametrize(("of_others", "sure"), [(1.0, True), (9.0, False)])
def test_a_joint_that_moves_in_one_recording_is_as_sure_as_that_one_makes_it(
    tmp_path: Path, of_others: float, sure: bool
) -> None:
    """Noise of others, which hardly move it, is no measure of it; what is beyond noise, is."""
    body = RigidBody(write_arm(tmp_path, 2), ("j1", "j2"), None)
    time = PERIOD * np.arange(5000)
    motions = []
    for k, (part, friction) in enumerate(((1.0, 1.0), (0.01, of_others), (0.01, of_others))):
        q, dq, ddq = (wave(time, 2, order) * [1.0, part] for order in range(3))
        added = np.column_stack([np.zeros(len(q)), friction * dq[:, 1]])
        motions.append(logged(body, k, (q, dq, ddq), added, noise=0.05))
    b = Balances(motions)
    term = joint_term(b, "viscous_friction")
    found = estimates(Fit(b, [term]), (term,), 0)[0]["coefficient"]
    assert found.value == pytest.approx(1.0, abs=0.01)
    assert (found.std < 0.01) == sure


@pytest.mark.parametrize("viscous", [0.0, 0.12, 0.5])
def test_dry_frictions_interval_holds_what_viscous_friction_that_was_not_named_may_take(
    tmp_path: Path, viscous: float
) -> None:
    body = RigidBody(write_arm(tmp_path, 2), ("j1", "j2"), None)
    q, dq, ddq = (wave(PERIOD * np.arange(5000), 2, order) for order in range(3))
    added = np.column_stack([np.zeros(len(q)), 0.5 * np.tanh(dq[:, 1] / 1e-3) + viscous * dq[:, 1]])
    b = Balances([logged(body, k, (q, dq, ddq), added, noise=0.4) for k in range(3)])
    dry = joint_term(b, *DRY)
    fit = Fit(b, [dry])
    figures = estimates(fit, (dry,), 0)[0]
    (beside,) = beside_the_unnamed(fit, (dry,), 0)
    own, both = figures["level"], holding(figures, figures, beside)["level"]
    assert both.value == own.value
    assert both.interval95[0] <= 0.5 <= both.interval95[1]
    assert both.interval95[0] <= own.interval95[0] < own.interval95[1] <= both.interval95[1]
    assert (own.interval95[0] > 0.5) == (viscous > 0.0)  # which the figure alone does not know
    assert both.std < 0.2 + 1.2 * viscous


def test_where_all_that_is_ordinary_was_named_intervals_are_its_own(tmp_path: Path) -> None:
    b = balances(tmp_path, np.full(4, 0.4))
    others = (("viscous_friction", ()), ("torque_offset", (OF_REPORT,)), ("rotor_inertia", ()))
    terms = tuple(joint_term(b, *each) for each in (DRY, *others))
    fit = Fit(b, terms)
    found, beside = estimates(fit, terms, 0), beside_the_unnamed(fit, terms, 0)
    for number, others in enumerate(beside):
        wide = holding(found[number], found[number], others)
        for name, each in found[number].items():
            assert wide[name].std == pytest.approx(each.std, rel=0.05)


def test_a_load_that_may_be_nothing_beside_what_was_not_named_keeps_its_figures(
    tmp_path: Path,
) -> None:
    """A centre is a moment over a mass: that of no mass may be anywhere."""
    b = balances(tmp_path, noise=0.02)
    load = term_of(b, CATALOGUE["payload"], Place(joints=(), link=1), ())
    assert load is not None
    (beside,) = beside_the_unnamed(Fit(b, [load]), (load,), 0)
    assert set(beside) == {"mass"}
    motions = []
    for motion in b.motions:
        columns = CATALOGUE["payload"].columns(motion, load.place, ())
        moments = np.array([2.0, 0.2, 0.0, 0.1, *(0.03, 0.03, 0.03, 0.0, 0.0, 0.0)])
        torque = motion.torque + np.stack([columns["torque", j] @ moments for j in range(2)], 1)
        motions.append(replace(motion, torque=torque, cache={}))
    loaded = Balances(motions)
    load = term_of(loaded, CATALOGUE["payload"], Place(joints=(), link=1), ())
    assert load is not None
    (beside,) = beside_the_unnamed(Fit(loaded, [load]), (load,), 0)
    assert "com_x" in beside


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
