"""A scene's file, whatever its format, as shapes, points, rules of contact, what is attached."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik._addresses import Packages, at_home
from pdoik._core import Attachment, Cloud, ContactRule, Robot, Scene, Shape, voxel_downsample
from pdoik._extras import asks_for
from pdoik._octomaps import boxes_of_file
from pdoik.scenes import moveit_yaml
from pdoik.scenes.asked import Asked, World, check_names
from pdoik.scenes.contacts import as_optional, is_pattern, read_matrix
from pdoik.scenes.mjcf import read_mjcf
from pdoik.scenes.moveit_text import read_moveit_text
from pdoik.scenes.own_links import OwnLinks
from pdoik.scenes.own_yaml import read_own
from pdoik.scenes.pieces import Thing, boxes, shapes_of
from pdoik.scenes.plausible import warn_of_emptiness, warn_of_units
from pdoik.scenes.sdf import read_sdf
from pdoik.scenes.values import EntryError, read_yaml
from pdoik.scenes.xml import root_of

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SceneFile:
    """What a scene's file holds.

    Attributes:
        path: The file.
        shapes: Of different names.
        surface: The points of its cloud as their file has them, (N, 3) [m]; no rows without one.
        leaf: Edge of the cells the cloud is to be thinned to [m]; 0 keeps every point.
        radii: Whether points that are kept cover those that are not.
        contacts: Rules of contact.
        attached: What is attached to links, for `Solver.attach_all`.
        left_out: What the file has besides them, in words.
    """

    path: Path
    shapes: tuple[Shape, ...]
    surface: FloatArray
    leaf: float
    radii: bool
    contacts: tuple[ContactRule, ...]
    attached: tuple[Attachment, ...] = ()
    left_out: tuple[str, ...] = ()

    def thinned(self) -> FloatArray:
        """The points that are kept, (K, 3) or (K, 4) with a radius each [m]."""
        if self.leaf > 0 and len(self.surface):
            return voxel_downsample(self.surface, self.leaf, self.radii)
        return self.surface

    def scene(self) -> Scene:
        """All of it as obstacles, but for what links carry."""
        points = self.thinned()
        cloud = Cloud(points) if len(points) else None
        return Scene(self.shapes, cloud=cloud, contacts=self.contacts)


def load_scene(
    path: str | os.PathLike[str],
    *,
    packages: Packages = (),
    frame: str | None = None,
    robot: Robot | None = None,
    without: Sequence[str] = (),
    keyframe: str | int | None = None,
) -> Scene:
    """The obstacles of a file.

    Read are MuJoCo's worlds (.xml), Gazebo's (SDFormat: .sdf, .world), MoveIt's .scene files and
    PlanningScene as YAML, OctoMaps (.bt, .ot), and pdoik's own YAML (see `pdoik.scenes.own_yaml`).
    An object of several shapes becomes shapes named id, id/1, id/2 ... Planes are solid on the side
    away from their normal however large they are drawn, cones become pyramids of 48 sides around
    them, ellipsoids polyhedra half a hundredth larger, height fields closed meshes. MuJoCo's meshes
    are their convex hulls, as it collides them; others' where those are larger by no more than a
    hundredth, or else meshes. What stands still where the file has it is an obstacle there, and so
    is what may move.

    Args:
        path: The file; its suffix, and of .xml the root, say what it is.
        packages: Folders by the names of packages in `package://` and `model://` addresses, or
            folders that hold packages; see `pdoik.urdf_text` for where else they are looked for.
            Meshes may also be next to the scene, by the last parts of their addresses.
        frame: Whose frame is the robot's base frame: of MuJoCo's worlds a body or a site, of
            Gazebo's a model, link or frame (MODEL::LINK). In MoveIt's YAML, what it calls that
            frame when its objects are not in it but in one that fixed_frame_transforms place. None
            for the robot's base link where the file has the robot; or else for the world's frame.
        robot: Leaves the robot out of MuJoCo's and Gazebo's worlds, by the names of its links and
            joints, and allows its base what the file does: contact of what stands still with what
            stands still, and pairs of bodies that MuJoCo is set to exclude.
        without: Names of objects to be left out: bodies with what hangs on them, geoms, models,
            objects, shapes.
        keyframe: Of MuJoCo's worlds, where what moves stands: a keyframe's name or number. None for
            where the model has it.

    Raises:
        LoadError: Names the file, the entry, and what is wrong with it; links carry something in
            it, which `pdoik.scenes.read_scene_file` gives besides the obstacles.

    Warns:
        ObstacleWarning: The file holds nothing, is in millimetres most likely, has a mesh that is
            open, what nothing touches, or what is driven while no robot is left out.
    """
    found = read_scene_file(
        path, packages=packages, frame=frame, robot=robot, without=without, keyframe=keyframe
    )
    if found.attached:
        names = ", ".join(shape.name for each in found.attached for shape in each.shapes)
        what = f"links carry {names}: pdoik.scenes.read_scene_file(path).attached has them"
        raise EntryError(found.path, f"{what}, for Solver.attach_all")
    return found.scene()


@asks_for("files")
def read_scene_file(
    path: str | os.PathLike[str],
    *,
    packages: Packages = (),
    frame: str | None = None,
    robot: Robot | None = None,
    without: Sequence[str] = (),
    keyframe: str | int | None = None,
) -> SceneFile:
    """As `load_scene`, with the cloud's points before thinning, what was left out or is attached.

    Raises:
        LoadError: As `load_scene`, but for what is attached to links.

    Warns:
        ObstacleWarning: As `load_scene`.
    """
    file = at_home(path)
    read = _READERS.get(file.suffix.lower())
    if read is None:
        raise EntryError(file, f"expected a scene ({', '.join(_READERS)}), got {file.suffix!r}")
    if not file.is_file():
        raise EntryError(file, "is a folder" if file.is_dir() else "no such file")
    asked = Asked(
        packages=packages,
        frame=frame,
        own=None if robot is None else OwnLinks.of(robot),
        without=(without,) if isinstance(without, str) else tuple(without),
        keyframe=keyframe,
    )
    return _scene_file(file, read(file, asked))


def _read_xml(file: Path, asked: Asked) -> World:
    """A world of MuJoCo's or of Gazebo's, distinguished by its root."""
    match root_of(file).tag:
        case "mujoco" | "mujocoinclude":
            return read_mjcf(file, asked)
        case "sdf" | "gazebo":
            return _read_sdf(file, asked)
        case "robot":
            raise EntryError(file, "is a robot, which Robot.from_urdf reads, and no scene")
        case tag:
            raise EntryError(file, f"expected <mujoco> or <sdf>, got <{tag}>")


def _read_sdf(file: Path, asked: Asked) -> World:
    _refuse_keyframe(file, asked)
    return read_sdf(file, asked)


def _read_yaml(file: Path, asked: Asked) -> World:
    _refuse_keyframe(file, asked)
    content = read_yaml(file)
    if "world" not in content:
        _refuse_frame(file, asked)
        return _without(read_own(content, file, asked.packages), asked, file)
    return _without(_read_moveit(content, file, asked), asked, file)


def _read_moveit(content: Mapping[str, Any], file: Path, asked: Asked) -> World:
    things = moveit_yaml.read_world(
        content,
        file,
        links=() if asked.own is None else asked.own.moved,
        frame=asked.frame,
        packages=asked.packages,
    )
    attached = tuple(
        Attachment(each.link, shapes_of([each.thing], file), each.touch_links)
        for each in moveit_yaml.read_attached(content, file, asked.packages)
    )
    contacts = read_matrix(content, file, {thing.name for thing in things})
    return World(things=tuple(things), contacts=tuple(contacts), attached=attached)


def _read_text(file: Path, asked: Asked) -> World:
    _refuse_keyframe(file, asked)
    _refuse_frame(file, asked)
    return _without(World(things=tuple(read_moveit_text(file))), asked, file)


def _read_octomap(file: Path, asked: Asked) -> World:
    _refuse_keyframe(file, asked)
    _refuse_frame(file, asked)
    piece = boxes(*boxes_of_file(file), np.eye(4), "")
    return _without(World(things=(Thing(name=file.stem, pieces=(piece,)),)), asked, file)


def _refuse_frame(file: Path, asked: Asked) -> None:
    if asked.frame is not None:
        raise EntryError(file, f"names no frames, expected one that has {asked.frame!r}")


def _refuse_keyframe(file: Path, asked: Asked) -> None:
    if asked.keyframe is not None:
        raise EntryError(file, f"has no keyframes, expected one that has {asked.keyframe!r}")


def _without(world: World, asked: Asked, file: Path) -> World:
    """The world but for objects that are to be left out, of which rules may speak nevertheless."""
    if not asked.without:
        return world
    names = [thing.name for thing in world.things]
    check_names(asked.without, names, "object", file)
    kept = tuple(thing for thing in world.things if thing.name not in asked.without)
    out = [thing for thing in world.things if thing.name in asked.without]
    gone = {name for thing in out for name in (thing.name, *thing.shape_names)}
    return replace(
        world,
        things=kept,
        contacts=tuple(
            as_optional(rule) if _may_mean(rule, gone) else rule
            for rule in world.contacts
            if not _would_mean_others(rule, gone)
        ),
        left_out=tuple(f"object {name}" for name in asked.without),
    )


def _may_mean(rule: ContactRule, names: Collection[str]) -> bool:
    return any(is_pattern(name) or name in names for name in (rule.one, rule.other))


def _would_mean_others(rule: ContactRule, gone: Collection[str]) -> bool:
    """Whether it is of something left out whose name would now be read as a pattern."""
    return any(is_pattern(name) and name in gone for name in (rule.one, rule.other))


def _scene_file(file: Path, world: World) -> SceneFile:
    """A file's content, looked at once as a whole."""
    found = SceneFile(
        path=file,
        shapes=shapes_of(world.things, file),
        surface=world.surface,
        leaf=world.leaf,
        radii=world.radii,
        contacts=world.contacts,
        attached=world.attached,
        left_out=world.left_out,
    )
    try:
        found.thinned()
    except ValueError as error:
        raise EntryError(file, str(error), "leaf") from error
    warn_of_emptiness(file, found.shapes, found.surface, found.left_out)
    warn_of_units(file, found.shapes)
    return found


_READERS: dict[str, Callable[[Path, Asked], World]] = {
    ".xml": _read_xml,
    ".sdf": _read_sdf,
    ".world": _read_sdf,
    ".scene": _read_text,
    ".yaml": _read_yaml,
    ".yml": _read_yaml,
    ".bt": _read_octomap,
    ".ot": _read_octomap,
}
