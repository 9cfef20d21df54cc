"""What the shipped H1 looks like, whose description has no geometry: its collision shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh

import pdoik

from .h1_shapes import SHAPES, Shape
from .visuals import painted

FloatArray = npt.NDArray[np.float64]

_SHELL, _DARK = (0.80, 0.81, 0.84, 1.0), (0.20, 0.21, 0.24, 1.0)
_DARK_LINKS = ("hip_yaw", "hip_roll", "shoulder_roll", "ankle")
_BALLS = {"knee": 0.046, "ankle": 0.032, "elbow": 0.036, "shoulder_pitch": 0.05}  # radii [m]


def body_visuals(robot: pdoik.Robot) -> dict[str, bytes]:
    """GLB files of the links that have shapes: light shells, dark joints, feet, hands and head."""
    visuals = {}
    for link in robot.link_names:
        scene = trimesh.Scene()
        for shape in SHAPES:
            if shape.link == link:
                scene.add_geometry(_mesh(shape))
        for part, radius in _BALLS.items():
            if link.endswith(f"{part}_link"):
                scene.add_geometry(_ball((0.0, 0.0, 0.0), radius))
        if scene.geometry:
            visuals[link] = bytes(scene.export(file_type="glb"))  # type: ignore[no-untyped-call]
    return visuals


def _mesh(shape: Shape) -> Any:  # trimesh's own stubs say no more
    if shape.kind == "sphere":
        return _ball(shape.a, shape.radius)
    ends = np.array([shape.a, shape.b])
    if shape.kind == "cylinder":
        mesh = trimesh.creation.cylinder(radius=shape.radius, segment=ends, sections=32)
    else:
        mesh = segment_mesh(ends[0], ends[1], shape.radius)
    is_limb_end = shape.radius == 0.025 and "elbow" in shape.link
    dark = is_limb_end or any(part in shape.link for part in _DARK_LINKS)
    mesh.visual = painted(_DARK if dark else _SHELL)
    return mesh


def segment_mesh(a: FloatArray, b: FloatArray, radius: float, sections: int = 24) -> Any:
    """A capsule about the segment from a to b, (3,) each [m]; a ball where they are one."""
    length = float(np.linalg.norm(b - a))
    if length < 1e-9:
        mesh = trimesh.creation.icosphere(subdivisions=3, radius=radius)
        mesh.apply_translation(a)
        return mesh
    mesh = trimesh.creation.capsule(height=length, radius=radius, count=[sections, sections])
    mesh.apply_translation([0, 0, -mesh.bounds.mean(axis=0)[2]])  # differs by version
    T = trimesh.geometry.align_vectors([0, 0, 1], (b - a) / length)  # type: ignore[no-untyped-call]
    T[:3, 3] = (a + b) / 2
    mesh.apply_transform(T)
    return mesh


def _ball(center: tuple[float, float, float], radius: float) -> Any:
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    mesh.apply_translation(center)
    mesh.visual = painted(_DARK)
    return mesh
