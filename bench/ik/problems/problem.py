"""A problem: what stands around a robot, where its tips shall be, and a known good answer."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.common.whole_files import write_text
from bench.ik.problems.solids import Solid

Contact = tuple[str, str]  # a link and a solid that may touch


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """One target, or one for each of several tips, in one scene."""

    name: str
    robot: str  # key of bench.ik.problems.robots
    solids: tuple[Solid, ...]
    targets: dict[str, FloatArray]  # by tip link, T_base_tip (4, 4)
    goal_q: FloatArray | None = None
    """What defines the targets, (n,) in the order of the robot's joints; None if none is known."""
    allowed: frozenset[Contact] = frozenset()
    """What may touch: the tool and the object that carries the target, the base and its table."""
    contacts: dict[str, FloatArray] = field(default_factory=dict)
    """Points (K, 3) of each link that the robot stands on, in its frame [m]; empty if bolted."""
    held: dict[str, float] = field(default_factory=dict)
    """Where joints stand that nobody moves, such as fingers [rad], [m]; else as the files say."""


def save(path: Path, problems: Sequence[Problem]) -> None:
    """Write problems as JSON."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps([asdict(each) for each in problems], default=_plain) + "\n")


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else sorted(value)


def load(path: Path) -> list[Problem]:
    """What `save` wrote."""
    return [_problem(entry) for entry in json.loads(path.read_text())]


def _problem(entry: dict[str, Any]) -> Problem:
    arrays = {
        name: {key: np.array(value) for key, value in entry.get(name, {}).items()}
        for name in ("targets", "contacts")
    }
    return Problem(
        name=entry["name"],
        robot=entry["robot"],
        solids=tuple(_solid(**solid) for solid in entry["solids"]),
        goal_q=None if entry["goal_q"] is None else np.array(entry["goal_q"]),
        allowed=frozenset(map(tuple, entry["allowed"])),
        held=entry.get("held", {}),
        **arrays,
    )


def _solid(name: str, kind: Any, size: list[float], T: list, vertices: list, faces: list) -> Solid:
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    corners = np.array(faces, dtype=np.int64).reshape(-1, 3)
    return Solid(name, kind, tuple(size), np.array(T), points, corners)
