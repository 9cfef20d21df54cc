"""The solids on the page: a mesh each, red where the worst constraint is to keep off it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import viser

import pdoik
from pdoik.solids import binding, shape_mesh

from ..shown import Shown
from .shapes import wxyz_of

FloatArray = npt.NDArray[np.float64]

_SHAPE, _SHAPE_TIGHT, _SHAPE_BROKEN = (150, 158, 172), (240, 140, 20), (224, 20, 20)
_LINES = (138, 146, 161)
_PLANE = 1.6  # edge of the square that stands for a half-space, over the robot's size
_PLANE_OPACITY = 0.5
_CELLS = 8  # of that square's edge


class ShapeScene:
    """The nodes below /shapes."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._root = server.scene.add_frame("/shapes", show_axes=False)
        self._drawn: tuple[pdoik.Shape, ...] = ()
        self._nodes: dict[str, Any] = {}  # by the shape's name
        self._plane_edge = _PLANE

    def follow_robot(self, size: float) -> None:
        """Half-spaces are drawn as large as this robot needs [m]."""
        self._plane_edge = _PLANE * size
        self._drawn = ()

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
            mesh, T = shape_mesh(shape, self._plane_edge)
            flat = shape.kind == "half_space"
            self._nodes[shape.name] = self._server.scene.add_mesh_simple(
                f"/shapes/{k}",
                np.asarray(mesh.vertices),
                np.asarray(mesh.faces),
                color=_SHAPE,
                opacity=_PLANE_OPACITY if flat else None,  # glass would hide what is behind it
                flat_shading=shape.kind in ("box", "convex_mesh", "mesh", "boxes"),
                side="double" if flat or shape.kind in ("mesh", "distance_field") else "front",
                cast_shadow=not flat,
                wxyz=wxyz_of(T[:3, :3]),
                position=T[:3, 3],
            )
            if flat:
                self._server.scene.add_line_segments(
                    f"/shapes/{k}/grid",
                    plane_lines(self._plane_edge),
                    _LINES,
                    thickness=1.0,
                    thickness_units="screen",
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


def plane_lines(edge: float) -> npt.NDArray[np.float32]:
    """A grid on the square of that edge, in the plane z = 0 about the origin, (N, 2, 3) [m]."""
    half = edge / 2
    steps = np.linspace(-half, half, _CELLS + 1)
    along = [[(x, -half, 0.0), (x, half, 0.0)] for x in steps]
    across = [[(-half, y, 0.0), (half, y, 0.0)] for y in steps]
    return np.array(along + across, dtype=np.float32)
