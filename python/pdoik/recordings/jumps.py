"""Positions that go farther from one sample to the next than their joint can move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .recording import FloatArray
from .resample import GAP

FAR = GAP
"""Times what the joint moves in a sample elsewhere: as over a gap, though no row is missing."""

QUICK = 0.06
"""No joint sets off, goes far and stands again within it [s]: as seen at 20 Hz, not quite even."""

_NEAR = 3  # steps on either side that show how the joint moves there
_NOISE = 4.0  # times the usual change from step to step: more than three steps of noise add up to
_SAME = 1e-6  # of the largest step: steps that differ by less are the same, but for float noise

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Steps:
    """Steps from each new value of a column to the next, (S,); repeated values are no steps."""

    before: IntArray  # row of the last reading of the old value
    after: IntArray  # row of the first of the new one
    size: FloatArray
    since: FloatArray  # time that the old value stood [s]
    samples: FloatArray  # in between, more than one where rows are missing
    lost: BoolArray  # over rows lost for so long that the joint may be elsewhere
    period: float  # of the column's rows [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Around:
    """How a joint moves before and after a step."""

    moved: float  # during the step, if it goes on like that
    change: float  # of that motion over the step
    way: int  # 1 or -1 where it clearly goes one way before and after, else 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Jumps:
    """Steps that the joint cannot have made, (J,)."""

    index: IntArray  # among the steps
    size: FloatArray  # with its sign, the joint's own motion taken off
    change: FloatArray  # by which the sizes are uncertain
    way: IntArray  # as in `Around`
    reach: float  # the most that the joint moves in a sample elsewhere
    noise: float  # what it seems to move within a few while it stands
    others: BoolArray  # (S,) steps of the joint's own


def steps_of(time: FloatArray, x: FloatArray) -> Steps | None:
    """The steps of a column with rising times, NaN where nothing was logged; None without any."""
    there = np.flatnonzero(np.isfinite(x))
    t, values = time[there], x[there]
    new = np.flatnonzero(np.diff(values) != 0.0) + 1
    if not len(new):
        return None
    old = np.concatenate([[0], new[:-1]])
    apart = np.diff(t)
    period = float(np.median(apart))
    gaps = np.concatenate([[0], np.cumsum(apart > GAP * period * (1 + 1e-6))])
    size = values[new] - values[new - 1]
    return Steps(
        before=there[new - 1],
        after=there[new],
        size=size,
        since=t[new] - t[old],
        samples=np.maximum(1.0, apart[new - 1] / period),
        lost=gaps[new] > gaps[old],
        period=period,
    )


def jumps_of(steps: Steps, speed: FloatArray | None) -> Jumps | None:
    """Steps far beyond all others, and beyond the recorded speed; None if there are none.

    A body takes several samples to set off and to stop, a jump is over in one: jumps stand alone,
    or go back and forth. Those much smaller than the largest are not reported yet.

    Args:
        steps: Of a column of positions.
        speed: (R,) of the same joint, if it was recorded.
    """
    sizes = np.where(steps.lost, 0.0, np.abs(steps.size) / steps.samples)
    ranked = np.append(np.sort(sizes)[::-1], 0.0)
    far = np.flatnonzero(ranked[:-1] > FAR * ranked[1:])
    if not len(far):
        return None
    reach = float(ranked[far[0] + 1])
    jumps = sizes > reach
    index = np.flatnonzero(jumps)
    if speed is not None:
        fastest = np.fmax(np.abs(speed[steps.before]), np.abs(speed[steps.after]))
        if (sizes <= FAR * fastest * steps.period)[index].any():
            return None
    onwards = np.sign(steps.size[index[1:]]) == np.sign(steps.size[index[:-1]])
    if (onwards & (np.diff(index) == 1)).any():
        return None
    others = ~steps.lost & ~jumps
    noise = noise_of(steps, others)
    around = [around_of(steps, others, int(k), noise) for k in index]
    return Jumps(
        index=index,
        size=steps.size[index] - np.array([each.moved for each in around]),
        change=np.array([max(each.change, noise) for each in around]),
        way=np.array([each.way for each in around], dtype=np.intp),
        reach=reach,
        noise=noise,
        others=others,
    )


def around_of(steps: Steps, others: BoolArray, k: int, noise: float) -> Around:
    """How the joint moves around step k, by the steps on either side up to a jump or a gap."""
    paces, moves, cadence = [], [], 0.0
    for near in (range(k - 1, k - 1 - _NEAR, -1), range(k + 1, k + 1 + _NEAR)):
        own: list[int] = []
        for i in near:
            if not 0 <= i < len(others) or not others[i]:
                break
            own.append(i)
        if own:
            move = float(steps.size[own].sum())
            paces.append(move / float(steps.since[own].sum()))
            moves.append(move if len(own) == _NEAR else 0.0)
            cadence = max(cadence, float(steps.since[own[0]]))
    lasted = min(float(steps.since[k]), cadence)  # what stood for longer had stopped
    way = int(np.sign(moves[0])) if len(moves) == 2 and moves[0] * moves[1] > 0.0 else 0
    return Around(
        moved=float(np.mean(paces)) * lasted if paces else 0.0,
        change=float(np.ptp(paces)) * lasted if paces else 0.0,
        way=way if way and min(map(abs, moves)) > noise else 0,
    )


def noise_of(steps: Steps, others: BoolArray) -> float:
    """What a few steps may add up to while the joint stands: noise, or a last digit or two."""
    size = steps.size[others]
    if len(size) < 2:
        return 0.0
    even = size / steps.since[others] * float(np.median(steps.since))
    usual = float(np.median(np.abs(np.diff(even))))
    bends = np.abs(np.diff(size))
    bends = bends[bends > _SAME * np.abs(size).max()]
    digit = float(np.quantile(bends, 0.02)) if len(bends) else 0.0
    return max(_NOISE * usual, 2.0 * digit)


def range_of_own(steps: Steps, others: BoolArray) -> float:
    """The farthest that the joint goes without a jump or a gap."""
    at = np.append(0.0, np.cumsum(np.where(others, steps.size, 0.0)))
    starts = np.append(0, np.flatnonzero(~others) + 1)
    ranges = np.maximum.reduceat(at, starts) - np.minimum.reduceat(at, starts)
    return float(ranges.max())
