"""The solids on the page: a mesh each, red where the worst constraint is to keep off it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
import viser

import pdoik
from pdoik._distance_fields import zero_level

from .binding import binding
from .shapes import wxyz_of
from .shown import Shown

FloatArray = npt.NDArray[np.float64]

_SHAPE, _SHAPE_TIGHT, _SHAPE_BROKEN = (150, 158, 172), (240, 140, 20), (224, 20, 20)
_MOST_TRIANGLES = 200_000  # of a distance field
_PLANE_EDGE = 4.0  # of the square that stands for a half-space [m]


class ShapeScene:
    """The nodes below /shapes."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._root = server.scene.add_frame("/shapes", show_axes=False)
        self._drawn: tuple[pdoik.Shape, ...] = ()
        self._nodes: dict[str, Any] = {}  # by the shape's name

    def show_shapes(self, visible: bool) -> None:
        self._root.visible = visible

    def show(self, shown: Shown) -> None:
        """Draw them if they are others; the binding one turns orange, or red if it fails."""
        if self._drawn is not shown.cloud.shapes:
            self._follow(shown.cloud.shapes)
        names = [shape.name for shape in self._drawn]
        tight = binding(shown.result, shown.robot, names).shape
        for name, node in self._nodes.items():
            color = _SHAPE
            if name == tight:
                color = _SHAPE_TIGHT if shown.met_to_tolerance else _SHAPE_BROKEN
            if tuple(node.color) != color:
                node.color = color

    def _follow(self, shapes: tuple[pdoik.Shape, ...]) -> None:
        """Move those that are elsewhere; draw all anew if they are others."""
        pairs = list(zip(self._drawn, shapes, strict=False))
        if len(self._drawn) != len(shapes) or not all(_alike(a, b) for a, b in pairs):
            self._draw(shapes)
            return
        for before, shape in pairs:
            if shape is not before:
                T, node = np.asarray(shape.T_base_shape), self._nodes[shape.name]
                node.wxyz, node.position = wxyz_of(T[:3, :3]), T[:3, 3]
        self._drawn = shapes

    def _draw(self, shapes: tuple[pdoik.Shape, ...]) -> None:
        for node in self._nodes.values():
            node.remove()
        self._nodes = {}
        for k, shape in enumerate(shapes):
            mesh, T = shape_mesh(shape)
            flat = shape.kind == "half_space"
            self._nodes[shape.name] = self._server.scene.add_mesh_simple(
                f"/shapes/{k}",
                np.asarray(mesh.vertices),
                np.asarray(mesh.faces),
                color=_SHAPE,
                opacity=0.2 if flat else None,  # solids that are not opaque hide each other
                flat_shading=shape.kind in ("box", "convex_mesh", "mesh", "boxes"),
                side="double" if flat or shape.kind in ("mesh", "distance_field") else "front",
                cast_shadow=not flat,
                wxyz=wxyz_of(T[:3, :3]),
                position=T[:3, 3],
            )
        self._drawn = shapes


def _alike(a: pdoik.Shape, b: pdoik.Shape) -> bool:
    """Whether one is the other, perhaps elsewhere."""
    if a is b:
        return True
    if (a.name, a.kind) != (b.name, b.kind) or a.kind == "half_space":
        return False
    return (
        (a.values.ctypes.data == b.values.ctypes.data or np.array_equal(a.values, b.values))
        and a.cell == b.cell
        and np.array_equal(a.size, b.size)
        and np.array_equal(a.vertices, b.vertices)
        and np.array_equal(a.triangles, b.triangles)
    )


def shape_mesh(shape: pdoik.Shape) -> tuple[trimesh.Trimesh, FloatArray]:
    """A shape's surface in its frame, and T_base_frame; of a half-space a large square [m].

    The square's middle is where the plane comes nearest to the base.
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
            vertices = _PLANE_EDGE / 2 * np.array(corners)
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
