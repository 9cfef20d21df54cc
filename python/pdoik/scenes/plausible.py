"""What is a mistake of a scene's file, most likely: no obstacles at all, and millimetres."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik._core import Shape
from pdoik.errors import ObstacleWarning

FloatArray = npt.NDArray[np.float64]

_THICK = 20.0
"""Along every axis [m]. In a robot's reach nothing is; what is 2 cm thick or more, in millimetres,
is."""


def warn_of_emptiness(
    file: Path, shapes: Sequence[Shape], surface: FloatArray, left_out: Sequence[str]
) -> None:
    """Warn of a scene without obstacles.

    Warns:
        ObstacleWarning: There are neither shapes nor points.
    """
    if not len(shapes) and not len(surface):
        rest = f" but what is left out: {'; '.join(left_out[:4])}" if left_out else ""
        more = f" and {len(left_out) - 4} more" if len(left_out) > 4 else ""
        warnings.warn(
            f"{file}: holds no obstacles{rest}{more}; whatever is solved in it keeps off nothing",
            ObstacleWarning,
            stacklevel=4,
        )


def warn_of_units(file: Path, shapes: Sequence[Shape]) -> None:
    """Warn of shapes that are too large to be in metres.

    Warns:
        ObstacleWarning: Most of the shapes that have an end, or a mesh, are more than 20 m thick.
    """
    sizes = {shape.name: size for shape in shapes if (size := _thickness(shape)) is not None}
    thick = [name for name, size in sizes.items() if size > _THICK]
    meshes = {shape.name for shape in shapes if shape.kind in ("mesh", "convex_mesh")}
    if 2 * len(thick) > len(sizes):
        warnings.warn(
            f"{file}: {len(thick)} of its {len(sizes)} shapes are more than {_THICK:g} m thick,"
            f" such as {thick[0]!r}: is it in millimetres? It is taken as metres: scale what wrote"
            " it by 0.001",
            ObstacleWarning,
            stacklevel=4,
        )
    elif large := [name for name in thick if name in meshes]:
        warnings.warn(
            f"{file}: the mesh {large[0]!r} is more than {_THICK:g} m thick: is its file in"
            " millimetres? It is taken as metres: give it a scale of 0.001",
            ObstacleWarning,
            stacklevel=4,
        )


def _thickness(shape: Shape) -> float | None:
    """The least of its extents along its own axes [m]; None where nobody knows it.

    A half-space has no end, and a distance field describes free space, too.
    """
    match shape.kind:
        case "half_space" | "distance_field":
            return None
        case "box":
            return min(shape.size)
        case "sphere":
            return 2 * shape.size[0]
        case "cylinder":
            return min(2 * shape.size[0], shape.size[1])
        case "capsule":
            return 2 * shape.size[0]
    return float(np.ptp(shape.vertices, axis=0).min())
