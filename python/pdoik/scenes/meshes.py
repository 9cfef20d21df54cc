"""Triangle meshes of scenes: found by their address, read, and asked whether they are convex."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik._addresses import Places
from pdoik._meshes import read_triangles
from pdoik.errors import LoadError
from pdoik.scenes.values import EntryError

FloatArray = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]

_HOLLOW = 0.01  # of its hull's volume that a mesh may lack and still counts as convex


def find_file(what: str, address: str, places: Places, file: Path, entry: str) -> Path:
    """The file that the address of a mesh or a map means; `what` it is, is for messages.

    Raises:
        EntryError: It is nowhere.
    """
    try:
        return places.find(address)
    except LoadError as error:
        raise EntryError(file, f"{what} {error}", entry) from error


def read_mesh(path: Path, file: Path, entry: str) -> tuple[FloatArray, Faces]:
    """Vertices (V, 3) [m, as the file has them] and triangles (F, 3) of a mesh file.

    Raises:
        EntryError: It cannot be read.
    """
    try:
        return read_triangles(path)
    except LoadError as error:
        raise EntryError(file, str(error), entry) from error


def check_convex(vertices: FloatArray, faces: Faces, file: Path, entry: str) -> None:
    """Look whether a mesh is closed, and as large as its convex hull but for a hundredth.

    Raises:
        EntryError: It is not.
    """
    if flaw := _flaw(vertices, faces):
        raise EntryError(file, flaw, entry)


def is_convex(vertices: FloatArray, faces: Faces) -> bool:
    """Whether `check_convex` lets it by."""
    return not _flaw(vertices, faces)


def _flaw(vertices: FloatArray, faces: Faces) -> str:
    """Why a mesh does not count as convex; '' if it does."""
    import trimesh
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull_volume = float(ConvexHull(vertices).volume)
    except (QhullError, ValueError):
        return "the mesh lies in one plane"
    mesh = trimesh.Trimesh(vertices, faces, process=True)  # joins equal vertices
    if not mesh.is_watertight:
        return "the mesh has holes"
    if not mesh.is_winding_consistent:
        return "some of the mesh's triangles face inward, some outward"
    share = abs(float(mesh.volume)) / hull_volume
    if share < 1 - _HOLLOW:
        return (
            f"the mesh is not convex: it fills {share:.1%} of its convex hull; give it as a mesh"
            " of any form (mesh), or in convex parts (CoACD, V-HACD), one shape each"
        )
    return ""
