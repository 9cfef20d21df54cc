"""What the Python peers share: the arm's hulls as shapes, and the verdict on an answer.

None of them may claim an answer that this verdict does not hold for: what they believe themselves
counts as little as a restart.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm
from bench.ik.methods.ours import asked_for
from bench.ik.methods.problem import Problem, Terms

POINT_RADIUS = 1e-3  # of a point that has none, for those who know no points [m]
_DRAWS = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class Hull:
    """A prolate spheroid on a link, all in the link's frame [m]."""

    link: str
    center: FloatArray  # (3,)
    axis: FloatArray  # (3,), of length 1
    semi_major: float
    semi_minor: float


def hulls_of(robot: pdoik.Robot) -> list[Hull]:
    """The robot's occupancy.

    Raises:
        ValueError: A hull is between two links.
    """
    balls = [(link, center, link, center, r) for link, center, r in robot.occupancy.spheres]
    return [_hull(*hull) for hull in (*balls, *robot.occupancy.spheroids)]


def _hull(link: str, a: Sequence[float], other: str, b: Sequence[float], semi_major: float) -> Hull:
    if link != other:
        raise ValueError(f"a hull between {link} and {other}, expected both foci on one")
    focus_a, focus_b = np.array(a), np.array(b)
    focal = float(np.linalg.norm(focus_b - focus_a)) / 2
    return Hull(
        link=link,
        center=(focus_a + focus_b) / 2,
        axis=(focus_b - focus_a) / (2 * focal) if focal > 0 else np.array([0.0, 0.0, 1.0]),
        semi_major=semi_major,
        semi_minor=float(np.sqrt(semi_major**2 - focal**2)) if focal > 0 else semi_major,
    )


def radius_of(point: FloatArray) -> float:
    """Radius of an obstacle (3,) or (4,), never zero [m]."""
    return max(float(point[3]) if len(point) == 4 else 0.0, POINT_RADIUS)


class Verdict:
    """pdoik.Solver.judge, which only computes: the goal, the limits, the exact clearance."""

    def __init__(self, arm: Arm, terms: Terms) -> None:
        self._arm = arm
        options = pdoik.Options(**asked_for(terms), clearance_tolerance=0.0)  # as compiled peers
        self._solver = pdoik.Solver(arm.robot, options)

    def __call__(self, problem: Problem, q: FloatArray) -> pdoik.Result:
        """On q, (n,)."""
        return self._solver.judge(problem.T_base_tip, q, problem.points)

    def of(self, problem: Problem) -> Callable[[FloatArray], bool]:
        """Whether a configuration solves it."""
        return lambda q: self(problem, q).success

    def starts(self, problem: Problem, rng: np.random.Generator) -> Callable[[], FloatArray]:
        """Draws configurations clear of obstacles, or any where that is hard to find."""

        def draw() -> FloatArray:
            for _ in range(_DRAWS):
                q = self._arm.random_configuration(rng)
                if self(problem, q).clearance > 0:
                    break
            return q

        return draw
