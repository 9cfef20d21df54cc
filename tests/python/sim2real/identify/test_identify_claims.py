"""What is claimed of arms with known causes: names, figures, intervals, and what is not said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Diagnosis
from sim2real_known_causes import PERIOD, RUBS, named, rubbing, several, study, told


def assert_friction(diagnosis: Diagnosis, n: int = 2) -> None:
    """Dry friction of all joints, whose intervals hold the truth and are not useless."""
    found = {f.joints[0]: f for f in diagnosis.findings if f.effect == "coulomb_friction"}
    for j in range(n):
        level = found[f"j{j + 1}"].parameters["level"]
        assert level.interval95[0] < RUBS[j] < level.interval95[1]
        assert level.value == pytest.approx(RUBS[j], rel=0.03)
        assert 0.01 * RUBS[j] < level.std < 0.06 * RUBS[j]


@pytest.mark.parametrize("noise", [1.0, 0.3, 0.0])
def test_a_sound_machine_is_told_nothing(tmp_path: Path, noise: float) -> None:
    diagnosis = told(study(tmp_path, noise=noise))
    assert diagnosis.findings == diagnosis.suspected == ()
    assert diagnosis.verdict == "no_mismatch"


def test_friction_of_all_joints_is_told_with_intervals_that_hold_it(tmp_path: Path) -> None:
    diagnosis = told(study(tmp_path, rubbing, 3))
    assert named(diagnosis.findings) == {("coulomb_friction", (f"j{k}",)) for k in (1, 2, 3)}
    assert diagnosis.verdict == "mismatch_explained"
    assert_friction(diagnosis, 3)


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
