"""What the Python peers share: the arm's hulls as shapes, and the verdict on an answer.

None of them may claim an answer that this verdict does not hold for: what they believe themselves
counts as little as a restart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import pdoik
from bench.ik.experiment import Arm, FloatArray
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
    hulls = []
    for link, center, radius in robot.occupancy.spheres:
        hulls.append(_hull(link, np.array(center), np.array(center), radius))
    for link_a, focus_a, link_b, focus_b, semi_major in robot.occupancy.spheroids:
        if link_a != link_b:
            raise ValueError(f"a hull between {link_a} and {link_b}, expected both foci on one")
        hulls.append(_hull(link_a, np.array(focus_a), np.array(focus_b), semi_major))
    return hulls


def _hull(link: str, focus_a: FloatArray, focus_b: FloatArray, semi_major: float) -> Hull:
    focal = float(np.linalg.norm(focus_b - focus_a)) / 2
    return Hull(
        link=link,
        center=(focus_a + focus_b) / 2,
        axis=(focus_b - focus_a) / (2 * focal) if focal > 0 else np.array([0.0, 0.0, 1.0]),
        semi_major=semi_major,
        semi_minor=float(np.sqrt(semi_major**2 - focal**2)) if focal > 0 else semi_major,
    )


def radius_of(point: FloatArray) -> float:
    """Of an obstacle (3,) or (4,), never zero [m]."""
    return max(float(point[3]) if len(point) == 4 else 0.0, POINT_RADIUS)


class Verdict:
    """pdoik.Solver.judge, which only computes: the goal, the limits, the exact clearance."""

    def __init__(self, arm: Arm, terms: Terms) -> None:
        self._arm = arm
        self._solver = pdoik.Solver(
            arm.robot,
            pdoik.Options(
                goal=terms.goal,
                position_tolerance=terms.position_tolerance,
                rotation_tolerance=terms.rotation_tolerance,
                clearance_tolerance=0.0,  # as the compiled peers have it
            ),
        )

    def __call__(self, problem: Problem, q: FloatArray) -> pdoik.Result:
        """On q, (n,)."""
        return self._solver.judge(problem.T_base_tip, q, problem.points)

    def clear_start(self, problem: Problem, rng: np.random.Generator) -> FloatArray:
        """A random configuration clear of obstacles, (n,), or any where that is hard to find."""
        for _ in range(_DRAWS):
            q = self._arm.random_configuration(rng)
            if self(problem, q).clearance > 0:
                break
        return q
