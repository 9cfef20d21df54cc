"""Goals as a YAML file: a list of requirements, which are all to be met.

- {tip: panda_link8, pose: {xyz: [0.4, 0.1, 0.5], rpy: [3.1416, 0, 0]}}
- pose: {xyz: [0.4, 0, 0.5], wxyz: [0, 1, 0, 0]}   # a region: anywhere in a box about this frame
  position: [[-0.1, 0, 0], [0.1, 0, .inf]]
  rotation: [[0, 0, -3.1416], [0, 0, 3.1416]]
- {position: [0.4, 0.1, 0.5], tool: {xyz: [0, 0, 0.1]}, position_tolerance: 0.001}
- {axis: {xyz: [0.4, 0.1, 0.5], of: z, direction: [0, 0, -1], cone: 0.1}, weight: 2}
- {look_at: {point: [1, 0, 0], axis: x, cone: 0.05}, soft: true}
- {tip: right_hand, relative_to: left_hand, pose: {matrix: [...]}, priority: position}
- center_of_mass: [[-0.05, -0.05, -.inf], [0.05, 0.05, .inf]]
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from pdoik._core import Goal
from pdoik._extras import asks_for
from pdoik.reports import Entry
from pdoik.scenes import EntryError, read_text

from .messages import warn_of_degrees
from .target import rigid, rotation_of_rpy, rotation_of_xyzw

FloatArray = npt.NDArray[np.float64]

Made = TypeVar("Made")

_FRAME = ("xyz", "rpy", "wxyz", "matrix")
_OF_TIPS: dict[str, Callable[[Entry], Any]] = {
    "tip": lambda entry: entry.text(),
    "relative_to": lambda entry: entry.text(),
    "soft": lambda entry: entry.boolean(),
    "weight": lambda entry: entry.number(),
    "priority": lambda entry: entry.text("position", "both"),
    "position_tolerance": lambda entry: entry.number(),
    "rotation_tolerance": lambda entry: entry.number(),
}


def read_goal_file(path: Path) -> list[Goal]:
    """The goals that a file lists, in its order.

    Raises:
        LoadError: Names the file, the entry and what was expected.
    """
    return [_goal(each) for each in _listed(path, "a list of requirements")]


def read_station_file(path: Path) -> list[list[Goal]]:
    """The goals of each station of a path: an entry is one, or a list that is met together.

    Raises:
        LoadError: As `read_goal_file`.
    """
    stations = []
    for each in _listed(path, "a list of stations", with_lines=True):
        if each.value == []:
            raise each.expected("a goal, or goals that are met together")
        together = each.items() if isinstance(each.value, list) else [each]
        stations.append([_goal(one) for one in together])
    return stations


@asks_for("files")
def _listed(path: Path, what: str, with_lines: bool = False) -> list[Entry]:
    """A file's entries, with their lines if these are to be reported."""
    import yaml

    text = read_text(path)
    try:
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)(text)
        node = loader.get_single_node()
        content = None if node is None else loader.construct_document(node)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise EntryError(path, f"not YAML: {' '.join(str(error).split())[:200]}") from error
    entry = Entry(content, str(path), "goals")
    if node is None or not isinstance(content, list) or not content:
        raise entry.expected(what)
    if not with_lines:
        return entry.items()
    lines = [each.start_mark.line + 1 for each in node.value]
    return [
        Entry(each.value, f"{path}: line {line}", each.name)
        for line, each in zip(lines, entry.items(), strict=True)
    ]


def _goal(entry: Entry) -> Goal:
    names = entry.names()
    kinds = [kind for kind in _KINDS if kind in names]
    if "pose" in kinds:  # whose bounds it has then
        kinds = [kind for kind in kinds if kind != "position"]
    if len(kinds) != 1:
        raise entry.wrong(f"expected one of {', '.join(_KINDS)}, got {', '.join(kinds) or 'none'}")
    (kind,) = kinds
    read, own = _KINDS[kind]
    known = {kind, *own, *(() if kind == "center_of_mass" else (*_OF_TIPS, "tool"))}
    for name in names:
        if name not in known:
            raise entry.wrong(f"has {name!r}, expected of {kind} only {', '.join(sorted(known))}")
    rest = {name: reader(entry[name]) for name, reader in _OF_TIPS.items() if name in names}
    if "tool" in names:
        rest["T_tip_tool"] = _frame(entry["tool"])
    return _or_wrong(entry, lambda: read(entry, rest))


def _pose(entry: Entry, rest: Mapping[str, Any]) -> Goal:
    if not {"rpy", "wxyz", "matrix"} & set(entry["pose"].names()):
        raise entry["pose"].wrong("has no orientation, expected rpy, wxyz or matrix")
    names = entry.names()
    bounds: dict[str, Any] = {
        name: _box(entry[name]) for name in ("position", "rotation") if name in names
    }
    if "rotation" in bounds:
        warn_of_degrees(_title(entry["rotation"]), bounds["rotation"].ravel())
    made: Goal = Goal.region(_frame(entry["pose"]), type="pose", **bounds, **rest)
    return made


def _position(entry: Entry, rest: Mapping[str, Any]) -> Goal:
    value = entry["position"].value
    if isinstance(value, list) and any(isinstance(row, list) for row in value):
        box = _box(entry["position"])
        made: Goal = Goal.region(np.eye(4), position=box, type="position", **rest)
        return made
    return Goal(entry["position"].array(3), type="position", **rest)


def _axis(entry: Entry, rest: Mapping[str, Any]) -> Goal:
    axis = entry["axis"]
    _only(axis, *_FRAME, "of", "direction", "cone")
    names = axis.names()
    of = _direction(axis["of"]) if "of" in names else np.array([0.0, 0.0, 1.0])
    turns = sorted({"rpy", "wxyz", "matrix", "direction"} & set(names))
    if len(turns) != 1:
        raise axis.wrong(f"expected one of direction, rpy, wxyz, matrix, got {turns or 'none'}")
    frame = {name: value for name, value in axis.value.items() if name in _FRAME}
    T = _frame(Entry(frame, axis.file, axis.name))
    if "direction" in names:
        T[:3, :3] = turn_onto(of, _direction(axis["direction"]))
    return Goal(T, type="axis", axis=of, rotation_slack=[_cone(axis)] * 3, **rest)


def _look_at(entry: Entry, rest: Mapping[str, Any]) -> Goal:
    look = entry["look_at"]
    keywords: dict[str, Any] = dict(rest)
    point = look
    if not isinstance(look.value, list):
        _only(look, "point", "axis", "cone")
        point = look["point"]
        keywords["cone"] = _cone(look)
        if "axis" in look.names():
            keywords["axis"] = _direction(look["axis"])
    made: Goal = Goal.look_at(point.array(3), **keywords)
    return made


def _center_of_mass(entry: Entry, rest: Mapping[str, Any]) -> Goal:
    return Goal.center_of_mass(*_box(entry["center_of_mass"]))


_KINDS: dict[str, tuple[Callable[[Entry, Mapping[str, Any]], Goal], tuple[str, ...]]] = {
    "pose": (_pose, ("position", "rotation")),
    "position": (_position, ()),
    "axis": (_axis, ()),
    "look_at": (_look_at, ()),
    "center_of_mass": (_center_of_mass, ()),
}


def _frame(entry: Entry) -> FloatArray:
    """Transform (4, 4) of xyz [m] and rpy [rad] or wxyz, or of a matrix; zero where left out."""
    _only(entry, *_FRAME)
    names = entry.names()
    if "matrix" in names:
        if len(names) > 1:
            raise entry.wrong("expected matrix alone, or xyz with rpy or wxyz")
        matrix = entry["matrix"].array(4, 4)
        return _or_wrong(entry["matrix"], lambda: rigid(matrix, "the matrix"))
    if "rpy" in names and "wxyz" in names:
        raise entry.wrong("expected rpy or wxyz, got both")
    T = np.eye(4)
    if "xyz" in names:
        T[:3, 3] = entry["xyz"].array(3)
    if "rpy" in names:
        angles = entry["rpy"].array(3)
        warn_of_degrees(_title(entry["rpy"]), angles)
        T[:3, :3] = rotation_of_rpy(*angles)
    if "wxyz" in names:
        xyzw = np.roll(entry["wxyz"].array(4), -1)
        T[:3, :3] = _or_wrong(entry["wxyz"], lambda: rotation_of_xyzw(xyzw, "w x y z"))
    return T


def _only(entry: Entry, *known: str) -> None:
    for name in entry.names():
        if name not in known:
            raise entry.wrong(f"has {name!r}, expected only {', '.join(known)}")


def _box(entry: Entry) -> FloatArray:
    """A lower and an upper corner, (2, 3)."""
    return entry.array(2, 3)


def _cone(entry: Entry) -> float:
    if "cone" not in entry.names():
        return 0.0
    warn_of_degrees(_title(entry["cone"]), [entry["cone"].number()])
    return entry["cone"].number()


def _direction(entry: Entry) -> FloatArray:
    """A letter or a vector of any length, (3,), of length 1."""
    if isinstance(entry.value, str):
        return np.asarray(np.eye(3)["xyz".index(entry.text("x", "y", "z"))])
    vector = entry.array(3)
    length = float(np.linalg.norm(vector))
    if not (np.isfinite(length) and length > 1e-9):
        raise entry.expected("x, y, z or a direction of three numbers")
    return vector / length


def turn_onto(a: FloatArray, b: FloatArray) -> FloatArray:
    """A rotation that takes one direction to another, (3, 3): the smallest (Rodrigues)."""
    v, cosine = np.cross(a, b), float(a @ b)
    if cosine < -1.0 + 1e-12:  # half a turn about anything square to it
        across = np.cross(a, np.eye(3)[np.abs(a).argmin()])
        across /= np.linalg.norm(across)
        return 2.0 * np.outer(across, across) - np.eye(3)
    K = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.asarray(np.eye(3) + K + K @ K / (1.0 + cosine))


def _or_wrong(entry: Entry, make: Callable[[], Made]) -> Made:
    """What is made; a complaint about it names the entry."""
    try:
        return make()
    except ValueError as error:
        if type(error) is not ValueError:  # it names its entry already
            raise
        raise entry.wrong(str(error)) from error


def _title(entry: Entry) -> str:
    return f"{entry.file}: {entry.name}"
