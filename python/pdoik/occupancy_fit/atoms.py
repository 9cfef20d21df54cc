"""A body in small parts, and which of them one convex piece can hold together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .beyond import labels, outward
from .hulls import FloatArray
from .solid import Solid, areas, subdivide

_FACES = 2500  # that the surface is cut into, about
_LONGEST = 8e-3  # of their edges, at least [m]
_TURN = 4.0  # normals that are alike when they are multiplied by this and rounded are grouped
_CUBES = 400  # inside, at most
_CUBE_WEIGHT = 1e-6  # as an area [m^2]
_SHARES = (0.25, 0.5, 0.75)  # of the way between two atoms, where it must be inside
_CHUNK = 4_000_000


@dataclass(slots=True)
class Atoms:
    """Small patches of a surface, and cubes inside."""

    corners: list[FloatArray]  # of each, (C, 3) [m]
    middles: FloatArray  # of those of each, (A, 3) [m]
    faces: list[FloatArray]  # of each that is a patch, (T, 3, 3) [m]
    weights: FloatArray  # (A,), areas [m^2]
    together: NDArray[np.bool_]  # (A, A), symmetric

    @classmethod
    def of(cls, body: FloatArray, slack: float) -> Atoms:
        """Atoms of a connected surface (T, 3, 3).

        Two go together where neither stands over the other's plane by more than the slack, and the
        way between them is inside, as far as voxels show.
        """
        solid = Solid.of(body)
        longest = max(_LONGEST, float(np.sqrt(4 * areas(body).sum() / _FACES)))
        faces = subdivide(body, longest)
        faces = faces[areas(faces) > 1e-12]
        normals = _normals(faces)
        outwards = normals * _sides(faces, normals, solid, body)[:, None]
        group = _groups(faces, outwards, longest, slack)
        order = np.argsort(group, kind="stable")
        faces, outwards, group = faces[order], outwards[order], group[order]
        first = np.flatnonzero(np.diff(group, prepend=-1))
        ends = np.append(first[1:], len(group))
        cubes = _cubes(solid)
        patches = [faces[a:b] for a, b in zip(first, ends, strict=True)]
        corners = _corners(faces, group)
        below = _below(faces, outwards, corners, group) <= slack
        count = len(first) + len(cubes)
        together = np.ones((count, count), dtype=bool)
        together[: len(first), : len(first)] = below & below.T
        share = areas(faces)
        weights = np.add.reduceat(share, first)
        middles = np.add.reduceat(share[:, None] * faces.mean(axis=1), first) / weights[:, None]
        together &= _way_inside(np.concatenate([middles, cubes.mean(axis=1)]), solid, slack)
        np.fill_diagonal(together, True)
        of_each = [*corners, *cubes]
        return cls(
            of_each,
            np.array([each.mean(axis=0) for each in of_each]),
            patches,
            np.concatenate([weights, np.full(len(cubes), _CUBE_WEIGHT)]),
            together,
        )

    def piece_from(self, seed: int, bare: NDArray[np.bool_]) -> NDArray[np.int_]:
        """Indices of bare atoms that all go together, with the seed, many of them."""
        left = np.flatnonzero(self.together[seed] & bare)
        left = left[left != seed]
        among = self.together[left].take(left, axis=1)
        chosen = [seed]
        while len(left):
            # As numbers, that BLAS multiplies: ten times as fast as truth values.
            order = np.argsort(among.astype(np.float64) @ -self.weights[left], kind="stable")
            kept = np.ones(len(left), dtype=bool)
            for atom in order:
                if kept[atom]:
                    chosen.append(int(left[atom]))
                    kept &= among[atom]
                    kept[atom] = False
                    if np.count_nonzero(kept) < 0.8 * len(left):
                        break
            left, among = left[kept], among[kept].compress(kept, axis=1)
        return np.array(chosen)


def _corners(faces: FloatArray, groups: NDArray[np.int_]) -> list[FloatArray]:
    """Distinct corners of each group of faces, which stand together, (C, 3)."""
    rows = np.column_stack([np.repeat(groups, 3), faces.reshape(-1, 3)])
    rows = rows[np.lexsort(rows.T[::-1])]
    rows = rows[np.append(True, (np.diff(rows, axis=0) != 0).any(axis=1))]
    return np.split(rows[:, 1:], np.flatnonzero(np.diff(rows[:, 0])) + 1)


def _cubes(solid: Solid) -> FloatArray:
    """Cubes deep inside, (C, 8, 3)."""
    inner, depth = solid.inner_points()
    step = 2
    while True:
        index = np.rint((inner - solid.origin) / solid.edge).astype(int)
        half = step * solid.edge / 2
        kept = (index % step == 0).all(axis=1) & (depth > np.sqrt(3) * half)
        if kept.sum() <= _CUBES:
            break
        step += 1
    signs = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3), axis=-1).reshape(8, 3)
    return np.asarray(inner[kept, None] + half * signs)


def _normals(faces: FloatArray) -> FloatArray:
    edges = faces[:, 1:] - faces[:, :1]
    normals = np.cross(edges[:, 0], edges[:, 1])
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


def _groups(faces: FloatArray, normals: FloatArray, size: float, slack: float) -> NDArray[np.int_]:
    """Groups of connected faces in one cell of a grid whose normals are nearly alike, (F,).

    Where a part of a group stands over the plane of another, each face is one by itself.
    """
    middle = faces.mean(axis=1)
    cell = np.floor((middle - middle.min(axis=0)) / size)
    key = np.concatenate([cell, np.rint(_TURN * normals)], axis=1)
    group = labels(faces, np.asarray(np.unique(key, axis=0, return_inverse=True)[1]).ravel())
    order = np.argsort(group, kind="stable")
    alone = int(group.max()) + 1 + np.arange(len(faces))
    for members in np.split(order, np.flatnonzero(np.diff(group[order])) + 1):
        if len(members) > 1 and _bent(faces[members], normals[members], slack):
            group[members] = alone[members]
    return group


def _bent(faces: FloatArray, normals: FloatArray, slack: float) -> bool:
    """Whether a part of a patch, (T, 3, 3), stands over the plane of another part."""
    height = np.einsum("fi,gci->fgc", normals, faces)
    height -= np.einsum("fi,fi->f", normals, faces[:, 0])[:, None, None]
    return bool(height.max() > slack)


def _below(
    faces: FloatArray, normals: FloatArray, corners: list[FloatArray], groups: NDArray[np.int_]
) -> FloatArray:
    """How far each group stands over another one's planes at most, (planes' groups, groups) [m].

    A plane without a normal says nothing. Planes that groups share are looked at once.
    """
    middle = faces.reshape(-1, 3).mean(axis=0)
    places = (np.concatenate(corners) - middle).astype(np.float32)
    first = np.cumsum([0, *map(len, corners[:-1])])
    offsets = np.einsum("fi,fi->f", normals, faces[:, 0] - middle)
    alike = np.rint(np.column_stack([groups, normals / 1e-4, offsets / 1e-6]))
    planes = np.unique(alike, axis=0, return_index=True)[1]
    of_group = np.flatnonzero(np.diff(groups[planes], prepend=-1))
    found = np.empty((len(planes), len(corners)), dtype=np.float32)
    step = max(_CHUNK // len(places), 1)
    for n in range(0, len(planes), step):
        at = planes[n : n + step]
        height = normals[at].astype(np.float32) @ places.T
        found[n : n + step] = np.maximum.reduceat(height, first, axis=1)
        found[n : n + step] -= offsets[at, None].astype(np.float32)
    return np.asarray(np.maximum.reduceat(found, of_group, axis=0))


def _sides(faces: FloatArray, normals: FloatArray, solid: Solid, body: FloatArray) -> FloatArray:
    """1 or -1 by which normals point out of the body, 0 where neither side is inside, (F,)."""
    closed = outward(body)
    if closed:
        return np.full(len(faces), closed)
    off = 1.5 * solid.edge * normals
    middle = faces.mean(axis=1)
    inside = [solid.depth_at(middle - off) > 0, solid.depth_at(middle + off) > 0]
    return np.asarray(inside[0].astype(float) - inside[1].astype(float))


def _way_inside(centers: FloatArray, solid: Solid, slack: float) -> NDArray[np.bool_]:
    """Which pairs of places have no voxel between them that is clearly outside, (A, A)."""
    clear = solid.depth > -(slack + solid.edge)
    found = np.ones((len(centers),) * 2, dtype=bool)
    at = ((centers - solid.origin) / solid.edge).astype(np.float32)
    step = max(_CHUNK // len(centers), 1)
    for n in range(0, len(centers), step):
        for share in _SHARES:
            cells = np.rint((1 - share) * at[n : n + step, None] + share * at).astype(np.int32)
            found[n : n + step] &= clear[cells[..., 0], cells[..., 1], cells[..., 2]]
    return found & found.T
