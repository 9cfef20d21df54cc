"""The reachability map on the page: a coloured cube at each place that is reached."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import trimesh
import viser
from PIL import Image
from trimesh.visual.material import PBRMaterial

from ..reach_cells import Cut, ReachCells, Squares, share_colors

_SHADES = (1.0, 0.88, 0.76)  # of faces along the cut and of the other two kinds
_COLORS = 256


class ReachScene:
    """The node /reach, there while a map is shown. Any thread may call it."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._lock = threading.Lock()
        self._cubes: Any = None
        self._drawn: tuple[ReachCells, Cut | None] | None = None

    def show(self, cells: ReachCells | None, cut: Cut | None) -> None:
        """Draw what a cut leaves of a map, in place of what is there; nothing for None."""
        with self._lock:
            wanted = None if cells is None else (cells, cut)
            if wanted == self._drawn:
                return
            with self._server.atomic():
                if self._cubes is not None:
                    self._cubes.remove()
                self._cubes = None if cells is None else self._add(cells, cut)
            self._drawn = wanted

    def _add(self, cells: ReachCells, cut: Cut | None) -> Any:
        squares = cells.visible(cut)
        if not len(squares.shares):
            return None
        glb = _glb(squares, bright_axis=2 if cut is None else cut.axis)
        return self._server.scene.add_glb("/reach", glb, cast_shadow=False, receive_shadow=False)


def _glb(squares: Squares, bright_axis: int) -> bytes:
    """Squares that shine in the legend's colours, whatever the light, but for a shade by axis."""
    count = len(squares.shares)
    first = 4 * np.arange(count)[:, None, None]
    triangles = first + np.array([[0, 1, 2], [0, 2, 3]])  # (F, 2, 3)
    u = (squares.shares * (_COLORS - 1) + 0.5) / _COLORS
    v = 1 - ((squares.axes - bright_axis) % 3 + 0.5) / len(_SHADES)
    colors = share_colors(np.linspace(0, 1, _COLORS))
    palette = np.stack([colors * shade for shade in _SHADES]).astype(np.uint8)
    material = PBRMaterial(  # type: ignore[no-untyped-call]
        baseColorFactor=(0, 0, 0, 255), metallicFactor=1.0, roughnessFactor=1.0,
        emissiveFactor=(1.0, 1.0, 1.0), emissiveTexture=Image.fromarray(palette),
    )  # fmt: skip
    mesh = trimesh.Trimesh(squares.corners.reshape(-1, 3), triangles.reshape(-1, 3), process=False)
    mesh.visual = trimesh.visual.TextureVisuals(  # type: ignore[no-untyped-call]
        uv=np.repeat(np.column_stack([u, v]), 4, axis=0), material=material
    )
    return bytes(trimesh.Scene(mesh).export(file_type="glb"))  # type: ignore[no-untyped-call]
