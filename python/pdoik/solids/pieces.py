"""The convex pieces of a link, which say whether it touches where its capsules do."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import pdoik

FloatArray = npt.NDArray[np.float64]


def link_pieces(robot: pdoik.Robot, q: FloatArray, link: str) -> list[pdoik.Shape]:
    """Those of a link, in the base frame; none where it has none."""
    return [
        pdoik.Shape.convex_mesh(f"{link} (piece {k})", vertices, robot.fk(q, link), triangles)
        for k, (owner, vertices, triangles, _) in enumerate(robot.occupancy.pieces)
        if owner == link
    ]
