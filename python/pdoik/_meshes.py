"""Triangles of mesh files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik._extras import asks_for
from pdoik._ply import PlyError, read_ply
from pdoik._polygons import triangulated
from pdoik.errors import LoadError

FloatArray = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]


@asks_for("files")
def read_triangles(path: Path) -> tuple[FloatArray, Faces]:
    """Vertices (V, 3) and triangles (T, 3) of a mesh.

    In metres where the file names its unit (COLLADA, 3MF), or else as the file has them. Faces of
    more corners are cut into triangles. Files other than PLY are read by trimesh.

    Raises:
        LoadError: The file cannot be read, holds no triangles, or a vertex is not finite.
    """
    try:
        vertices, faces = _of_ply(path) if path.suffix.lower() == ".ply" else _of_others(path)
    except ModuleNotFoundError:  # asks for the extra
        raise
    except Exception as error:  # trimesh's loaders raise whatever their parsers do
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise LoadError(f"cannot read mesh {path}: {reason}") from error
    if not len(faces):
        raise LoadError(f"mesh {path} holds no triangles")
    if not np.isfinite(vertices).all():
        raise LoadError(f"mesh {path} has vertices that are not finite")
    return vertices, faces


def _of_ply(path: Path) -> tuple[FloatArray, Faces]:
    ply = read_ply(path.read_bytes())
    if not len(ply.counts):
        raise PlyError("it holds no faces; points are given as a cloud")
    return ply.vertices, triangulated(ply.vertices, ply.corners, ply.counts)


def _of_others(path: Path) -> tuple[FloatArray, Faces]:
    import trimesh
    from trimesh.units import unit_conversion

    mesh = trimesh.load_mesh(path)
    unit = 1.0 if mesh.units is None else unit_conversion(mesh.units, "meters")
    return unit * np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64)
