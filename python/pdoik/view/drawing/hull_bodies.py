"""What a robot without meshes looks like: the capsules and spheres that its links fill."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh

import pdoik
from pdoik._hulls import wide_hulls

from ..body import segment_mesh


def hull_bodies(robot: pdoik.Robot) -> dict[str, Any]:
    """A mesh in its link's frame of each link that has hulls; those around others are left out."""
    parts: dict[str, list[trimesh.Trimesh]] = {}
    wide = set(wide_hulls(robot))
    for i, (link, center, radius) in enumerate(robot.occupancy.spheres):
        if i not in wide:
            ball = trimesh.creation.icosphere(subdivisions=2, radius=radius)
            ball.apply_translation(center)
            parts.setdefault(link, []).append(ball)
    for link, a, b, radius, *_ in robot.occupancy.capsules:
        parts.setdefault(link, []).append(segment_mesh(np.array(a), np.array(b), radius, 12))
    return {link: trimesh.util.concatenate(meshes) for link, meshes in parts.items()}
