"""What the posterior over causes ends with, on arms of two and three joints with known causes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pin = pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Diagnosis, Finding, Study, diagnose
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify.hypothesis import Hypothesis, peculiar
from pdoik.sim2real.identify.pool import Pool
from pdoik.sim2real.identify.posterior import Posterior, State
from pdoik.sim2real.motion.balances import Balances
from pdoik.sim2real.motion.place import Place
from pdoik.sim2real.motion.prepare import prepare
from pdoik.sim2real.regression.fit import TermKey, term_of
from pdoik.sim2real.study.study import Setup
from sim2real_motions import wave, write_arm
from sim2real_recordings import even_recording

PERIOD, NOISE, RIGHT = 0.005, 0.03, 0.01
RUBS = np.array([1.0, 0.6, 0.3])  # [N m]
Cause = Callable[[int, np.ndarray, np.ndarray], np.ndarray]  # of recording, q and dq


def study(
    folder: Path,
    cause: Cause | None = None,
    n: int = 2,
    *,
    runs: int = 3,
    held: int = 0,
    noise: float = 1.0,
    slow: float = 1.0,
    seconds: float = 16.0,
    tilt: Sequence[float] = (0.0, 0.0),
    days: Sequence[str] = (),
) -> Study:
    """An arm by Pinocchio with torques that its description does not tell of."""
    robot = write_arm(folder, n)
    model = pin.buildModelFromUrdf(str(robot))
    model.gravity.linear = Rotation.from_euler("XY", tilt).inv().apply([0.0, 0.0, -9.80665])
    data, recordings = model.createData(), []
    for k in range(runs):
        rng = np.random.default_rng(k)
        time = PERIOD * np.arange(round(seconds / PERIOD))
        q, dq, ddq = (slow * wave(time + 37.0 * k, n, order) for order in range(3))
        tau = np.array([pin.rnea(model, data, *each) for each in zip(q, dq, ddq, strict=True)])
        tau = tau if cause is None else tau + cause(k, q, dq)
        q, dq, tau = (
            each + noise * size * rng.standard_normal(q.shape)
            for each, size in ((q, 1e-5), (dq, 1e-3), (tau, NOISE))
        )
        role = "fit" if k < runs - held else "validate"
        made = even_recording(time, role=role, q=q, dq=dq, tau=tau)
        recordings.append(replace(made, name=f"run{k}.csv"))
    return Study(
        folder=folder,
        robot=robot,
        joints=tuple(f"j{k + 1}" for k in range(n)),
        recordings=tuple(recordings),
        split="by the test",
        setups={f"run{k}.csv": Setup(session=day) for k, day in enumerate(days)},
    )


def rubbing(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
    return RUBS[: q.shape[1]] * np.tanh(dq / 1e-3)


def on(j: int, torque: np.ndarray, n: int = 2) -> np.ndarray:
    return torque[:, None] * np.eye(n)[j]


def several(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
    """Friction everywhere, a spring at the second joint, more friction near rest at the first."""
    spring = on(1, 4.0 * np.maximum(q[:, 1] - 0.5, 0.0))
    return (
        rubbing(k, q, dq)
        + spring
        + on(0, np.tanh(dq[:, 0] / 1e-3) * np.exp(-((dq[:, 0] / 0.3) ** 2)))
    )


SEVERAL: set[TermKey] = {
    ("position_dependent_spring", Place(joints=(1,))),
    ("stribeck_friction", Place(joints=(0,))),
}


def told(study: Study) -> Diagnosis:
    """The diagnosis of a search that ends: each of its steps is told."""
    steps = iter(range(60))
    return diagnose(study, tell=lambda *said: next(steps))  # StopIteration where it goes on


def named(findings: Sequence[Finding]) -> set[tuple[str, tuple[str, ...]]]:
    return {(each.effect, each.joints) for each in findings}


def keys(state: State) -> set[TermKey]:
    return {each.key for each in state.chosen}


def assert_friction(diagnosis: Diagnosis, n: int = 2, least: float = 0.0) -> None:
    """Dry friction of all joints, whose intervals hold the truth and are not useless."""
    found = {f.joints[0]: f for f in diagnosis.findings if f.effect == "coulomb_friction"}
    for j in range(n):
        level = found[f"j{j + 1}"].parameters["level"]
        assert level.interval95[0] < RUBS[j] < level.interval95[1]
        assert level.value == pytest.approx(RUBS[j], rel=0.03)
        assert 0.01 * RUBS[j] < level.std < 0.06 * RUBS[j]


@pytest.mark.parametrize("noise", [1.0, 0.3, 0.0])
def test_a_sound_machine_is_told_nothing(tmp_path: Path, noise: float) -> None:
    sound = study(tmp_path, noise=noise)
    posterior = Posterior.of(prepare(sound).fit)
    assert posterior.grown(posterior.begun(RIGHT)).chosen == ()
    diagnosis = told(sound)
    assert diagnosis.findings == diagnosis.suspected == ()
    assert diagnosis.verdict == "no_mismatch"


def test_friction_of_all_joints_is_told_with_intervals_that_hold_it(tmp_path: Path) -> None:
    diagnosis = told(study(tmp_path, rubbing, 3))
    assert named(diagnosis.findings) == {("coulomb_friction", (f"j{k}",)) for k in (1, 2, 3)}
    assert diagnosis.verdict == "mismatch_explained"
    assert_friction(diagnosis, 3)


@pytest.mark.parametrize("step", [1e-6, 0.005, 0.01, 0.03])
def test_friction_is_only_that_however_quickly_it_turns(tmp_path: Path, step: float) -> None:
    """Where the arm is so slow that much of its motion lies within the step."""
    rounded = study(tmp_path, lambda k, q, dq: RUBS[:2] * np.tanh(dq / step), slow=0.15)
    diagnosis = told(rounded)
    assert named(diagnosis.findings) == {("coulomb_friction", (f"j{k}",)) for k in (1, 2)}
    assert_friction(diagnosis)


@pytest.mark.parametrize("degrees", [(90, 0), (0, 90), (0, -90), (60, 40), (3, -2)])
def test_a_base_is_found_however_it_is_mounted(tmp_path: Path, degrees: tuple[int, int]) -> None:
    tilt = np.radians(degrees)
    diagnosis = told(study(tmp_path, rubbing, 3, tilt=tilt))
    (found,) = (each for each in diagnosis.findings if each.effect == "gravity_direction")
    there, true = (
        Rotation.from_euler("XY", each).inv().apply([0.0, 0.0, -1.0])
        for each in ([found.values["tilt_x"], found.values["tilt_y"]], tilt)
    )
    assert np.degrees(np.arccos(there @ true)) < 0.5
    assert len(diagnosis.findings) == 4
    assert_friction(diagnosis, 3)


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> Balances:
    return prepare(study(tmp_path_factory.mktemp("several"), several)).fit


@pytest.mark.parametrize("seed", range(3))
def test_the_order_of_candidates_does_not_matter(mixed: Balances, seed: int) -> None:
    posterior = Posterior.of(mixed)
    plain = posterior.grown(posterior.begun(RIGHT))
    order = np.random.default_rng(seed).permutation(len(posterior.pool.candidates))
    shuffled = [posterior.pool.candidates[k] for k in order]
    other = replace(posterior, pool=Pool(posterior.data, shuffled), tried={})
    found = other.grown(other.begun(RIGHT))
    assert keys(found) == keys(plain) == SEVERAL
    assert found.log_posterior == pytest.approx(plain.log_posterior, abs=0.5)


def test_the_order_of_recordings_does_not_matter(tmp_path: Path) -> None:
    first = study(tmp_path, several)
    one = told(first)
    two = told(replace(first, recordings=first.recordings[::-1]))
    assert named(one.findings) == named(two.findings)
    assert len(one.findings) == 4
    for each in one.findings:
        (same,) = (f for f in two.findings if named([f]) == named([each]))
        for name, figure in each.parameters.items():
            assert same.parameters[name].value == pytest.approx(figure.value, abs=0.2 * figure.std)
            assert same.parameters[name].std == pytest.approx(figure.std, rel=0.2)


def cause(posterior: Posterior, effect: str, j: int, code: float | None = None) -> Hypothesis:
    """An effect at a joint as it is first tried."""
    b, place = posterior.balances, Place(joints=(j,))
    shapes = CATALOGUE[effect].shapes(b.motions, place)
    shape = next(s for s in shapes if code is None or s[0] == code)
    term = term_of(b, CATALOGUE[effect], place, shape)
    assert term is not None
    return peculiar(b, term)


def test_a_cause_goes_when_a_better_one_comes(mixed: Balances) -> None:
    """A curve over positions explains what a spring does: until the spring is there."""
    posterior = Posterior.of(mixed)
    curve = cause(posterior, "unknown", 1, code=0.0)
    state = posterior.begun(RIGHT, [curve])
    assert state.log_posterior > posterior.begun(RIGHT).log_posterior + 100.0
    assert keys(posterior.grown(state)) == SEVERAL


def test_a_cause_that_is_worth_nothing_does_not_stay(mixed: Balances) -> None:
    posterior = Posterior.of(mixed)
    needless = [cause(posterior, "asymmetric_friction", 1), cause(posterior, "unknown", 0, 3.0)]
    assert keys(posterior.grown(posterior.begun(RIGHT, needless))) == SEVERAL


@pytest.fixture(scope="module")
def contradicted(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    """A spring and friction near rest that only the recordings to learn from have."""
    folder = tmp_path_factory.mktemp("contradicted")

    def cause(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        return several(k, q, dq) if k < 2 else rubbing(k, q, dq)

    return told(study(folder, cause, runs=4, held=2))


def test_what_held_out_recordings_contradict_is_suspected(contradicted: Diagnosis) -> None:
    friction = {("coulomb_friction", ("j1",)), ("coulomb_friction", ("j2",))}
    assert named(contradicted.findings) == friction
    assert named(contradicted.suspected) == {
        ("position_dependent_spring", ("j2",)),
        ("stribeck_friction", ("j1",)),
    }
    assert all("contradict" in each.statement for each in contradicted.suspected)


def test_what_is_contradicted_does_not_spoil_the_rest(contradicted: Diagnosis) -> None:
    assert_friction(contradicted)
    for each in contradicted.joints.values():
        assert each.after < 2.0 * each.noise_floor


def test_days_that_differ_widen_the_interval(tmp_path: Path) -> None:
    factors = np.array([0.7, 1.3, 0.85, 1.15])

    def changing(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        return factors[k] * rubbing(k, q, dq)

    stds = {}
    for each in (rubbing, changing):
        diagnosis = told(study(tmp_path, each, runs=4, days="abcd"))
        assert named(diagnosis.findings) == {("coulomb_friction", (f"j{k}",)) for k in (1, 2)}
        levels = [f.parameters["level"] for f in sorted(diagnosis.findings, key=lambda f: f.joints)]
        for level, true in zip(levels, RUBS, strict=False):
            assert level.interval95[0] < true < level.interval95[1]
        stds[each] = np.array([level.std for level in levels])
    error = factors.std(ddof=1) / np.sqrt(4)  # of a mean of four days
    assert stds[changing] / RUBS[:2] == pytest.approx(error, rel=0.5)
    assert (stds[changing] > 2.0 * stds[rubbing]).all()


@pytest.mark.parametrize(("first", "last"), [(0.5, 1.0), (3.0, 3.05), (3.0, 3.6), (7.5, 8.0)])
def test_a_study_whose_rows_hardly_act_ends(tmp_path: Path, first: float, last: float) -> None:
    """Joints that move for a moment, without noise, and stand for the rest of it."""
    whole = study(tmp_path, rubbing, noise=0.0, seconds=8.0)
    halted = []
    for each in whole.recordings:
        at = np.clip(each.time, first, last)
        moving = ((each.time >= first) & (each.time <= last))[:, None]
        index = np.round(at / PERIOD).astype(int)
        assert each.dq is not None
        assert each.tau is not None
        tau = np.where(moving, each.tau[index], 0.0)
        halted.append(replace(each, q=each.q[index], dq=each.dq[index] * moving, tau=tau))
    diagnosis = told(replace(whole, recordings=tuple(halted)))
    assert set(diagnosis.joints) == {"j1", "j2"}
    assert diagnosis.verdict in ("cannot_tell", "mismatch_unexplained")
