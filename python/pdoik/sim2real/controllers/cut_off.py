"""A drive that gives less than its law asks for: beyond a level, or a line that falls with speed.

No command of torque need be logged: below the limit the law is learnt from what the drive gave, and
beyond it the law says what was asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from pdoik.recordings import FloatArray

from ..regression.clusters import clustered
from ..thresholds.controllers import ControllerThresholds
from .law import solved
from .open_law import Saved, Strip, explicit, followed_by_others

_LEVELS = (0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 0.98)  # of the highest effort
_FASTEST = (0.5, 0.65, 0.8, 1.0, 1.2, 1.5, 2.0, 3.0)  # no-load speeds over the fastest seen
_REACHED = (0.999, 0.995, 0.98, 0.95, 0.9)  # quantiles of the efforts, by which a line lies high
_TOP = 0.999  # quantile that is the highest
_LEAST = 0.02  # of the stall torque, that a line does not fall below
_BLUR = 0.03  # share of it within which an effort is at a limit: filters, and sensors' zeros
_NOISES = 2.0  # the same in errors of the law where nothing cuts it off
_MOST_OVER = 0.1  # share of what is at a limit that may lie over it
_MOST_AT = 0.6  # share of all that may be at it
_ROUNDS = 60  # of the simplex


@dataclass(frozen=True, slots=True, kw_only=True)
class CutOff:
    """What one joint's drive does not exceed."""

    joint: int
    level: float  # at rest [N m], or the effort's unit
    level_std: float
    no_load: float  # speed at which nothing is left [rad/s]; inf where the level is the same
    no_load_std: float
    saved: Saved  # of what the law leaves
    explained: float  # share of the effort in the band of the motion
    agree: int  # recordings in which it gains
    recordings: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Rows:
    law: FloatArray  # (N, p)
    effort: FloatArray
    speed: FloatArray
    block: NDArray[np.intp]
    left_whole: FloatArray  # what it leaves without a limit
    noise: float = 0.0  # what it leaves where nothing cuts it off

    def near(self, level: float) -> float:
        """How far from a limit an effort is at it."""
        return max(_BLUR * level, _NOISES * self.noise)

    def most(self, sign: FloatArray, level: float, fall: float) -> FloatArray:
        """What is given at most along `sign`; `fall` is one over the no-load speed, (N,)."""
        return _most(sign * self.speed, level, fall)

    def at(self, level: float, fall: float) -> NDArray[np.bool_]:
        """Rows at the limit, or over it."""
        most = self.most(np.sign(self.effort), level, fall)
        return np.asarray(np.abs(self.effort) > most - self.near(level))

    def left(self, level: float, fall: float) -> tuple[FloatArray, FloatArray] | None:
        """What the law, cut off, leaves, and what it asks for; None where nothing is cut off."""
        at = self.at(level, fall)
        if at.sum() < self.law.shape[1] // 4 + 4 or at.mean() > _MOST_AT:
            return None
        asked = self.law @ solved(self.law[~at], self.effort[~at])
        sign = np.sign(self.effort)
        beyond = sign * asked - self.most(sign, level, fall)
        over = np.abs(self.effort) > self.most(sign, level, fall) + self.near(level)
        if np.median(beyond[at]) <= 0.0 or over[at].mean() > _MOST_OVER:
            return None
        most = self.most(np.sign(asked), level, fall)
        return self.effort - np.clip(asked, -most, most), asked


def cut_off(j: int, strips: Sequence[Strip], limits: ControllerThresholds) -> CutOff | None:
    """The limit of joint j's drive; None where it shows none."""
    rows = _rows(strips)
    if rows is None:
        return None
    level, fall = _best(rows)
    tried = rows.left(level, fall)
    rows = replace(rows, noise=_usual(rows.left_whole if tried is None else tried[0]))
    level, fall = _best(rows)
    tried = rows.left(level, fall)
    if tried is None:
        return None
    left, asked = tried
    saved = _saved(rows, left)
    varied = rows.effort - rows.effort.mean()
    explained = 1.0 - float(left @ left) / max(float(varied @ varied), 1e-300)
    # A limit that is met on few occasions is shown by how little is left of these.
    figures = 2 if fall > 0.0 else 1
    bic = -saved.blocks * np.log(max(1.0 - saved.gain, 1e-9)) - figures * np.log(saved.blocks)
    clear = saved.t >= limits.late_t or bic >= limits.least_bic
    if saved.gain < limits.late_gain or not clear or explained < limits.followed:
        return None
    if followed_by_others(_below(strips, rows, level, fall)) < limits.followed_elsewhere:
        return None
    level, level_std, no_load, no_load_std = _figures(rows, asked, level, fall)
    return CutOff(
        joint=j,
        level=level,
        level_std=level_std,
        no_load=no_load,
        no_load_std=no_load_std,
        saved=saved,
        explained=explained,
        agree=saved.agree(strips),
        recordings=len(strips),
    )


def saved_by(cut: CutOff, strips: Sequence[Strip]) -> Saved:
    """What the limit takes from what a law leaves of other recordings."""
    rows = _rows(strips)
    tried = None if rows is None else rows.left(cut.level, 1.0 / cut.no_load)
    if rows is None or tried is None:
        return Saved(by=np.zeros(0), of=np.zeros(0))
    return _saved(rows, tried[0])


def _most(along: FloatArray, level: float, fall: float) -> FloatArray:
    """What is given at most at speeds along the effort, (N,)."""
    return np.asarray(level * np.maximum(1.0 - along * fall, _LEAST))


def _below(strips: Sequence[Strip], rows: _Rows, level: float, fall: float) -> list[Strip]:
    """The strips where nothing cuts them off."""
    kept = []
    for strip in strips:
        most = _most(np.sign(strip.effort) * strip.speed, level, fall)
        kept.append(
            replace(strip, use=strip.use & (np.abs(strip.effort) <= most - rows.near(level)))
        )
    return kept


def _rows(strips: Sequence[Strip]) -> _Rows | None:
    """None where there are too few."""
    law, effort, speed, block = explicit(strips)
    if len(effort) < 2 * law.shape[1]:
        return None
    left = effort - law @ solved(law, effort)
    return _Rows(law=law, effort=effort, speed=speed, block=block, left_whole=left)


def _usual(left: FloatArray) -> float:
    """Standard deviation of what is usually left."""
    return 1.4826 * float(np.median(np.abs(left)))


def _saved(rows: _Rows, left: FloatArray) -> Saved:
    """Beside a law without a limit."""
    before, after = (
        np.bincount(rows.block, each**2).astype(np.float64) for each in (rows.left_whole, left)
    )
    return Saved(by=before - after, of=before)


def _best(rows: _Rows) -> tuple[float, float]:
    """Level and fall that leave least."""

    def cost(level: float, fall: float) -> float:
        tried = rows.left(level, fall) if level > 0.0 <= fall else None
        return np.inf if tried is None else float(tried[0] @ tried[0])

    size, speed = np.abs(rows.effort), np.sign(rows.effort) * rows.speed
    top, fastest = float(np.quantile(size, _TOP)), float(np.quantile(np.abs(speed), _TOP))
    flat = [(share * top, 0.0) for share in _LEVELS]
    lines = []
    for share in _FASTEST:
        along = speed / max(share * fastest, 1e-12)
        known = along < 0.9
        levels = np.quantile(size[known] / (1.0 - along[known]), _REACHED)
        lines += [(float(level), 1.0 / max(share * fastest, 1e-12)) for level in levels]
    found = [_polished(cost, min(starts, key=lambda x: cost(*x))) for starts in (flat, lines)]
    return min(found, key=lambda x: cost(*x))


def _polished(
    cost: Callable[[float, float], float], start: tuple[float, float]
) -> tuple[float, float]:
    """Near a start, where the cost is lowest (Nelder and Mead); a level alone stays alone."""
    if not np.isfinite(cost(*start)):
        return start
    free = 2 if start[1] > 0.0 else 1

    def at(x: FloatArray) -> tuple[float, float]:
        return float(x[0]) * start[0], float(x[1]) * start[1] if free == 2 else 0.0

    result = optimize.minimize(  # type: ignore[call-overload]  # its stubs know no simplex
        lambda x: cost(*at(x)),
        np.ones(free),
        method="Nelder-Mead",
        options={
            "maxfev": _ROUNDS,
            "initial_simplex": 1.0 + 0.04 * np.vstack([np.zeros(free), np.eye(free)]),
        },
    )
    return at(np.asarray(result.x))


def _figures(
    rows: _Rows, asked: FloatArray, level: float, fall: float
) -> tuple[float, float, float, float]:
    """Level and no-load speed with errors, by the rows at the limit, blocks as clusters."""
    sign = np.sign(rows.effort)
    at = rows.at(level, fall) & (sign * asked > rows.most(sign, level, fall))
    size, along, block = np.abs(rows.effort[at]), (sign * rows.speed)[at], rows.block[at]
    A = np.stack([np.ones(len(size)), -along], axis=1)[:, : 2 if fall > 0.0 else 1]
    x = np.linalg.lstsq(A, size, rcond=None)[0]
    inverse = np.linalg.pinv(A.T @ A)
    covariance, _ = clustered(inverse, A, size - A @ x, block)
    std = float(np.hypot(np.sqrt(covariance[0, 0]), _BLUR * x[0]))
    if fall == 0.0 or x[1] <= 0.0:
        return float(x[0]), std, np.inf, 0.0
    slope_std = float(np.hypot(np.sqrt(covariance[1, 1]), 2.0 * _BLUR * x[1]))
    no_load = float(x[0] / x[1])
    return float(x[0]), std, no_load, no_load * float(np.hypot(slope_std / x[1], std / x[0]))
