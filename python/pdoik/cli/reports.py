"""pdoik report: what a file of pdoik solve --report holds, asked again and judged."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

import pdoik
from pdoik._files import write_whole

from .messages import NOT_SOLVED, fail, misuse_fails, out
from .tables import angle_text, json_text, length_text, time_text

_MOST = 20  # lines of what differs or is wrong


def report(
    file: Annotated[
        Path,
        typer.Argument(help="Of pdoik solve --report or pdoik.write_report.", metavar="FILE"),
    ],
    urdf: Annotated[
        Path | None, typer.Option(help="Write the URDF that it holds into this file.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
) -> None:
    """Ask once more what a report asked, and judge what it says by other code than the solver's.

    Exit status: 0 the same answer to the bit and all it claims holds, 1 not so, 2 no report.

    [bold]Example[/]: pdoik report case.json
    """
    with misuse_fails():
        replay = pdoik.replay_report(file)
    if urdf is not None:
        if replay.urdf is None:
            fail(f"--urdf: {file} holds no URDF, the robot is {replay.robot.name} in numbers alone")
        with misuse_fails("--urdf"):
            write_whole(urdf, replay.urdf)
    if json:
        out.print(json_text(_facts(replay)), highlight=False, markup=False)
    else:
        _print(file, replay)
    if not replay.same or replay.faults:
        raise typer.Exit(NOT_SOLVED)


def _facts(replay: pdoik.Replay) -> dict[str, object]:
    return {
        "kind": replay.kind,
        "robot": replay.robot.name,
        "note": replay.note,
        "written": replay.written,
        "by": dict(replay.by),
        "here": dict(replay.here),
        "same": replay.same,
        "differences": list(replay.differences),
        "reasons": list(replay.reasons),
        "clocked": list(replay.clocked),
        "found": replay.found,
        "found_again": replay.found_again,
        "faults": replay.faults,
        "unjudged": list(replay.unjudged),
        "answers": [dict(each) for each in replay.answers],
        "again": [dict(each) for each in replay.again],
        "judged": [asdict(each) for each in replay.judged],
    }


def _print(file: Path, replay: pdoik.Replay) -> None:
    count = len(replay.answers)
    asked = {
        "solve": "a solve",
        "batch": f"a batch of {count}",
        "any": "a solve for any of several goals",
        "all": f"all solutions, {count},",
        "steps": f"{count} steps",
    }
    by = ", ".join(replay.by[name] for name in ("simd", "processor", "system") if name in replay.by)
    links = f"{replay.robot.base_link} to {', '.join(replay.robot.tip_links)}"
    say = f"{file.name}: {asked[replay.kind]} of {replay.robot.name}, {links}"
    out.print(escape(say), highlight=False)
    out.print(escape(f"pdoik {replay.by.get('pdoik')}, {by}; {replay.written}"), style="dim")
    if replay.note:
        out.print(escape(f"note: {replay.note}"), highlight=False)
    out.print(_one(replay) if count == 1 else _many(replay))
    if replay.same:
        same = "the same answer, to the bit" if count == 1 else "the same answers, to the bit"
        if len(replay.clocked) < count:
            out.print(f"[green]{same}[/]")
        if replay.clocked:
            out.print(
                f"{len(replay.clocked)} of {count} ended by the clock, which another run need not"
                " repeat",
                highlight=False,
            )
    else:
        out.print("[red]not the same answer[/]")
        _lines([*replay.differences, *(f"perhaps {reason}" for reason in replay.reasons)])
    if replay.found is not None:
        then, now = replay.found, replay.found_again or replay.found
        out.print(f"{_whether_all(then)}; now {_whether_all(now)}", highlight=False)
    if replay.faults:
        out.print("[red]what it says does not hold[/]")
        _lines(replay.faults)
    else:
        success = any(answer["success"] for answer in replay.answers)
        what = "its figures and its success hold" if success else "its figures hold"
        out.print(f"[green]{what}[/], by other code than the solver's")
    if replay.unjudged:
        out.print(escape(f"not looked at by that: {'; '.join(replay.unjudged)}"), style="dim")


def _whether_all(found: Any) -> str:
    return "all there are" if found["complete"] else f"coverage {found['coverage']:.0%}"


def _lines(lines: list[str]) -> None:
    for line in lines[:_MOST]:
        out.print(f"  {escape(line)}", highlight=False)
    if len(lines) > _MOST:
        out.print(f"  and {len(lines) - _MOST} more; --json lists all", highlight=False)


def _one(replay: pdoik.Replay) -> Table:
    """Figures of one replay: as the report says, as they come now, as the other code has them."""
    table = Table("", "report", "now", "judged", box=box.SIMPLE_HEAD, pad_edge=False)
    was, now, judged = replay.answers[0], replay.again[0], asdict(replay.judged[0])
    table.add_row("status", was["status"], now["status"], "")
    if "tracking" in was:
        table.add_row("step", was["tracking"], now["tracking"], "")
    for name, text in (
        ("position_error", length_text),
        ("rotation_error", angle_text),
        ("clearance", length_text),
        ("self_distance", length_text),
        ("limit_violation", angle_text),
        ("balance_violation", length_text),
    ):
        known = "" if judged[name] is None else text(judged[name])
        table.add_row(name.replace("_", " "), text(was[name]), text(now[name]), known)
    table.add_row("worst", escape(was["worst_constraint"]), escape(now["worst_constraint"]), "")
    if replay.kind == "any":
        table.add_row("goal", str(was["goal_index"]), str(now["goal_index"]), "")
    table.add_row("restarts", str(was["restarts"]), str(now["restarts"]), "")
    table.add_row("time", time_text(was["time"]), time_text(now["time"]), "")
    return table


def _many(replay: pdoik.Replay) -> Table:
    """How many answers have which status."""
    table = Table("", "report", "now", box=box.SIMPLE_HEAD, pad_edge=False)
    key = "tracking" if replay.kind == "steps" else "status"
    was, now = (_counts(answers, key) for answers in (replay.answers, replay.again))
    for status in {**was, **now}:
        table.add_row(status, str(was[status]), str(now[status]))
    return table


def _counts(answers: Any, key: str) -> Counter[str]:
    return Counter(answer[key] for answer in answers)
