"""How late a joint's effort answers its command, compared with the machine's other joints.

Every log is late by its filters, and every joint of a machine by the same ones: what is later than
the others is something of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.drives import ActuatorLag, CommandDelay
from ..findings import Support
from ..thresholds import ControllerThresholds
from .linear_law import Gained, LinearModel, Strip, followed_by_others, gained, law_of

_TIMES = np.array([0, 4, 8, 12, 16, 24, 32, 40, 50, 65, 80, 100, 125, 150, 180, 220]) * 1e-3
_SKEWS = np.array([-60, -40, -20, -10, 0, 5, 10, 15, 20, 30, 40, 60, 80, 110, 150]) * 1e-3
_EFFECTS = {"delay": CommandDelay.id, "lag": ActuatorLag.id}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve:
    """The laws of one joint as it is taken to be later and later."""

    of: str  # what is late: "delay", the command; "lag", the effort behind a first-order filter
    laws: tuple[LinearModel, ...]  # at `_TIMES`

    @property
    def rss(self) -> FloatArray:
        """What they leave, (times,)."""
        return np.array([law.rss for law in self.laws])

    @property
    def explained(self) -> float:
        """Share of the effort in the motion's band at the best time."""
        target = self.laws[0].target
        return 1.0 - float(self.rss.min()) / max(float(target @ target), 1e-300)

    @property
    def likelihood(self) -> FloatArray:
        """Log likelihood, of as many rows as are independent where the best law is, (times,)."""
        rows = self.laws[int(np.argmin(self.rss))].rows
        return np.asarray(-0.5 * rows * np.log(np.maximum(self.rss, 1e-300)))

    def top(self) -> tuple[float, float]:
        """The likeliest time and its error [s], by a parabola through its neighbours."""
        log = self.likelihood
        k = int(np.clip(np.argmax(log), 1, len(_TIMES) - 2))
        x, y = _TIMES[k - 1 : k + 2], log[k - 1 : k + 2]
        a, b, _ = np.polyfit(x - x[1], y, 2)
        if k != np.argmax(log) or a >= 0.0:
            return float(_TIMES[np.argmax(log)]), float(x[2] - x[0]) / 2.0
        return float(np.clip(x[1] - 0.5 * b / a, x[0], x[2])), float(np.sqrt(-0.5 / a))


@dataclass(frozen=True, slots=True, kw_only=True)
class Late:
    """One joint's effort comes later than its peers'."""

    joint: int
    of: str  # delay or lag
    usual: float  # of the others [s]
    time: float  # beyond that [s]
    std: float  # [s]
    explained: float  # share of the effort in the band of the motion
    support: Support


def in_time(joints: Mapping[int, Sequence[Strip]]) -> dict[int, tuple[Strip, ...]]:
    """All joints' efforts moved by one time, by which they follow best from their commands."""
    each = [
        [np.log(max(law_of([s.moved(t) for s in strips]).rss, 1e-300)) for t in _SKEWS]
        for strips in joints.values()
    ]
    time = float(_SKEWS[np.argmin(np.median(np.array(each), axis=0))]) if each else 0.0
    return {j: tuple(s.moved(time) for s in strips) for j, strips in joints.items()}


def curves_of(strips: Sequence[Strip]) -> tuple[Curve, ...]:
    """One curve for each kind of lateness: delay, lag."""
    return tuple(
        Curve(of=of, laws=tuple(_law(strips, of, float(t)) for t in _TIMES)) for of in _EFFECTS
    )


def later_ones(joints: Mapping[int, Sequence[Strip]], limits: ControllerThresholds) -> list[Late]:
    """The joints that answer later than the others, of each one's strips.

    They must do so as the channels were logged, and with what all joints have in common taken out.
    """
    plain = _later(joints, limits)
    aligned = _later(in_time(joints), limits) if plain else {}
    return [late for j, late in aligned.items() if j in plain]


def _later(joints: Mapping[int, Sequence[Strip]], limits: ControllerThresholds) -> dict[int, Late]:
    curves = {j: curves_of(strips) for j, strips in joints.items()}
    explained = {j: max(curve.explained for curve in each) for j, each in curves.items()}
    followed = [j for j, share in explained.items() if share >= limits.followed]
    found = {}
    for j, each in curves.items():
        peers = [i for i in followed if i != j]
        # What is wrong with a joint is in its law too: the others say whether laws are seen at all.
        if not peers or explained[j] < limits.followed_itself:
            continue
        curve = min(each, key=lambda c: float(c.rss.min()))
        times = [own.top()[0] for i in peers for own in curves[i] if own.of == curve.of]
        late = _late(j, joints[j], curve, float(np.median(times)), limits)
        if late is not None:
            found[j] = late
    return found


def _late(
    j: int, strips: Sequence[Strip], curve: Curve, usual: float, limits: ControllerThresholds
) -> Late | None:
    """A joint whose time is another one than usual, with the odds that it is (Laplace)."""
    best, std = curve.top()
    period = max(strip.period for strip in strips)
    if best - usual < max(limits.later, period):
        return None
    before, after = (_law(strips, curve.of, time) for time in (usual, best))
    saved = gained(strips, before.left, after.left)
    effect = CATALOGUE[_EFFECTS[curve.of]]
    odds = after.over(before) + float(np.log(effect.odds / (1.0 - effect.odds)))
    odds += float(np.log(min(np.sqrt(2.0 * np.pi) * std / _TIMES[-1], 1.0)))
    if saved.share < limits.late_gain or odds < limits.worth:
        return None
    times = (best, 0.0) if curve.of == "delay" else (0.0, best)
    if followed_by_others(strips, *times) < limits.followed_elsewhere:
        return None
    return Late(
        joint=j,
        of=curve.of,
        usual=usual,
        time=best - usual,
        std=float(np.hypot(std, 0.25 * period)),
        explained=1.0 - after.rss / max(float(after.target @ after.target), 1e-300),
        support=saved.support(strips, odds),
    )


def gained_by(late: Late, strips: Sequence[Strip]) -> Gained:
    """What the time takes from what a law leaves of other recordings."""
    before, after = (_law(strips, late.of, t) for t in (late.usual, late.usual + late.time))
    return gained(strips, before.left, after.left)


def _law(strips: Sequence[Strip], of: str, time: float) -> LinearModel:
    return law_of(strips, time, 0.0) if of == "delay" else law_of(strips, 0.0, time)
