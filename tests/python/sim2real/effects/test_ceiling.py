"""Torques' ceilings, seen in torques alone: of a level, of a line that falls, and of neither."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Study, diagnose
from pdoik.sim2real.motion import Ceiling, ceiling_of, prepare
from pdoik.sim2real.thresholds import LimitThresholds
from sim2real_known_causes import NOISE, rubbing, study

NO_LOAD = 4.0  # [rad/s]
LIMITS = LimitThresholds()


def limited(made: Study, level: float, no_load: float = np.inf) -> Study:
    """The second joint's torques cut off, and noise as before on what is given."""
    rng = np.random.default_rng(9)
    recordings = []
    for each in made.recordings:
        assert each.tau is not None
        assert each.dq is not None
        tau, along = each.tau.copy(), np.sign(each.tau[:, 1]) * each.dq[:, 1]
        most = level * np.clip(1.0 - along / no_load, 0.0, 2.0 if np.isfinite(no_load) else 1.0)
        over = np.abs(tau[:, 1]) > most
        given = np.sign(tau[:, 1]) * most + NOISE * rng.standard_normal(len(most))
        tau[over, 1] = given[over]
        recordings.append(replace(each, tau=tau))
    return replace(made, recordings=tuple(recordings))


def seen(made: Study, j: int = 1) -> Ceiling | None:
    return ceiling_of(prepare(made).fit.motions, j, LIMITS)


@pytest.mark.parametrize("share", [0.5, 0.7])
def test_a_level_is_found_where_torques_pile_up(tmp_path: Path, share: float) -> None:
    made = study(tmp_path, rubbing)
    highest = max(float(np.abs(each.tau[:, 1]).max()) for each in made.recordings)  # type: ignore[index]
    found = seen(limited(made, share * highest))
    assert found is not None
    assert found.no_load == np.inf
    assert abs(found.level - share * highest) < 1.96 * found.level_std < 0.1 * found.level
    assert found.occasions >= LIMITS.least_occasions


def test_a_line_that_falls_with_speed_is_told_from_a_level(tmp_path: Path) -> None:
    made = study(tmp_path, rubbing)
    highest = max(float(np.abs(each.tau[:, 1]).max()) for each in made.recordings)  # type: ignore[index]
    found = seen(limited(made, 0.7 * highest, NO_LOAD))
    assert found is not None
    assert found.no_load == pytest.approx(NO_LOAD, abs=2.0 * found.no_load_std + 0.2)
    assert found.level == pytest.approx(0.7 * highest, rel=0.1)


@pytest.mark.parametrize("noise", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("slow", [0.3, 1.0])
def test_sound_joints_have_none(tmp_path: Path, noise: float, slow: float) -> None:
    made = study(tmp_path, rubbing, 3, noise=noise, slow=slow)
    assert [seen(made, j) for j in range(3)] == [None] * 3


def test_torque_that_is_all_friction_is_no_ceiling(tmp_path: Path) -> None:
    """A joint that turns evenly bears the same torque throughout, and nothing makes up for it."""

    def heavy(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        return 1000.0 * rubbing(k, q, dq)

    assert seen(study(tmp_path, heavy)) is None


def test_it_is_told_without_any_command(tmp_path: Path) -> None:
    made = study(tmp_path, rubbing, held=1)
    highest = max(float(np.abs(each.tau[:, 1]).max()) for each in made.recordings)  # type: ignore[index]
    diagnosis = diagnose(limited(made, 0.6 * highest))
    (found,) = (each for each in diagnosis.findings if each.effect == "torque_saturation")
    assert found.joints == ("j2",)
    low, high = found.parameters["level"].interval95
    assert low < 0.6 * highest < high
    assert {each.effect for each in found.equivalents} == {"torque_speed_limit"}
    assert found.evidence.channels == ("tau",)


@pytest.mark.parametrize(("share", "found"), [(0.67, 1), (1.05, 0)])
def test_one_that_judges_never_reach_must_stand_out_by_itself(
    tmp_path: Path, share: float, found: int
) -> None:
    """The recording that only judges is too slow to reach it, and says nothing against it."""
    made, slow = study(tmp_path, rubbing), study(tmp_path, rubbing, slow=0.03)
    highest = max(float(np.abs(each.tau[:, 1]).max()) for each in made.recordings)  # type: ignore[index]
    judge = replace(slow.recordings[0], role="validate", name="slow.csv")
    whole = replace(made, recordings=(*limited(made, share * highest).recordings, judge))
    said = [each for each in diagnose(whole).findings if each.effect == "torque_saturation"]
    assert len(said) == found
