"""The collision objects of a MoveIt planning scene as solids."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
from bench.problems.loaders.errors import LoaderError
from bench.problems.loaders.values import numbers, pose, read_pose
from bench.problems.solids import Solid, SolidError, mesh

FloatArray = npt.NDArray[np.float64]
KINDS = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone"}  # shape_msgs/SolidPrimitive
COUNTS = {"box": 3, "sphere": 1, "cylinder": 2, "cone": 2}  # numbers in `dimensions`


def read_world(scene: Mapping[str, Any], file: Path, links: Collection[str]) -> list[Solid]:
    """The solids of world.collision_objects, in the frame of the robot's base.

    An object of several pieces gives solids named id/0, id/1 and so on.

    Args:
        scene: A PlanningScene.
        file: Where it comes from, for messages.
        links: The robot's; an object in the frame of one that moves is refused.

    Raises:
        LoaderError: An entry cannot be read; attached objects and octomaps are not supported.
    """
    state = scene.get("robot_state") or {}
    if state.get("attached_collision_objects"):
        raise LoaderError(file, "attached objects are not supported", "robot_state")
    world = scene.get("world") or {}
    objects = world.get("collision_objects")
    if not isinstance(objects, list):
        raise LoaderError(file, "has no collision_objects", "world")
    frames = _fixed_frames(scene, file)
    solids: list[Solid] = []
    for k, item in enumerate(objects):
        entry = f"world.collision_objects[{k}]"
        if not isinstance(item, Mapping):
            raise LoaderError(file, f"expected an object, got {item!r}", entry)
        name = str(item.get("id", k)).strip()
        T = _frame(item, frames, links, file, f"{entry} ({name})")
        T = T @ read_pose(item.get("pose"), file, f"{entry}.pose")
        solids += _pieces(item, name, T, file, f"{entry} ({name})")
    return solids


def _fixed_frames(scene: Mapping[str, Any], file: Path) -> dict[str, FloatArray]:
    """T_base_frame of the frames that fixed_frame_transforms give, the planning frame as base."""
    frames = {}
    for k, item in enumerate(scene.get("fixed_frame_transforms") or []):
        entry = f"fixed_frame_transforms[{k}]"
        child = str(item.get("child_frame_id", "")).lstrip("/")
        frames[child] = read_pose(item.get("transform"), file, entry)
    return frames


def _frame(
    item: Mapping[str, Any],
    frames: Mapping[str, FloatArray],
    links: Collection[str],
    file: Path,
    entry: str,
) -> FloatArray:
    """T_base_frame of an object; names that nobody knows are other words for the base."""
    name = str((item.get("header") or {}).get("frame_id", "")).lstrip("/")
    if name in frames:
        return frames[name]
    if name in links and name not in ("base_link", "world") and not name.endswith("link0"):
        raise LoaderError(file, f"is in the frame of the link {name!r}", entry)
    return np.eye(4)


def _pieces(
    item: Mapping[str, Any], name: str, T: FloatArray, file: Path, entry: str
) -> list[Solid]:
    made: list[tuple[str, Any, FloatArray]] = []
    for kind in ("primitive", "mesh", "plane"):
        things = item.get({"primitive": "primitives", "mesh": "meshes", "plane": "planes"}[kind])
        poses = item.get(f"{kind}_poses") or []
        things = things or []
        if poses and len(poses) != len(things):
            raise LoaderError(file, f"{len(things)} of {kind}, {len(poses)} poses", entry)
        for k, thing in enumerate(things):
            where = f"{entry}.{kind}[{k}]"
            at = read_pose(poses[k] if poses else None, file, f"{entry}.{kind}_poses[{k}]")
            if not isinstance(thing, Mapping):
                raise LoaderError(file, f"expected a {kind}, got {thing!r}", where)
            made.append((kind, (thing, where), T @ at))
    names = [name] if len(made) == 1 else [f"{name}/{k}" for k in range(len(made))]
    solids = []
    for part, (kind, (thing, where), T_piece) in zip(names, made, strict=True):
        try:
            solids.append(_READ[kind](part, thing, T_piece, file, where))
        except SolidError as error:
            raise LoaderError(file, str(error), where) from error
    return solids


def _primitive(name: str, item: Mapping[str, Any], T: FloatArray, file: Path, entry: str) -> Solid:
    kind = item.get("type")
    kind = KINDS.get(kind, kind) if isinstance(kind, int) else str(kind).lower()
    if kind not in COUNTS:
        raise LoaderError(file, f"type is {item.get('type')!r}, expected {KINDS}", entry)
    sizes = item.get("dimensions") or []
    values = numbers(sizes[: COUNTS[kind]], "xyz"[: COUNTS[kind]], file, f"{entry}.dimensions")
    if kind == "cylinder":
        values = values[::-1]  # height and radius come; radius and length are kept
    if kind == "cone":
        height, radius = values
        cone = trimesh.creation.cone(radius, height, sections=48)
        cone.apply_translation((0, 0, -height / 2))
        return mesh(name, cone, T)
    return Solid(name, kind, tuple(float(v) for v in values), T)


def _mesh(name: str, item: Mapping[str, Any], T: FloatArray, file: Path, entry: str) -> Solid:
    if item.get("resource"):
        return _mesh_file(name, item, T, file, entry)
    vertices = [
        numbers(vertex, "xyz", file, f"{entry}.vertices[{k}]")
        for k, vertex in enumerate(item.get("vertices") or [])
    ]
    faces = [
        numbers(
            face.get("vertex_indices") if isinstance(face, Mapping) else face,
            "abc",
            file,
            f"{entry}.triangles[{k}]",
        )
        for k, face in enumerate(item.get("triangles") or [])
    ]
    corners = np.array(faces, dtype=np.int64).reshape(-1, 3)
    if corners.size and not (corners.min() >= 0 and corners.max() < len(vertices)):
        raise LoaderError(file, "a triangle has a vertex that is not there", entry)
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    return Solid(name, "mesh", (), T, points, corners)


def _mesh_file(name: str, item: Mapping[str, Any], T: FloatArray, file: Path, entry: str) -> Solid:
    """A mesh by its address, looked up beside the scene, by its last parts."""
    parts = Path(str(item["resource"]).split("://", 1)[-1]).parts
    for first in range(len(parts)):
        path = file.parent / Path(*parts[first:])
        if path.is_file():
            break
    else:
        raise LoaderError(file, f"mesh {item['resource']!r} is not beside the scene", entry)
    try:
        surface = trimesh.load_mesh(path)
    except Exception as error:  # trimesh's loaders raise whatever their parsers do
        raise LoaderError(file, f"cannot read mesh {path}: {error}", entry) from error
    if item.get("dimensions"):
        surface.apply_scale(numbers(item["dimensions"], "xyz", file, f"{entry}.dimensions"))
    return mesh(name, surface, T)


def _plane(name: str, item: Mapping[str, Any], T: FloatArray, file: Path, entry: str) -> Solid:
    """The plane a x + b y + c z + d = 0, solid on the side away from its normal."""
    *normal, d = numbers(item.get("coef"), "abcd", file, f"{entry}.coef")
    length = float(np.linalg.norm(normal))
    if length < 1e-9:
        raise LoaderError(file, "the normal is zero", entry)
    z = np.array(normal) / length
    x = np.cross(z, [1.0, 0, 0] if abs(z[0]) < 0.9 else [0, 1.0, 0])
    x /= np.linalg.norm(x)
    frame = pose(-d / length * z, np.column_stack([x, np.cross(z, x), z]))
    return Solid(name, "half_space", (), T @ frame)


_READ = {"primitive": _primitive, "mesh": _mesh, "plane": _plane}
