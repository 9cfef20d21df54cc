"""What is believed: held-out recordings judge only, evidence names, sessions widen intervals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from pdoik.recordings import FloatArray, Recording
from pdoik.sim2real import Diagnosis, Estimate, Finding, Study, diagnose, load_study
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.effects.contacts import ExternalContact
from pdoik.sim2real.effects.drives import OF_BOTH, OF_DRIVE, OF_REPORT
from pdoik.sim2real.identify import estimates, held_out_support
from pdoik.sim2real.infer import event_support, spreads_of, with_torque_scale
from pdoik.sim2real.motion import Balances, Motion, Place, RigidBody, motion_of
from pdoik.sim2real.regression import DAYS, Fit, Term, background, refined, term_of
from pdoik.sim2real.study import Trust
from pdoik.sim2real.thresholds import Thresholds
from sim2real_channels import study as small_study
from sim2real_identified import figure, identified, named, ordinary_fit
from sim2real_motions import PERIOD, moved, recording, wave, write_arm


def shuffled(recording: Recording) -> Recording:
    """Torques in another order."""
    assert recording.tau is not None
    order = np.random.default_rng(5).permutation(len(recording.time))
    return replace(recording, tau=recording.tau[order])


def inverted(recording: Recording) -> Recording:
    """Torques of another sign and size."""
    assert recording.tau is not None
    return replace(recording, tau=-3.0 * recording.tau)


def learnt(diagnosis: Diagnosis) -> list[tuple[object, ...]]:
    """What was found where, and how large, claimed or suspected; not what only judges show.

    The figure of a joint's friction takes in what of it is not claimed: its interval is as wide.
    """
    every = (*diagnosis.findings, *diagnosis.suspected)
    return sorted(
        (f.effect, f.joints, f.links, f.recordings, _figures(f))
        for f in every
        if not f.held_out_only
    )


def _figures(finding: Finding) -> tuple[object, ...]:
    if CATALOGUE[finding.effect].carries:
        return tuple((name, f"{each.std:.12g}") for name, each in finding.parameters.items())
    return tuple(finding.parameters.items())


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
    assert learnt(after) == learnt(before)
    contradicted = {f.effect for f in before.findings} - {f.effect for f in after.findings}
    assert contradicted <= {f.effect for f in after.suspected}
    gains = [f.evidence.validation_gain for f in before.findings]
    assert [f.evidence.validation_gain for f in after.findings] != gains
    assert {n: j.after for n, j in after.joints.items()} != {
        n: j.after for n, j in before.joints.items()
    }


def test_what_little_speaks_for_is_suspected_and_not_in_the_model(
    concealed: tuple[Study, Diagnosis],
) -> None:
    study, before = concealed
    strict = diagnose(study, thresholds=Thresholds().changed({"diagnosis.suspected": 1.0}))
    assert strict.findings == ()
    names = {(f.effect, f.joints, f.links) for f in strict.suspected}
    assert {(f.effect, f.joints, f.links) for f in before.findings} <= names
    assert strict.verdict != "no_mismatch"
    assert strict.thresholds["diagnosis"]["suspected"] == 1.0
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
        named_so = replace(motion.recording, name=f"day{k}")
        motions.append(replace(motion, recording=named_so, torque=torque, cache={}))
    return Balances(motions)


def with_torque(b: Balances, added: Callable[[Motion, int], FloatArray | float]) -> Balances:
    """The same with more torque at the second joint, which depends on motion and recording."""
    motions = []
    for k, motion in enumerate(b.motions):
        torque = motion.torque.copy()
        torque[:, 1] += added(motion, k)
        motions.append(replace(motion, torque=torque, cache={}))
    return Balances(motions)


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
    both = base.extended(lucky)
    assert both.cost() < base.cost()  # it does gain where it was learnt
    start = Fit(b, ())
    real, chance = (held_out_support(both, start, each, 0.0) for each in (friction, lucky))
    assert real.sessions == real.agree == 4
    assert real.t > 8.0
    assert real.gain > 0.9
    assert chance.gain < 0.02
    assert chance.size < 0.3 < 3.0 < real.size
    assert named(identified(b)) == {("viscous_friction", (1,))}


def test_friction_is_named_though_its_size_is_another_each_day(tmp_path: Path) -> None:
    b = balances(tmp_path, noise=0.05)
    rubs = lambda motion, k: (1.0, 1.6)[k] * (motion.sign(1) + 0.5 * motion.dq[:, 1])  # noqa: E731
    state = identified(with_torque(Balances(b.motions[:2]), rubs))
    assert named(state) == {("coulomb_friction", (1,)), ("viscous_friction", (1,))}
    for effect, mean in (("coulomb_friction", 1.3), ("viscous_friction", 0.65)):
        low, high = figure(state.fit, effect, 1).interval95
        assert low < mean < high
        assert high - low > 0.6 * mean  # the next day is another one again


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


MASSES = {"link_inertial_error": ("d_mass",), "payload": ("mass",)}


def point(mass: float, at: tuple[float, float, float]) -> FloatArray:
    """Ten inertial parameters of a mass."""
    x, y, z = at
    inertia = (y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y)
    return mass * np.array([1.0, x, y, z, *inertia])


def swinging_once(folder: Path, friction: float = 0.0) -> tuple[Balances, Term]:
    """An arm whose last link is heavier and swings in the first of three recordings only."""
    body = RigidBody(write_arm(folder, 2), ("j1", "j2"), None)
    heavier = np.concatenate([np.zeros(10), point(0.6, (0.17, -0.05, 0.08))])
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


@pytest.mark.parametrize("friction", [0.0, 0.05])
def test_a_body_that_swings_in_one_session_alone_is_named(tmp_path: Path, friction: float) -> None:
    """Where it hardly moves only its weight is learnt; what swings is then any number at all."""
    b, heavier = swinging_once(tmp_path, friction)
    state = identified(b)
    (body,) = (term for term in state.accepted if term.place.link is not None)
    assert body.place == heavier.place
    low, high = estimates(state.fit, (body,), 0)[0][next(iter(MASSES[body.effect]))].interval95
    assert low < 0.6 < high
    rest = named(state) - {(body.effect, ())}
    assert rest == ({("coulomb_friction", (0,))} if friction else set())
    if friction:
        low, high = figure(state.fit, "coulomb_friction", 0).interval95
        assert low < friction < high


def test_what_one_session_alone_tells_apart_is_named_with_both_figures(tmp_path: Path) -> None:
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
    state = identified(Balances(motions))
    assert named(state) == {("coulomb_friction", (1,)), ("viscous_friction", (1,))}
    for effect in ("coulomb_friction", "viscous_friction"):
        low, high = figure(state.fit, effect, 1).interval95
        assert low < 0.3 < high
        assert low > 0.1


def test_an_offset_is_not_taken_for_friction_of_one_way(tmp_path: Path) -> None:
    """While a joint moves both say the same; the plainer is the name."""
    b = balances(tmp_path, noise=0.05)
    state = identified(with_torque(b, lambda m, k: 0.8 * m.sign(1) + 0.5 * m.dq[:, 1] - 0.3))
    names = ("coulomb_friction", "viscous_friction", "torque_offset")
    assert named(state) == {(name, (1,)) for name in names}
    for name, true in zip(names, (0.8, 0.5, -0.3), strict=True):
        low, high = figure(state.fit, name, 1).interval95
        assert low < true < high


@pytest.mark.parametrize(("true", "report", "drive"), [(OF_REPORT, 0.3, 0.0), (OF_DRIVE, 0.0, 0.3)])
def test_a_reports_zero_is_told_from_a_drives(
    tmp_path: Path, true: float, report: float, drive: float
) -> None:
    b = balances(tmp_path, noise=0.05)
    motions = []
    for motion in b.motions:
        torque, command = motion.torque.copy(), motion.torque.copy()
        torque[:, 1] += report
        command[:, 1] -= drive
        motions.append(replace(motion, torque=torque, command=command, cache={}))
    world = Balances(motions)
    for first in (OF_BOTH, OF_REPORT, OF_DRIVE):  # whatever was taken first
        term = joint_term(world, "torque_offset", (first,))
        assert refined(Fit(world, ()), term).shape == (true,)
    state = identified(world)
    (zero,) = state.accepted
    assert (zero.effect, zero.place.joints) == ("torque_offset", (1,))
    if report:  # a drive's may be one of both, and of the report the other way
        assert zero.shape == (true,)
    low, high = estimates(state.fit, (zero,), 0)[0]["offset"].interval95
    assert low < 0.3 < high


def test_what_a_mass_that_is_a_tenth_off_explains_is_not_peculiar(tmp_path: Path) -> None:
    """Half of gravity's torque over a part of the joint's travel looks like a spring."""
    b = balances(tmp_path, noise=0.02)
    assert named(identified(with_torque(b, lambda motion, k: 0.08 * motion.tau[:, 1]))) == set()
    spring = CATALOGUE["position_dependent_spring"]

    def pulled(motion: Motion, k: int) -> FloatArray:
        columns = spring.columns(motion, Place(joints=(1,)), (1.0, 0.2))
        return np.asarray(6.0 * columns["torque", 1][:, 0])

    state = identified(with_torque(b, pulled))
    assert (spring.id, (1,)) in named(state)
    (term,) = (each for each in state.accepted if each.effect == spring.id)
    found = estimates(state.fit, (term,), 0)[0]
    for name, true in (("stiffness", 6.0), ("onset", 0.2)):
        assert found[name].value == pytest.approx(true, rel=0.1)


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


@pytest.mark.long
def test_days_that_differ_widen_the_interval(tmp_path: Path) -> None:
    inside, narrow = [], []
    rng = np.random.default_rng(3)
    for _ in range(20):
        fit = ordinary_fit(balances(tmp_path, 1.0 + 0.1 * rng.standard_normal(4), noise=0.05))
        found = figure(fit, "viscous_friction", 1)
        days = [term for term in fit.terms if term.effect == DAYS]
        alone = figure(fit.without(*days), "viscous_friction", 1)
        inside.append(found.interval95[0] <= 1.0 <= found.interval95[1])
        narrow.append(alone.interval95[0] <= 1.0 <= alone.interval95[1])
    assert np.mean(inside) > 0.85
    assert np.mean(narrow) < 0.7  # rows alone know nothing of days


def test_days_that_are_alike_make_it_narrower_than_one_day_could(tmp_path: Path) -> None:
    b = balances(tmp_path, np.ones(4))
    one = Balances(b.motions[:1])
    alike, alone = (figure(ordinary_fit(each), "viscous_friction", 1) for each in (b, one))
    assert alike.interval95[0] < 1.0 < alike.interval95[1]
    assert alike.std < 0.4 * alone.std
    assert alone.std == pytest.approx(0.1, rel=0.2)  # by which friction differs from day to day


def test_a_joint_that_moves_in_one_recording_is_as_sure_as_that_one_makes_it(
    tmp_path: Path,
) -> None:
    """Noise of others, which hardly move it, is no measure of it."""
    body = RigidBody(write_arm(tmp_path, 2), ("j1", "j2"), None)
    time = PERIOD * np.arange(5000)
    found = []
    for parts in ((1.0, 0.01, 0.01), (1.0,)):
        motions = []
        for k, part in enumerate(parts):
            q, dq, ddq = (wave(time, 2, order) * [1.0, part] for order in range(3))
            added = np.column_stack([np.zeros(len(q)), dq[:, 1]])
            motions.append(logged(body, k, (q, dq, ddq), added, noise=0.05))
        found.append(figure(ordinary_fit(Balances(motions)), "viscous_friction", 1))
    with_others, alone = found
    assert with_others.value == pytest.approx(1.0, abs=0.05)
    assert with_others.std < 1.2 * alone.std


@pytest.mark.parametrize("viscous", [0.0, 0.12, 0.5])
def test_dry_frictions_interval_holds_what_viscous_friction_may_take(
    tmp_path: Path, viscous: float
) -> None:
    """Both are in the model, named or not."""
    body = RigidBody(write_arm(tmp_path, 2), ("j1", "j2"), None)
    q, dq, ddq = (wave(PERIOD * np.arange(5000), 2, order) for order in range(3))
    added = np.column_stack([np.zeros(len(q)), 0.5 * np.tanh(dq[:, 1] / 1e-3) + viscous * dq[:, 1]])
    b = Balances([logged(body, k, (q, dq, ddq), added, noise=0.4) for k in range(3)])
    state = identified(b)
    assert ("coulomb_friction", (1,)) in named(state)
    found = figure(state.fit, "coulomb_friction", 1)
    assert found.interval95[0] < 0.5 < found.interval95[1]
    assert found.std < 0.1


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
    support = event_support(fit, push, fit)
    assert support.event
    assert least <= support.weight <= most
    assert (support.gain > 0.9) == (force > 0.0)


def test_what_is_plain_is_sure(tmp_path: Path) -> None:
    found = diagnose(small_study(tmp_path, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    assert {f.effect for f in found.findings} == {"coulomb_friction"}
    assert all(f.confidence > 0.9 for f in found.findings)
