"""Solid shapes of a scene: what they are, points of their surfaces, and what coal makes of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import coal
import numpy as np
import numpy.typing as npt
import trimesh

FloatArray = npt.NDArray[np.float64]
Kind = Literal["box", "sphere", "cylinder", "capsule", "half_space", "mesh"]

KINDS: tuple[Kind, ...] = get_args(Kind)
NUMBERS: dict[Kind, tuple[str, ...]] = {
    "box": ("x", "y", "z"),  # edges
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),  # about z, the middle at the origin
    "capsule": ("radius", "length"),  # length of the cylindrical part
    "half_space": (),  # everything below z = 0 of its frame
    "mesh": (),
}
PATCH = 1.5  # how far from its origin a half-space is sampled [m]


class SolidError(ValueError):
    """A solid that cannot be: says which one and why."""


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """One obstacle.

    Args:
        name: For messages and allowed contacts; unique in a scene.
        kind: What it is.
        size: The numbers of NUMBERS[kind] [m].
        T: Takes its points to the robot's base frame, (4, 4).
        vertices: Of a mesh, (V, 3) [m] in its own frame.
        faces: Of a mesh, (F, 3) indices.

    Raises:
        SolidError: The kind is unknown, a size is missing or not positive, T is not rigid.
    """

    name: str
    kind: Kind
    size: tuple[float, ...]
    T: FloatArray
    vertices: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    faces: npt.NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise SolidError(f"{self.name}: kind is {self.kind!r}, expected one of {KINDS}")
        names = NUMBERS[self.kind]
        if len(self.size) != len(names):
            raise SolidError(
                f"{self.name}: a {self.kind} has {len(names)} sizes {names}, got {self.size}"
            )
        if not all(np.isfinite(self.size)) or any(number <= 0 for number in self.size):
            raise SolidError(f"{self.name}: sizes {self.size} of a {self.kind} must be positive")
        R = np.asarray(self.T)[:3, :3]
        if np.shape(self.T) != (4, 4) or not np.allclose(R @ R.T, np.eye(3), atol=1e-5):
            raise SolidError(f"{self.name}: its pose is not a rigid 4x4 transform")
        if self.kind == "mesh" and not (len(self.vertices) and len(self.faces)):
            raise SolidError(f"{self.name}: a mesh without triangles")

    def moved(self, T: FloatArray) -> Solid:
        """The same in another frame: T takes the old one's points to the new one."""
        return Solid(self.name, self.kind, self.size, T @ self.T, self.vertices, self.faces)

    def sample(self, leaf: float) -> FloatArray:
        """Points of the surface, neighbours at most `leaf` apart in each direction, (N, 3) [m].

        A half-space is sampled within PATCH of its origin.
        """
        points = _SAMPLE[self.kind](self, leaf)
        return points @ self.T[:3, :3].T + self.T[:3, 3]

    def surface(self) -> trimesh.Trimesh:
        """Triangles for pictures, round shapes by facets, in the base frame."""
        mesh = _SURFACE[self.kind](self)
        mesh.apply_transform(self.T)
        return mesh

    def geometry(self) -> Any:
        """Coal's exact shape, in the solid's own frame; a mesh by its triangles."""
        return _GEOMETRY[self.kind](self)


def pose(position: npt.ArrayLike = (0, 0, 0), rotation: npt.ArrayLike | None = None) -> FloatArray:
    """The 4x4 transform with this origin [m] and rotation matrix (the identity without one)."""
    T = np.eye(4)
    T[:3, 3] = position
    if rotation is not None:
        T[:3, :3] = rotation
    return T


def box(name: str, size: npt.ArrayLike, T: FloatArray) -> Solid:
    """A box with these edges [m] about the origin of T."""
    x, y, z = (float(edge) for edge in np.asarray(size, dtype=float))
    return Solid(name, "box", (x, y, z), T)


def cylinder(name: str, radius: float, length: float, T: FloatArray) -> Solid:
    """A cylinder about the z axis of T, its middle at the origin [m]."""
    return Solid(name, "cylinder", (float(radius), float(length)), T)


def mesh(name: str, surface: trimesh.Trimesh, T: FloatArray) -> Solid:
    """A triangle mesh."""
    vertices = np.asarray(surface.vertices, dtype=np.float64)
    return Solid(name, "mesh", (), T, vertices, np.asarray(surface.faces, dtype=np.int64))


def _line(length: float, leaf: float) -> FloatArray:
    """From -length / 2 to length / 2, both ends included."""
    count = max(1, int(np.ceil(length / leaf - 1e-9)))
    return np.linspace(-length / 2, length / 2, count + 1)


def _circle(radius: float, leaf: float) -> FloatArray:
    """Directions of points on a circle, (N, 2)."""
    count = max(6, int(np.ceil(2 * np.pi * radius / leaf)))
    angle = np.arange(count) * (2 * np.pi / count)
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _sheet(u: FloatArray, v: FloatArray) -> FloatArray:
    return np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)


def _sample_box(solid: Solid, leaf: float) -> FloatArray:
    lines = [_line(edge, leaf) for edge in solid.size]
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        sheet = _sheet(lines[u], lines[v])
        for side in (-0.5, 0.5):
            face = np.empty((len(sheet), 3))
            face[:, axis] = side * solid.size[axis]
            face[:, [u, v]] = sheet
            faces.append(face)
    return np.concatenate(faces)


def _cap(radius: float, leaf: float, z: float) -> FloatArray:
    rings = [np.zeros((1, 2))]
    rings += [r * _circle(r, leaf) for r in np.linspace(0, radius, 1 + _steps(radius, leaf))[1:]]
    flat = np.concatenate(rings)
    return np.column_stack([flat, np.full(len(flat), z)])


def _side(radius: float, length: float, leaf: float) -> FloatArray:
    ring = radius * _circle(radius, leaf)
    return np.concatenate(
        [np.column_stack([ring, np.full(len(ring), z)]) for z in _line(length, leaf)]
    )


def _dome(radius: float, leaf: float, z: float, up: bool) -> FloatArray:
    """Half a sphere on the plane at z, from the pole to the equator."""
    rows = [np.array([[0.0, 0.0, radius]])]
    for polar in np.linspace(0, np.pi / 2, 1 + _steps(np.pi / 2 * radius, leaf))[1:]:
        r = radius * np.sin(polar)
        ring = r * _circle(r, leaf)
        rows.append(np.column_stack([ring, np.full(len(ring), radius * np.cos(polar))]))
    points = np.concatenate(rows)
    if not up:
        points[:, 2] *= -1
    points[:, 2] += z
    return points


def _steps(length: float, leaf: float) -> int:
    return max(1, int(np.ceil(length / leaf - 1e-9)))


def _sample_sphere(solid: Solid, leaf: float) -> FloatArray:
    (radius,) = solid.size
    return np.concatenate([_dome(radius, leaf, 0.0, up) for up in (True, False)])


def _sample_cylinder(solid: Solid, leaf: float) -> FloatArray:
    radius, length = solid.size
    caps = [_cap(radius, leaf, z) for z in (-length / 2, length / 2)]
    return np.concatenate([_side(radius, length, leaf), *caps])


def _sample_capsule(solid: Solid, leaf: float) -> FloatArray:
    radius, length = solid.size
    domes = [_dome(radius, leaf, z, z > 0) for z in (-length / 2, length / 2)]
    return np.concatenate([_side(radius, length, leaf), *domes])


def _sample_half_space(solid: Solid, leaf: float) -> FloatArray:
    line = _line(2 * PATCH, leaf)
    return np.column_stack([_sheet(line, line), np.zeros(len(line) ** 2)])


def _sample_mesh(solid: Solid, leaf: float) -> FloatArray:
    vertices, _ = trimesh.remesh.subdivide_to_size(solid.vertices, solid.faces, leaf, max_iter=20)
    return np.unique(np.asarray(vertices, dtype=np.float64), axis=0)


def _triangles(solid: Solid) -> Any:
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(solid.faces), len(solid.vertices))
    tree.addVertices(solid.vertices)
    tree.addTriangles(solid.faces)
    tree.endModel()
    return tree


_SAMPLE = {
    "box": _sample_box,
    "sphere": _sample_sphere,
    "cylinder": _sample_cylinder,
    "capsule": _sample_capsule,
    "half_space": _sample_half_space,
    "mesh": _sample_mesh,
}
_GEOMETRY = {
    "box": lambda solid: coal.Box(*solid.size),
    "sphere": lambda solid: coal.Sphere(*solid.size),
    "cylinder": lambda solid: coal.Cylinder(*solid.size),
    "capsule": lambda solid: coal.Capsule(*solid.size),
    "half_space": lambda solid: coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0),
    "mesh": _triangles,
}
_SURFACE = {
    "box": lambda solid: trimesh.creation.box(extents=solid.size),
    "sphere": lambda solid: trimesh.creation.icosphere(2, solid.size[0]),
    "cylinder": lambda solid: trimesh.creation.cylinder(*solid.size, sections=24),
    "capsule": lambda solid: trimesh.creation.capsule(solid.size[1], solid.size[0], count=(12, 12)),
    "half_space": lambda solid: trimesh.creation.box(
        extents=(2 * PATCH, 2 * PATCH, 0.01), transform=pose((0, 0, -0.005))
    ),
    "mesh": lambda solid: trimesh.Trimesh(solid.vertices, solid.faces, process=False),
}
