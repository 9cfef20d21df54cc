"""MoveIt's PlanningScene as YAML, as robowflex and MotionBenchMaker write it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik._addresses import Packages, Places
from pdoik.scenes.meshes import find_file, read_mesh
from pdoik.scenes.moveit_octomap import read_octomap
from pdoik.scenes.pieces import Kind, Piece, Thing, cone, mesh, plane
from pdoik.scenes.values import EntryError, numbers, read_pose, rows

FloatArray = npt.NDArray[np.float64]

_KINDS = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone"}  # shape_msgs/SolidPrimitive
_COUNTS = {"box": 3, "sphere": 1, "cylinder": 2, "cone": 2}  # numbers in `dimensions`
_SOLIDS: dict[str, Kind] = {"box": "box", "sphere": "sphere", "cylinder": "cylinder"}
_PLURALS = {"primitive": "primitives", "mesh": "meshes", "plane": "planes"}


def read_world(
    scene: Mapping[str, Any],
    file: Path,
    *,
    links: Collection[str] = (),
    frame: str | None = None,
    packages: Packages = (),
) -> list[Thing]:
    """The objects of world.collision_objects and the octomap, in the frame of the robot's base.

    Args:
        scene: A PlanningScene.
        file: Where it comes from, for messages.
        links: The robot's; an object in the frame of one that moves is refused.
        frame: The name of the base's frame: objects are to be in it, or in a frame that
            fixed_frame_transforms place. None: names that nobody knows are other words for it.
        packages: As in `load_scene`.

    Raises:
        EntryError: An entry cannot be read.
    """
    world = scene.get("world") or {}
    objects = world.get("collision_objects") if isinstance(world, Mapping) else None
    octomap = world.get("octomap") if isinstance(world, Mapping) else None
    if objects is None and octomap:
        objects = []
    if not isinstance(objects, list):
        raise EntryError(file, "has no collision_objects", "world")
    frames = _fixed_frames(scene, file, frame)
    places, things = Places.of(packages, file), []
    for k, item in enumerate(objects):
        entry = f"world.collision_objects[{k}]"
        if not isinstance(item, Mapping):
            raise EntryError(file, f"expected an object, got {item!r}", entry)
        name = str(item.get("id", k)).strip()
        entry = f"{entry} ({name})"
        T = _frame(item, frames, links, frame, file, entry)
        T = T @ read_pose(item.get("pose"), file, f"{entry}.pose")
        things.append(Thing(name=name, pieces=_pieces(item, T, file, entry, places)))
    if isinstance(octomap, Mapping) and (octomap.get("octomap") or {}).get("data"):
        T = _frame(octomap, frames, links, frame, file, "world.octomap")
        things.append(read_octomap(octomap, T, file))
    return things


def _pieces(
    item: Mapping[str, Any], T: FloatArray, file: Path, entry: str, places: Places
) -> tuple[Piece, ...]:
    return tuple(
        _READ[kind](thing, T_piece, file, where, places)
        for kind, thing, T_piece, where in _parts(item, T, file, entry)
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AttachedThing:
    """An object attached to a link, its pieces in the link's frame."""

    link: str
    thing: Thing
    touch_links: tuple[str, ...]


def read_attached(
    scene: Mapping[str, Any], file: Path, packages: Packages = ()
) -> list[AttachedThing]:
    """The objects of robot_state.attached_collision_objects.

    Raises:
        EntryError: An entry cannot be read; an object is in another frame than that of its link.
    """
    state = scene.get("robot_state") or {}
    items = state.get("attached_collision_objects") if isinstance(state, Mapping) else None
    places, found = Places.of(packages, file), []
    for k, item in enumerate(items or []):
        entry = f"robot_state.attached_collision_objects[{k}]"
        thing = item.get("object") if isinstance(item, Mapping) else None
        if not isinstance(thing, Mapping) or not item.get("link_name"):
            raise EntryError(file, f"expected link_name and object, got {item!r}", entry)
        link, name = str(item["link_name"]), str(thing.get("id", k)).strip()
        entry = f"{entry} ({name})"
        frame = str((thing.get("header") or {}).get("frame_id", "")).lstrip("/")
        if frame not in ("", link):
            what = f"is in the frame {frame!r}, expected that of its link, {link!r}"
            raise EntryError(file, what, entry)
        T = read_pose(thing.get("pose"), file, f"{entry}.pose")
        pieces = _pieces(thing, T, file, entry, places)
        touch_links = tuple(str(each) for each in item.get("touch_links") or [])
        found.append(
            AttachedThing(link=link, thing=Thing(name=name, pieces=pieces), touch_links=touch_links)
        )
    return found


def _fixed_frames(scene: Mapping[str, Any], file: Path, base: str | None) -> dict[str, FloatArray]:
    """T_base_frame of the frames that fixed_frame_transforms give in the planning frame.

    The planning frame is the base's, unless `base` is one of these frames.
    """
    frames = {}
    for k, item in enumerate(scene.get("fixed_frame_transforms") or []):
        entry = f"fixed_frame_transforms[{k}]"
        if not isinstance(item, Mapping):
            raise EntryError(file, f"expected a transform, got {item!r}", entry)
        child = str(item.get("child_frame_id", "")).lstrip("/")
        frames[child] = read_pose(item.get("transform"), file, entry)
        parent = str((item.get("header") or {}).get("frame_id", "")).lstrip("/")
        if base is not None and parent:
            frames.setdefault(parent, np.eye(4))
    if base in frames:
        T_base_planning = np.linalg.inv(frames[base])
        frames = {name: T_base_planning @ T for name, T in frames.items()}
    return frames


def _frame(
    item: Mapping[str, Any],
    frames: Mapping[str, FloatArray],
    links: Collection[str],
    base: str | None,
    file: Path,
    entry: str,
) -> FloatArray:
    """T_base_frame of an object."""
    name = str((item.get("header") or {}).get("frame_id", "")).lstrip("/")
    if name in frames:
        return frames[name]
    if base is not None and name not in (base, ""):
        raise EntryError(file, f"is in the frame {name!r}, of which {base!r} is not given", entry)
    if name in links and name not in ("base_link", "world") and not name.endswith("link0"):
        raise EntryError(file, f"is in the frame of the link {name!r}", entry)
    return np.eye(4)


def _parts(
    item: Mapping[str, Any], T: FloatArray, file: Path, entry: str
) -> list[tuple[str, Mapping[str, Any], FloatArray, str]]:
    """Kind, content, T_base_piece and entry of each piece."""
    parts = []
    for kind, plural in _PLURALS.items():
        things, poses = item.get(plural) or [], item.get(f"{kind}_poses") or []
        if poses and len(poses) != len(things):
            raise EntryError(file, f"{len(things)} of {kind}, {len(poses)} poses", entry)
        for k, thing in enumerate(things):
            where = f"{entry}.{kind}[{k}]"
            at = read_pose(poses[k] if poses else None, file, f"{entry}.{kind}_poses[{k}]")
            if not isinstance(thing, Mapping):
                raise EntryError(file, f"expected a {kind}, got {thing!r}", where)
            parts.append((kind, thing, T @ at, where))
    return parts


def _primitive(item: Mapping[str, Any], T: FloatArray, file: Path, entry: str, _: Places) -> Piece:
    kind = item.get("type")
    kind = _KINDS.get(kind, kind) if isinstance(kind, int) else str(kind).lower()
    if kind not in _COUNTS:
        raise EntryError(file, f"type is {item.get('type')!r}, expected {_KINDS}", entry)
    count = _COUNTS[kind]
    sizes = item.get("dimensions") or []
    values = numbers(sizes[:count], "xyz"[:count], file, f"{entry}.dimensions")
    if count == 2:
        values = values[::-1]  # height and radius come; radius and length are kept
    if kind == "cone":
        try:
            return cone(values[0], values[1], T, entry)
        except ValueError as error:
            raise EntryError(file, str(error), entry) from error
    return Piece(kind=_SOLIDS[kind], size=tuple(values.tolist()), T=T, entry=entry)


def _mesh(item: Mapping[str, Any], T: FloatArray, file: Path, entry: str, places: Places) -> Piece:
    if item.get("resource"):
        path = find_file("mesh", str(item["resource"]), places, file, entry)
        points, corners = read_mesh(path, file, entry)
        if item.get("dimensions"):
            points = points * numbers(item["dimensions"], "xyz", file, f"{entry}.dimensions")
        return mesh(points, corners, T, entry)
    faces = [
        face.get("vertex_indices") if isinstance(face, Mapping) else face
        for face in item.get("triangles") or []
    ]
    points = rows(item.get("vertices") or [], "xyz", file, f"{entry}.vertices")
    corners = rows(faces, "abc", file, f"{entry}.triangles").astype(np.int64)
    if not corners.size:
        raise EntryError(file, "a mesh without triangles", entry)
    if not (corners.min() >= 0 and corners.max() < len(points)):
        raise EntryError(file, "a triangle has a vertex that is not there", entry)
    return mesh(points, corners, T, entry)


def _plane(item: Mapping[str, Any], T: FloatArray, file: Path, entry: str, _: Places) -> Piece:
    try:
        return plane(numbers(item.get("coef"), "abcd", file, f"{entry}.coef"), T, entry)
    except EntryError:
        raise
    except ValueError as error:
        raise EntryError(file, str(error), entry) from error


_READ = {"primitive": _primitive, "mesh": _mesh, "plane": _plane}
