"""Which two things of a picture are marked: those that fail, or those that are nearest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik._hulls import hull_names
from pdoik.solids import (
    Binding,
    NearestObstacle,
    binding,
    clearances_of,
    named_part,
    nearest_obstacle,
    nearest_points,
    without_numbers,
)

from .contents import Contents

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A line between two things, red where they are nearer than is asked for.

    Attributes:
        line: Between their nearest points, (2, 3) [m]; None where these are not known.
        text: What they are, and how far apart.
        fails: Whether they are too near.
        hulls: Those of the robot that are meant, in the order of `placed_hulls`.
        names: The shapes, attached or not, that are meant.
    """

    line: FloatArray | None
    text: str
    fails: bool
    hulls: frozenset[int] = frozenset()
    names: frozenset[str] = frozenset()


def mark_of(solver: pdoik.Solver, result: pdoik.Result, contents: Contents) -> Mark | None:
    """What fails of a result; where nothing does, what the robot is nearest to, if anything."""
    if not len(contents.robot.occupancy) and not contents.held:
        return None
    held = [shape.name for shape in contents.held]
    shapes = [shape.name for shape in contents.shapes]
    found = Binding() if result.success else binding(result, contents.robot, shapes, held)
    if len(found.hulls) + len(found.held) == 2:
        return _between_own(result, contents, found)
    clearances = solver.clearances(contents.q, contents.scene)
    clearances = clearances_of(found, clearances)
    if found.shape is not None and clearances[0].part != _own_name(contents, found):
        return _to_shape(solver, result, contents, found)  # another part is deeper, that may be
    nearest = nearest_obstacle(
        clearances,
        contents.robot,
        contents.q,
        contents.points,
        contents.shapes,
        carried=solver.carried,
    )
    return None if nearest is None else _to_nearest(solver.options, result, nearest, found)


def _to_nearest(
    options: pdoik.Options, result: pdoik.Result, nearest: NearestObstacle, found: Binding
) -> Mark:
    if found.shape is not None or found.obstacle is not None:
        fails, lacking = True, -result.room
    else:  # something else fails more than this, or nothing
        least = options.clearance - options.clearance_tolerance
        fails = not result.success and nearest.distance < least
        lacking = options.clearance - nearest.distance
    part = without_numbers(nearest.part)
    if nearest.distance < 0:
        text = f"{part}, {-1e3 * nearest.distance:.1f} mm inside {nearest.obstacle}"
    else:
        text = f"{1e3 * nearest.distance:.1f} mm, {part} to {nearest.obstacle}"
        text += f"; {1e3 * lacking:.1f} mm less than asked" if fails else ""
    return Mark(
        line=nearest.line,
        text=text,
        fails=fails,
        hulls=frozenset(found.hulls if fails else ()),
        names=frozenset({nearest.part, nearest.obstacle} if fails else ()),
    )


def _to_shape(
    solver: pdoik.Solver, result: pdoik.Result, contents: Contents, found: Binding
) -> Mark:
    """The part that the worst constraint is about, where others are nearer to the shape."""
    name = _own_name(contents, found)
    part = named_part(name, contents.robot, contents.q, solver.carried)
    (shape,) = (each for each in contents.shapes if each.name == found.shape)
    lacking = f"{1e3 * result.worst_violation:.1f} mm less than asked"
    return Mark(
        line=None if part is None else nearest_points(part, shape),
        text=f"{without_numbers(name)} to {shape.name}, {lacking}",
        fails=True,
        hulls=frozenset(found.hulls),
        names=frozenset({shape.name, *found.held}),
    )


def _own_name(contents: Contents, found: Binding) -> str:
    """Name of the robot's part that a constraint is about."""
    return found.held[0] if found.held else hull_names(contents.robot)[found.hulls[0]]


def _between_own(result: pdoik.Result, contents: Contents, found: Binding) -> Mark:
    """Two parts of the robot, or of what it holds."""
    by_name = {shape.name: shape for shape in contents.held}
    parts = [*(contents.hulls[k] for k in found.hulls), *(by_name[name] for name in found.held)]
    first, second = (part.name for part in parts)
    distance = 1e3 * result.self_distance
    apart = f"{distance:.1f} mm apart" if distance >= 0 else f"{-distance:.1f} mm in each other"
    return Mark(
        line=nearest_points(*parts),
        text=f"{first} and {second}, {apart}",
        fails=True,
        hulls=frozenset(found.hulls),
        names=frozenset(found.held),
    )
