"""What comes late or reads too much: signals of a moment ago, motions that were smaller."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.motion import Motion, Place, derivative, shifted
from sim2real_columns import STEP, added, tip_change, tips, torque, torques
from sim2real_motions import INSIDE, PERIOD, moved, pd, wave


def test_a_late_command_is_the_command_of_a_moment_ago(motion: Motion) -> None:
    d, controller = 0.0137, motion.controller
    assert controller is not None
    late_q, late_dq = (
        wave(motion.time + 0.01 - d, 3, k) - wave(motion.time + 0.01, 3, k) for k in (0, 1)
    )
    expected = controller.kp * late_q + controller.kd * late_dq
    for j in range(3):
        found = added("command_delay", motion, Place(joints=(j,)), (0.0, d), delay=d)
        assert set(found) == {("law", j)}
        assert found["law", j][INSIDE] == pytest.approx(expected[INSIDE, j], abs=5e-3)
        assert np.abs(expected).max() > 0.5
        assert motion.command is not None
        told = motion.command[:, j]
        found = added("command_delay", motion, Place(joints=(j,)), (1.0, d), delay=d)
        assert found["drive", j] == pytest.approx(shifted(told, d, PERIOD) - told, abs=1e-12)


def test_a_lagging_drive_satisfies_its_differential_equation(motion: Motion) -> None:
    T, place = 0.05, Place(joints=(2,))
    assert motion.command is not None
    told = motion.command[:, 2]
    change = added("actuator_lag", motion, place, (1.0, T), time_constant=T)["drive", 2]
    exerted = told + change
    left = T * derivative(exerted, PERIOD) + exerted - told
    assert np.abs(left[INSIDE]).max() < 2e-3 * np.abs(change).max()
    assert np.abs(change).max() > 0.1


def test_a_late_log_of_torque_or_speed_is_the_torque_or_speed_of_a_moment_ago(
    motion: Motion,
) -> None:
    assert motion.body is not None
    s = -0.021
    then = [wave(motion.time - s, 3, k) for k in range(3)]
    before = motion.body.dynamics(*then).tau - motion.tau
    found = added("timestamp_skew", motion, Place(joints=(1,)), (0.0, s), skew=s)
    assert found["torque", 1][INSIDE] == pytest.approx(before[INSIDE, 1], abs=2e-2)
    assert np.abs(before).max() > 0.5
    found = added("timestamp_skew", motion, Place(joints=(1,)), (1.0, s), skew=s)
    late = then[1][:, 1] - motion.dq[:, 1]
    assert found["velocity", 1][INSIDE] == pytest.approx(late[INSIDE], abs=2e-3)
    assert motion.controller is not None
    assert found["law", 1] == pytest.approx(motion.controller.kd[1] * found["velocity", 1])


def test_a_position_that_reads_too_much_is_a_motion_that_was_smaller(motion: Motion) -> None:
    assert motion.body is not None

    def needed(b: float) -> np.ndarray:
        scale = np.array([1.0, 1.0 + b, 1.0])
        return torque(motion, q=motion.q * scale, dq=motion.dq * scale, ddq=motion.ddq * scale)

    columns = CATALOGUE["sensor_gain"].columns(motion, Place(joints=(1,)), (1.0,))
    columns = {key: column[:, 0] for key, column in columns.items()}
    difference = (needed(STEP) - needed(-STEP)) / (2 * STEP)
    assert torques(columns, 3) == pytest.approx(difference, abs=1e-3)
    q = motion.q * np.array([1.0, 1.0 + STEP, 1.0])
    assert tips(columns) == pytest.approx(tip_change(motion, motion.body, q) / STEP, abs=1e-3)
    found = added("sensor_gain", motion, Place(joints=(1,)), (1.0,), gain=1.25)
    assert found["velocity", 1] == pytest.approx((1 / 1.25 - 1) * motion.dq[:, 1])


def test_a_speed_that_reads_too_much_shows_in_speed_and_in_the_controllers_law(
    tmp_path: Path,
) -> None:
    right = moved(tmp_path, 2, controller=pd(2))
    speed = right.recording.dq
    assert speed is not None
    wrong = moved(tmp_path, 2, controller=pd(2), dq=speed * [1.0, 1.4])
    assert wrong.law is not None
    assert right.law is not None
    found = added("sensor_gain", right, Place(joints=(1,)), (0.0,), gain=1.4)
    assert found["velocity", 1][INSIDE] == pytest.approx(0.4 * speed[INSIDE, 1], abs=1e-3)
    by_law = (right.law - wrong.law)[INSIDE, 1]  # given less law: what the law lacks
    assert found["law", 1][INSIDE] == pytest.approx(by_law, abs=1e-2)


@pytest.mark.parametrize("compensated", [False, True])
def test_a_position_that_the_log_alone_has_wrong_spoils_the_law_worked_out_from_it(
    tmp_path: Path, compensated: bool
) -> None:
    right = moved(tmp_path, 2, controller=replace(pd(2), gravity_compensation=compensated))
    gain, place = 1.02, Place(joints=(1,))
    sensed = added("sensor_gain", right, place, (1.0,), gain=gain)
    logged = added("sensor_gain", right, place, (2.0,), gain=gain)
    assert right.controller is not None
    assert right.body is not None
    true = right.q / [1.0, gain]
    lacks = right.controller.kp * (right.q - true)  # given, with the true position, less the law
    if compensated:
        lacks += right.body.gravity(true) - right.body.gravity(right.q)
    assert ("law", 1) not in sensed
    assert logged["law", 1] == pytest.approx(lacks[:, 1], abs=0.01 * np.abs(lacks).max())
    assert (("law", 0) in logged) == (compensated and np.abs(lacks[:, 0]).max() > 1e-6)
