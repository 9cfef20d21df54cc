"""What pdoik solve found, together with what it was asked."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import pdoik

from .obstacles import Obstacles
from .question import Question


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """A result together with what it is a result of."""

    robot: pdoik.Robot
    options: pdoik.Options
    question: Question
    result: pdoik.Result
    obstacles: Obstacles | None = None
    surface_clearance: float = math.inf  # with the cloud before it was thinned [m]
    surface_room: float = math.inf  # the same of Result.room [m]

    @property
    def answer(self) -> pdoik.Result:
        """Result as the solver gave it."""
        return self.result

    @property
    def nearest(self) -> pdoik.Result:
        return self.result

    @property
    def is_found(self) -> bool:
        return bool(self.result.success)


@dataclass(frozen=True, slots=True, kw_only=True)
class AllSolutions:
    """The same of --all."""

    robot: pdoik.Robot
    options: pdoik.Options
    question: Question
    answer: pdoik.Solutions  # as the solver gave it
    obstacles: Obstacles | None = None

    @property
    def nearest(self) -> pdoik.Result | None:
        """Result nearest to the start, or to the middle of the ranges where there was none."""
        return self.answer[0] if len(self.answer) else None

    @property
    def is_found(self) -> bool:
        return len(self.answer) > 0


def distance_to(solution: AllSolutions, result: pdoik.Result) -> float:
    """Distance of a result from the start, or from the middle of the ranges [rad] (and [m])."""
    q0 = solution.question.q0
    start = solution.robot.mid_configuration() if q0 is None else q0
    return float(np.linalg.norm(result.q - start))
