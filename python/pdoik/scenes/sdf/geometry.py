"""The <geometry> of Gazebo's collisions as pieces."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import numpy.typing as npt

from pdoik._addresses import Places
from pdoik.scenes.meshes import find_file, read_mesh
from pdoik.scenes.pieces import Kind, Piece, cone, ellipsoid, half_space, mesh
from pdoik.scenes.values import EntryError
from pdoik.scenes.xml import numbers_of, text_of

FloatArray = npt.NDArray[np.float64]


def piece_of_geometry(
    geometry: Element | None, T: FloatArray, file: Path, entry: str, places: Places
) -> Piece | None:
    """A collision at T, (4, 4); None of an empty one. A plane is a half-space, as Gazebo has it.

    Raises:
        EntryError: It is of a kind that is not read, or a number or a mesh is not there.
    """
    shape = None if geometry is None else next(iter(geometry), None)
    if shape is None or shape.tag == "empty":
        return None
    try:
        return _piece(shape, T, file, entry, places)
    except EntryError:
        raise
    except ValueError as error:
        raise EntryError(file, str(error), entry) from error


def _piece(shape: Element, T: FloatArray, file: Path, entry: str, places: Places) -> Piece:
    def number(tag: str) -> float:
        return float(numbers_of(shape, tag, 1, file, entry)[0])

    match shape.tag:
        case "box":
            edges = numbers_of(shape, "size", 3, file, entry)
            return Piece(kind="box", size=tuple(edges.tolist()), T=T, entry=entry)
        case "sphere":
            return Piece(kind="sphere", size=(number("radius"),), T=T, entry=entry)
        case "cylinder" | "capsule":
            kind: Kind = "cylinder" if shape.tag == "cylinder" else "capsule"
            return Piece(kind=kind, size=(number("radius"), number("length")), T=T, entry=entry)
        case "cone":
            return cone(number("radius"), number("length"), T, entry)
        case "ellipsoid":
            return ellipsoid(numbers_of(shape, "radii", 3, file, entry), T, entry)
        case "plane":
            normal = numbers_of(shape, "normal", 3, file, entry, "0 0 1")
            return half_space(T[:3, :3] @ normal, T[:3, 3], entry)
        case "mesh":
            return _mesh(shape, T, file, entry, places)
        case tag:
            raise EntryError(
                file,
                f"<{tag}> is not read: leave its model out with without=[...], and give it as a"
                " mesh or Shape.height_field",
                entry,
            )


def _mesh(shape: Element, T: FloatArray, file: Path, entry: str, places: Places) -> Piece:
    if shape.find("submesh") is not None:
        what = "a <submesh> is not read: put it into a file of its own"
        raise EntryError(file, what, entry)
    path = find_file("mesh", text_of(shape, "uri"), places, file, entry)
    vertices, faces = read_mesh(path, file, entry)
    scale = numbers_of(shape, "scale", 3, file, entry, "1 1 1")
    if not np.all(scale):
        raise EntryError(file, f"a scale of {scale.tolist()} leaves nothing", entry)
    if np.prod(scale) < 0:  # as in a mirror
        faces = faces[:, ::-1]
    return mesh(vertices * scale, faces, T, entry)
