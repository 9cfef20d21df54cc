"""The lines at the top of the panel: what the solver said, how long it took, what binds."""

from __future__ import annotations

import re
import time
from collections import deque
from html import escape

import numpy as np
import viser

import pdoik
from pdoik.solids import without_numbers

from .limits import limit_text, nearest_limit
from .message import Message
from .shown import Shown

_WINDOW = 2.0  # [s]
_GOOD, _NEAR, _BAD, _POSED = "#1b7f3b", "#b26a00", "#b3261e", "#4a5568"
_WHICH_GOAL = re.compile(r"^goal \d+ of \d+: ")
_WORDS = {"exhausted": "no solution found", "blocked": "target blocked"}
_POSED_BY = {"log": "posed by the log", "joints": "posed by hand", "solution": "chosen solution"}


class Meter:
    """How many solves a second, and their median time, over the last two seconds."""

    def __init__(self) -> None:
        self._solves: deque[tuple[float, float]] = deque(maxlen=1000)  # when, how long [s]

    def add(self, seconds: float, now: float | None = None) -> None:
        self._solves.append((time.monotonic() if now is None else now, seconds))

    def rate(self, now: float | None = None) -> float:
        """[1/s]."""
        since = (time.monotonic() if now is None else now) - _WINDOW
        return sum(when > since for when, _ in self._solves) / _WINDOW

    def median(self) -> float:
        """Median time of the solves that are remembered [s]; NaN without any."""
        return float(np.median([seconds for _, seconds in self._solves] or [np.nan]))

    def text(self) -> str:
        if not self._solves:
            return "none yet"
        return f"{self.rate():.0f} /s, median {1e3 * self.median():.3f} ms"


class Status:
    """Numbers that change with each solve, and the last message."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self.meter = Meter()
        self.text = ""  # what is on the page, as HTML
        self._numbers = gui.add_html("")
        self._message = Message(gui)

    def show(self, shown: Shown) -> None:
        if shown.origin == "target":
            self.meter.add(shown.found.time)
        self.text = status_html(shown, self.meter)
        self._numbers.content = self.text

    def say(self, message: str, *, bad: bool = False) -> None:
        """A line below the numbers, until the next one."""
        self._message.say(message, bad=bad)


def status_html(shown: Shown, meter: Meter) -> str:
    """Status, time, errors, clearance and the worst constraint."""
    result, robot = shown.result, shown.robot
    if shown.origin == "target":
        word = _WORDS.get(shown.found.status, shown.found.status.replace("_", " "))
        good = _NEAR if result.status == "nearest" else _GOOD
        badge = word, good if shown.met_to_tolerance else _BAD
        clock = f"{1e3 * shown.found.time:.3f} ms"
    else:
        badge = _POSED_BY[shown.origin], _POSED if result.success else _BAD
        clock = ""
    rows = [
        ("position error", f"{1e3 * result.position_error:.4f} mm"),
        ("rotation error", f"{1e3 * result.rotation_error:.4f} mrad"),
        ("clearance", _clearance(result, shown)),
        *_nearest(shown),
        *_extras(shown),
        ("worst constraint", escape(without_numbers(result.worst_constraint))),
        ("", margin_text(result, robot)),
        ("solve rate", meter.text()),
    ]
    cells = "".join(
        '<tr><td style="color:#667;padding:0 0.8em 0 0;white-space:nowrap;vertical-align:top">'
        f'{name}</td><td style="overflow-wrap:anywhere">{value}</td></tr>'
        for name, value in rows
    )
    return (
        '<div style="padding:0.2em 1em 0.4em;font-size:0.85em;line-height:1.5;'
        'font-variant-numeric:tabular-nums">'
        f'<div style="display:flex;align-items:baseline"><span style="background:{badge[1]};'
        f'color:white;border-radius:4px;padding:0.1em 0.6em;font-weight:600">{badge[0]}</span>'
        f'<span style="margin-left:auto;font-size:1.25em;font-weight:600">{clock}</span></div>'
        f"{_words(shown, badge[0])}"
        f'<table style="margin-top:0.4em;border-spacing:0">{cells}</table></div>'
    )


def _words(shown: Shown, badge: str) -> str:
    """Which goal is met, and how it went where the badge does not say it all."""
    message = _WHICH_GOAL.sub("", shown.found.message)  # the view names it
    words = [shown.choice, "" if message == badge else message]
    text = without_numbers(": ".join(each for each in words if each))
    return f'<div style="margin-top:0.3em;overflow-wrap:anywhere">{escape(text)}</div>'


def _nearest(shown: Shown) -> list[tuple[str, str]]:
    """What the robot is nearest to: an obstacle, and a limit."""
    rows = []
    if shown.nearest is not None:
        nearest = shown.nearest
        where = f"{nearest.obstacle}, {1e3 * nearest.distance:.1f} mm from {nearest.part}"
        rows.append(("nearest obstacle", escape(without_numbers(where))))
    limit = nearest_limit(shown.robot, shown.q)
    if limit is not None:
        rows.append(("nearest joint limit", escape(limit_text(limit, shown.robot))))
    return rows


def _clearance(result: pdoik.Result, shown: Shown) -> str:
    if not len(shown.robot.occupancy):
        return "the robot has no collision model"
    counts = {"points": len(shown.obstacles), "shapes": len(shown.cloud.shapes)}
    named = " and ".join(f"{n} {what[: -1 if n == 1 else None]}" for what, n in counts.items() if n)
    return f"{1e3 * result.clearance:.1f} mm to {named}" if named else "no obstacles"


def _extras(shown: Shown) -> list[tuple[str, str]]:
    """What only some solves ask for."""
    rows = []
    if shown.options.keeps_off_itself(shown.robot) and len(shown.robot.occupancy):
        rows.append(("self-collision", f"{1e3 * shown.result.self_distance:.1f} mm between links"))
    if shown.options.balance.contacts:
        lost = shown.result.balance_violation
        rows.append(("balance", f"lost by {1e3 * lost:.1f} mm" if lost > 0 else "held"))
    return rows


def margin_text(result: pdoik.Result, robot: pdoik.Robot) -> str:
    """Words for how far the worst constraint is missed, or holds."""
    amount = f"{1e3 * abs(result.worst_violation):.3g} {_unit(result, robot)}"
    return f"missed by {amount}" if result.worst_violation > 0 else f"holds, {amount} to spare"


def _unit(result: pdoik.Result, robot: pdoik.Robot) -> str:
    """Unit of a thousandth of the worst constraint."""
    name = result.worst_constraint
    if name.startswith("limit of "):
        kinds = dict(zip(robot.joint_names, robot.joint_types, strict=True))
        return "mm" if kinds.get(name.removeprefix("limit of ")) == "prismatic" else "mrad"
    return "mrad" if name.startswith("rotation") else "mm"
