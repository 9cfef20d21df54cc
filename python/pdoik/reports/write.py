"""Writes a report: everything that was asked, and the answer."""

from __future__ import annotations

import datetime
import gzip
import hashlib
import os
import platform
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from .._core import BatchResult, Result
from .._files import write_whole
from ..solver import Solver
from ..tracker import Tracker
from .obstacles import obstacles_entry, read_obstacles
from .question import answer_entry, carried_entry, goals_entry, options_entry, read_goals
from .robot import robot_entry
from .values import Entry, json_lines, plain

FORMAT = 1
"""Of the file; a reader of this version reads all up to it."""
ENDINGS = (".json", ".json.gz")


def write_report(
    path: str | os.PathLike[str],
    solver: Solver | Tracker,
    T_base_tip: Any,
    *,
    q0: ArrayLike | None = None,
    obstacles: Any = None,
    posture: ArrayLike | None = None,
    max_step: ArrayLike | None = None,
    result: Any = None,
    note: str = "",
    urdf: str | None = None,
) -> None:
    """Write a question and its answer into one file, which `replay_report` asks again.

    It holds the robot, hulls included, as numbers; options, targets, obstacles, start and answer,
    each number to the bit; and version, processor and the kernels' instructions.

    Args:
        path: To write, NAME.json or NAME.json.gz; one that is there is replaced.
        solver: What was asked, with what its links carry. Or a Tracker.
        T_base_tip: As in `Solver.solve`, or shape (B, 4, 4) as in `Solver.solve_batch`. Of a
            Tracker the targets of its steps, a list of what `Tracker.step` takes.
        q0: As in `Solver.solve`. Of a Tracker where it was reset to before the first step.
        obstacles: As in `Solver.solve`, the same for all steps of a Tracker.
        posture: As in `Solver.solve` and `Tracker.set_posture`.
        max_step: As in `Solver.solve`.
        result: What was answered: a Result, a BatchResult, or a list of TrackerResult, one a step.
            None asks now; a Tracker's steps are then made by another one like it.
        note: What is wrong with the answer, in words.
        urdf: The text that the robot was read from, for other tools; see `pdoik.urdf_text`.

    Raises:
        ValueError: As in `Solver.solve`; the name ends otherwise; a result is missing or is none.
        OSError: It cannot be written.
    """
    ending_of(path)
    asked: dict[str, Any] = {"obstacles": obstacles_entry(obstacles)}
    vectors = {"q0": q0, "posture": posture, "max_step": max_step}
    asked |= {
        name: None if value is None else plain(np.asarray(value, dtype=np.float64))
        for name, value in vectors.items()
    }
    settings = None
    if isinstance(solver, Tracker):
        if q0 is None or max_step is not None:
            raise ValueError(
                "q0 is where a tracker was reset to, which has to be told; no max_step"
            )
        kind, settings = "steps", plain(solver.settings)
        asked["targets"] = [goals_entry(target) for target in T_base_tip]
    elif is_batch(T_base_tip):
        if posture is not None or max_step is not None:
            raise ValueError("a batch takes neither posture nor max_step")
        kind, asked["target"] = "batch", goals_entry(T_base_tip)
    else:
        kind, asked["target"] = "solve", goals_entry(T_base_tip)
    asker = Asker.of(solver, kind)
    question = Entry(asked, os.fspath(path))
    answers = asker.ask(question) if result is None else _listed(result, kind)
    content = {
        "pdoik_report": FORMAT,
        "note": note,
        "written": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "by": this_build(),
        "kind": kind,
        "robot": robot_entry(solver.robot),
        "options": options_entry(asker.solver.options),
        "tracker": settings,
        "carried": carried_entry(solver.carried),
        "question": asked,
        "answers": [answer_entry(each) for each in answers],
        "urdf": urdf,
    }
    text = (json_lines(content) + "\n").encode()
    write_whole(path, gzip.compress(text, mtime=0) if ending_of(path) == ".json.gz" else text)


def ending_of(path: str | os.PathLike[str]) -> str:
    """One of ENDINGS.

    Raises:
        ValueError: The name ends otherwise.
    """
    name = Path(path).name
    for ending in ENDINGS:
        if name.lower().endswith(ending):
            return ending
    raise ValueError(f"expected a name that ends in {' or '.join(ENDINGS)}, got {name!r}")


def is_batch(target: Any) -> bool:
    """Whether these are targets of a batch."""
    if hasattr(target, "values"):
        return any(is_batch(each) for each in target.values())
    return not isinstance(target, _core.Goal) and np.ndim(target) == 3


def _listed(result: Any, kind: str) -> Sequence[Result]:
    if kind == "solve" and isinstance(result, Result):
        return [result]
    if kind == "batch" and isinstance(result, BatchResult):
        return list(result)
    is_list = isinstance(result, Sequence) and not isinstance(result, BatchResult)
    if kind == "steps" and is_list and all(isinstance(r, _core.TrackerResult) for r in result):
        return list(result)
    wanted = {"solve": "a Result", "batch": "a BatchResult", "steps": "a list of TrackerResult"}
    raise ValueError(f"result is {type(result).__name__}, expected {wanted[kind]}")


class Asker:
    """Asks a report's question.

    Args:
        solver: To ask.
        kind: "solve", "batch" or "steps".
        tracker: Of steps: made anew for each question.
    """

    def __init__(self, solver: Solver, kind: str, tracker: dict[str, Any] | None = None) -> None:
        self.solver = solver
        self.kind = kind
        self.tracker = tracker
        self.carried = solver.carried

    @classmethod
    def of(cls, solver: Solver | Tracker, kind: str) -> Asker:
        """With a tracker's solver and settings."""
        if isinstance(solver, Solver):
            return cls(solver, kind)
        asker = cls(solver.solver, kind, solver.settings)
        asker.carried = solver.carried
        return asker

    def ask(self, question: Entry) -> Sequence[Result]:
        """One answer for each target, asked among the obstacles as they are in the file."""
        dof = self.solver.robot.dof
        obstacles = read_obstacles(question["obstacles"]).given
        q0 = question["q0"]
        posture, max_step = (question[name].array_or_none(dof) for name in ("posture", "max_step"))
        if self.kind == "solve":
            target = read_goals(question["target"])
            return [self.solver.solve(target, q0.array_or_none(dof), obstacles, posture, max_step)]
        if self.kind == "batch":
            many = isinstance(q0.value, list) and any(isinstance(row, list) for row in q0.value)
            starts = q0.array_or_none(*((None, dof) if many else (dof,)))
            targets = read_goals(question["target"], batch=True)
            return list(self.solver.solve_batch(targets, starts, obstacles))
        assert self.tracker is not None
        tracker = Tracker(
            self.solver, **{**self.tracker, "max_time": self.tracker["max_time"] or None}
        )
        for each in self.carried:
            tracker.attach(*each)
        tracker.reset(q0.array(dof))
        tracker.set_posture(posture)
        return [
            tracker.step(read_goals(target, nan=True), obstacles)
            for target in question["targets"].items()
        ]


def this_build() -> dict[str, str]:
    """What may make answers differ in their last bits."""
    core = Path(_core.__file__).read_bytes()
    return {
        "pdoik": version("pdoik"),
        "core": hashlib.sha256(core).hexdigest()[:16],
        "simd": _core.simd_name(),
        "processor": _processor(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "numpy": np.__version__,
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
