"""Collisions of an arm's meshes with objects' meshes and with themselves, by coal.

Nothing here knows the library's hulls: it says whether what the hulls promise is true.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Self

import coal
import numpy as np
import pinocchio

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm
from bench.ik.judges.arm_meshes import arm_meshes
from bench.ik.judges.triangles import is_inside, touch, tree_of


@dataclass(frozen=True, slots=True)
class Body:
    """A triangle mesh, ready for coal."""

    name: str
    triangles: FloatArray  # (T, 3, 3) [m]
    tree: Any  # coal.BVHModelOBBRSS
    lower: FloatArray  # of its bounding box, (3,) [m]
    upper: FloatArray

    @classmethod
    def of(cls, name: str, triangles: FloatArray) -> Self:
        """The body of these triangles, in whatever frame they are."""
        vertices = triangles.reshape(-1, 3)
        tree = tree_of(vertices, np.arange(len(vertices), dtype=np.int64).reshape(-1, 3))
        return cls(name, triangles, tree, vertices.min(axis=0), vertices.max(axis=0))

    def holds(self, point: FloatArray) -> bool:
        """Whether a point of its frame is inside."""
        in_box = (point > self.lower).all() and (point < self.upper).all()
        return bool(in_box) and is_inside(point, self.triangles)


class MeshJudge:
    """Says which link of an arm runs into which object.

    Two bodies collide when their surfaces meet, or when one holds the other (which surfaces alone
    do not tell: its first vertex is then inside by winding number).

    Raises:
        MissingDescriptionError: The arm's meshes are not installed.
    """

    def __init__(self, arm: Arm) -> None:
        self._model = pinocchio.buildModelFromUrdf(str(arm.urdf))
        self._data = self._model.createData()
        self._links = [
            (self._model.getFrameId(name), Body.of(name, triangles))
            for name, triangles in arm_meshes(arm).items()
        ]

    def collision(self, q: FloatArray, objects: Sequence[Body]) -> str | None:
        """The first pair at q, (n,) [rad], as "link and object"; None if the arm is clear.

        The objects are in the base frame.
        """
        pinocchio.framesForwardKinematics(self._model, self._data, q)
        still = coal.Transform3s.Identity()
        for frame, link in self._links:
            T = self._data.oMf[frame]
            middle = T.rotation @ ((link.lower + link.upper) / 2) + T.translation
            half = np.abs(T.rotation) @ ((link.upper - link.lower) / 2)
            place = coal.Transform3s(T.rotation, T.translation)
            for body in objects:
                if (body.lower > middle + half).any() or (body.upper < middle - half).any():
                    continue
                if (
                    touch(link.tree, place, body.tree, still)
                    or link.holds(T.actInv(body.triangles[0, 0]))
                    or body.holds(T.act(link.triangles[0, 0]))
                ):
                    return f"{link.name} and {body.name}"
        return None


def self_judge(
    robot: pdoik.Robot, meshes: Mapping[str, FloatArray]
) -> Callable[[FloatArray], bool]:
    """What says of a configuration whether two links meet, by coal on their meshes.

    Links that are joined by a joint may, and so may the robot's ignored pairs. The meshes are
    triangles by link, (T, 3, 3) each, in the link's frame [m].
    """
    trees = {link: Body.of(link, part).tree for link, part in meshes.items() if len(part)}
    free = {frozenset(pair) for pair in robot.ignored_pairs} | _joined(robot, list(trees))
    pairs = [pair for pair in combinations(trees, 2) if frozenset(pair) not in free]

    def meet(q: FloatArray) -> bool:
        poses = {link: robot.fk(q, link) for link in trees}
        places = {link: coal.Transform3s(T[:3, :3], T[:3, 3]) for link, T in poses.items()}
        return any(touch(trees[a], places[a], trees[b], places[b]) for a, b in pairs)

    return meet


def _joined(robot: pdoik.Robot, links: list[str]) -> set[frozenset[str]]:
    """Pairs that at most one joint moves against each other, by moving one after the other."""
    q = np.random.default_rng(0).uniform(robot.lower, robot.upper)
    moves = dict.fromkeys(combinations(links, 2), 0)
    before = {link: robot.fk(q, link) for link in links}
    for joint in range(robot.dof):
        moved = q.copy()
        moved[joint] = robot.lower[joint] if q[joint] > 0 else robot.upper[joint]
        after = {link: robot.fk(moved, link) for link in links}
        for a, b in moves:
            apart = [np.linalg.inv(T[a]) @ T[b] for T in (before, after)]
            moves[a, b] += not np.allclose(*apart, atol=1e-9)
    return {frozenset(pair) for pair, count in moves.items() if count <= 1}
