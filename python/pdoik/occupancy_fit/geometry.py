"""The collision geometry of a URDF as triangles in each link's frame."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import trimesh

from .._addresses import Packages, Places
from .._meshes import read_triangles
from ..descriptions import attribute, numbers, pose_of, tree_of, urdf_joints, xml_text
from ..errors import LoadError
from .hulls import FloatArray, Point

_SIDES = 48  # of the prism around a cylinder
_ICOSPHERE_SUBDIVISIONS = 3  # of the polyhedron around a sphere


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkGeometry:
    """One link: its collision surface and where its child joints sit."""

    name: str
    triangles: FloatArray  # (T, 3, 3), in the link's frame [m]; T = 0 without collision geometry
    child_joints: tuple[tuple[str, Point], ...]  # (child link, joint origin in this link's frame)


def load_geometry(
    urdf: str | Path,
    packages: Packages = (),
    base_link: str | None = None,
    tip_link: str | None = None,
) -> list[LinkGeometry]:
    """The links of a URDF in the file's order, or those of one chain from base to tip.

    Args:
        urdf: A file, or XML text (recognised by its leading `<`).
        packages: Folders by the names of packages in `package://` addresses, or folders that hold
            packages; see `pdoik.urdf_text` for where else they are looked for.
        base_link: First link to keep; None for the root.
        tip_link: Last link to keep; None keeps all links below the base.

    Raises:
        LoadError: The description, a mesh or a number in them cannot be read.
        ValueError: `base_link` or `tip_link` is not in the description or not on one chain.
    """
    links, joints = _parts(urdf)
    places = Places.of(packages, Path(urdf) if xml_text(urdf) is None else None)
    keep = _chain(links, joints, base_link, tip_link)
    _find_all_meshes([element for name, element in links.items() if name in keep], places)
    return [
        LinkGeometry(
            name=name,
            triangles=_link_triangles(element, places),
            child_joints=tuple((child, xyz) for parent, child, xyz in joints if parent == name),
        )
        for name, element in links.items()
        if name in keep
    ]


def links_left_out(
    urdf: str | Path, base_link: str | None = None, tip_link: str | None = None
) -> tuple[str, ...]:
    """The links with collision geometry that `load_geometry` leaves out, in the file's order."""
    links, joints = _parts(urdf)
    keep = _chain(links, joints, base_link, tip_link)
    return tuple(
        name
        for name, element in links.items()
        if name not in keep and element.find("collision") is not None
    )


def _parts(
    urdf: str | Path,
) -> tuple[dict[str, Element], list[tuple[str, str, Point]]]:
    """Links by name, and of each joint parent, child and origin, in the file's order."""
    root = tree_of(urdf)
    joints = [(each.parent, each.child, _point(each.T_parent_child)) for each in urdf_joints(root)]
    return {attribute(each, "name"): each for each in root.findall("link")}, joints


def _point(T: FloatArray) -> Point:
    x, y, z = T[:3, 3].tolist()
    return (x, y, z)


def _chain(
    links: Iterable[str],
    joints: list[tuple[str, str, Point]],
    base_link: str | None,
    tip_link: str | None,
) -> set[str]:
    parent_of = {child: parent for parent, child, _ in joints}
    for argument, link in (("base_link", base_link), ("tip_link", tip_link)):
        if link is not None and link not in links:
            raise ValueError(f"{argument} {link!r} is not a link of the robot: {sorted(links)}")

    def path_to_root(link: str) -> list[str]:
        path = [link]
        while path[-1] in parent_of:
            if parent_of[path[-1]] in path:
                raise LoadError(f"link {link!r} is its own ancestor")
            path.append(parent_of[path[-1]])
        return path

    chain = set(links) if tip_link is None else set(path_to_root(tip_link))
    if base_link is None:
        return chain
    if base_link not in chain:
        raise ValueError(f"tip_link {tip_link!r} does not hang on base_link {base_link!r}")
    return {link for link in chain if base_link in path_to_root(link)}


def _link_triangles(link: Element, places: Places) -> FloatArray:
    pieces = [np.empty((0, 3, 3))]
    for collision in link.findall("collision"):
        where = f"link {link.get('name')!r}"
        shape = collision.find("geometry/*")
        if shape is None:
            raise LoadError(f"{where} has a collision element without geometry")
        triangles = _shape_triangles(shape, where, places)
        T = pose_of(collision)
        pieces.append(triangles @ T[:3, :3].T + T[:3, 3])
    return np.concatenate(pieces)


def _shape_triangles(shape: Element, where: str, places: Places) -> FloatArray:
    """Triangles of a polyhedron that contains the shape: round ones are circumscribed."""
    if shape.tag == "box":
        mesh = trimesh.creation.box(extents=numbers(shape, "size", 3, where, positive=True))
    elif shape.tag == "cylinder":
        (radius,) = numbers(shape, "radius", 1, where, positive=True)
        (length,) = numbers(shape, "length", 1, where, positive=True)
        outer = radius / np.cos(np.pi / _SIDES)
        mesh = trimesh.creation.cylinder(radius=outer, height=length, sections=_SIDES)
    elif shape.tag == "sphere":
        (radius,) = numbers(shape, "radius", 1, where, positive=True)
        mesh = trimesh.creation.icosphere(subdivisions=_ICOSPHERE_SUBDIVISIONS, radius=1.0)
        plane_distances = np.einsum("ij,ij->i", mesh.face_normals, mesh.triangles[:, 0])
        mesh.apply_scale(radius / plane_distances.min())
    elif shape.tag == "mesh":
        vertices, faces = read_triangles(_find_mesh(attribute(shape, "filename"), where, places))
        return vertices[faces] * numbers(shape, "scale", 3, where, default="1 1 1")
    else:
        raise LoadError(f"{where}: unknown collision shape <{shape.tag}>")
    return np.asarray(mesh.triangles, dtype=np.float64)


def _find_all_meshes(links: list[Element], places: Places) -> None:
    """Name all meshes that are missing, not the first alone."""
    missing: dict[str, str] = {}  # by address, each once
    for link in links:
        for mesh in link.findall("collision/geometry/mesh"):
            address = attribute(mesh, "filename")
            try:
                _find_mesh(address, f"link {link.get('name')!r}", places)
            except LoadError as error:
                missing.setdefault(address, str(error))
    if len(missing) == 1:
        raise LoadError(*missing.values())
    if missing:
        raise LoadError(f"{len(missing)} meshes are missing: {'; '.join(missing.values())}")


def _find_mesh(address: str, where: str, places: Places) -> Path:
    try:
        return places.find(address)
    except LoadError as error:
        raise LoadError(f"{where}: mesh {error}") from error
