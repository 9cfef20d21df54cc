"""Whether a robot's links meet one another, by coal on their meshes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import combinations

import coal
import numpy as np
import numpy.typing as npt

import pdoik
from bench.ik.judges.meshes import Body

FloatArray = npt.NDArray[np.float64]


def self_judge(
    robot: pdoik.Robot, meshes: Mapping[str, FloatArray]
) -> Callable[[FloatArray], bool]:
    """What says of a configuration whether two links meet, by coal on their meshes.

    Links that are joined by a joint may, and so may the robot's ignored pairs.

    Args:
        robot: Whose poses and ignored pairs.
        meshes: Triangles by link, (m, 3, 3) each, in the link's frame [m].
    """
    trees = {link: Body.of(link, triangles).tree for link, triangles in meshes.items()}
    ignored = {frozenset(pair) for pair in robot.ignored_pairs}
    rng = np.random.default_rng(0)
    rigid_or_joined = _joined(robot, list(trees), rng)
    pairs = [
        pair
        for pair in combinations(trees, 2)
        if frozenset(pair) not in ignored and frozenset(pair) not in rigid_or_joined
    ]

    def meet(q: FloatArray) -> bool:
        poses = {link: robot.fk(q, link) for link in trees}
        places = {link: coal.Transform3s(T[:3, :3], T[:3, 3]) for link, T in poses.items()}
        for a, b in pairs:
            result = coal.CollisionResult()
            coal.collide(trees[a], places[a], trees[b], places[b], coal.CollisionRequest(), result)
            if result.isCollision():
                return True
        return False

    return meet


def _joined(robot: pdoik.Robot, links: list[str], rng: np.random.Generator) -> set[frozenset[str]]:
    """Pairs that at most one joint moves against each other, by moving one after the other."""
    q = rng.uniform(robot.lower, robot.upper)
    moves: dict[frozenset[str], int] = {frozenset(pair): 0 for pair in combinations(links, 2)}
    before = {link: robot.fk(q, link) for link in links}
    for joint in range(robot.dof):
        moved = q.copy()
        moved[joint] = robot.lower[joint] if q[joint] > 0 else robot.upper[joint]
        after = {link: robot.fk(moved, link) for link in links}
        for pair in combinations(links, 2):
            a, b = pair
            apart = [np.linalg.inv(T[a]) @ T[b] for T in (before, after)]
            moves[frozenset(pair)] += not np.allclose(*apart, atol=1e-9)
    return {pair for pair, count in moves.items() if count <= 1}
