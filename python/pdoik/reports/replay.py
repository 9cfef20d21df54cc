"""Reads a report, asks its question again, and judges what it says."""

from __future__ import annotations

import dataclasses
import gzip
import json
import math
import os
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .._core import Robot
from ..errors import LoadError
from ..options import Options
from ..solver import Solver
from .judge import Judge, Judged
from .obstacles import read_obstacles
from .question import (
    ANSWER,
    EFFORT,
    FORGIVEN,
    OF_STEPS,
    answer_entry,
    read_answer,
    read_carried,
    read_goals,
    read_options,
)
from .robot import read_robot
from .urdf import misread
from .values import Entry, by_name
from .write import FORMAT, Asker, ending_of, this_build

PATIENCE = 60.0
"""Time for what the clock did not end where it was asked first, on a slower machine [s]."""
KINDS = ("solve", "batch", "steps")


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay:
    """A report beside its replay.

    Attributes:
        kind: "solve", "batch" or "steps".
        note: Of who wrote it.
        by: Versions, processor and instructions there; `here` those of this process.
        here: See `by`.
        robot: That was asked for.
        options: What was asked for.
        answers: What the report says, by the names of a Result.
        again: What this process answers to the same.
        differences: Where the two are not the same to the bit, in words. Answers that the clock
            ended are left out.
        reasons: What may make them differ.
        clocked: Answers that the clock ended or cut short, which another machine need not repeat.
        judged: What each of the report's answers is worth, by independent code.
        unjudged: What that code does not judge.
        misread: Where the robot is not the one of the URDF in the report, in words.
        written: When, UTC.
        urdf: The text that the robot was read from, if the report has it.
    """

    kind: str
    note: str
    by: Mapping[str, str]
    here: Mapping[str, str]
    robot: Robot
    options: Options
    answers: Sequence[Mapping[str, Any]]
    again: Sequence[Mapping[str, Any]]
    differences: Sequence[str]
    reasons: Sequence[str]
    clocked: Sequence[int]
    judged: Sequence[Judged]
    unjudged: Sequence[str]
    misread: Sequence[str]
    written: str
    urdf: str | None

    @property
    def same(self) -> bool:
        """Whether the answers are the same to the bit, but for those that the clock ended."""
        return not self.differences

    @property
    def faults(self) -> list[str]:
        """What the report claims and what does not hold, in words."""
        judged = enumerate(self.judged)
        found = [f"{_title(self.kind, k)}{fault}" for k, each in judged for fault in each.faults]
        return [*self.misread, *found]


def _title(kind: str, k: int) -> str:
    """Of an answer of a batch or of steps."""
    return {"solve": "", "batch": f"target {k}: ", "steps": f"step {k}: "}[kind]


def replay_report(path: str | os.PathLike[str]) -> Replay:
    """Ask a report's question again, and judge what it says by code that is not the solver's.

    Args:
        path: Of `write_report`.

    Raises:
        LoadError: It is no report, or of a newer version; names the entry and what is wrong.
    """
    entry = _read(path)
    robot = read_robot(entry["robot"])
    options = read_options(entry["options"])
    kind = entry["kind"].text(*KINDS)
    answers = [read_answer(each, robot.dof) for each in entry["answers"].items()]
    targets = _targets(entry["question"], kind)
    if len(answers) != len(targets):
        what = f"expected {len(targets)}, one for each target, got {len(answers)}"
        raise entry["answers"].wrong(what)
    clocked = [k for k, answer in enumerate(answers) if _is_clocked(answer, options)]
    deadline = math.inf if kind == "steps" else options.max_time
    again = _ask(entry, robot, _patient(options, answers, clocked), kind)
    by = {name: entry["by"][name].text() for name in entry["by"].names()}
    here = this_build()
    differences = []
    for k, (was, now) in enumerate(zip(answers, again, strict=True)):
        found = _differences(was, now, counts=kind != "batch")
        if found and k not in clocked and was["time"] - was["intake"] >= 0.5 * deadline:
            clocked.append(k)  # it may strike from there on, and cut what follows a solution, too
        if k not in clocked:
            differences += [f"{_title(kind, k)}{each}" for each in found]
    judge = Judge(robot, options, carries=bool(entry["carried"].items()))
    obstacles = read_obstacles(entry["question"]["obstacles"])
    judged = [
        judge(target, answer, obstacles) for target, answer in zip(targets, answers, strict=True)
    ]
    urdf = None if entry["urdf"].value is None else entry["urdf"].text()
    try:
        otherwise = [] if urdf is None else misread(urdf, robot)
    except ValueError as error:
        raise entry["urdf"].wrong(str(error)) from error
    return Replay(
        kind=kind,
        note=entry["note"].text(),
        written=entry["written"].text(),
        urdf=urdf,
        misread=otherwise,
        by=by,
        here=here,
        robot=robot,
        options=options,
        answers=answers,
        again=again,
        differences=differences,
        reasons=_reasons(by, here) if differences else [],
        clocked=clocked,
        judged=judged,
        unjudged=judge.unjudged,
    )


def _read(path: str | os.PathLike[str]) -> Entry:
    file = os.fspath(path)
    try:
        raw = Path(path).read_bytes()
        if ending_of(path) == ".json.gz":
            raw = gzip.decompress(raw)
        content = json.loads(raw.decode("utf-8"), object_pairs_hook=by_name)
    except (OSError, EOFError, zlib.error) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise LoadError(f"cannot read {file}: {reason}") from error
    except (ValueError, RecursionError) as error:
        raise LoadError(f"{file}: no report: {error}") from error
    entry = Entry(content, file)
    if not isinstance(content, Mapping) or "pdoik_report" not in content:
        raise LoadError(f"{file}: no report: expected the entry 'pdoik_report'")
    version = entry["pdoik_report"].whole()
    if not 1 <= version <= FORMAT:
        raise entry["pdoik_report"].wrong(f"expected 1 to {FORMAT}, got {version}: a newer pdoik's")
    return entry


def _targets(question: Entry, kind: str) -> list[Any]:
    """The goals of each answer."""
    if kind == "steps":
        return [read_goals(each, nan=True) for each in question["targets"].items()]
    if kind == "solve":
        return [read_goals(question["target"])]
    batch = read_goals(question["target"], batch=True)
    if not isinstance(batch, Mapping):
        return list(batch)
    return [
        dict(zip(batch, row, strict=True)) for row in zip(*batch.values(), strict=False)
    ]  # of different lengths: the solver says so


def _is_clocked(answer: Mapping[str, Any], options: Options) -> bool:
    if answer["status"] == "time_limit" or answer.get("tracking") == "deadline_struck":
        return True
    return options.prefer == "nearest" and answer["restarts"] < options.max_restarts


def _patient(
    options: Options, answers: Sequence[Mapping[str, Any]], clocked: Sequence[int]
) -> Options:
    """So much time that a slower machine comes to the same answer, and no further than that."""
    if clocked and len(answers) > 1:
        return options
    patient = dataclasses.replace(options, max_time=max(options.max_time, PATIENCE))
    if not clocked:
        return patient
    return dataclasses.replace(patient, max_restarts=answers[0]["restarts"])


def _ask(entry: Entry, robot: Robot, options: Options, kind: str) -> list[dict[str, Any]]:
    tracker = None
    try:
        solver = Solver(robot, options)
        carried = read_carried(entry["carried"])
        if kind == "steps":
            tracker = _settings(entry["tracker"], robot.dof)
        else:
            for each in carried:
                solver.attach(*each)
        asker = Asker(solver, kind, tracker)
        asker.carried = tuple(carried)
        return [
            read_answer(Entry(answer_entry(each), entry.file), robot.dof)
            for each in asker.ask(entry["question"])
        ]
    except ValueError as error:
        if type(error) is not ValueError:  # it names its entry already
            raise
        raise entry.wrong(str(error)) from error


def _settings(entry: Entry, dof: int) -> dict[str, Any]:
    """Of a tracker, with time for a slower machine."""
    settings: dict[str, Any] = {
        name: entry[name].number()
        for name in ("period", "max_time", "speed_share", "posture_weight", "smoothness")
    }
    settings["max_speed"] = entry["max_speed"].array_or_none(dof)
    settings["max_time"] = max(settings["max_time"], 1.0)
    return settings


def _differences(was: Mapping[str, Any], now: Mapping[str, Any], *, counts: bool) -> list[str]:
    """What is not the same to the bit, in words.

    Args:
        was: The report's answer.
        now: This process's.
        counts: Compare effort, too; in a batch it depends on which thread solved what before.
    """
    found = []
    forgiven = [name for name in FORGIVEN if name in was]
    for name in (*ANSWER, *forgiven, *(EFFORT if counts else ()), *OF_STEPS):
        a, b = was.get(name), now.get(name)
        if name == "q":
            a, b = np.asarray(a), np.asarray(b)
            if a.tobytes() != b.tobytes():
                found.append(f"q differs by up to {np.abs(a - b).max():.3g}")
        elif isinstance(a, np.ndarray):
            if a.tobytes() != np.asarray(b).tobytes():
                found.append(f"{name} was {a.tolist()}, is {np.asarray(b).tolist()}")
        elif a != b and not (a != a and b != b):  # NaN
            found.append(f"{name} was {a!r}, is {b!r}")
    return found


def _reasons(by: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """What of the two builds and machines is not the same."""
    reasons = []
    if by.get("simd") != here["simd"]:
        simd = by.get("simd")
        reasons.append(
            f"other instructions: {simd} there, {here['simd']} here; PDOIK_SIMD={simd} takes those"
        )
    if by.get("core") != here["core"]:
        versions = f"pdoik {by.get('pdoik')} there, {here['pdoik']} here"
        reasons.append(f"another build: {versions}, compiled modules differ")
    if by.get("processor") != here["processor"]:
        reasons.append(f"another processor: {by.get('processor')} there, {here['processor']} here")
    return reasons
