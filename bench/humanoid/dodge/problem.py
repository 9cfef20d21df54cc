"""H1's dodging as the solver sees it: feet, centre of mass, hulls, what a joint's motion costs."""

from __future__ import annotations

from typing import Any

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.humanoid.world.robot import TIP_LINK, Setup
from bench.humanoid.world.standing import COM_LOWER, COM_UPPER
from pdoik.view.h1_shapes import (
    FEET,
    JOINT_NAMES,
    SOLE_HALF_WIDTH,
    SOLE_HEEL,
    SOLE_HEIGHT,
    SOLE_TOE,
)

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
        for x in (SOLE_HEEL, SOLE_TOE)
        for y in (-SOLE_HALF_WIDTH, SOLE_HALF_WIDTH)
    ]
    return pdoik.Balance(
        com_lower=[COM_LOWER[0], -np.inf, COM_LOWER[2]],
        com_upper=[COM_UPPER[0], np.inf, COM_UPPER[2]],
        contacts=dict.fromkeys(FEET, sole),
        support_margin=SUPPORT_MARGIN,
    )


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
