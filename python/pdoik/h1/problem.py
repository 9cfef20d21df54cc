"""H1's dodging as the solver sees it: feet, centre of mass, hulls, what a joint's motion costs."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import pdoik
from pdoik.h1.model import Setup
from pdoik.h1.robot import BASE_LINK, JOINT_NAMES, TIP_LINK, FloatArray, figures
from pdoik.h1.shapes import SOLE_HALF_WIDTH, SOLE_HEEL, SOLE_HEIGHT, SOLE_TOE
from pdoik.h1.standing import COM_LOWER, COM_UPPER

TORSO = "torso_link"
GRAVITY = 9.81  # [m/s^2]
MAX_OBSTACLES = 20_000
SUPPORT_MARGIN = 0.05  # inside the soles' hull, for feet that are free: y about -0.12 to 0 [m]

_COST = {  # of a joint's motion: about what it moves
    "hip": 3.0,
    "knee": 2.0,
    "ankle": 1.0,
    "torso": 2.0,
    "shoulder": 0.3,
    "elbow": 0.1,
}
JOINT_WEIGHTS: FloatArray = np.array(
    [next(cost for part, cost in _COST.items() if part in name) for name in JOINT_NAMES]
)


@cache
def robot_in_world(setup: Setup) -> pdoik.Robot:
    """The H1 standing where the set-up has its left foot; tips: the right ankle and the torso."""
    return pdoik.Robot.builtin("h1", BASE_LINK, [TIP_LINK, TORSO], T_world_base=setup.T_world_base)


def foot_goal(setup: Setup) -> dict[str, Any]:
    """The right foot where the set-up has it: on a ball (the paper) its position, else flat."""
    kind = "position" if setup.feet == "weld and ball" else "pose"
    return {TIP_LINK: pdoik.Goal(setup.T_world_tip, type=kind)}


def balance(setup: Setup) -> pdoik.Balance:
    """The paper's box (Eq. com); for feet that are free, over the soles as well."""
    if setup.feet != "floor":
        return pdoik.Balance(com_lower=COM_LOWER, com_upper=COM_UPPER)
    sole = [
        [x, y, -SOLE_HEIGHT]
        for x, y in (
            (SOLE_HEEL, -SOLE_HALF_WIDTH),
            (SOLE_TOE, -SOLE_HALF_WIDTH),
            (SOLE_TOE, SOLE_HALF_WIDTH),
            (SOLE_HEEL, SOLE_HALF_WIDTH),
        )
    ]
    return pdoik.Balance(
        com_lower=[COM_LOWER[0], -np.inf, COM_LOWER[2]],
        com_upper=[COM_UPPER[0], np.inf, COM_UPPER[2]],
        contacts={BASE_LINK: sole, TIP_LINK: sole},
        support_margin=SUPPORT_MARGIN,
    )


def moment_limits(setup: Setup, force: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What the two ankles together may turn the robot with, least and most, [N m].

    Both motors' effort; and for feet that are free what keeps the centre of pressure on the soles,
    which the heels bound first: the ground's force times where the sole ends, 23 N m at rest.

    Args:
        setup: What holds the feet.
        force: The ground's vertical force, (K,) [N].

    Returns:
        Lower and upper limits, (K,) each.
    """
    effort = np.full(len(force), 2 * figures().joints["left_ankle_joint"].effort)
    if setup.feet == "weld and ball":
        effort /= 2  # a foot on a ball takes no moment
    if setup.feet != "floor":
        return -effort, effort
    return np.maximum(-effort, -SOLE_TOE * force), np.minimum(effort, -SOLE_HEEL * force)


def options(setup: Setup, **changes: Any) -> pdoik.Options:
    """Balanced, off itself, near a posture by JOINT_WEIGHTS."""
    given: dict[str, Any] = {
        "balance": balance(setup),
        "self_collision": True,
        "max_obstacles": MAX_OBSTACLES,
        "joint_weights": JOINT_WEIGHTS,
        **changes,
    }
    return pdoik.Options(**given)
