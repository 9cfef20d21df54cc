"""Encoders that wrap: at one end of their range they go on at the other.

A drive that sends its position in 16 bits, say from -12.5 to 12.5 rad, or an angle given from -pi
to pi, jumps by its whole range where the joint turns on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from .jumps import FAR, QUICK, IntArray, Jumps, Steps, jumps_of, steps_of
from .recording import STILL, FloatArray

_GLITCHES = 0.1  # share of jumps that may be off, by a glitch next to them
_BEYOND = 1e-3  # share of readings that may be glitches out of the encoder's range
_SEVERAL = 3  # jumps of one size against the motion that no chance makes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wrap:
    """How far an encoder's readings jump, and where."""

    size: float
    index: IntArray  # of the steps that jump
    turns: FloatArray  # of each, multiples of the size with their sign
    reach: float  # the most that the column moves in a sample elsewhere


def wrap_of(x: FloatArray, steps: Steps, jumps: Jumps, *, turns: bool) -> Wrap | None:
    """The wrap that explains the jumps, all but those far smaller than it; None if there is none.

    They are of one size, or multiples of it, up to what the joint moves in a sample. And either
    this is the whole range of what is read, and the joint goes on against the jumps, or at least
    moves at both ends; or it is a turn; or there are several jumps, all against the motion. Where
    samples are few only turns are reported, and of a joint that goes on: what is lifted slowly may
    drop between two of them.

    Args:
        x: (R,) a column of positions.
        steps: Of it.
        jumps: Among them.
        turns: Whether the joint is where it was after a turn: no slide.
    """
    sizes, signs = np.abs(jumps.size), np.sign(jumps.size)
    allowed = max(jumps.reach, STILL)
    at_both = _within(x) > FAR * max(allowed, jumps.noise)
    quick = steps.period <= QUICK
    span, most = (float(np.ptp(np.nanquantile(x, (k, 1.0 - k)))) for k in (0.0, _BEYOND))
    for base in (sizes.max(), sizes.min()):
        multiples = np.rint(sizes / base)
        found = multiples > 0.0
        size = float(np.median(sizes[found] / multiples[found]))
        off = np.abs(sizes - multiples * size)
        if (off > allowed * steps.samples[jumps.index])[found].mean() > _GLITCHES:
            continue
        along = (jumps.way * signs)[found]
        goes_on = 1 not in along and (-1 in along or at_both)
        is_range = quick and most <= size + allowed and goes_on
        several = quick and len(along) >= _SEVERAL and bool((along < 0).all())
        change = float(np.median(jumps.change[found]))
        if size < span <= size + change:  # noise at its ends makes jumps seem smaller
            size = span
        whole = 2.0 * pi * round(size / (2.0 * pi))
        exact = max(change / np.sqrt(len(along)), STILL)
        is_turn = turns and whole > 0.0 and abs(size - whole) <= exact and (quick or goes_on)
        if is_range or several or is_turn:
            return Wrap(
                size=whole if is_turn else size,
                index=jumps.index[found],
                turns=(signs * multiples)[found],
                reach=jumps.reach,
            )
    return None


def _within(x: FloatArray) -> float:
    """How far the readings go from both of their ends: they do not if they are at two places."""
    middle = 0.5 * (np.nanmin(x) + np.nanmax(x))
    return float(min(np.ptp(x[x <= middle]), np.ptp(x[x > middle])))


def unwrapped(x: FloatArray, steady: FloatArray, steps: Steps, wrap: Wrap) -> FloatArray:
    """The column without the wrap; after lost rows it goes on at the nearest turn.

    Args:
        x: (R,) as read.
        steady: The same without glitches, which are put at the nearest turn, too.
        steps: Of `steady`.
        wrap: Of `steady`.
    """
    turns = np.where(steps.lost, np.rint(steps.size / wrap.size), 0.0)
    turns[wrap.index] = wrap.turns
    offset = np.zeros(len(x))
    offset[steps.after] = turns
    out = x - wrap.size * np.cumsum(offset)
    known = np.isfinite(steady)
    rest = np.flatnonzero(np.isfinite(x) & ~known)
    near = np.interp(rest, np.flatnonzero(known), out[known])
    out[rest] -= wrap.size * np.rint((out[rest] - near) / wrap.size)
    return out


def lost_turns(steps: Steps, wrap: Wrap) -> int:
    """How often rows are missing for so long that the joint may have turned farther."""
    far = wrap.reach * steps.since / steps.period > 0.5 * wrap.size
    return int((steps.lost & far).sum())


def command_unwrapped(
    time: FloatArray, command: FloatArray, wrap: Wrap, x: FloatArray
) -> FloatArray | None:
    """A commanded position without jumps of its own by the encoder's size, None if it has none.

    It begins at the turn nearest to the position: one of the two may be past the end already.

    Args:
        time: (R,) [s].
        command: (R,), NaN where nothing was logged.
        wrap: Of the encoder.
        x: (R,) the position, unwrapped.
    """
    steps = steps_of(time, command)
    jumps = None if steps is None else jumps_of(steps, None)
    if steps is None or jumps is None:
        return None
    turns = np.rint(jumps.size / wrap.size)
    found = turns != 0.0
    off = np.abs(jumps.size - turns * wrap.size)[found]
    if not len(off) or off.max() > max(jumps.reach, STILL):
        return None
    own = replace(wrap, index=jumps.index[found], turns=turns[found], reach=jumps.reach)
    out = unwrapped(command, command, steps, own)
    both = np.isfinite(out) & np.isfinite(x)
    if both.any():
        out -= wrap.size * np.rint(np.median((out - x)[both]) / wrap.size)
    return out
