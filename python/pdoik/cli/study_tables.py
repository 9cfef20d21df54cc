"""What `pdoik study check` prints."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from string import ascii_lowercase
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from .messages import out

if TYPE_CHECKING:
    from pdoik.sim2real import StudyCheck
    from pdoik.sim2real.study_check import Visible

_WIDTH = 160  # where nobody looks at a terminal
_LONG = 11  # letters of a joint's name, beyond which a number stands for it
_MANY = 7  # joints
_POSES = 4
_NOTES = 12

Row = tuple[str, str, str]  # effect, variant, unit


def print_check(check: StudyCheck) -> None:
    """Recordings, joints, effects, and what is missing."""
    wide = out if out.is_terminal else Console(file=out.file, width=_WIDTH)
    wide.print(_recordings(check))
    wide.print(_joints(check))
    for note in check.notes[:_NOTES]:
        out.print(escape(f"note: {note}"), highlight=False)
    if len(check.notes) > _NOTES:
        out.print(f"... and {len(check.notes) - _NOTES} more notes", highlight=False)
    if check.unanswerable:
        out.print(f"[bold]{escape(check.unanswerable)}[/]", highlight=False)
        return
    out.print(f"Torque {escape(check.torque)}; balances up to {check.cutoff:.3g} Hz.\n")
    letters = _Letters()
    out.print("[bold]Smallest size that would be seen[/]", highlight=False)
    wide.print(_effects(check, letters))
    for letter, reason in letters:
        out.print(escape(f"  {letter}  {reason}"), highlight=False)
    for reason, effects in _unseen(check).items():
        out.print(f"Not seen: {', '.join(effects)}: {escape(reason)}.", highlight=False)


def _table(*names: str, left: Iterable[str] = ()) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for name in names:
        table.add_column(escape(name), justify="left" if name in left else "right", no_wrap=True)
    return table


def _recordings(check: StudyCheck) -> Table:
    left = ("recording", "role", "channels")
    table = _table(*left[:2], "s", "Hz", "jitter", "gaps", "lost", "channels", left=left)
    for each in check.recordings:
        gaps = f"{each.gaps} ({each.longest_gap:.2g} s)" if each.gaps else "none"
        table.add_row(
            escape(each.name),
            each.role,
            f"{each.length:.1f}",
            f"{each.rate:.4g}",
            f"{100 * each.jitter:.1f} %",
            gaps,
            f"{100 * each.lost:.2g} %",
            " ".join(each.channels),
        )
    return table


def _joints(check: StudyCheck) -> Table:
    left = ("joint", "unit", "stands at")
    table = _table(
        *("", "joint", "from", "to", "unit", "speed /s", "accel /s^2", "moving", "reversals"),
        "stands at",
        left=left,
    )
    for k, each in enumerate(check.joints):
        poses = ", ".join(f"{pose:.2f}" for pose in each.stands[:_POSES])
        table.add_row(
            str(k + 1),
            escape(each.name),
            f"{each.lower:.2f}",
            f"{each.upper:.2f}",
            each.unit,
            f"{each.speed:.2f}",
            f"{each.acceleration:.1f}",
            f"{100 * each.moving:.0f} %" + ("" if each.judged else " (too little)"),
            str(each.reversals),
            poses + (" ..." if len(each.stands) > _POSES else ""),
        )
    return table


class _Letters:
    """Reasons by a letter each, in the order in which they come up."""

    def __init__(self) -> None:
        self._reasons: dict[str, str] = {}

    def of(self, reason: str) -> str:
        """Letter of a reason."""
        count = len(self._reasons)
        name = ascii_lowercase[count % 26] * (1 + count // 26)
        return self._reasons.setdefault(reason, name)

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return iter((letter, reason) for reason, letter in self._reasons.items())


def _effects(check: StudyCheck, letters: _Letters) -> Table:
    """A row for each effect that is seen somewhere, a column for each joint."""
    joints = [each.name for each in check.joints]
    short = len(joints) <= _MANY and all(len(name) <= _LONG for name in joints)
    heads = joints if short else [str(k + 1) for k in range(len(joints))]
    rows: dict[Row, dict[str, list[Visible]]] = {}
    for each in check.effects:
        row = (each.effect, each.variant, each.unit)
        rows.setdefault(row, {}).setdefault(each.joint, []).append(each)
    base = any(each.joint == "" and each.smallest is not None for each in check.effects)
    table = _table("effect", "unit", *heads, *(["(base)"] if base else []), left=("effect", "unit"))
    for (effect, variant, unit), by_joint in rows.items():
        if not any(each.smallest is not None for some in by_joint.values() for each in some):
            continue
        name = effect.replace("_", " ") + (f" ({variant})" if variant else "")
        plain = {} if not variant else rows.get((effect, "", unit), {})
        cells = [
            _cell(by_joint.get(joint) or plain.get(joint, []), letters)
            for joint in [*joints, *([""] if base else [])]
        ]
        table.add_row(escape(name), escape(unit), *cells)
    return table


def _cell(some: list[Visible], letters: _Letters) -> str:
    """The smallest size at a joint, or the letter of the reason why there is none."""
    sizes = [each for each in some if each.smallest is not None]
    if not sizes:
        return f"[dim]{letters.of(some[0].reason)}[/]" if some and some[0].reason else ""
    best = min(sizes, key=lambda each: (each.smallest or 0.0) * (-1 if each.below else 1))
    rounded = float(f"{best.smallest:.2g}")
    return f"{'<' if best.below else ''}{rounded:g}"


def _unseen(check: StudyCheck) -> dict[str, list[str]]:
    """Effects that are seen nowhere, by why."""
    seen = {each.effect for each in check.effects if each.smallest is not None}
    reasons: dict[str, list[str]] = {}
    for each in check.effects:
        name = each.effect.replace("_", " ")
        if each.effect not in seen and name not in reasons.get(each.reason, []):
            reasons.setdefault(each.reason, []).append(name)
    return reasons
