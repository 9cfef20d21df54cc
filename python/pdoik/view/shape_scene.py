"""The solids on the page: a mesh each, red where the worst constraint is to keep off it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import viser

import pdoik
from pdoik.solids import binding, shape_mesh

from .shapes import wxyz_of
from .shown import Shown

FloatArray = npt.NDArray[np.float64]

_SHAPE, _SHAPE_TIGHT, _SHAPE_BROKEN = (150, 158, 172), (240, 140, 20), (224, 20, 20)


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
