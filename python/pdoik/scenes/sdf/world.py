"""Gazebo's worlds (SDFormat) as scenes: the collisions of models where the file places them.

PyPI has no reader of SDFormat that is kept and for all Pythons: this one knows what places and
shapes need, models within models, includes, frames, placements, and the state that Gazebo's older
editor saves.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import numpy.typing as npt

from pdoik._addresses import Packages, Places
from pdoik.errors import ObstacleWarning
from pdoik.scenes.asked import Asked, World, check_names, some
from pdoik.scenes.contacts import rules_of_pairs
from pdoik.scenes.own_links import WORLD, OwnLinks
from pdoik.scenes.pieces import Piece, Thing
from pdoik.scenes.sdf.frames import Scope
from pdoik.scenes.sdf.geometry import piece_of_geometry
from pdoik.scenes.sdf.include import scope_of
from pdoik.scenes.sdf.state import apply_state
from pdoik.scenes.values import EntryError
from pdoik.scenes.xml import root_of, text_of

FloatArray = npt.NDArray[np.float64]


@dataclass(slots=True)
class _Model:
    """A model and where it is."""

    scope: Scope
    T_world_model: FloatArray
    is_static: bool
    pieces: list[Piece] = field(default_factory=list)
    untouchable: list[str] = field(default_factory=list)
    links: list[str] = field(default_factory=list)


def read_sdf(file: Path, asked: Asked) -> World:
    """The obstacles of a world, or of a file with a model.

    An object is a model, called MODEL, or OUTER::MODEL within another one; it has a shape for each
    collision. Left out are the model that has the robot's joints, collisions of which the
    collide_bitmask is 0, and actors.

    Raises:
        LoadError: Names the entry and what is wrong with it.

    Warns:
        ObstacleWarning: Models have links that are seen and cannot be touched.
    """
    scope = _whole(file, asked.packages)
    models = list(_models(scope, np.eye(4)))
    names = [each.scope.name for each in models]
    check_names(asked.without, names, "model", file)
    unwanted = [name for name in names if any(_is_in(name, out) for out in asked.without)]
    own = [each for each in models if asked.own and _is_robot(each.scope, asked.own)]
    out = {*unwanted, *(n for n in names for each in own if _is_in(n, each.scope.name))}
    kept = [each for each in models if each.scope.name not in out]
    for each in kept:
        _fill(each, asked.packages)
    T_base_world = np.linalg.inv(_base(scope, own, asked, file))
    _warn_of_untouchable(kept, file)
    things = [
        Thing(
            name=each.scope.name,
            pieces=tuple(replace(p, T=T_base_world @ p.T) for p in each.pieces),
        )
        for each in kept
        if each.pieces
    ]
    actors = [f"actor {each.get('name', '')}" for each in scope.element.findall("actor")]
    out_names = [f"model {name}" for name in names if name in out]
    out_names += [name for each in kept for name in each.untouchable]
    shapes = [name for thing in things for name in thing.shape_names]
    may_touch = _allowed(things, kept, own, asked.own)
    return World(
        things=tuple(things),
        contacts=tuple(rules_of_pairs(may_touch, shapes)),
        left_out=(*out_names, *actors),
    )


def _whole(file: Path, packages: Packages) -> Scope:
    """The world of a file; around a model that is alone in it, one that is empty."""
    root = root_of(file)
    if root.tag not in ("sdf", "gazebo"):
        raise EntryError(file, f"expected <sdf>, got <{root.tag}>")
    worlds = root.findall("world")
    if len(worlds) > 1:
        named = some(str(each.get("name")) for each in worlds)
        raise EntryError(file, f"holds {len(worlds)} worlds ({named}): put each into its own file")
    if worlds:
        world = worlds[0]
    else:
        world = Element("world")
        world.extend(root.findall("model"))
    if world.find("population") is not None:
        raise EntryError(file, "<population> is not read: write out its models")
    scope = scope_of(world, file, packages)
    apply_state(scope)
    return scope


def _models(scope: Scope, T_world_scope: FloatArray, static: bool = False) -> Iterator[_Model]:
    """All models, those within others after them."""
    for name, inner in scope.models.items():
        T = T_world_scope @ scope.pose_of(name)
        is_static = static or text_of(inner.element, "static") in ("true", "1")
        yield _Model(inner, T, is_static)
        yield from _models(inner, T, is_static)


def _fill(model: _Model, packages: Packages) -> None:
    """The collisions of a model's own links."""
    scope = model.scope
    places = Places.of(packages, scope.file)
    for link in scope.element.findall("link"):
        link_name = str(link.get("name", ""))
        T_link = model.T_world_model @ scope.pose_of(link_name)
        within = Scope(link, scope.file, scope.name)
        touched = False
        for k, collision in enumerate(link.findall("collision")):
            entry = f"model {scope.name}, link {link_name}, collision {collision.get('name', k)}"
            if _is_untouchable(collision):
                model.untouchable.append(f"{entry}, which nothing touches")
                continue
            T = T_link @ _pose_in_link(scope, within, link_name, collision)
            piece = piece_of_geometry(collision.find("geometry"), T, scope.file, entry, places)
            if piece is not None:
                model.pieces.append(piece)
                touched = True
        if not touched and link.find("visual") is not None:
            model.links.append(f"{scope.name}::{link_name}")


def _pose_in_link(scope: Scope, link: Scope, link_name: str, collision: Element) -> FloatArray:
    """T_link_collision: in the link's frame, or in one of the model's that it names."""
    pose = collision.find("pose")
    if pose is None or not (pose.get("relative_to") or pose.get("frame")):
        return link.pose_in(collision)
    return np.linalg.inv(scope.pose_of(link_name)) @ scope.pose_in(collision)


def _is_untouchable(collision: Element) -> bool:
    bitmask = text_of(collision.find("surface/contact"), "collide_bitmask")
    try:
        return bool(bitmask) and int(bitmask, 0) == 0
    except ValueError:
        return False


def _is_robot(scope: Scope, own: OwnLinks) -> bool:
    """Whether a model has all the joints that move the robot."""
    joints = {each.get("name") for each in scope.element.findall("joint")}
    return bool(own.joints) and own.joints <= joints


def _is_in(name: str, outer: str) -> bool:
    return name == outer or name.startswith(f"{outer}::")


def _base(scope: Scope, own: list[_Model], asked: Asked, file: Path) -> FloatArray:
    """T_world_base, (4, 4)."""
    if asked.frame is not None:
        return scope.pose_of(asked.frame)
    if not own or asked.own is None or asked.own.base_link == WORLD:
        return np.eye(4)
    model, base_link = own[0], asked.own.base_link
    named = [e.get("name") for e in model.scope.element if e.tag in ("link", "frame")]
    if base_link not in named:
        raise EntryError(
            file,
            f"the robot, model {model.scope.name}, has no link or frame {base_link!r}, its base"
            f" link: say what that is, frame='{model.scope.name}::LINK'",
        )
    return model.T_world_model @ model.scope.pose_of(base_link)


def _allowed(
    things: list[Thing], kept: list[_Model], own: list[_Model], robot: OwnLinks | None
) -> Iterator[tuple[str, str]]:
    """Links that stand still may touch shapes that do, (link, shape): neither can move away."""
    if robot is None or not own or not any(_stands(each) for each in own):
        return
    static = {each.scope.name for each in kept if each.is_static}
    links = {
        str(e.get("name")) for each in own for e in each.scope.element if e.tag in ("link", "frame")
    }
    for link in sorted(links & robot.still):
        for thing in things:
            if thing.name in static:
                yield from ((link, shape) for shape in thing.shape_names)


def _stands(model: _Model) -> bool:
    """Whether a model is static, or a joint holds it to the world."""
    joints = model.scope.element.findall("joint")
    return model.is_static or any(
        WORLD in (text_of(each, "parent"), text_of(each, "child")) for each in joints
    )


def _warn_of_untouchable(models: list[_Model], file: Path) -> None:
    seen_only = [link for each in models if not each.pieces for link in each.links]
    if seen_only:
        warnings.warn(
            f"{file}: nothing can touch {some(seen_only)}, which are seen but have no collision:"
            " the robot will go through. Give them one, or leave their models out with"
            " without=[...]",
            ObstacleWarning,
            stacklevel=2,
        )
