"""Solid shapes of a scene: what they are, points of their surfaces, and what coal makes of them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple, Self

import coal
import numpy as np
import numpy.typing as npt
import trimesh

from bench.common.arrays import FloatArray, moved
from bench.ik.judges.triangles import tree_of

Kind = Literal["box", "sphere", "cylinder", "capsule", "half_space", "mesh"]
PATCH = 1.5  # how far from its origin a half-space is sampled [m]


class SolidError(ValueError):
    """A solid that cannot be: says which one and why."""


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """One obstacle.

    Raises:
        SolidError: The kind is unknown, a size is missing or not positive, T is not rigid.
    """

    name: str  # for messages and allowed contacts; unique in a scene
    kind: Kind
    size: tuple[float, ...]  # the numbers of its kind [m]
    T: FloatArray  # takes its points to the robot's base frame, (4, 4)
    vertices: FloatArray = field(default_factory=lambda: np.empty((0, 3)))  # of a mesh [m]
    faces: npt.NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))

    def __post_init__(self) -> None:
        if self.kind not in _KINDS:
            raise SolidError(f"{self.name}: kind is {self.kind!r}, expected one of {[*_KINDS]}")
        names = _KINDS[self.kind].sizes
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

    def moved(self, T: FloatArray) -> Self:
        """The same in another frame: T takes the old one's points to the new one."""
        return replace(self, T=T @ self.T)

    def sample(self, leaf: float) -> FloatArray:
        """Points of the surface, neighbours at most `leaf` apart in each direction, (N, 3) [m].

        A half-space is sampled within PATCH of its origin.
        """
        return moved(_KINDS[self.kind].sample(self, leaf), self.T)

    def surface(self) -> trimesh.Trimesh:
        """Triangles for pictures, round shapes by facets, in the base frame."""
        return _KINDS[self.kind].surface(self).apply_transform(self.T)

    def geometry(self) -> Any:
        """Coal's exact shape, in the solid's own frame; a mesh by its triangles."""
        return _KINDS[self.kind].geometry(self)


def pose(position: npt.ArrayLike = (0, 0, 0), rotation: npt.ArrayLike | None = None) -> FloatArray:
    """The 4x4 transform with this origin [m] and rotation matrix (the identity without one)."""
    T = np.eye(4)
    T[:3, 3] = position
    if rotation is not None:
        T[:3, :3] = rotation
    return T


def box(name: str, size: npt.ArrayLike, T: FloatArray) -> Solid:
    """A box with these edges [m] about the origin of T."""
    return Solid(name, "box", tuple(float(edge) for edge in size), T)


def cylinder(name: str, radius: float, length: float, T: FloatArray) -> Solid:
    """A cylinder about the z axis of T, its middle at the origin [m]."""
    return Solid(name, "cylinder", (float(radius), float(length)), T)


def mesh(name: str, surface: trimesh.Trimesh, T: FloatArray) -> Solid:
    """A triangle mesh."""
    vertices = np.asarray(surface.vertices, dtype=np.float64)
    return Solid(name, "mesh", (), T, vertices, np.asarray(surface.faces, dtype=np.int64))


def _steps(length: float, leaf: float) -> int:
    return max(1, int(np.ceil(length / leaf - 1e-9)))


def _line(length: float, leaf: float) -> FloatArray:
    """Points from -length / 2 to length / 2, both ends included."""
    return np.linspace(-length / 2, length / 2, _steps(length, leaf) + 1)


def _sheet(u: FloatArray, v: FloatArray) -> FloatArray:
    return np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)


def _box(solid: Solid, leaf: float) -> FloatArray:
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


Rings = list[tuple[float, float]]  # radius and height of each [m]


def _rings(rings: Iterable[tuple[float, float]], leaf: float) -> FloatArray:
    """Points on circles about z; a circle of no radius is a point."""
    rows = []
    for radius, z in rings:
        count = max(6, int(np.ceil(2 * np.pi * radius / leaf))) if radius > 0 else 1
        angle = np.arange(count) * (2 * np.pi / count)
        circle = radius * np.column_stack([np.cos(angle), np.sin(angle)])
        rows.append(np.column_stack([circle, np.full(count, z)]))
    return np.concatenate(rows)


def _side(radius: float, length: float, leaf: float) -> Rings:
    return [(radius, z) for z in _line(length, leaf)]


def _disc(radius: float, z: float, leaf: float) -> Rings:
    return [(r, z) for r in np.linspace(0, radius, 1 + _steps(radius, leaf))]


def _dome(radius: float, z: float, up: bool, leaf: float) -> Rings:
    """Half a sphere on the plane at z, from the pole to the equator."""
    polar = np.linspace(0, np.pi / 2, 1 + _steps(np.pi / 2 * radius, leaf))
    high = radius if up else -radius
    return list(zip(radius * np.sin(polar), z + high * np.cos(polar), strict=True))


def _sphere(solid: Solid, leaf: float) -> FloatArray:
    (radius,) = solid.size
    return _rings([*_dome(radius, 0.0, True, leaf), *_dome(radius, 0.0, False, leaf)], leaf)


def _cylinder(solid: Solid, leaf: float) -> FloatArray:
    radius, length = solid.size
    ends = [ring for z in (-length / 2, length / 2) for ring in _disc(radius, z, leaf)]
    return _rings([*_side(radius, length, leaf), *ends], leaf)


def _capsule(solid: Solid, leaf: float) -> FloatArray:
    radius, length = solid.size
    ends = [ring for z in (-length / 2, length / 2) for ring in _dome(radius, z, z > 0, leaf)]
    return _rings([*_side(radius, length, leaf), *ends], leaf)


def _half_space(_: Solid, leaf: float) -> FloatArray:
    line = _line(2 * PATCH, leaf)
    return np.column_stack([_sheet(line, line), np.zeros(len(line) ** 2)])


def _mesh(solid: Solid, leaf: float) -> FloatArray:
    vertices, _ = trimesh.remesh.subdivide_to_size(solid.vertices, solid.faces, leaf, max_iter=20)
    return np.unique(np.asarray(vertices, dtype=np.float64), axis=0)


class _Of(NamedTuple):
    """What a kind is."""

    sizes: tuple[str, ...]
    sample: Callable[[Solid, float], FloatArray]
    geometry: Callable[[Solid], Any]
    surface: Callable[[Solid], trimesh.Trimesh]


_shape = trimesh.creation
_KINDS: dict[str, _Of] = {
    "box": _Of(
        ("x", "y", "z"), _box, lambda s: coal.Box(*s.size), lambda s: _shape.box(extents=s.size)
    ),
    "sphere": _Of(
        ("radius",),
        _sphere,
        lambda s: coal.Sphere(*s.size),
        lambda s: _shape.icosphere(2, s.size[0]),
    ),
    "cylinder": _Of(
        ("radius", "length"),  # about z, the middle at the origin
        _cylinder,
        lambda s: coal.Cylinder(*s.size),
        lambda s: _shape.cylinder(*s.size, sections=24),
    ),
    "capsule": _Of(
        ("radius", "length"),  # of the cylindrical part
        _capsule,
        lambda s: coal.Capsule(*s.size),
        lambda s: _shape.capsule(s.size[1], s.size[0], count=(12, 12)),
    ),
    "half_space": _Of(
        (),  # everything below z = 0 of its frame
        _half_space,
        lambda _: coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0),
        lambda _: _shape.box(extents=(2 * PATCH, 2 * PATCH, 0.01), transform=pose((0, 0, -0.005))),
    ),
    "mesh": _Of(
        (),
        _mesh,
        lambda s: tree_of(s.vertices, s.faces),
        lambda s: trimesh.Trimesh(s.vertices, s.faces, process=False),
    ),
}
