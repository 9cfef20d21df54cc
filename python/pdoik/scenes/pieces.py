"""Solids as files describe them, before anything is asked of a mesh; and shapes made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from pdoik._core import Shape
from pdoik.scenes.meshes import check_convex, is_convex
from pdoik.scenes.values import EntryError

FloatArray = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]
Kind = Literal[
    "box", "sphere", "cylinder", "capsule", "half_space", "convex_mesh", "mesh", "boxes",
    "distance_field",
]  # fmt: skip

_CONE_SIDES = 48
_ELLIPSOID_SUBDIVISIONS = 3  # of an icosahedron; the polyhedron is 0.5 % larger


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Piece:
    """One solid of a file.

    Attributes:
        kind: What it is.
        size: Edges of a box; radius, and length if it has one [m].
        T: Takes its points to the base frame, (4, 4); a half-space is below z = 0.
        vertices: Of a mesh, (V, 3) in its own frame [m]; of boxes the lowest and the highest
            corner of each, by turns.
        faces: Of a mesh, (F, 3) places in `vertices`; none for the hull of its vertices.
        distances: Of a distance field, what `Shape.distance_field` takes besides its name and pose.
        exact: Of a convex mesh, whether the faces are the surface itself, to be convex exactly.
        entry: Where in the file it is, for messages.
    """

    kind: Kind
    size: tuple[float, ...] = ()
    T: FloatArray
    vertices: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    faces: Faces = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))
    distances: dict[str, Any] = field(default_factory=dict)
    exact: bool = False
    entry: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Thing:
    """One object of a file, of one or more pieces."""

    name: str
    pieces: tuple[Piece, ...]

    @property
    def shape_names(self) -> list[str]:
        """What its shapes are called: name, name/1, name/2 ..."""
        return [f"{self.name}/{k}" if k else self.name for k in range(len(self.pieces))]


def shapes_of(things: Sequence[Thing], file: Path) -> tuple[Shape, ...]:
    """The shapes of a file's objects.

    Raises:
        EntryError: Two have one name, a size is not positive, a pose is not rigid, or a convex mesh
            is not closed or not convex.
    """
    shapes: dict[str, Shape] = {}
    for thing in things:
        for name, piece in zip(thing.shape_names, thing.pieces, strict=True):
            if name in shapes:
                raise EntryError(file, f"two shapes are named {name!r}", piece.entry)
            try:
                shapes[name] = _shape(name, piece, file)
            except EntryError:
                raise
            except ValueError as error:
                raise EntryError(file, str(error), piece.entry) from error
    return tuple(shapes.values())


def _shape(name: str, piece: Piece, file: Path) -> Shape:
    T = piece.T
    match piece.kind:
        case "box":
            return Shape.box(name, piece.size, T)
        case "sphere":
            return Shape.sphere(name, T[:3, 3], piece.size[0])
        case "cylinder":
            return Shape.cylinder(name, piece.size[0], piece.size[1], T)
        case "capsule":
            return Shape.capsule(name, piece.size[0], piece.size[1], T)
        case "half_space":
            return Shape.half_space(name, T[:3, 2], T[:3, 3])
        case "convex_mesh":
            triangles = piece.faces.tolist() if piece.exact else None
            if len(piece.faces) and not piece.exact:
                check_convex(piece.vertices, piece.faces, file, piece.entry)
            return Shape.convex_mesh(name, piece.vertices, T, triangles)
        case "mesh":
            return Shape.mesh(name, piece.vertices, piece.faces, T)
        case "boxes":
            return Shape.boxes(name, piece.vertices[0::2], piece.vertices[1::2], T)
        case "distance_field":
            return Shape.distance_field(name, T_base_shape=T, **piece.distances)


def mesh(vertices: FloatArray, faces: Faces, T: FloatArray, entry: str) -> Piece:
    """A mesh of any form, by its convex hull if that is hardly larger."""
    kind: Kind = "convex_mesh" if is_convex(vertices, faces) else "mesh"
    return Piece(kind=kind, T=T, vertices=vertices, faces=faces, entry=entry)


def boxes(low: FloatArray, high: FloatArray, T: FloatArray, entry: str) -> Piece:
    """Boxes along the axes of T by their lowest and highest corners, (N, 3) [m]."""
    corners = np.stack([low, high], axis=1).reshape(-1, 3)
    return Piece(kind="boxes", T=T, vertices=corners, entry=entry)


def cone(radius: float, length: float, T: FloatArray, entry: str) -> Piece:
    """A cone about z, its tip at half the length, by a pyramid around it that is hardly larger [m].

    Raises:
        ValueError: A number is not positive.
    """
    if not (radius > 0 and length > 0):
        raise ValueError(f"radius {radius} and length {length} of a cone must be positive")
    angles = np.arange(_CONE_SIDES) * (2 * np.pi / _CONE_SIDES)
    outer = radius / np.cos(np.pi / _CONE_SIDES)
    base = np.column_stack([outer * np.cos(angles), outer * np.sin(angles), 0 * angles])
    vertices = np.concatenate([base, [[0, 0, 0], [0, 0, length]]]) - [0, 0, length / 2]
    ring = np.arange(_CONE_SIDES)
    following = np.roll(ring, -1)
    bottom = np.column_stack([following, ring, np.full_like(ring, _CONE_SIDES)])
    side = np.column_stack([ring, following, np.full_like(ring, _CONE_SIDES + 1)])
    faces = np.asarray(np.concatenate([bottom, side]), dtype=np.int64)
    return Piece(kind="convex_mesh", T=T, vertices=vertices, faces=faces, entry=entry)


def ellipsoid(radii: FloatArray, T: FloatArray, entry: str) -> Piece:
    """An ellipsoid by a polyhedron around it that is hardly larger, half axes along those of T [m].

    Raises:
        ValueError: A half axis is not positive.
    """
    import trimesh

    if not (np.isfinite(radii) & (radii > 0)).all():
        raise ValueError(f"half axes {radii.tolist()} of an ellipsoid must be positive")
    ball = trimesh.creation.icosphere(subdivisions=_ELLIPSOID_SUBDIVISIONS)
    inner = np.einsum("ij,ij->i", ball.face_normals, ball.triangles[:, 0]).min()
    vertices = np.asarray(ball.vertices, dtype=np.float64) / inner * radii
    return Piece(kind="convex_mesh", T=T, vertices=vertices, entry=entry)


def half_space(normal: FloatArray, point: FloatArray, entry: str) -> Piece:
    """All behind the plane through a point [m].

    Raises:
        ValueError: The normal is zero.
    """
    T = np.array(Shape.half_space("it", normal, point).T_base_shape, dtype=np.float64)
    return Piece(kind="half_space", T=T, entry=entry)


def plane(abcd: FloatArray, T: FloatArray, entry: str) -> Piece:
    """The plane a x + b y + c z + d = 0 of frame T, solid on the side away from its normal.

    Raises:
        ValueError: The normal is zero.
    """
    normal, d = abcd[:3], abcd[3]
    square = float(normal @ normal)
    if square < 1e-18:
        raise ValueError("the plane's normal is zero")
    return half_space(T[:3, :3] @ normal, T[:3, :3] @ (-d / square * normal) + T[:3, 3], entry)
