"""The shipped H1, where its ankles are and what holds its feet: nothing here needs MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Literal

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from pdoik.view.h1_shapes import FEET, SOLE_HEIGHT

URDF = Path(str(files("pdoik"))) / "robots" / "h1.urdf"
OCCUPANCY = URDF.with_name("h1.occupancy.yaml")
BASE_LINK, TIP_LINK = FEET  # the solver's base and first end effector
TORSO = "torso_link"
HIP_HALF_SPAN = 0.0875 + 0.11536  # from the URDF: half the ankles' distance at q = 0, [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """Where the ankles are and what holds the feet."""

    name: str
    ankle_x: float  # the left one's; the right one's is its negative, [m]
    feet: Literal["weld and ball", "welds", "floor"]
    com_feedback: bool = False  # whether the controller pulls the CoM to where the posture has it

    @property
    def T_world_base(self) -> FloatArray:
        """Pose of the left ankle link, the solver's base: it faces -y. (4, 4) [m]."""
        return self._ankle(self.ankle_x)

    @property
    def T_world_tip(self) -> FloatArray:
        """Goal of the right ankle link; for `paper` its position only. (4, 4) [m]."""
        return self._ankle(-self.ankle_x)

    @property
    def floor_z(self) -> float:
        """Height of the floor, [m]; z is 0 at the ankles."""
        return -SOLE_HEIGHT

    @staticmethod
    def _ankle(x: float) -> FloatArray:
        T = np.eye(4)
        T[:3, :3] = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]  # ahead is -y, left is +x
        T[0, 3] = x
        return T


PAPER = Setup(name="paper", ankle_x=0.2, feet="weld and ball")
WELDED = Setup(name="welded", ankle_x=HIP_HALF_SPAN, feet="welds")
FREE = Setup(name="free", ankle_x=HIP_HALF_SPAN, feet="floor")
BALANCED = Setup(name="balanced", ankle_x=HIP_HALF_SPAN, feet="floor", com_feedback=True)
SETUPS = {setup.name: setup for setup in (PAPER, WELDED, FREE, BALANCED)}


@cache
def robot_in_world(setup: Setup) -> pdoik.Robot:
    """The H1 standing where the set-up has its left foot; tips: the right ankle and the torso."""
    return pdoik.Robot.builtin("h1", BASE_LINK, [TIP_LINK, TORSO], T_world_base=setup.T_world_base)
