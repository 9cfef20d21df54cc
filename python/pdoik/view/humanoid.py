"""What the page knows of the H1 besides its description: a stance, its feet, and the floor."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.spatial import ConvexHull

import pdoik

from .h1_shapes import (
    FEET,
    JOINT_NAMES,
    ROOT_LINK,
    SOLE_HALF_WIDTH,
    SOLE_HEEL,
    SOLE_HEIGHT,
    SOLE_TOE,
)

FloatArray = npt.NDArray[np.float64]

SUPPORT_MARGIN = 0.01  # [m]
_UPRIGHT = (*FEET, ROOT_LINK, "torso_link")  # bases whose z axis is up in the stance
_KNEE = 0.35  # [rad]
_STANCE = {  # of either side; the right one's roll is the other way, [rad]
    "hip_pitch": -_KNEE / 2,
    "knee": _KNEE,
    "ankle": -_KNEE / 2,
    "shoulder_pitch": 0.2,
    "shoulder_roll": 0.15,
    "elbow": 0.8,
}


def is_h1(robot: pdoik.Robot) -> bool:
    return robot.name == "h1" and set(JOINT_NAMES) <= set(robot.joint_names)


def first_posture(robot: pdoik.Robot) -> FloatArray:
    """The H1 on bent knees; of other robots the middle of the ranges, (n,)."""
    q = robot.mid_configuration()
    if is_h1(robot):
        for i, name in enumerate(robot.joint_names):
            side, _, part = name.removesuffix("_joint").partition("_")
            if name in JOINT_NAMES:
                mirrored = side == "right" and part == "shoulder_roll"
                q[i] = (-1 if mirrored else 1) * _STANCE.get(part, 0.0)
    return np.asarray(q)


def can_balance(robot: pdoik.Robot) -> bool:
    """Whether the page knows where the robot's soles are and which way is up."""
    return is_h1(robot) and robot.base_link in _UPRIGHT


def balance_over_feet() -> pdoik.Balance:
    """The centre of mass over the hull of both soles."""
    sole = [
        (x, y, -SOLE_HEIGHT)
        for x in (SOLE_HEEL, SOLE_TOE)
        for y in (-SOLE_HALF_WIDTH, SOLE_HALF_WIDTH)
    ]
    return pdoik.Balance(contacts=dict.fromkeys(FEET, sole), support_margin=SUPPORT_MARGIN)


def floor_height(robot: pdoik.Robot) -> float:
    """Where the floor is drawn: under the H1's soles in its first posture, otherwise at 0 [m]."""
    if not can_balance(robot):
        return 0.0
    q = first_posture(robot)
    return float(min(robot.fk(q, foot)[2, 3] for foot in FEET)) - SOLE_HEIGHT


def object_frame(robot: pdoik.Robot, q: FloatArray) -> FloatArray:
    """Pose of the frame that logs have an object in: the H1's pelvis, or the base, (4, 4) [m]."""
    return np.asarray(robot.fk(q, ROOT_LINK if is_h1(robot) else robot.base_link))


def support_polygon(robot: pdoik.Robot, q: FloatArray, of: pdoik.Balance) -> FloatArray:
    """The hull of the contacts seen from above, its corners in order, at their mean height.

    Returns:
        Shape (K, 3), base frame [m].
    """
    points = np.concatenate(
        [
            np.asarray(local) @ robot.fk(q, link)[:3, :3].T + robot.fk(q, link)[:3, 3]
            for link, local in of.contacts.items()
        ]
    )
    corners = points[ConvexHull(points[:, :2]).vertices]
    corners[:, 2] = points[:, 2].mean()
    return np.asarray(corners)
