"""Collisions between an arm's meshes and objects' meshes, by coal and Pinocchio's kinematics.

Nothing here knows the library's hulls: it says whether what the hulls promise is true.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import coal
import numpy as np
import numpy.typing as npt
import pinocchio

from bench.ik.experiment import Arm
from bench.ik.judges.arm_meshes import arm_meshes

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Body:
    """A triangle mesh, ready for coal."""

    name: str
    triangles: FloatArray  # (T, 3, 3) [m]
    tree: Any  # coal.BVHModelOBBRSS
    lower: FloatArray  # of its bounding box, (3,) [m]
    upper: FloatArray

    @classmethod
    def of(cls, name: str, triangles: FloatArray) -> Body:
        """The body of these triangles, in whatever frame they are."""
        vertices = triangles.reshape(-1, 3)
        tree = coal.BVHModelOBBRSS()
        tree.beginModel(len(triangles), len(vertices))
        tree.addVertices(vertices)
        tree.addTriangles(np.arange(len(vertices), dtype=np.int64).reshape(-1, 3))
        tree.endModel()
        return cls(name, triangles, tree, vertices.min(axis=0), vertices.max(axis=0))


class MeshJudge:
    """Says which link of an arm runs into which object.

    Two bodies collide when their surfaces meet, or when one holds the other (which surfaces alone
    do not tell: its first vertex is then inside by winding number).

    Args:
        arm: Whose meshes to load.

    Raises:
        MissingDescriptionError: They are not installed.
    """

    def __init__(self, arm: Arm) -> None:
        self._model = pinocchio.buildModelFromUrdf(str(arm.urdf))
        self._data = self._model.createData()
        self._links = [
            (self._model.getFrameId(name), Body.of(name, triangles))
            for name, triangles in arm_meshes(arm).items()
        ]
        self._request = coal.CollisionRequest(coal.CONTACT, 1)

    def collision(self, q: FloatArray, objects: Sequence[Body]) -> str | None:
        """The first pair found, as "link and object"; None if the arm is clear.

        Args:
            q: Joint positions, (n,) [rad].
            objects: In the base frame.
        """
        pinocchio.framesForwardKinematics(self._model, self._data, q)
        still = coal.Transform3s.Identity()
        for frame, link in self._links:
            T = self._data.oMf[frame]
            lower, upper = _turned_box(link, T.rotation, T.translation)
            place = coal.Transform3s(T.rotation, T.translation)
            for body in objects:
                if (body.lower > upper).any() or (body.upper < lower).any():
                    continue
                result = coal.CollisionResult()
                coal.collide(link.tree, place, body.tree, still, self._request, result)
                if result.isCollision() or self._one_inside_the_other(link, T, body):
                    return f"{link.name} and {body.name}"
        return None

    def distance(self, q: FloatArray, objects: Sequence[Body]) -> float:
        """Least distance between the surfaces of arm and objects [m]."""
        pinocchio.framesForwardKinematics(self._model, self._data, q)
        still, request = coal.Transform3s.Identity(), coal.DistanceRequest()
        least = np.inf
        for frame, link in self._links:
            T = self._data.oMf[frame]
            place = coal.Transform3s(T.rotation, T.translation)
            for body in objects:
                result = coal.DistanceResult()
                coal.distance(link.tree, place, body.tree, still, request, result)
                least = min(least, float(result.min_distance))
        return least

    @staticmethod
    def _one_inside_the_other(link: Body, T: Any, body: Body) -> bool:
        in_link, in_base = T.actInv(body.triangles[0, 0]), T.act(link.triangles[0, 0])
        return _holds(link, in_link) or _holds(body, in_base)


def _holds(body: Body, point: FloatArray) -> bool:
    in_box = (point > body.lower).all() and (point < body.upper).all()
    return bool(in_box) and is_inside(point, body.triangles)


def is_inside(point: FloatArray, triangles: FloatArray) -> bool:
    """Whether a closed surface goes round a point: generalised winding number above one half."""
    a, b, c = np.moveaxis(triangles - point, 1, 0)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    sine = np.einsum("ij,ij->i", a, np.cross(b, c))
    cosine = (
        la * lb * lc
        + np.einsum("ij,ij->i", a, b) * lc
        + np.einsum("ij,ij->i", b, c) * la
        + np.einsum("ij,ij->i", c, a) * lb
    )
    return abs(float(np.arctan2(sine, cosine).sum())) / (2 * np.pi) > 0.5


def _turned_box(
    body: Body, rotation: FloatArray, translation: FloatArray
) -> tuple[FloatArray, FloatArray]:
    middle = rotation @ ((body.lower + body.upper) / 2) + translation
    half = np.abs(rotation) @ ((body.upper - body.lower) / 2)
    return middle - half, middle + half
