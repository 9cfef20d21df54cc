"""pdoik's own scenes: shapes by kind and pose, a cloud, rules of contact, what links carry; YAML.

shapes:
  - {name: table, box: [1, 0.8, 0.05], position: [0.5, 0, -0.03], rpy: [0, 0, 0.1]}
  - {name: can, cylinder: {radius: 0.03, length: 0.12}, position: [0.5, 0, 0.06]}
  - {name: wall, half_space: {normal: [-1, 0, 0], point: [1, 0, 0]}}
  - {name: part, convex_mesh: {file: part.stl}, xyzw: [0, 0, 0, 1]}
  - {name: bin, mesh: {file: bin.stl, scale: 0.001}, position: [0.4, 0, 0]}
  - {name: room, octomap: {file: room.bt, unknown: false, region: [[-1, -1, 0], [1, 1, 2]]}}
  - {name: map, distance_field: {file: map.npy, cell: 0.02, truncation: 0.08, unknown: free}}
cloud: scan.pcd
leaf: 0.02
radii: true
allowed: [[base_link, table]]
contacts:
  - {one: box, other: table, clearance: 0}
  - {one: "finger*", other: can, allowed: 0.005}
attached:
  - {link: hand, shapes: [{name: box, box: [0.1, 0.1, 0.1], position: [0, 0, 0.1]}],
     may_touch: ["finger*"], contacts: []}
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from pdoik._addresses import Packages, Places
from pdoik._core import Attachment, ContactRule
from pdoik._octomaps import boxes_of_file
from pdoik.clouds import load_cloud
from pdoik.errors import LoadError
from pdoik.scenes import fields
from pdoik.scenes.asked import World
from pdoik.scenes.contacts import is_pattern, read_rules
from pdoik.scenes.meshes import find_file, read_mesh
from pdoik.scenes.pieces import Kind, Piece, Thing, boxes, half_space, shapes_of
from pdoik.scenes.values import EntryError, numbers, rotation, rows

FloatArray = npt.NDArray[np.float64]

TOP_KEYS = ("shapes", "cloud", "leaf", "radii", "allowed", "contacts", "attached")
_KINDS = (
    *("box", "sphere", "cylinder", "capsule", "half_space"),
    *("convex_mesh", "mesh", "boxes", "octomap", "distance_field"),
)
_POSE_KEYS = ("position", "rpy", "xyzw", "T")


def read_own(content: Mapping[str, Any], file: Path, packages: Packages = ()) -> World:
    """All that the file holds.

    Raises:
        EntryError: Names the entry and what is wrong with it.
    """
    unknown = [str(key) for key in content if key not in TOP_KEYS]
    if unknown or not content:
        got = f"got {unknown[0]!r}" if unknown else "got nothing"
        raise EntryError(file, f"expected {', '.join(TOP_KEYS)}, or MoveIt's world; {got}")
    things = read_shapes(content, file, packages)
    attached = read_attached(content, file, packages)
    contacts = read_contacts(content, file)
    known = {thing.name for thing in things}
    known |= {shape.name for each in attached for shape in each.shapes}
    _check_allowed(content, known, file)
    cloud, radii = content.get("cloud"), content.get("radii", False)
    leaf = float(numbers([content.get("leaf", 0.0)], "l", file, "leaf")[0])
    if leaf < 0:
        raise EntryError(file, f"expected metres, at least 0, got {leaf}", "leaf")
    if not isinstance(radii, bool):
        raise EntryError(file, f"expected true or false, got {radii!r}", "radii")
    world = World(things=tuple(things), contacts=tuple(contacts), attached=attached)
    if cloud is None:
        return world
    if not isinstance(cloud, str):
        raise EntryError(file, f"expected the name of a file, got {cloud!r}", "cloud")
    try:
        surface = load_cloud(file.parent / cloud)
    except ValueError as error:
        raise EntryError(file, str(error), "cloud") from error
    return replace(world, surface=surface, leaf=leaf, radii=radii)


def read_shapes(
    content: Mapping[str, Any], file: Path, packages: Packages = (), entry: str = "shapes"
) -> list[Thing]:
    """What `shapes` lists.

    Raises:
        EntryError: Names the shape and what is wrong with it.
    """
    items, at = content.get("shapes") or [], entry
    if not isinstance(items, list):
        raise EntryError(file, f"expected a list, got {items!r}", at)
    places, things = Places.of(packages, file), []
    for k, item in enumerate(items):
        entry = f"{at}[{k}]"
        if not isinstance(item, Mapping):
            raise EntryError(file, f"expected name, kind and pose, got {item!r}", entry)
        name = str(item.get("name", "")).strip()
        if not name:
            raise EntryError(file, "has no name", entry)
        entry = f"{entry} ({name})"
        piece = _read_piece(item, file, entry, places)
        things.append(Thing(name=name, pieces=(piece,)))
    return things


def read_contacts(content: Mapping[str, Any], file: Path) -> list[ContactRule]:
    """What `allowed` lists, [link, shape] or [link, shape, depth], and then what `contacts` does.

    Raises:
        EntryError: One is neither.
    """
    rules = read_rules(content.get("contacts") or [], file, "contacts")
    contacts = content.get("allowed") or []
    if not isinstance(contacts, list):
        expected = "expected a list of [link, shape] or [link, shape, depth]"
        raise EntryError(file, f"{expected}, got {contacts!r}", "allowed")
    allowed = [_read_allowed(contact, file, f"allowed[{k}]") for k, contact in enumerate(contacts)]
    return [*allowed, *rules]


def _read_allowed(contact: object, file: Path, entry: str) -> ContactRule:
    match contact:
        case [str(link), str(shape)] if link and shape:
            return ContactRule(link, shape)
        case [str(link), str(shape), float() | int() as depth] if link and shape and depth >= 0:
            return ContactRule(link, shape, allowed=float(depth))
    raise EntryError(
        file, f"expected [link, shape] or [link, shape, depth >= 0], got {contact!r}", entry
    )


def _check_allowed(content: Mapping[str, Any], known: Collection[str], file: Path) -> None:
    """Look whether `allowed` names shapes that are there."""
    for k, (_, shape, *_) in enumerate(content.get("allowed") or []):
        if shape not in known and not is_pattern(shape):
            raise EntryError(file, f"there is no shape {shape!r}", f"allowed[{k}]")


def read_attached(
    content: Mapping[str, Any], file: Path, packages: Packages = ()
) -> tuple[Attachment, ...]:
    """What `attached` lists.

    Raises:
        EntryError: Names the entry and what is wrong with it.
    """
    items = content.get("attached") or []
    if not isinstance(items, list):
        raise EntryError(file, f"expected a list, got {items!r}", "attached")
    return tuple(
        _read_attachment(item, file, f"attached[{k}]", packages) for k, item in enumerate(items)
    )


def _read_attachment(item: Any, file: Path, entry: str, packages: Packages) -> Attachment:
    given = _fields(item, ("link", "shapes"), ("may_touch", "contacts"), file, entry)
    links = given["link"] if isinstance(given["link"], list) else [given["link"]]
    may_touch = given.get("may_touch") or []
    for key, names in (("link", links), ("may_touch", may_touch)):
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise EntryError(file, f"expected names, got {names!r}", f"{entry}.{key}")
    things = read_shapes(given, file, packages, f"{entry}.shapes")
    contacts = read_rules(given.get("contacts") or [], file, f"{entry}.contacts")
    return Attachment(links, shapes_of(things, file), may_touch, contacts)


def _read_piece(item: Mapping[str, Any], file: Path, entry: str, places: Places) -> Piece:
    kinds = [kind for kind in _KINDS if kind in item]
    unknown = [str(key) for key in item if key not in ("name", *_KINDS, *_POSE_KEYS)]
    if unknown:
        what = f"unknown key {unknown[0]!r}; a shape has a name, one of {', '.join(_KINDS)}"
        raise EntryError(file, f"{what}, and {', '.join(_POSE_KEYS)}", entry)
    if len(kinds) != 1:
        got = " and ".join(kinds) or "none"
        raise EntryError(file, f"expected one of {', '.join(_KINDS)}; got {got}", entry)
    (kind,) = kinds
    value, where = item[kind], f"{entry}.{kind}"
    if kind == "half_space":
        given = _fields(value, ("normal", "point"), (), file, where)
        if any(key in item for key in _POSE_KEYS):
            raise EntryError(file, "a half_space has normal and point, and no pose", entry)
        normal = numbers(given["normal"], "xyz", file, f"{where}.normal")
        point = numbers(given["point"], "xyz", file, f"{where}.point")
        try:
            return half_space(normal, point, entry)
        except ValueError as error:
            raise EntryError(file, "the normal is zero", f"{where}.normal") from error
    T = _read_pose(item, file, entry)
    if kind == "convex_mesh":
        return _read_mesh("convex_mesh", value, T, file, where, places)
    if kind == "mesh":
        return _read_mesh("mesh", value, T, file, where, places)
    if kind == "boxes":
        return _read_boxes(value, T, file, where)
    if kind == "distance_field":
        given = _fields(value, ("file",), fields.KEYS, file, where)
        distances = fields.read_field(given, file, where, places)
        return Piece(kind="distance_field", T=T, distances=distances, entry=entry)
    if kind == "octomap":
        return _read_octomap(value, T, file, where, places)
    size = _read_size(kind, value, file, where)
    solid: dict[str, Kind] = {
        "box": "box", "sphere": "sphere", "cylinder": "cylinder", "capsule": "capsule"
    }  # fmt: skip
    return Piece(kind=solid[kind], size=size, T=T, entry=entry)


def _read_size(kind: str, value: Any, file: Path, entry: str) -> tuple[float, ...]:
    if kind == "box":
        return tuple(numbers(value, "xyz", file, entry).tolist())
    if kind == "sphere" and not isinstance(value, Mapping):
        value = {"radius": value}
    names = ("radius",) if kind == "sphere" else ("radius", "length")
    given = _fields(value, names, (), file, entry)
    return tuple(float(numbers([given[n]], n[0], file, f"{entry}.{n}")[0]) for n in names)


def _read_pose(item: Mapping[str, Any], file: Path, entry: str) -> FloatArray:
    """T_base_shape of position and rpy or xyzw, or of T."""
    from scipy.spatial.transform import Rotation

    given = [key for key in _POSE_KEYS if key in item]
    if given not in (["T"], []) and ("T" in given or {"rpy", "xyzw"} <= set(given)):
        raise EntryError(file, f"expected T, or position with rpy or xyzw; got {given}", entry)
    if "T" in given:
        T = rows(item["T"], "xyzw", file, f"{entry}.T")
        if T.shape != (4, 4):
            raise EntryError(file, f"expected 4 rows of 4 numbers, got {len(T)}", f"{entry}.T")
        return T
    T = np.eye(4)
    if "position" in given:
        T[:3, 3] = numbers(item["position"], "xyz", file, f"{entry}.position")
    if "rpy" in given:
        rpy = numbers(item["rpy"], "rpy", file, f"{entry}.rpy")
        T[:3, :3] = Rotation.from_euler("xyz", rpy).as_matrix()
    if "xyzw" in given:
        T[:3, :3] = rotation(item["xyzw"], file, f"{entry}.xyzw")
    return T


def _read_boxes(value: Any, T: FloatArray, file: Path, entry: str) -> Piece:
    given = _fields(value, ("low", "high"), (), file, entry)
    low, high = (rows(given[key], "xyz", file, f"{entry}.{key}") for key in ("low", "high"))
    if len(low) != len(high):
        raise EntryError(file, f"{len(low)} lowest corners and {len(high)} highest", entry)
    return boxes(low, high, T, entry)


def _read_octomap(value: Any, T: FloatArray, file: Path, entry: str, places: Places) -> Piece:
    if isinstance(value, str):
        value = {"file": value}
    given = _fields(value, ("file",), ("unknown", "region"), file, entry)
    unknown, region = given.get("unknown", False), given.get("region")
    if not isinstance(unknown, bool):
        raise EntryError(file, f"expected true or false, got {unknown!r}", f"{entry}.unknown")
    if region is not None:
        region = rows(region, "xyz", file, f"{entry}.region")
    path = find_file("map", str(given["file"]), places, file, entry)
    try:
        low, high = boxes_of_file(path, unknown=unknown, region=region)
    except LoadError as error:
        raise EntryError(file, str(error), entry) from error
    return boxes(low, high, T, entry)


def _read_mesh(
    kind: Literal["convex_mesh", "mesh"],
    value: Any,
    T: FloatArray,
    file: Path,
    entry: str,
    places: Places,
) -> Piece:
    if isinstance(value, Mapping) and "file" in value:
        given = _fields(value, ("file",), ("scale",), file, entry)
        path = find_file("mesh", str(given["file"]), places, file, entry)
        vertices, faces = read_mesh(path, file, entry)
        vertices = vertices * _read_scale(given.get("scale", 1.0), file, f"{entry}.scale")
        return Piece(kind=kind, T=T, vertices=vertices, faces=faces, entry=entry)
    optional = ("triangles",) if kind == "convex_mesh" else ()
    needed = ("vertices",) if optional else ("vertices", "triangles")
    given = _fields(value, needed, optional, file, entry)
    vertices = rows(given["vertices"], "xyz", file, f"{entry}.vertices")
    if given.get("triangles") is None:
        return Piece(kind=kind, T=T, vertices=vertices, entry=entry)
    faces = rows(given["triangles"], "abc", file, f"{entry}.triangles").astype(np.int64)
    if faces.size and not (faces.min() >= 0 and faces.max() < len(vertices)):
        raise EntryError(file, "a triangle has a vertex that is not there", entry)
    return Piece(kind=kind, T=T, vertices=vertices, faces=faces, exact=True, entry=entry)


def _read_scale(value: Any, file: Path, entry: str) -> FloatArray:
    """Along x, y, z, (3,): one number or three."""
    if isinstance(value, int | float):
        value = [value] * 3
    scale = numbers(value, "xyz", file, entry)
    if not (scale > 0).all():
        raise EntryError(file, f"expected numbers above 0, got {value!r}", entry)
    return scale


def _fields(
    value: Any, needed: tuple[str, ...], optional: tuple[str, ...], file: Path, entry: str
) -> Mapping[str, Any]:
    """A mapping with these keys and no others."""
    keys = set(value) if isinstance(value, Mapping) else set()
    if not (keys >= set(needed) and keys <= {*needed, *optional}):
        raise EntryError(file, f"expected {{{', '.join(needed)}}}, got {value!r}", entry)
    assert isinstance(value, Mapping)
    return value
