"""Positions that jump: unwrapped where an encoder wraps, else left out with what is around them.

Where an encoder slips or is set anew nobody knows which readings were right, but filters would
smear the jump over all that is near.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from pdoik.errors import LoadError

from .columns import Table
from .glitches import glitches
from .jumps import FAR, QUICK, IntArray, Jumps, Steps, jumps_of, range_of_own, steps_of
from .recording import STILL, FloatArray
from .units import Units
from .wrapped import Wrap, command_unwrapped, lost_turns, unwrapped, wrap_of

_AROUND = 0.25  # left out on either side of a jump [s]
_MOST = 0.5  # of a column's readings that may be left out
_PASSES = 4  # jumps of very different sizes are found one after the other
_NAMED = 5  # jumps in one message


def with_jumps_mended(
    table: Table, joints: Sequence[str], units: Units, slides: Collection[str]
) -> Table:
    """The table, itself if no position jumps.

    Args:
        table: Its times rise, all joints have positions.
        joints: With positions.
        units: Of the columns.
        slides: The prismatic ones among the joints.

    Raises:
        LoadError: a joint's readings jump so often, and not as an encoder that wraps, that too
            little is left.
    """
    for joint in joints:
        table = _mended(table, joint, units, slides=joint in slides)
    return table


def _mended(table: Table, joint: str, units: Units, *, slides: bool) -> Table:
    column, command, unit = f"q.{joint}", f"q_des.{joint}", "m" if slides else "rad"
    x = _in_si(table, column, units, slides)
    assert x is not None
    wanted = _in_si(table, command, units, slides)
    if wanted is not None and np.array_equal(x, wanted, equal_nan=True):
        return table  # commands alone, which may step
    speed = _in_si(table, f"dq.{joint}", units, slides)
    if speed is not None:  # drives that derive it from the position have a glitch at each jump
        speed = np.where(glitches(speed), np.nan, speed)
    columns: dict[str, FloatArray] = {}
    notes: list[str] = []
    for _ in range(_PASSES):
        steady = np.where(glitches(x), np.nan, x)
        steps = steps_of(table.time, steady)
        jumps = None if steps is None else jumps_of(steps, speed)
        if steps is None or jumps is None:
            break
        wrap = wrap_of(steady, steps, jumps, turns=not slides)
        if wrap is None:
            index = _certain(steps, jumps)
            if not len(index):
                break
            x, said = _without(table, column, x, steps, index, unit)
            notes.append(said)
        else:
            x = unwrapped(x, steady, steps, wrap)
            notes += _of_wrap(column, steps, wrap, unit)
            following = None if wanted is None else command_unwrapped(table.time, wanted, wrap, x)
            if following is not None:
                wanted = columns[command] = following
                notes.append(f"{command} wraps as {column} does; it was unwrapped by itself")
        columns[column] = x
    if not columns:
        return table
    raw = {name: values / units.factor(name, slides) for name, values in columns.items()}
    return replace(table, columns={**table.columns, **raw}, notes=(*table.notes, *notes))


def _in_si(table: Table, column: str, units: Units, slides: bool) -> FloatArray | None:
    values = table.columns.get(column)
    return None if values is None else values * units.factor(column, slides)


def _certain(steps: Steps, jumps: Jumps) -> IntArray:
    """Steps that are certainly no move of the joint.

    Where samples are too few it may move between two of them; where it does not move otherwise,
    nothing shows how far it can; and where a reading was held it may have moved meanwhile.
    """
    own = range_of_own(steps, jumps.others)
    if steps.period > QUICK or own < max(STILL, FAR * jumps.noise):
        return jumps.index[:0]
    size = np.abs(steps.size[jumps.index])
    meanwhile = jumps.reach * steps.since[jumps.index] / steps.period
    return jumps.index[(size > STILL) & (size > FAR * meanwhile)]


def _without(
    table: Table, column: str, x: FloatArray, steps: Steps, index: IntArray, unit: str
) -> tuple[FloatArray, str]:
    """The column without what is around these steps, and what is said of them."""
    rows = np.zeros(len(x), dtype=np.bool_)
    for k in index:
        first = np.searchsorted(table.time, table.time[steps.before[k]] - _AROUND)
        last = np.searchsorted(table.time, table.time[steps.after[k]] + _AROUND, side="right")
        rows[first:last] = True
    when = table.start + table.time[steps.after[index]]
    shown = ", ".join(f"{each:.3f}" for each in when[:_NAMED]) + ", ..." * (len(when) > _NAMED)
    size = np.abs(steps.size[index])
    sizes = " to ".join(dict.fromkeys(f"{each:.3g}" for each in (size.min(), size.max())))
    text = (
        f"{column} jumps {_times(len(index))} by {sizes} {unit} (at {shown} s), farther than it can"
        " move from one sample to the next"
    )
    if np.isfinite(x[rows]).sum() > _MOST * np.isfinite(x).sum():
        raise LoadError(
            f"{table.name}: {text}, and not as an encoder that wraps; without what is around them"
            " too little is left, expected positions that a joint can follow"
        )
    return np.where(rows, np.nan, x), f"{text}: left out within {_AROUND:g} s"


def _of_wrap(column: str, steps: Steps, wrap: Wrap, unit: str) -> list[str]:
    """What is said of an encoder that wraps."""
    several = " or multiples of it" if np.abs(wrap.turns).max() > 1.0 else ""
    said = [
        f"{column} jumps {_times(len(wrap.index))} by {wrap.size:.4g} {unit}{several}, where its"
        " encoder wraps; it was unwrapped"
    ]
    if lost := lost_turns(steps, wrap):
        said.append(f"{column} may have turned farther in {lost} of its gaps")
    return said


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
