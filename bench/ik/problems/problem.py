"""A problem: what stands around a robot, where its tips shall be, and a known good answer."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from bench.common.whole_files import write_text
from bench.ik.problems.solids import Solid

FloatArray = npt.NDArray[np.float64]
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
    """By which links the robot stands: points (K, 3) in the link's frame [m]; empty if bolted."""


def save(path: Path, problems: Sequence[Problem]) -> None:
    """Write problems as JSON."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps([_to_json(problem) for problem in problems]) + "\n")


def load(path: Path) -> list[Problem]:
    """What `save` wrote."""
    return [_from_json(entry) for entry in json.loads(path.read_text())]


def _to_json(problem: Problem) -> dict[str, Any]:
    return {
        "name": problem.name,
        "robot": problem.robot,
        "solids": [
            {
                "name": solid.name,
                "kind": solid.kind,
                "size": list(solid.size),
                "T": solid.T.tolist(),
                "vertices": solid.vertices.tolist(),
                "faces": solid.faces.tolist(),
            }
            for solid in problem.solids
        ],
        "targets": {tip: T.tolist() for tip, T in problem.targets.items()},
        "goal_q": None if problem.goal_q is None else problem.goal_q.tolist(),
        "allowed": sorted(problem.allowed),
        "contacts": {link: points.tolist() for link, points in problem.contacts.items()},
    }


def _from_json(entry: dict[str, Any]) -> Problem:
    return Problem(
        name=entry["name"],
        robot=entry["robot"],
        solids=tuple(
            Solid(
                solid["name"],
                solid["kind"],
                tuple(solid["size"]),
                np.array(solid["T"]),
                np.array(solid["vertices"], dtype=np.float64).reshape(-1, 3),
                np.array(solid["faces"], dtype=np.int64).reshape(-1, 3),
            )
            for solid in entry["solids"]
        ),
        targets={tip: np.array(T) for tip, T in entry["targets"].items()},
        goal_q=None if entry["goal_q"] is None else np.array(entry["goal_q"]),
        allowed=frozenset((link, solid) for link, solid in entry["allowed"]),
        contacts={link: np.array(points) for link, points in entry.get("contacts", {}).items()},
    )
