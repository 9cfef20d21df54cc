"""Torques where one joint stands elsewhere are those of the rigid body put there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.motion import Motion, RigidBody, motion_of, prepare, torque_turned
from sim2real_floating import Hidden
from sim2real_floating import study as floating_study
from sim2real_motions import CUTOFF, moved, recording, write_arm


def arm_with_a_slider(folder: Path) -> Motion:
    robot = write_arm(folder, 3)
    text = robot.read_text().replace('"j2" type="revolute"', '"j2" type="prismatic"')
    robot.write_text(text)
    body = RigidBody(robot, ("j1", "j2", "j3"), None)
    run = recording(body, 3, 4.0, tau_cmd=None, q_des=None, dq_des=None)
    return motion_of(run, body, None, CUTOFF, np.full(3, 1e-14), None)


def legs(folder: Path) -> Motion:
    return prepare(floating_study(folder, Hidden(), runs=1, seconds=4.0)).fit.motions[0]


@pytest.mark.parametrize("made", [lambda f: moved(f, 3, seconds=4.0), arm_with_a_slider, legs])
def test_turned_torques_are_the_bodys_own(made: object, tmp_path: Path) -> None:
    motion = made(tmp_path)  # type: ignore[operator]
    assert motion.body is not None
    size = np.abs(motion.tau_without_rotor()).max()
    for j in range(motion.body.n):
        for by in (0.003, -0.35, 0.2, 1.1):
            q = motion.q.copy()
            q[:, j] += by
            there = motion.body.torque(q, motion.dq, motion.ddq)
            np.testing.assert_allclose(torque_turned(motion, j, by), there, atol=1e-9 * size)
            assert np.abs(there - motion.tau_without_rotor()).max() > 1e-6 * size
        assert [key for key in motion.cache if key.startswith("turned")] == [f"turned {j}"]
