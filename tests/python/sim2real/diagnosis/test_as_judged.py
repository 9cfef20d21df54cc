"""What held-out recordings say of causes, and what stands for what is not stated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Study, diagnose
from sim2real_known_causes import RUBS, Cause, named, rubbing, study, told


def friction(study_: Study, joint: str, speed: float) -> tuple[float, float]:
    """What findings say of a joint's friction at a speed, and half the width of its interval."""
    said = half = 0.0
    for each in diagnose(study_).findings:
        factor = {"coulomb_friction": 1.0, "viscous_friction": speed}.get(each.effect)
        if factor is not None and each.joints == (joint,):
            figure = next(iter(each.parameters.values()))
            low, high = figure.interval95
            said, half = said + factor * figure.value, np.hypot(half, 0.5 * factor * (high - low))
    return said, float(half)


def test_a_level_takes_in_a_slope_that_judges_do_not_bear_out(tmp_path: Path) -> None:
    """On another day the slope is gone: not stated, and the friction is as large."""
    slope = 0.25

    def fading(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        return rubbing(k, q, dq) + (slope if k < 3 else 0.0) * dq

    made = study(tmp_path, fading, runs=4, held=1)
    findings = diagnose(made).findings
    assert ("viscous_friction", ("j2",)) not in named(findings)
    assert ("coulomb_friction", ("j2",)) in named(findings)
    speed = float(np.mean([np.mean(np.abs(each.dq[:, 1])) for each in made.recordings[:3]]))  # type: ignore[index]
    said, half = friction(made, "j2", speed)
    true = RUBS[1] + slope * speed
    assert abs(said - true) < max(half, 0.05 * true)
    assert said - RUBS[1] > 0.5 * slope * speed


def breaking(cause: Cause, recording: int, since: int) -> Cause:
    """A cause that begins within a recording, and stays."""

    def late(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        after = (k > recording) | ((k == recording) & (np.arange(len(q)) >= since))
        return rubbing(k, q, dq) + np.where(np.reshape(after, (-1, 1)), cause(k, q, dq), 0.0)

    return late


def test_a_spring_may_begin_in_the_middle_of_a_recording(tmp_path: Path) -> None:

    def spring(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        return np.stack([np.zeros(len(q)), 6.0 * q[:, 1]], axis=1)

    found = told(study(tmp_path, breaking(spring, 1, 1600))).findings
    (finding,) = (each for each in found if each.effect == "position_dependent_spring")
    assert finding.joints == ("j2",)
    assert finding.begins is not None
    low, high = finding.parameters["stiffness"].interval95
    assert low < 6.0 < high


def test_a_ripple_of_three_waves_a_turn_is_found(tmp_path: Path) -> None:
    """Gravity has one, inertia two."""

    def ripple(k: int, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        wave = np.stack([np.zeros(len(q)), 0.8 * np.sin(3.0 * q[:, 1] + 0.4)], axis=1)
        return rubbing(k, q, dq) + wave

    found = told(study(tmp_path, ripple)).findings
    (finding,) = (each for each in found if each.effect == "torque_ripple")
    assert finding.joints == ("j2",)
    assert finding.values["harmonic"] == pytest.approx(3.0, abs=0.15)
    assert finding.values["amplitude"] == pytest.approx(0.8, rel=0.1)
