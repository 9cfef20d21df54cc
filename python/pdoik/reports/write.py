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
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from .._core import BatchResult, Result, Solutions
from .._files import write_whole
from ..solver import Solver
from ..tracker import Tracker
from .asker import Asker
from .call import CALLS, call_entry
from .goals import alternatives_entry, goals_entry, is_list_of_goals
from .obstacles import obstacles_entry
from .question import answer_entry, carried_entry, found_entry, options_entry
from .robot import robot_entry
from .values import Entry, json_lines, plain

FORMAT = 2
"""Format of the file; a reader of this version reads all up to it."""
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
    lock: Any = None,
    T_tip_tool: Any = None,
    priority: str | None = None,
    call: Literal["solve", "solve_batch", "solve_any", "solve_all"] | None = None,
    costs: ArrayLike | None = None,
    limit: int | None = None,
    distinct: float | None = None,
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
        T_base_tip: What the method takes that was called. Of a Tracker the targets of its steps, a
            list of what `Tracker.step` takes.
        q0: As in `Solver.solve`. Of a Tracker where it was reset to before the first step.
        obstacles: As in `Solver.solve`, the same for all steps of a Tracker.
        posture: As in `Solver.solve` and `Tracker.set_posture`.
        max_step: As in `Solver.solve`.
        lock: As in `Solver.solve`.
        T_tip_tool: As in `Solver.solve`.
        priority: As in `Solver.solve`.
        call: The method that was called. None for `solve`, or `solve_batch` where there are targets
            of several solves, or what the result is of.
        costs: As in `Solver.solve_any`, for that alone.
        limit: As in `Solver.solve_all`, for that alone.
        distinct: As in `Solver.solve_all`, for that alone.
        result: What was answered: a Result, a BatchResult, Solutions, or a list of TrackerResult,
            one a step. None asks now; a Tracker's steps are then made by another one like it.
        note: What is wrong with the answer, in words.
        urdf: The text that the robot was read from, for other tools; see `pdoik.urdf_text`.

    Raises:
        ValueError: As in `Solver.solve`; the name ends otherwise; a result is missing or is none.
        OSError: It cannot be written.
    """
    ending_of(path)
    vectors = {"q0": q0, "posture": posture, "max_step": max_step}
    asked: dict[str, Any] = {"obstacles": obstacles_entry(obstacles)}
    asked |= call_entry(vectors=vectors, lock=lock, T_tip_tool=T_tip_tool, priority=priority)
    kind = _kind(solver, T_base_tip, call, result)
    if costs is not None and kind != "any":
        raise ValueError("costs are of call='solve_any'")
    if not (limit is distinct is None) and kind != "all":
        raise ValueError("limit and distinct are of call='solve_all'")
    settings = None
    if isinstance(solver, Tracker):
        others = (max_step, lock, T_tip_tool, priority)
        if q0 is None or any(each is not None for each in others):
            raise ValueError(
                "q0 is where a tracker was reset to, which has to be given; no max_step, lock,"
                " T_tip_tool or priority"
            )
        settings = plain(solver.settings)
        asked["targets"] = [goals_entry(target) for target in T_base_tip]
    elif kind == "any":
        asked["target"] = alternatives_entry(T_base_tip)
        asked["costs"] = None if costs is None else plain(np.asarray(costs, dtype=np.float64))
    else:
        asked["target"] = goals_entry(T_base_tip)
    if kind == "all":
        if priority is not None:
            raise ValueError("solve_all takes no priority; the options have one")
        asked |= {"limit": limit, "distinct": distinct}
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
        "found": found_entry(answers) if kind == "all" else None,
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
    """Whether these are targets of several solves."""
    if hasattr(target, "values"):
        return any(is_batch(each) for each in target.values())
    if is_list_of_goals(target):
        return any(hasattr(each, "values") or is_list_of_goals(each) for each in target)
    return not isinstance(target, _core.Goal) and np.ndim(target) == 3


def _kind(solver: Solver | Tracker, target: Any, call: str | None, result: Any) -> str:
    """One of a report's."""
    if isinstance(solver, Tracker):
        if call is not None:
            raise ValueError(f"call is {call!r}, expected none of a Tracker")
        return "steps"
    if call is not None:
        if call not in CALLS:
            raise ValueError(f"call is {call!r}, expected one of {', '.join(CALLS)}")
        return CALLS[call]
    if isinstance(result, Solutions):
        return "all"
    many = is_list_of_goals(target) and isinstance(result, BatchResult)
    return "batch" if many or is_batch(target) else "solve"


def _listed(result: Any, kind: str) -> Any:
    """Answers, one after the other."""
    if kind in ("solve", "any") and isinstance(result, Result):
        return [result]
    if kind == "batch" and isinstance(result, BatchResult):
        return list(result)
    if kind == "all" and isinstance(result, Solutions):
        return result
    is_list = isinstance(result, Sequence) and not isinstance(result, BatchResult)
    if kind == "steps" and is_list and all(isinstance(r, _core.TrackerResult) for r in result):
        return list(result)
    wanted = {
        "solve": "a Result",
        "any": "a Result",
        "batch": "a BatchResult",
        "all": "Solutions",
        "steps": "a list of TrackerResult",
    }
    raise ValueError(f"result is {type(result).__name__}, expected {wanted[kind]}")


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
