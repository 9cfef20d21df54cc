"""The reachability map on the page: a coloured cube at each place that is reached."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import trimesh
import viser

from .reach_cells import Cut, ReachCells, share_colors


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
        seen = cells.visible(cut)
        if not len(seen):
            return None
        cube = trimesh.creation.box(extents=[cells.edge] * 3)
        return self._server.scene.add_batched_meshes_simple(
            "/reach",
            np.asarray(cube.vertices),
            np.asarray(cube.faces),
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (len(seen), 1)),
            batched_positions=cells.centers[seen],
            batched_colors=share_colors(cells.shares[seen]),
            flat_shading=True,
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )
