"""What a session hands to the page: a posture with its verdict, or all solutions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik.solids import NearestObstacle

from .goals import TipGoal, choice_text
from .obstacles import Obstacles

FloatArray = npt.NDArray[np.float64]
Origin = Literal["target", "joints", "log", "solution"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shown:
    """What there is to show after a wish was granted."""

    robot: pdoik.Robot
    q: FloatArray  # (n,), the posture
    goals: dict[str, TipGoal]  # of each tip link; a free one's target is where it is
    met: dict[str, int]  # which target of each tip is met, or comes nearest
    options: pdoik.Options  # of the solver
    result: pdoik.Result  # of q: the solver's, or its judge's where q was given
    found: pdoik.Result  # what the search said: `result`, unless it went far and found nothing
    obstacles: FloatArray  # (K, 4), points kept off, base frame; the ball is the last row [m]
    cloud: Obstacles  # what they were made from, and the shapes
    nearest: NearestObstacle | None  # of `obstacles` and the shapes
    origin: Origin  # what the wish was for

    @property
    def targets(self) -> dict[str, FloatArray]:
        """The first T_base_tip of each tip link, (4, 4)."""
        return {tip: goal.targets[0] for tip, goal in self.goals.items()}

    @property
    def met_to_tolerance(self) -> bool:
        """Whether all is met, or all but an orientation that has only to be as near as can be."""
        return self.result.success or self.result.status == "nearest"

    @property
    def choice(self) -> str:
        """'goal 2 of 4', or '' where there is no choice."""
        return choice_text(self.goals, self.met)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AllSolutions:
    """What `Session.find_all` found, nearest first."""

    robot: pdoik.Robot
    found: pdoik.Solutions
    choice: str  # of which goals, '' where there is no choice
