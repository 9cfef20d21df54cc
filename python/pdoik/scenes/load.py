"""A scene's file, whatever its format, as shapes, points, rules of contact, and what is carried."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik._addresses import Packages
from pdoik._core import Attachment, Cloud, ContactRule, Scene, Shape, voxel_downsample
from pdoik._extras import asks_for
from pdoik._octomaps import boxes_of_file
from pdoik.clouds import load_cloud
from pdoik.scenes import moveit_yaml, own_yaml
from pdoik.scenes.contacts import read_matrix
from pdoik.scenes.moveit_text import read_moveit_text
from pdoik.scenes.pieces import Thing, boxes, shapes_of
from pdoik.scenes.values import EntryError, numbers, read_yaml

FloatArray = npt.NDArray[np.float64]

SUFFIXES = (".scene", ".yaml", ".yml", ".bt", ".ot")


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
        attached: What links carry, for `Solver.attach_all`.
    """

    path: Path
    shapes: tuple[Shape, ...]
    surface: FloatArray
    leaf: float
    radii: bool
    contacts: tuple[ContactRule, ...]
    attached: tuple[Attachment, ...] = ()

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
) -> Scene:
    """The obstacles of a file.

    Read are MoveIt's .scene files, MoveIt's PlanningScene as YAML, and pdoik's own YAML (see
    `pdoik.scenes.own_yaml`). An object of several shapes becomes shapes named id, id/1, id/2 ...
    Planes are solid on the side away from their normal, cones become pyramids of 48 sides around
    them, and MoveIt's meshes their convex hulls where those are larger by no more than a hundredth.

    Args:
        path: .scene, .yaml or .yml.
        packages: Folders by the names of packages in `package://` addresses of meshes, or folders
            that hold packages; see `pdoik.urdf_text` for where else they are looked for. Meshes may
            also be beside the scene, by the last parts of their addresses.
        frame: In MoveIt's YAML, what it calls the robot's base frame, when that is not the frame
            that its objects are in but one that fixed_frame_transforms place.

    Raises:
        LoadError: Names the file, the entry, and what is wrong with it; links carry something in
            it, which `pdoik.scenes.read_scene_file` gives beside the obstacles.
    """
    found = read_scene_file(path, packages=packages, frame=frame)
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
) -> SceneFile:
    """As `load_scene`, with the cloud's points before thinning.

    Raises:
        LoadError: As `load_scene`.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in SUFFIXES:
        raise EntryError(file, f"expected a scene ({', '.join(SUFFIXES)}), got {suffix!r}")
    if suffix in (".bt", ".ot"):
        return _scene_file(file, _read_octomap(file), [])
    content = None if suffix == ".scene" else read_yaml(file)
    if content is not None and "world" in content:
        return _read_moveit(content, file, frame, packages)
    if frame is not None:
        raise EntryError(file, f"names no frames, expected one that has {frame!r}")
    if content is None:
        return _scene_file(file, read_moveit_text(file), [])
    return _read_own(content, file, packages)


def _read_octomap(file: Path) -> list[Thing]:
    if not file.is_file():
        raise EntryError(file, "is a folder" if file.is_dir() else "no such file")
    low, high = boxes_of_file(file)
    return [Thing(name=file.stem, pieces=(boxes(low, high, np.eye(4), ""),))]


def _read_moveit(
    content: dict[str, Any], file: Path, frame: str | None, packages: Packages
) -> SceneFile:
    things = moveit_yaml.read_world(content, file, frame=frame, packages=packages)
    attached = tuple(
        Attachment(each.link, shapes_of([each.thing], file), each.touch_links)
        for each in moveit_yaml.read_attached(content, file, packages)
    )
    contacts = read_matrix(content, file, {thing.name for thing in things})
    return _scene_file(file, things, contacts, attached=attached)


def _read_own(content: dict[str, Any], file: Path, packages: Packages) -> SceneFile:
    unknown = [str(key) for key in content if key not in own_yaml.TOP_KEYS]
    if unknown or not content:
        got = f"got {unknown[0]!r}" if unknown else "got nothing"
        raise EntryError(file, f"expected {', '.join(own_yaml.TOP_KEYS)}, or MoveIt's world; {got}")
    things = own_yaml.read_shapes(content, file, packages)
    contacts = own_yaml.read_contacts(content, file)
    attached = own_yaml.read_attached(content, file, packages)
    known = {thing.name for thing in things}
    known |= {shape.name for each in attached for shape in each.shapes}
    for k, (_, shape, *_) in enumerate(content.get("allowed") or []):
        if shape not in known and not set("*?") & set(shape):
            raise EntryError(file, f"there is no shape {shape!r}", f"allowed[{k}]")
    cloud, radii = content.get("cloud"), content.get("radii", False)
    leaf = float(numbers([content.get("leaf", 0.0)], "l", file, "leaf")[0])
    if leaf < 0:
        raise EntryError(file, f"expected metres, at least 0, got {leaf}", "leaf")
    if not isinstance(radii, bool):
        raise EntryError(file, f"expected true or false, got {radii!r}", "radii")
    if cloud is None:
        return _scene_file(file, things, contacts, attached=attached)
    if not isinstance(cloud, str):
        raise EntryError(file, f"expected the name of a file, got {cloud!r}", "cloud")
    try:
        surface = load_cloud(file.parent / cloud)
    except ValueError as error:
        raise EntryError(file, str(error), "cloud") from error
    return _scene_file(
        file, things, contacts, attached=attached, surface=surface, leaf=leaf, radii=radii
    )


def _scene_file(
    file: Path,
    things: Sequence[Thing],
    contacts: Sequence[ContactRule],
    *,
    attached: tuple[Attachment, ...] = (),
    surface: FloatArray | None = None,
    leaf: float = 0.0,
    radii: bool = False,
) -> SceneFile:
    """A file's content, looked at once as a whole."""
    found = SceneFile(
        path=file,
        shapes=shapes_of(things, file),
        surface=np.empty((0, 3)) if surface is None else surface,
        leaf=leaf,
        radii=radii,
        contacts=tuple(contacts),
        attached=attached,
    )
    try:
        found.thinned()
    except ValueError as error:
        raise EntryError(file, str(error), "leaf") from error
    return found
