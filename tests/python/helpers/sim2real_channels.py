"""A small arm whose description does not tell all, and whose torques may lie."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pdoik.sim2real import Study
from pdoik.sim2real.motion import RigidBody
from sim2real_motions import PERIOD, recording, wave, write_arm

SECONDS = 20.0
JOINTS = ("j1", "j2", "j3")


def study(folder: Path, rotor: tuple[float, ...], factor: tuple[float, ...]) -> Study:
    """An arm with rotors and dry friction that its description does not tell of."""
    robot = write_arm(folder, 3)
    body = RigidBody(robot, JOINTS, None)
    time = PERIOD * np.arange(round(SECONDS / PERIOD))
    q, dq, ddq = (wave(time, 3, order) for order in range(3))
    tau = body.dynamics(q, dq, ddq).tau + np.array(rotor) * ddq + 1.5 * np.tanh(dq / 0.01)
    tau = tau + 0.02 * np.random.default_rng(0).standard_normal(tau.shape)
    alone = {"tau_cmd": None, "q_des": None, "dq_des": None}
    logged = recording(body, 3, SECONDS, tau=tau * np.array(factor), **alone)
    return Study(
        folder=folder, robot=robot, joints=JOINTS, recordings=(logged,), split="by the test"
    )
