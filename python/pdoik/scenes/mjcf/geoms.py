"""MuJoCo's geoms as pieces, of the form in which MuJoCo collides them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik._height_fields import mesh_of_heights
from pdoik.scenes.pieces import Piece, ellipsoid, mesh

FloatArray = npt.NDArray[np.float64]


def piece_of_geom(model: Any, g: int, T: FloatArray, entry: str) -> Piece | None:
    """Geom g at T, (4, 4); None for a kind that no piece is like.

    A plane is a half-space however large it is drawn, and a mesh its convex hull: MuJoCo collides
    them so.
    """
    import mujoco

    size, kind = model.geom_size[g], mujoco.mjtGeom(int(model.geom_type[g]))
    match kind:
        case mujoco.mjtGeom.mjGEOM_PLANE:
            return Piece(kind="half_space", T=T, entry=entry)
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return Piece(kind="sphere", size=(float(size[0]),), T=T, entry=entry)
        case mujoco.mjtGeom.mjGEOM_BOX:
            return Piece(kind="box", size=tuple((2 * size).tolist()), T=T, entry=entry)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return Piece(
                kind="capsule", size=(float(size[0]), 2 * float(size[1])), T=T, entry=entry
            )
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return Piece(
                kind="cylinder", size=(float(size[0]), 2 * float(size[1])), T=T, entry=entry
            )
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            return ellipsoid(size, T, entry)
        case mujoco.mjtGeom.mjGEOM_MESH:
            vertices, _ = _mesh(model, int(model.geom_dataid[g]))
            return Piece(kind="convex_mesh", T=T, vertices=vertices, entry=entry)
        case mujoco.mjtGeom.mjGEOM_SDF:
            return mesh(*_mesh(model, int(model.geom_dataid[g])), T, entry)
        case mujoco.mjtGeom.mjGEOM_HFIELD:
            vertices, faces = _height_field(model, int(model.geom_dataid[g]))
            return Piece(kind="mesh", T=T, vertices=vertices, faces=faces, entry=entry)
    return None


def _mesh(model: Any, m: int) -> tuple[FloatArray, npt.NDArray[np.int64]]:
    first, count = int(model.mesh_vertadr[m]), int(model.mesh_vertnum[m])
    begin, faces = int(model.mesh_faceadr[m]), int(model.mesh_facenum[m])
    return (
        model.mesh_vert[first : first + count].astype(np.float64),
        model.mesh_face[begin : begin + faces].astype(np.int64),
    )


def _height_field(model: Any, h: int) -> tuple[FloatArray, npt.NDArray[np.int64]]:
    rows, columns = int(model.hfield_nrow[h]), int(model.hfield_ncol[h])
    x, y, top, below = (float(value) for value in model.hfield_size[h])
    first = int(model.hfield_adr[h])
    data = model.hfield_data[first : first + rows * columns].reshape(rows, columns)
    cell = (2 * x / (columns - 1), 2 * y / (rows - 1))
    vertices, faces = mesh_of_heights(top * data.T.astype(np.float64), cell, -below)
    return vertices - [x, y, 0], faces
