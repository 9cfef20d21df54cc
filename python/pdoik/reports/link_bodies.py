"""Links themselves, as the convex pieces that they are made of."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .._core import Occupancy, Shape
from ..options import Options
from .convex import Body, piece, to_shape
from .distances import above_faces, to_mesh
from .values import FloatArray


class LinkBodies:
    """What decides where a capsule touches: the pieces of links, if an occupancy has any.

    Links without pieces are what their capsules fill, then.

    Args:
        occupancy: With pieces or without.
        options: Whether they are asked.
    """

    def __init__(self, occupancy: Occupancy, options: Options) -> None:
        self._pieces: dict[str, list[tuple[Any, Any]]] = {}
        for link, vertices, triangles, _ in occupancy.pieces if options.exact_contact else ():
            self._pieces.setdefault(link, []).append((np.array(vertices), np.array(triangles)))
        self._capsules = occupancy.capsules

    def __bool__(self) -> bool:
        """Whether there are pieces at all."""
        return bool(self._pieces)

    def __contains__(self, link: str) -> bool:
        """Whether a link has pieces."""
        return link in self._pieces

    def __call__(self, link: str, poses: Mapping[str, FloatArray]) -> list[Body]:
        """The bodies that a link is made of, at poses of all links."""
        T = poses[link]
        if link in self._pieces:
            return [piece(*each, T) for each in self._pieces[link]]
        return [
            Body(np.array([a, b]) @ T[:3, :3].T + T[:3, 3], radius)
            for of, a, b, radius, _ in self._capsules
            if of == link
        ]

    def to_shape(
        self, link: str, poses: Mapping[str, FloatArray], shape: Shape, wanted: float
    ) -> float:
        """Least distance of a link from a shape, no distance field; no more than wanted [m]."""
        return min(to_shape(body, shape, wanted) for body in self(link, poses))

    def to_balls(
        self, link: str, poses: Mapping[str, FloatArray], balls: FloatArray, wanted: float
    ) -> float:
        """Least distance of balls (N, 4) from a link's pieces; where it is enough, no more [m]."""
        T, radii = poses[link], balls[:, 3]
        local = (balls[:, :3] - T[:3, 3]) @ T[:3, :3]
        least = np.inf
        for vertices, triangles in self._pieces[link]:
            above = above_faces(local, vertices, triangles).max(axis=1) - radii
            least = min(least, float(above[above >= wanted].min(initial=np.inf)))
            for k in np.flatnonzero(above < wanted):
                least = min(least, to_mesh(vertices, triangles)(local[k]) - radii[k])
        return least
