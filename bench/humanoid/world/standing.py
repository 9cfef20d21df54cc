"""A posture to stand in: feet in place, pelvis upright, knees a little bent, CoM over the soles."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.humanoid.world.robot import TIP_LINK, Setup, robot_in_world
from pdoik.view.h1_shapes import JOINT_NAMES, ROOT_LINK

COM_LOWER = np.array([-0.16, -0.07, 0.8])  # Eq. com, world [m]
COM_UPPER = np.array([0.16, 0.075, 0.94])
# How far the CoM is ahead of the ankles [m]. Soles: their middle is at 0.062. On a weld and a ball
# one ankle's 40 N m holds 0.08 m to either side.
COM_AHEAD = {"floor": 0.05, "welds": 0.05, "weld and ball": 0.0}
KNEE = 0.35  # [rad]

_COMFORT = {  # what the joints without a task of their own hold to, [rad]
    "left_knee_joint": KNEE,
    "right_knee_joint": KNEE,
    "left_hip_pitch_joint": -KNEE / 2,
    "right_hip_pitch_joint": -KNEE / 2,
    "left_ankle_joint": -KNEE / 2,
    "right_ankle_joint": -KNEE / 2,
    "left_shoulder_roll_joint": 0.15,
    "right_shoulder_roll_joint": -0.15,
    "left_shoulder_pitch_joint": 0.2,
    "right_shoulder_pitch_joint": 0.2,
    "left_elbow_joint": 0.8,
    "right_elbow_joint": 0.8,
}


@cache
def _standing(setup: Setup) -> tuple[float, ...]:
    robot = robot_in_world(setup)
    comfort = np.array([_COMFORT.get(name, 0.0) for name in JOINT_NAMES])
    # The weight of a hard task is 1e4 times that of the joints' wish; the paper asks only for the
    # right ankle's position, so its tilt is a wish there.
    tilt_weight = 0.1 if setup.feet == "weld and ball" else 100.0

    def residuals(q: FloatArray) -> FloatArray:
        T_world_tip, T_world_pelvis = robot.fk(q, TIP_LINK), robot.fk(q, ROOT_LINK)
        return np.concatenate(
            [
                100.0 * (T_world_tip - setup.T_world_tip)[:3, 3],
                tilt_weight * _rotation_error(T_world_tip, setup.T_world_tip),
                100.0 * T_world_pelvis[:2, 2],  # its z axis, upright
                100.0 * (robot.center_of_mass(q)[:2] - [0.0, -COM_AHEAD[setup.feet]]),
                0.01 * (q - comfort),
            ]
        )

    start = np.clip(comfort, robot.lower + 1e-3, robot.upper - 1e-3)
    bounds = (robot.lower, robot.upper)
    found = least_squares(residuals, start, bounds=bounds, xtol=1e-12, ftol=1e-12)
    return tuple(float(angle) for angle in found.x)


def standing_posture(setup: Setup) -> FloatArray:
    """Feet as the set-up has them, CoM over the soles and in the box of Eq. com, (19,) [rad]."""
    return np.array(_standing(setup))


def _rotation_error(T: FloatArray, T_goal: FloatArray) -> FloatArray:
    return np.asarray(Rotation.from_matrix(T_goal[:3, :3].T @ T[:3, :3]).as_rotvec())
