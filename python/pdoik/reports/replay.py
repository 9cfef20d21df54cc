"""Reads a report, asks its question again, and judges what it says."""

from __future__ import annotations

import dataclasses
import gzip
import json
import math
import os
import warnings
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .._core import Robot
from ..errors import GoalWarning, LoadError
from ..options import Options
from ..solver import Solver
from .asker import Asker
from .call import Call, calls_of, read_keywords
from .differences import of_answers, of_found, reasons_for
from .goals import each_of, read_goals
from .judge import Judge, Judged
from .obstacles import read_obstacles
from .question import (
    answer_entry,
    found_entry,
    read_answer,
    read_carried,
    read_found,
    read_options,
)
from .robot import read_robot
from .urdf import misread
from .values import Entry, by_name
from .write import FORMAT, ending_of, this_build

PATIENCE = 60.0
"""Time for what the clock did not end where it was asked first, on a slower machine [s]."""
KINDS = ("solve", "batch", "steps", "any", "all")


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay:
    """A report together with its replay.

    Attributes:
        kind: "solve", "batch", "any", "all" or "steps".
        note: Of who wrote it.
        by: Versions, processor and instructions there; `here` those of this process.
        here: See `by`.
        robot: That was asked for.
        options: What was asked for.
        answers: What the report says, by the names of a Result.
        again: What this process answers to the same.
        found: Of all solutions what is none of theirs: whether they are complete, and so on.
        found_again: The same by this process.
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
    found: Mapping[str, Any] | None = None
    found_again: Mapping[str, Any] | None = None

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
    """Title of one of several answers."""
    titles = {"batch": f"target {k}: ", "steps": f"step {k}: ", "all": f"solution {k}: "}
    return titles.get(kind, "")


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
    found = read_found(entry["found"], len(answers)) if kind == "all" else None
    asked = _asked(entry["question"], kind, answers, robot.dof)
    clocked = _clocked(answers, options) if found is None else _all_clocked(found, options)
    again, found_again = _ask(entry, robot, _patient(options, answers, clocked, kind), kind)
    by = {name: entry["by"][name].text() for name in entry["by"].names()}
    here = this_build()
    differences = []
    if found is not None and found_again is not None and not clocked:
        differences += of_found(found, found_again)
    deadline = math.inf if kind == "steps" else options.max_time
    for k, (was, now) in enumerate(zip(answers, again, strict=False)):  # `found` says how many
        off = of_answers(was, now, counts=kind != "batch")
        if off and k not in clocked and was["time"] - was["intake"] >= 0.5 * deadline:
            clocked.append(k)  # it may strike from there on, and cut what follows a solution, too
        if k not in clocked:
            differences += [f"{_title(kind, k)}{each}" for each in off]
    carried = read_carried(entry["carried"])
    obstacles = read_obstacles(entry["question"]["obstacles"])
    contacts = [*obstacles.contacts, *(rule for each in carried for rule in each.contacts)]
    judge = Judge(robot, options, carries=bool(carried), contacts=contacts)
    judged = [
        judge(goals, answer, obstacles, call)
        for (goals, call), answer in zip(asked, answers, strict=True)
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
        reasons=reasons_for(by, here) if differences else [],
        clocked=clocked,
        judged=judged,
        unjudged=judge.unjudged,
        found=found,
        found_again=found_again,
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


def _asked(
    question: Entry, kind: str, answers: Sequence[Mapping[str, Any]], dof: int
) -> list[tuple[Any, Call]]:
    """The goals of each answer, and what else was said of it."""
    if kind == "steps":
        targets = [read_goals(each, nan=True) for each in question["targets"].items()]
        calls = [Call()] * len(targets)
    else:
        goals = read_goals(question["target"], batch=kind in ("batch", "any"))
        targets = each_of(goals) if kind in ("batch", "any") else [goals]
        if kind == "any":
            targets = [_met(targets, answer, question) for answer in answers[:1]]
        if kind == "all":
            targets *= len(answers)
        calls = calls_of(read_keywords(question, dof, kind), len(targets))
    if not len(answers) == len(targets) == len(calls):
        what = f"expected {len(targets)}, one for each target, got {len(answers)}"
        raise Entry(answers, question.file, "answers").wrong(what)
    return list(zip(targets, calls, strict=True))


def _met(targets: Sequence[Any], answer: Mapping[str, Any], question: Entry) -> Any:
    """Target, of several that would do, the one that an answer says it is about."""
    index = answer.get("goal_index", -1)
    if not 0 <= index < len(targets):
        what = f"expected an answer to one of {len(targets)} goals, got goal_index {index}"
        raise question["target"].wrong(what)
    return targets[index]


def _clocked(answers: Sequence[Mapping[str, Any]], options: Options) -> list[int]:
    """Answers that the clock ended."""
    return [
        k
        for k, answer in enumerate(answers)
        if answer["status"] == "time_limit"
        or answer.get("tracking") == "deadline_struck"
        or (options.prefer == "nearest" and answer["restarts"] < options.max_restarts)
    ]


def _all_clocked(found: Mapping[str, Any], options: Options) -> list[int]:
    """The same of all solutions, of which none is as it was when the clock ended the search.

    Where there is none -1 stands for the search.
    """
    struck = found["status"] == "time_limit" or found["time"] >= 0.5 * options.max_time
    return list(range(len(found["turns"]))) or [-1] if struck else []


def _patient(
    options: Options, answers: Sequence[Mapping[str, Any]], clocked: Sequence[int], kind: str
) -> Options:
    """So much time that a slower machine comes to the same answer, and no further than that."""
    if clocked and (len(answers) > 1 or kind == "all"):
        return options
    patient = dataclasses.replace(options, max_time=max(options.max_time, PATIENCE))
    if not clocked:
        return patient
    return dataclasses.replace(patient, max_restarts=answers[0]["restarts"])


def _ask(
    entry: Entry, robot: Robot, options: Options, kind: str
) -> tuple[list[dict[str, Any]], dict[str, Any] | None]:
    """Answers, and of all solutions what is none of theirs."""
    tracker = None
    try:
        solver = Solver(robot, options)
        carried = read_carried(entry["carried"])
        if kind == "steps":
            tracker = _settings(entry["tracker"], robot.dof)
        else:
            solver.attach_all(carried)
        asker = Asker(solver, kind, tracker)
        asker.carried = carried
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GoalWarning)  # who asked was warned
            again = asker.ask(entry["question"])
        answers = [read_answer(Entry(answer_entry(each), entry.file), robot.dof) for each in again]
        if kind != "all":
            return answers, None
        return answers, read_found(Entry(found_entry(again), entry.file), len(answers))
    except ValueError as error:
        if type(error) is not ValueError:  # it names its entry already
            raise
        raise entry.wrong(str(error)) from error


def _settings(entry: Entry, dof: int) -> dict[str, Any]:
    """Settings of a tracker, with time for a slower machine."""
    settings: dict[str, Any] = {
        name: entry[name].number()
        for name in ("period", "max_time", "speed_share", "posture_weight", "smoothness")
    }
    settings["max_speed"] = entry["max_speed"].array_or_none(dof)
    settings["max_time"] = max(settings["max_time"], 1.0)
    return settings
