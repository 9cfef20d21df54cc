"""One question, one answer, and what answers: the interface that every IK method is put behind."""

from collections.abc import Callable
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, Literal, Protocol

import numpy as np

from bench.common.arrays import FloatArray

Goal = Literal["pose", "axis"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Terms:
    """What all problems of an experiment have in common; a method is made for them."""

    goal: Goal = "axis"  # "axis": position and the direction of one of the tip's axes; "pose": all
    goal_axis: Literal["x", "z"] = "z"  # the last joint's own axis for the shipped arms
    position_tolerance: float = 0.01  # [m]
    rotation_tolerance: float = 0.01  # [rad]
    max_time: float = 60.0  # of one solve [s]
    seed: int = 0  # of what a method draws


@dataclass(frozen=True, slots=True)
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

    @classmethod
    def of(cls, result: Any) -> "Answer":
        """Make it of a result of this library's, or of a compiled peer's answer."""
        fields = {name: getattr(result, name) for name in cls.__slots__ if name != "claimed"}
        return cls(claimed=result.success, **fields)

    def row(self) -> dict[str, Any]:
        """For a table of trials."""
        fields = {name: getattr(self, name) for name in self.__slots__}
        return {**fields, "q": self.q.tolist()}


class Method(Protocol):
    """A solver, made for one arm and one set of terms; making it is not part of any time."""

    name: str
    language: str  # of what runs inside a solve

    def solve(self, problem: Problem) -> Answer:
        """Solve it in at most the terms' time."""
        ...


def with_restarts(
    began: float,
    max_time: float,
    start: FloatArray,
    search: Callable[[FloatArray], tuple[FloatArray, int, int]],
    solves: Callable[[FloatArray], bool],
    draw: Callable[[], FloatArray],
) -> Answer:
    """Searches from a start, then from drawn ones, until one solves it or time is up [s].

    A search gives its answer, how many iterations, and how many searches of its own that took;
    each iteration is one evaluation. Who `solves` asks has the last word on an answer.
    """
    iterations, searches = 0, 0
    while True:
        q, more, own = search(start)
        iterations, searches = iterations + more, searches + own
        found = solves(q)
        time = perf_counter() - began
        if found or time >= max_time:
            break
        start = draw()
    return Answer(
        q=q,
        claimed=bool(found and time < max_time),
        time=time,
        iterations=iterations,
        evaluations=iterations,
        restarts=searches - 1,
    )
