"""How late a joint's effort answers its command, beside the other joints of the same machine.

Every log is late by its filters, and every joint of a machine by the same ones: what is later than
the others is something of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..study.recording import FloatArray
from ..thresholds.controllers import ControllerThresholds
from .open_law import Strip, left_by

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
    gain: float  # share of what the law leaves that is saved, beside a time as the others'
    t: float  # that over its error
    explained: float  # share of the effort in the band of the motion
    blocks: int
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
        each = [left_by(strips, *((t, 0.0) if of == "delay" else (0.0, t))) for t in _TIMES]
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
    saved = curve.at(usual) - curve.at(best)
    used = curve.whole > 0.0
    total, error = float(saved.sum()), float(np.std(saved[used]) * np.sqrt(used.sum()))
    before = float(curve.at(usual).sum())
    gain, t = total / max(before, 1e-300), total / max(error, 1e-300)
    period = max(strip.period for strip in strips)
    if best - usual < max(limits.later, period) or gain < limits.late_gain or t < limits.late_t:
        return None
    by_piece = [float(saved[np.unique(strip.block[strip.use])].sum()) for strip in strips]
    return Late(
        joint=j,
        of=curve.of,
        usual=usual,
        time=best - usual,
        std=float(np.hypot(curve.std(), 0.25 * period)),
        gain=gain,
        t=t,
        explained=1.0 - float(curve.at(best).sum()) / float(curve.whole.sum()),
        blocks=int(used.sum()),
        agree=sum(each > 0.0 for each in by_piece),
        recordings=len(by_piece),
    )


def saved_by(late: Late, strips: Sequence[Strip]) -> FloatArray:
    """Squares that the time takes from what a law leaves elsewhere, and those, (2, B)."""
    times = (late.usual, late.usual + late.time)
    before, after = (
        left_by(strips, *((t, 0.0) if late.of == "delay" else (0.0, t))).squares for t in times
    )
    return np.stack([before - after, before])


def _lowest(rss: FloatArray) -> float:
    """Where a parabola through the lowest and its neighbours is lowest."""
    k = int(np.argmin(rss))
    if k in (0, len(rss) - 1):
        return float(_TIMES[k])
    x, y = _TIMES[k - 1 : k + 2], rss[k - 1 : k + 2]
    a, b, _ = np.polyfit(x - x[1], y, 2)
    return float(np.clip(x[1] - 0.5 * b / a, x[0], x[2])) if a > 0.0 else float(x[1])
