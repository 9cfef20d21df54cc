"""How late a joint's effort answers its command, beside the other joints of the same machine.

Every log is late by its filters, and every joint of a machine by the same ones: what is later than
the others is something of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray

from ..thresholds.controllers import ControllerThresholds
from .open_law import Left, Saved, Strip, followed_by_others, left_by

_TIMES = np.array([0, 4, 8, 12, 16, 24, 32, 40, 50, 65, 80, 100, 125, 150, 180, 220]) * 1e-3
_SKEWS = np.array([-60, -40, -20, -10, 0, 5, 10, 15, 20, 30, 40, 60, 80, 110, 150]) * 1e-3
_DRAWS = 200  # of blocks, for errors


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve:
    """What a joint's law leaves as it is taken to be later and later, (times, B)."""

    of: str  # what is late: "delay", the command; "lag", the effort behind a first-order filter
    squares: FloatArray
    whole: FloatArray  # (B,)

    @property
    def rss(self) -> FloatArray:
        """Of every time, (times,)."""
        return np.asarray(self.squares.sum(axis=1))

    @property
    def best(self) -> float:
        """The time that fits best [s]."""
        return _lowest(self.rss)

    @property
    def explained(self) -> float:
        """Share of the effort in the motion's band at the best time."""
        return 1.0 - float(self.rss.min()) / max(float(self.whole.sum()), 1e-300)

    def at(self, time: float) -> FloatArray:
        """Squares at a time between those that were tried, (B,)."""
        k = int(np.clip(np.searchsorted(_TIMES, time) - 1, 0, len(_TIMES) - 2))
        share = (time - _TIMES[k]) / (_TIMES[k + 1] - _TIMES[k])
        return np.asarray((1.0 - share) * self.squares[k] + share * self.squares[k + 1])

    def std(self) -> float:
        """Error of the best time, by blocks drawn anew [s]."""
        rng = np.random.default_rng(0)
        used = np.flatnonzero(self.whole)
        drawn = rng.choice(used, (_DRAWS, len(used)))
        return float(np.std([_lowest(self.squares[:, each].sum(axis=1)) for each in drawn]))


@dataclass(frozen=True, slots=True, kw_only=True)
class Late:
    """One joint's effort comes later than its peers'."""

    joint: int
    of: str  # delay or lag
    usual: float  # of the others [s]
    time: float  # beyond that [s]
    std: float  # [s]
    saved: Saved  # of what the law leaves with a time as the others'
    explained: float  # share of the effort in the band of the motion
    agree: int  # recordings in which it gains
    recordings: int


def in_time(joints: Mapping[int, Sequence[Strip]]) -> dict[int, tuple[Strip, ...]]:
    """All joints' efforts moved by one time, by which they follow best from their commands."""
    each = [
        [np.log(max(left_by([s.moved(t) for s in strips], 0.0, 0.0).rss, 1e-300)) for t in _SKEWS]
        for strips in joints.values()
    ]
    time = float(_SKEWS[np.argmin(np.median(np.array(each), axis=0))]) if each else 0.0
    return {j: tuple(s.moved(time) for s in strips) for j, strips in joints.items()}


def curves_of(strips: Sequence[Strip]) -> dict[str, Curve]:
    """By what is late."""
    found = {}
    for of in ("delay", "lag"):
        each = [_left(strips, of, float(t)) for t in _TIMES]
        squares = np.stack([left.squares for left in each])
        found[of] = Curve(of=of, squares=squares, whole=each[0].whole)
    return found


def later_ones(joints: Mapping[int, Sequence[Strip]], limits: ControllerThresholds) -> list[Late]:
    """The joints that answer later than the others, of each one's strips.

    They must do so as the channels were logged, and with what all joints have in common taken out.
    """
    plain = _later(joints, limits)
    aligned = _later(in_time(joints), limits) if plain else {}
    return [late for j, late in aligned.items() if j in plain]


def _later(joints: Mapping[int, Sequence[Strip]], limits: ControllerThresholds) -> dict[int, Late]:
    curves = {j: curves_of(strips) for j, strips in joints.items()}
    explained = {j: max(c.explained for c in each.values()) for j, each in curves.items()}
    followed = [j for j, share in explained.items() if share >= limits.followed]
    found = {}
    for j, each in curves.items():
        peers = [i for i in followed if i != j]
        # What is wrong with a joint is in its law too: the others say whether laws are seen at all.
        if not peers or explained[j] < limits.followed_itself:
            continue
        curve = min(each.values(), key=lambda c: float(c.rss.min()))
        usual = float(np.median([curves[i][curve.of].best for i in peers]))
        late = _late(j, joints[j], curve, usual, limits)
        if late is not None:
            found[j] = late
    return found


def _late(
    j: int, strips: Sequence[Strip], curve: Curve, usual: float, limits: ControllerThresholds
) -> Late | None:
    best = curve.best
    saved = Saved(by=curve.at(usual) - curve.at(best), of=curve.at(usual))
    period = max(strip.period for strip in strips)
    clear = saved.gain >= limits.late_gain and saved.t >= limits.late_t
    if best - usual < max(limits.later, period) or not clear:
        return None
    times = (best, 0.0) if curve.of == "delay" else (0.0, best)
    if followed_by_others(strips, *times) < limits.followed_elsewhere:
        return None
    return Late(
        joint=j,
        of=curve.of,
        usual=usual,
        time=best - usual,
        std=float(np.hypot(curve.std(), 0.25 * period)),
        saved=saved,
        explained=1.0 - float(curve.at(best).sum()) / float(curve.whole.sum()),
        agree=saved.agree(strips),
        recordings=len(strips),
    )


def saved_by(late: Late, strips: Sequence[Strip]) -> Saved:
    """What the time takes from what a law leaves of other recordings."""
    times = (late.usual, late.usual + late.time)
    before, after = (_left(strips, late.of, time).squares for time in times)
    return Saved(by=before - after, of=before)


def _left(strips: Sequence[Strip], of: str, time: float) -> Left:
    return left_by(strips, time, 0.0) if of == "delay" else left_by(strips, 0.0, time)


def _lowest(rss: FloatArray) -> float:
    """Where a parabola through the lowest and its neighbours is lowest."""
    k = int(np.argmin(rss))
    if k in (0, len(rss) - 1):
        return float(_TIMES[k])
    x, y = _TIMES[k - 1 : k + 2], rss[k - 1 : k + 2]
    a, b, _ = np.polyfit(x - x[1], y, 2)
    return float(np.clip(x[1] - 0.5 * b / a, x[0], x[2])) if a > 0.0 else float(x[1])
