"""Loaders: the static methods of `Robot`, `Cloud` and `Shape` that read a file, an image or a map.

Robots come from URDF, xacro, MJCF and by name (`pdoik.descriptions` reads them), clouds from depth
images, shapes from height fields and OctoMaps. A loader imports what reads its kind of file when it
is called, so a program that calls none starts sooner. Types are written with their modules, as the
stub of the compiled module has them.
"""

from __future__ import annotations

import collections.abc
import inspect
import os
from dataclasses import replace
from string import whitespace
from typing import TYPE_CHECKING

import numpy.typing

from ._core import Cloud, Robot, Shape
from .errors import LoadError

if TYPE_CHECKING:
    import pdoik._addresses

    from .descriptions import Kind, RobotDescription

read_urdf = Robot.from_urdf  # the compiled one, of text alone, which `from_urdf` below replaces

_NAMED: dict[Kind, str] = {
    "urdf": "a URDF, which Robot.from_urdf reads",
    "xacro": "a xacro file, which Robot.from_urdf and Robot.from_xacro read",
    "mjcf": "an MJCF, which Robot.from_mjcf reads",
}


def from_urdf(
    path_or_xml: str | os.PathLike[str],
    base_link: str | None = None,
    tip_link: str | collections.abc.Sequence[str] | None = None,
    *,
    T_world_base: numpy.typing.ArrayLike | None = None,
    floating_base: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None,
    srdf: str | os.PathLike[str] | None = None,
    hulls: bool = False,
    arguments: collections.abc.Mapping[str, str] | None = None,
    packages: pdoik._addresses.Packages = (),
) -> Robot:
    """Read a URDF, or a xacro file, which the package `xacro` expands.

    Args:
        path_or_xml: A file's path, or the XML text of a URDF itself (recognised by its leading
            "<").
        base_link: Any link of the tree, which becomes the base frame. None takes the description's
            root.
        tip_link: The link that goals are given for, or several. None takes every leaf.
        T_world_base: Where the base link stands, shape (4, 4) [m]: targets, obstacles and centre of
            mass are then in the frame of a link "world" that is put under it.
        floating_base: Instead, how far the base link may go in the world: lower and upper bounds of
            x, y, z [m], yaw, pitch and roll [rad], each of shape (6,). They are the first six
            joints, base_x to base_roll.
        srdf: The robot's SRDF, as a path or as text: its pairs become `ignored_pairs`, and solvers
            keep the robot's hulls off one another unless their options say otherwise.
        hulls: Fit hulls to its collision geometry, which takes a minute or two for an arm. They are
            kept in the user's cache (`PDOIK_CACHE`), and taken from there the next time.
        arguments: Of a xacro file.
        packages: Folders by the name of the package, for `package://NAME/...` and `$(find NAME)`;
            or folders that hold packages. See `pdoik.urdf_text` for where else they are looked for.

    Raises:
        LoadError: A file cannot be read, the XML or the tree is malformed, a link is missing,
            limits are out of order, an axis is zero, a mesh is missing that hulls are asked for.

    Warns:
        RobotWarning: Oddities that do not stop kinematics, such as missing velocity limits, which
            are taken as none, and inertias no body can have.
    """
    from .descriptions import RobotDescription, load_given

    text = str(path_or_xml).lstrip("\ufeff" + whitespace)  # a byte order mark may come first
    if text.startswith("<"):
        given = RobotDescription.of_text(text, packages=packages)
        _check(given, "the text", "urdf")
    else:
        given = _given_file(path_or_xml, arguments, packages, "urdf", "xacro")
    return load_given(given, base_link, tip_link, T_world_base, floating_base, srdf, hulls)


def from_xacro(
    path: str | os.PathLike[str],
    base_link: str | None = None,
    tip_link: str | collections.abc.Sequence[str] | None = None,
    *,
    T_world_base: numpy.typing.ArrayLike | None = None,
    floating_base: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None,
    srdf: str | os.PathLike[str] | None = None,
    hulls: bool = False,
    arguments: collections.abc.Mapping[str, str] | None = None,
    packages: pdoik._addresses.Packages = (),
) -> Robot:
    """Read a xacro file, by the package `xacro`.

    Args:
        path: A file's path.
        base_link: As for `from_urdf`, like the others.
        tip_link: As there.
        T_world_base: As there.
        floating_base: As there.
        srdf: As there.
        hulls: As there.
        arguments: What `xacro FILE NAME:=VALUE` takes.
        packages: As there.

    Raises:
        LoadError: As there; or xacro refuses the file.
        MissingExtraError: The package xacro is not installed.
    """
    from .descriptions import load_given

    given = _given_file(path, None, packages, "urdf", "xacro")
    given = replace(given, kind="xacro", arguments=arguments or {})
    return load_given(given, base_link, tip_link, T_world_base, floating_base, srdf, hulls)


def from_mjcf(
    path: str | os.PathLike[str],
    base_link: str | None = None,
    tip_link: str | collections.abc.Sequence[str] | None = None,
    *,
    T_world_base: numpy.typing.ArrayLike | None = None,
    floating_base: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None,
    srdf: str | os.PathLike[str] | None = None,
    hulls: bool = False,
) -> Robot:
    """Read a model of MuJoCo, by the package `mujoco`.

    Bodies are links, and a joint's value is its `qpos`. Ball joints are refused; a body that floats
    stands where the model has it; joint equalities that are lines become mimic joints, and other
    equalities are left out, so closed loops are open. Speeds are without limit.

    Args:
        path: A file's path.
        base_link: As for `from_urdf`, like the others. The root is the link "world".
        tip_link: As there.
        T_world_base: As there.
        floating_base: As there.
        srdf: As there.
        hulls: As there; of the geometry that can touch.

    Raises:
        LoadError: As there; or MuJoCo is not installed or refuses the file, or a joint is a ball.
    """
    from .descriptions import load_given

    given = _given_file(path, None, (), "mjcf")
    return load_given(given, base_link, tip_link, T_world_base, floating_base, srdf, hulls)


def from_description(
    name: str,
    base_link: str | None = None,
    tip_link: str | collections.abc.Sequence[str] | None = None,
    *,
    T_world_base: numpy.typing.ArrayLike | None = None,
    floating_base: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None,
    srdf: str | os.PathLike[str] | None = None,
    hulls: bool = True,
    arguments: collections.abc.Mapping[str, str] | None = None,
    packages: pdoik._addresses.Packages = (),
) -> Robot:
    """Read a shipped robot, or a description that another package brings, by its name.

    Args:
        name: Such as "panda" (shipped); "ur5", "xarm7" (package example-robot-data); "ur10e",
            "panda_mj_description" (robot_descriptions); "unitree_g1" (mujoco-menagerie). The last
            two get their files from the network the first time.
        base_link: As for `from_urdf`, like the others.
        tip_link: As there.
        T_world_base: As there.
        floating_base: As there.
        srdf: As there.
        hulls: As there, but fitted by default. Shipped robots have theirs.
        arguments: Of a xacro file, in addition to those that the description has.
        packages: As there.

    Raises:
        LoadError: As there; or no robot has this name, or its package cannot get the files.
    """
    from .descriptions import RobotDescription, load_given, load_robot, shipped_name

    if shipped_name(name) is not None:
        return load_robot(
            name,
            base_link,
            tip_link,
            T_world_base=T_world_base,
            floating_base=floating_base,
            srdf=srdf,
        )
    given = RobotDescription.of_name(name, arguments=arguments, packages=packages)
    return load_given(given, base_link, tip_link, T_world_base, floating_base, srdf, hulls)


def _given_file(
    path: str | os.PathLike[str],
    arguments: collections.abc.Mapping[str, str] | None,
    packages: pdoik._addresses.Packages,
    *kinds: Kind,
) -> RobotDescription:
    """The description in a file of one of these kinds.

    Raises:
        LoadError: There is no such file, or it is of another kind.
    """
    from ._addresses import at_home
    from .descriptions import RobotDescription

    file = at_home(path)
    try:
        given = RobotDescription.of_file(file, arguments=arguments, packages=packages)
    except LoadError as error:
        if isinstance(error.__cause__, FileNotFoundError) and not file.suffix:
            said = f"no such file: {file}; names are for Robot.from_description"
            raise LoadError(said) from error
        raise
    _check(given, str(file), *kinds)
    return given


def _check(given: RobotDescription, name: str, *kinds: Kind) -> None:
    """Refuse a description of another kind, and say which loader reads it."""
    if given.kind not in kinds:
        raise LoadError(f"{name} is {_NAMED[given.kind]}")


def from_depth(
    image: numpy.typing.ArrayLike,
    K: numpy.typing.ArrayLike,
    T_base_camera: numpy.typing.ArrayLike | None = None,
    max_range: float | None = None,
    *,
    scale: float | None = None,
    leaf: float | None = None,
    radii: bool = False,
    solid: bool = False,
) -> Cloud:
    """Make a cloud of what a depth camera has seen.

    Args:
        image: Depths along the optical axis, shape (H, W). Floats are metres and whole numbers
            millimetres, unless scale says otherwise; 0, NaN and infinity where nothing was seen.
        K: The camera's matrix, shape (3, 3), or fx, fy, cx, cy, shape (4,) [pixels].
        T_base_camera: Its optical frame, x to the right of the image, y down, z forward, in the
            base frame, shape (4, 4) [m]. None for the base frame itself.
        max_range: What is farther along the axis is left out [m]. None for nothing.
        scale: The metres of one unit of the image.
        leaf: As for `Cloud`.
        radii: As there.
        solid: As there; the cloud is seen from the camera.

    Returns:
        The cloud; without points where all that was seen is beyond max_range.

    Raises:
        ValueError: Names what is wrong: a shape, a matrix that is no camera's or of another image
            size, units that cannot be, an image in which nothing was seen.
    """
    from ._depth import points_of_depth

    points = points_of_depth(image, K, T_base_camera, max_range, scale)
    if not len(points):
        return Cloud(numpy.empty((0, 3)), leaf=leaf, radii=radii, solid=solid)
    eye = numpy.zeros(3) if T_base_camera is None else numpy.asarray(T_base_camera)[:3, 3]
    viewpoint = eye if solid else None
    return Cloud(points, leaf=leaf, radii=radii, solid=solid, viewpoint=viewpoint)


def height_field(
    name: str,
    heights: numpy.typing.ArrayLike,
    cell: numpy.typing.ArrayLike,
    T_base_shape: numpy.typing.ArrayLike | None = None,
    *,
    bottom: float | None = None,
) -> Shape:
    """Make ground of its heights over a grid: a closed mesh, solid down to its bottom.

    Args:
        name: What results call it.
        heights: heights[i, j] stands at x = i cell, y = j cell in its frame, shape (I, J) [m].
        cell: From one height to the next [m], one number or two, along x and y.
        T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
        bottom: Height of its underside [m]. None for as far below the lowest as the field is long.

    Raises:
        ValueError: Names the shape and what is wrong with it, such as a height that is NaN.
    """
    from ._height_fields import mesh_of_heights

    try:
        vertices, triangles = mesh_of_heights(heights, cell, bottom)
    except ValueError as error:
        raise ValueError(f"shape '{name}': {error}") from error
    return Shape.mesh(name, vertices, triangles, T_base_shape)


def octomap(
    name: str,
    path: str | os.PathLike[str],
    T_base_shape: numpy.typing.ArrayLike | None = None,
    *,
    unknown: bool = False,
    region: numpy.typing.ArrayLike | None = None,
) -> Shape:
    """Read an OctoMap: its occupied cells, joined to few boxes.

    Args:
        name: What results call it.
        path: A file that OctoMap wrote: .bt, or .ot, whose leaves are occupied from even odds on.
        T_base_shape: The map's frame in the base frame, shape (4, 4) [m]; None for the base frame
            itself.
        unknown: Whether cells that the map does not know are occupied, too: in the region, or
            without one in the smallest box that holds all it knows. Otherwise they are free.
        region: The lowest and the highest x, y, z of what counts, in the map's frame, shape
            (2, 3) [m]. None for all of it.

    Raises:
        LoadError: The file cannot be read, or nothing in it is occupied.
        ValueError: Names the shape and what is wrong with it.
    """
    from ._addresses import at_home
    from ._octomaps import boxes_of_file

    low, high = boxes_of_file(at_home(path), unknown=unknown, region=region)
    return Shape.boxes(name, low, high, T_base_shape)


for owner, loaders in (
    (Robot, (from_urdf, from_xacro, from_mjcf, from_description)),
    (Cloud, (from_depth,)),
    (Shape, (height_field, octomap)),
):
    for loader in loaders:
        loader.__doc__ = inspect.cleandoc(loader.__doc__ or "")  # as it stands in the stub
        setattr(owner, loader.__name__, staticmethod(loader))
