"""One question, one answer, and what answers: the interface that every IK method is put behind."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Goal = Literal["pose", "axis"]
Axis = Literal["x", "z"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Terms:
    """What all problems of an experiment have in common; a method is made for them."""

    goal: Goal = "axis"  # "axis": position and the direction of one of the tip's axes; "pose": all
    goal_axis: Axis = "z"  # the last joint's own axis for the shipped arms
    position_tolerance: float = 0.01  # [m]
    rotation_tolerance: float = 0.01  # [rad]
    max_time: float = 60.0  # of one solve [s]
    seed: int = 0  # of what a method draws


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A target among obstacle points."""

    T_base_tip: FloatArray  # (4, 4)
    q0: FloatArray  # where to start, (n,) [rad]
    points: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    """(K, 3), or (K, 4) with a radius each [m]; base frame."""
    near_q0: bool = True
    """Whether answers near q0 are preferred; if not, q0 is mid-range, where all start anyway."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a method returned. Whether it is right is for a judge to say."""

    q: FloatArray  # the best it has, claimed or not, (n,) [rad]
    claimed: bool  # in its own opinion the problem is solved
    time: float  # [s]
    iterations: int  # over all starts
    evaluations: int  # of its objective, over all starts
    restarts: int = 0  # starts beyond the first


class Method(Protocol):
    """A solver, made for one arm and one set of terms; making it is not part of any time."""

    name: str
    language: str  # of what runs inside a solve

    def solve(self, problem: Problem) -> Answer:
        """Solve it in at most the terms' time."""
        ...
