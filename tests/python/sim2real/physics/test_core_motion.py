"""A recording's motion: derivatives, the torque to explain, the controller's law."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.motion import Motion, RigidBody, motion_of
from sim2real_motions import CUTOFF, INSIDE, moved, pd, recording, wave, write_arm


def test_a_motion_has_the_derivatives_of_its_positions_and_the_torques_of_its_body(
    motion: Motion,
) -> None:
    assert motion.body is not None
    for values, order, off in ((motion.q, 0, 1e-5), (motion.dq, 1, 1e-4), (motion.ddq, 2, 5e-3)):
        assert values[INSIDE] == pytest.approx(wave(motion.time, 3, order)[INSIDE], abs=off)
    assert motion.torque is not None
    assert motion.tau[INSIDE] == pytest.approx(motion.torque[INSIDE], abs=5e-3)
    assert motion.tip_error is not None
    assert motion.tip_error[INSIDE] == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize(
    ("missing", "source"),
    [
        ((), "tau"),
        (("tau",), "tau_cmd"),
        (("tau", "tau_cmd"), "law"),
        (("tau", "tau_cmd", "q_des"), ""),
    ],
)
def test_torque_is_what_was_measured_else_what_was_commanded_else_the_law(
    tmp_path: Path, missing: tuple[str, ...], source: str
) -> None:
    m = moved(tmp_path, 2, controller=pd(2), **dict.fromkeys(missing))
    assert m.source == source
    assert (m.torque is None) == (source == "")


def test_the_law_is_that_of_a_controller_with_gravity_limits_and_a_period(tmp_path: Path) -> None:
    names = ("j1", "j2")
    body = RigidBody(write_arm(tmp_path, 2), names, None)
    run = recording(body, 2)
    limit = np.array([1e9, 2.0])
    controller = pd(2, torque_limit=limit, period=0.008)
    m = motion_of(run, body, controller, CUTOFF, np.full(2, 1e-14))
    now = run.time - 0.004  # what is held over a period comes half of it late
    q, dq, q_des, dq_des = (wave(now + ahead, 2, k) for ahead in (0.0, 0.01) for k in (0, 1))
    asked = controller.kp * (q_des - q) + controller.kd * (dq_des - dq) + body.gravity(q)
    assert m.law is not None
    assert m.law[INSIDE] == pytest.approx(np.clip(asked, -limit, limit)[INSIDE], abs=1e-9)
    assert np.mean(np.abs(m.law[:, 1]) >= 2.0) > 0.01
