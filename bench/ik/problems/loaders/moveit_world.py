"""The collision objects of a MoveIt planning scene as solids."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from bench.ik.problems.loaders.errors import LoaderError
from bench.ik.problems.solids import Solid, SolidError
from pdoik.scenes import moveit_yaml


def read_world(scene: Mapping[str, Any], file: Path, links: Collection[str]) -> list[Solid]:
    """The solids of world.collision_objects, in the frame of the robot's base.

    An object of several pieces gives solids named id/0, id/1 and so on; meshes need not be convex.

    Args:
        scene: A PlanningScene.
        file: Where it comes from, for messages.
        links: The robot's; an object in the frame of one that moves is refused.

    Raises:
        LoaderError: An entry cannot be read; attached objects and octomaps are not supported.
    """
    solids = []
    for thing in moveit_yaml.read_world(scene, file, links=links):
        many = len(thing.pieces) > 1
        for k, piece in enumerate(thing.pieces):
            name = f"{thing.name}/{k}" if many else thing.name
            try:
                solid = Solid(name, piece.kind, piece.size, piece.T, piece.vertices, piece.faces)
            except SolidError as error:
                raise LoaderError(file, str(error), piece.entry) from error
            solids.append(solid)
    return solids
