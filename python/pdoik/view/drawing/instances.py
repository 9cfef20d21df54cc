"""One mesh on the page at many places."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh
import viser


def add_instances(
    server: viser.ViserServer,
    name: str,
    mesh: trimesh.Trimesh,
    count: int,
    color: tuple[int, int, int],
    **looks: Any,
) -> Any:
    """A node that draws a mesh `count` times, all at the origin and in one colour at first.

    Args:
        server: Where to draw.
        name: The node's.
        mesh: In its own frame.
        count: How many.
        color: Red, green and blue, 0 to 255.
        looks: As viser's add_batched_meshes_simple takes them.
    """
    return server.scene.add_batched_meshes_simple(
        name,
        np.asarray(mesh.vertices),
        np.asarray(mesh.faces),
        batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
        batched_positions=np.zeros((count, 3)),
        batched_scales=np.ones((count, 3)),
        batched_colors=np.tile(np.array(color, dtype=np.uint8), (count, 1)),
        lod="off",
        **looks,
    )
