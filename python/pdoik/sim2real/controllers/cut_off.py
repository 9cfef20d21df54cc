"""A drive that gives less than its law asks for: beyond a level, or a line that falls with speed.

No command of torque need be logged: below the limit the law is learnt from what the drive gave, and
beyond it the law says what was asked for. Which rows are at the limit and the figures of law and
limit are fitted by turns: given the rows, a level and its fall are linear, as the law is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.drives import TorqueSaturation, TorqueSpeedLimit
from ..findings import Support
from ..thresholds import ControllerThresholds
from .linear_law import (
    Gained,
    LinearModel,
    Parameter,
    Strip,
    explicit,
    followed_by_others,
    gained,
    parts_of,
)

_LEVELS = (0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 0.98)  # of the highest effort
_FASTEST = (0.5, 0.65, 0.8, 1.0, 1.2, 1.5, 2.0, 3.0)  # no-load speeds over the fastest seen
_REACHED = (0.999, 0.995, 0.98, 0.95, 0.9)  # quantiles of the efforts, by which a line lies high
_TOP = 0.999  # quantile that is the highest
_LEAST = 0.02  # of the stall torque, that a line does not fall below
_BLUR = 0.03  # share of it within which an effort is at a limit: filters, and sensors' zeros
_NOISES = 2.0  # the same in errors of the law where nothing cuts it off
_KNOWN = 0.9  # numerics: share of a no-load speed up to which efforts say how high a line lies
_TURNS = 10  # of rows and figures


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """What a drive gives at most: level (1 - speed / no_load) along its effort."""

    level: float  # at rest [N m], or the effort's unit
    fall: float = 0.0  # one over the no-load speed [s/rad]; 0: the same at all speeds

    def most(self, along: FloatArray) -> FloatArray:
        """The most that is given at speeds along the effort, (N,)."""
        return np.asarray(self.level * np.maximum(1.0 - along * self.fall, _LEAST))


@dataclass(frozen=True, slots=True, kw_only=True)
class CutOff:
    """What one joint's drive does not exceed."""

    joint: int
    level: float  # at rest [N m], or the effort's unit
    level_std: float
    no_load: float  # speed at which nothing is left [rad/s]; inf where the level is the same
    no_load_std: float
    explained: float  # share of the effort in the band of the motion
    support: Support

    @property
    def limit(self) -> Limit:
        """The same as a limit."""
        return Limit(level=self.level, fall=1.0 / self.no_load)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Rows:
    """Rows of all recordings."""

    law: FloatArray  # (N, p)
    effort: FloatArray
    speed: FloatArray
    parts: tuple[slice, ...]
    limits: ControllerThresholds
    noise: float = 0.0  # what the law leaves where nothing cuts it off

    def near(self, limit: Limit) -> float:
        """How far from a limit an effort is at it."""
        return max(_BLUR * limit.level, _NOISES * self.noise)

    def model(self, *more: Parameter, used: FloatArray | float = 1.0) -> LinearModel:
        """The law on the rows that are used, (N, 1), with more parameters."""
        law = Parameter(name="law", columns=self.law * used)
        return LinearModel(target=self.effort, parameters=(law, *more), parts=self.parts)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Cut:
    """A law that is cut off."""

    limit: Limit
    model: LinearModel  # of law and limit
    asked: FloatArray  # (N,) by the law
    left: FloatArray  # (N,)

    @property
    def rss(self) -> float:
        return float(self.left @ self.left)


def cut_off(j: int, strips: Sequence[Strip], limits: ControllerThresholds) -> CutOff | None:
    """The limit of joint j's drive; None where it shows none."""
    rows = _rows(strips, limits)
    if rows is None:
        return None
    free = rows.model()
    first = _best(rows)
    rows = replace(rows, noise=_usual(free.left if first is None else first.left))
    cut = _best(rows)
    if cut is None:
        return None
    saved = gained(strips, free.left, cut.left)
    varied = rows.effort - rows.effort.mean()
    explained = 1.0 - cut.rss / max(float(varied @ varied), 1e-300)
    effect = CATALOGUE[(TorqueSpeedLimit if cut.limit.fall else TorqueSaturation).id]
    odds = cut.model.over(free) + float(np.log(effect.odds / (1.0 - effect.odds)))
    if saved.share < limits.late_gain or odds < limits.worth or explained < limits.followed:
        return None
    if followed_by_others(_below(strips, rows, cut.limit)) < limits.followed_elsewhere:
        return None
    level, fall = cut.limit.level, cut.limit.fall
    level_std = float(np.hypot(cut.model.std("level"), _BLUR * level))
    no_load, no_load_std = np.inf, 0.0
    if fall > 0.0:
        slope, slope_std = cut.model.value("slope"), cut.model.std("slope")
        shares = (slope_std / slope, 2.0 * _BLUR, level_std / level)
        no_load, no_load_std = 1.0 / fall, float(np.linalg.norm(shares)) / fall
    return CutOff(
        joint=j,
        level=level,
        level_std=level_std,
        no_load=no_load,
        no_load_std=no_load_std,
        explained=explained,
        support=saved.support(strips, odds),
    )


def gained_by(cut: CutOff, strips: Sequence[Strip], limits: ControllerThresholds) -> Gained:
    """What the limit takes from what a law leaves of other recordings; nothing if it shows none."""
    rows = _rows(strips, limits)
    other = None if rows is None else _turned(rows, cut.limit, _at(rows, cut.limit))
    if rows is None or other is None:
        return Gained(by=np.zeros(1), of=np.zeros(1))
    most = cut.limit.most(np.sign(other.asked) * rows.speed)
    left = rows.effort - np.clip(other.asked, -most, most)
    return gained(strips, rows.model().left, left)


def _below(strips: Sequence[Strip], rows: _Rows, limit: Limit) -> list[Strip]:
    """The strips where nothing cuts them off."""
    kept = []
    for strip in strips:
        most = limit.most(np.sign(strip.effort) * strip.dq)
        kept.append(
            replace(strip, use=strip.use & (np.abs(strip.effort) <= most - rows.near(limit)))
        )
    return kept


def _rows(strips: Sequence[Strip], limits: ControllerThresholds) -> _Rows | None:
    """Rows of all strips; None where there are too few."""
    law = explicit(strips)
    if len(law) < 2 * law.shape[1]:
        return None
    effort, speed = (
        np.concatenate([getattr(strip, name)[strip.picked] for strip in strips])
        for name in ("effort", "dq")
    )
    parts = parts_of([len(strip.picked) for strip in strips])
    return _Rows(law=law, effort=effort, speed=speed, parts=parts, limits=limits)


def _usual(left: FloatArray) -> float:
    """Standard deviation of what is usually left."""
    return 1.4826 * float(np.median(np.abs(left)))


def _best(rows: _Rows) -> _Cut | None:
    """The level, or the line, that leaves least; None where nothing is cut off."""
    size, speed = np.abs(rows.effort), np.sign(rows.effort) * rows.speed
    top, fastest = float(np.quantile(size, _TOP)), float(np.quantile(np.abs(speed), _TOP))
    flat = [Limit(level=share * top) for share in _LEVELS]
    lines = []
    for share in _FASTEST:
        no_load = max(share * fastest, 1e-12)
        along = speed / no_load
        known = along < _KNOWN
        levels = np.quantile(size[known] / (1.0 - along[known]), _REACHED)
        lines += [Limit(level=float(level), fall=1.0 / no_load) for level in levels]
    found = []
    for starts in (flat, lines):
        tried = [_turned(rows, limit, _at(rows, limit)) for limit in starts]
        likely = [each for each in tried if each is not None]
        if likely:
            cut = _settled(rows, min(likely, key=lambda each: each.rss))
            if _turned(rows, cut.limit, _at(rows, cut.limit)):  # of all that is near it, too
                found.append(cut)
    return min(found, key=lambda each: each.rss, default=None)


def _settled(rows: _Rows, cut: _Cut) -> _Cut:
    """The cut with rows at the limit and figures by turns, as long as less is left."""
    for _ in range(_TURNS):
        other = _turned(rows, cut.limit, _at(rows, cut.limit, cut.asked))
        if other is None or other.rss >= cut.rss:
            break
        cut = other
    return cut


def _at(rows: _Rows, limit: Limit, asked: FloatArray | None = None) -> NDArray[np.bool_]:
    """Rows at the limit, or over it; where it is known, what was asked for is beyond it, too."""
    sign = np.sign(rows.effort)
    most = limit.most(sign * rows.speed)
    at = np.abs(rows.effort) > most - rows.near(limit)
    return np.asarray(at if asked is None else at & (sign * asked > most))


def _turned(rows: _Rows, limit: Limit, at: NDArray[np.bool_]) -> _Cut | None:
    """Law and limit fitted with these rows at it; None where nothing is cut off."""
    if at.sum() < rows.law.shape[1] // 4 + 4 or at.mean() > rows.limits.most_at:
        return None
    sign, share = np.sign(rows.effort), at.astype(np.float64)
    parameters = [Parameter(name="level", columns=share * sign, positive=True)]
    if limit.fall > 0.0:
        parameters.append(Parameter(name="slope", columns=-share * rows.speed, positive=True))
    model = rows.model(*parameters, used=1.0 - share[:, None])
    level = model.value("level")
    if level <= 0.0:
        return None
    fall = model.value("slope") / level if limit.fall > 0.0 else 0.0
    new = Limit(level=level, fall=fall)
    asked = rows.law @ model.of("law")
    most = new.most(sign * rows.speed)
    over = np.abs(rows.effort) > most + rows.near(new)
    if np.median((sign * asked - most)[at]) <= 0.0 or over[at].mean() > rows.limits.most_over:
        return None
    most = new.most(np.sign(asked) * rows.speed)
    return _Cut(limit=new, model=model, asked=asked, left=rows.effort - np.clip(asked, -most, most))
