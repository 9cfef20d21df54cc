"""The surface of a shape as triangles."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import trimesh

import pdoik
from pdoik._distance_fields import zero_level

FloatArray = npt.NDArray[np.float64]

_MOST_TRIANGLES = 200_000  # of a distance field

_PLANE_EDGE = 4.0  # of the square that stands for a half-space [m]


def shape_mesh(
    shape: pdoik.Shape, plane_edge: float = _PLANE_EDGE
) -> tuple[trimesh.Trimesh, FloatArray]:
    """A shape's surface in its frame, and T_base_frame, (4, 4) [m].

    Args:
        shape: Any.
        plane_edge: Of the square that a half-space is drawn as, its middle where the plane comes
            nearest to the base [m].
    """
    T = np.array(shape.T_base_shape, dtype=np.float64)
    size = list(shape.size)
    match shape.kind:
        case "box":
            return trimesh.creation.box(extents=size), T
        case "sphere":
            return trimesh.creation.icosphere(subdivisions=3, radius=size[0]), T
        case "cylinder":
            return trimesh.creation.cylinder(radius=size[0], height=size[1], sections=48), T
        case "capsule":
            capsule = trimesh.creation.capsule(radius=size[0], height=size[1], count=[24, 24])
            capsule.apply_translation([0, 0, -capsule.bounds[:, 2].mean()])  # differs by version
            return capsule, T
        case "half_space":
            T[:3, 3] = (T[:3, 2] @ T[:3, 3]) * T[:3, 2]
            corners = [[x, y, 0.0] for x in (-1, 1) for y in (-1, 1)]
            vertices = plane_edge / 2 * np.array(corners)
            return trimesh.Trimesh(vertices, [[0, 2, 1], [1, 2, 3]]), T
        case "boxes":
            low, high = np.asarray(shape.vertices)[0::2], np.asarray(shape.vertices)[1::2]
            unit = trimesh.creation.box(bounds=[[0, 0, 0], [1, 1, 1]])
            vertices = low[:, None] + unit.vertices[None] * (high - low)[:, None]
            places = len(unit.vertices) * np.arange(len(low))[:, None, None]
            faces = (unit.faces[None] + places).reshape(-1, 3)
            return trimesh.Trimesh(vertices.reshape(-1, 3), faces, process=False), T
        case "distance_field":
            return _zero_level(shape), T
        case _:
            return trimesh.Trimesh(shape.vertices, shape.triangles, process=False), T


def _zero_level(shape: pdoik.Shape) -> trimesh.Trimesh:
    """Where a distance field is 0, of every second cell, or fewer, where that is large."""
    values, cell = shape.values, shape.cell
    assert cell is not None
    step = 1
    while True:
        vertices, faces = zero_level(values[::step, ::step, ::step], step * cell)
        if len(faces) <= _MOST_TRIANGLES or min(values.shape) < 8 * step:
            # Of a cell the middle stays where it is.
            return trimesh.Trimesh(vertices - 0.5 * (step - 1) * cell, faces, process=False)
        step *= 2
