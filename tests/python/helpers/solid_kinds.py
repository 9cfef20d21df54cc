"""Solids of every kind, somewhere around a robot."""

from __future__ import annotations

import numpy as np
import trimesh

import pdoik

CORNERS = [(x, y, z) for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (0.0, 0.2)]
KINDS = (
    "sphere", "box", "cylinder", "capsule", "half_space", "convex_mesh", "mesh", "boxes",
    "distance_field",
)  # fmt: skip


def shape(kind: str, rng: np.random.Generator) -> pdoik.Shape:
    """One of the kind somewhere around the robot, turned."""
    T = np.eye(4)
    T[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    T[:3, :3] *= np.linalg.det(T[:3, :3])
    T[:3, 3] = rng.uniform([-0.7, -0.7, 0.0], [0.7, 0.7, 1.0])
    match kind:
        case "sphere":
            return pdoik.Shape.sphere("it", T[:3, 3], 0.1)
        case "box":
            return pdoik.Shape.box("it", (0.3, 0.2, 0.1), T)
        case "cylinder":
            return pdoik.Shape.cylinder("it", 0.1, 0.3, T)
        case "capsule":
            return pdoik.Shape.capsule("it", 0.1, 0.3, T)
        case "half_space":
            return pdoik.Shape.half_space("it", T[:3, 2], T[:3, 3])
        case "mesh":
            ring = trimesh.creation.torus(0.2, 0.04, major_sections=12, minor_sections=6)
            return pdoik.Shape.mesh("it", ring.vertices, ring.faces, T)
        case "boxes":
            low = np.array([[-0.2, -0.2, 0.0], [0.1, 0.0, 0.1]])
            return pdoik.Shape.boxes("it", low, low + np.array([0.05, 0.1, 0.2]), T)
        case "distance_field":
            places = 0.02 * (np.indices((20, 20, 20)).transpose(1, 2, 3, 0) - 9.5)
            ball = np.linalg.norm(places, axis=-1) - 0.1
            return pdoik.Shape.distance_field("it", ball, 0.02, T)
        case _:
            return pdoik.Shape.convex_mesh("it", CORNERS, T)
