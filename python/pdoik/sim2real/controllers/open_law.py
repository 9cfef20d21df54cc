"""Every linear law at once: a joint's effort by error, its integral, speeds, gravity and rotors.

A log is coarse beside a controller's ticks: with gains of thousands the steps of an encoder are
most of what it shows of the effort. Within the band of the motion they are not, and there each law
of PD, PID or cascade, with what is fed forward, is linear in the same few columns. All of them are
fitted together: whose law it is, nobody has to know to see that it acts late, or is cut off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from pdoik.recordings import FloatArray

from ..motion.signals import dilated, lagged, shifted, zero_phase
from ..thresholds.controllers import ControllerThresholds
from .law import solved
from .rows import Piece

_PER_CUTOFF = 6.0  # rows in a period of the cut-off
_REACH = 0.5  # periods of the cut-off that a filter smears
_OF_RATE = 0.35  # of the log's rate, above which nothing is kept
COMMON = 10  # columns of a law that are the same in every recording


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Strip:
    """One recording of a joint in the motion's band; arrays are (T,), rows every `step`."""

    period: float
    step: int
    q: FloatArray
    aim: FloatArray  # q_des
    speed: FloatArray  # dq
    pace: FloatArray  # dq_des; zero where it was not logged
    rate: FloatArray  # of q_des; zero where dq_des was logged
    gravity: FloatArray
    inertia: FloatArray
    mass: FloatArray
    others: FloatArray  # (T, 2)
    effort: FloatArray
    slow: FloatArray  # (T, s) what changes within seconds: an integral's errors, a sensor's zero
    use: NDArray[np.bool_]
    block: NDArray[np.intp]

    def moved(self, time: float) -> Strip:
        """With the effort as it was so much later [s]: its channel was logged that late."""
        return replace(self, effort=shifted(self.effort, -time, self.period))

    def columns(self, delay: float, lag: float) -> FloatArray:
        """The law's parts for commands that come late and an effort that lags, (T, 11)."""

        def late(values: FloatArray) -> FloatArray:
            return shifted(values, delay, self.period) if delay > 0.0 else values

        error = late(self.aim) - self.q
        speed = late(self.pace) - self.speed
        parts = [error, np.cumsum(error) * self.period, speed, late(self.pace), self.gravity]
        parts += [late(self.inertia), self.mass * error, self.mass * speed, *self.others.T]
        every = np.stack([*parts, late(self.rate)], axis=1)
        return lagged(every, lag, self.period) if lag > 0.0 else every


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Left:
    """What a law leaves, block by block of all recordings, (B,)."""

    squares: FloatArray
    whole: FloatArray  # of the effort itself, beside what changes slowly

    @property
    def rss(self) -> float:
        """Sum of squares."""
        return float(self.squares.sum())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Saved:
    """Squares that something takes from what a law leaves, block by block, (B,)."""

    by: FloatArray
    of: FloatArray  # that were left without it

    @property
    def blocks(self) -> int:
        """In which there is anything."""
        return int(np.count_nonzero(self.of))

    @property
    def gain(self) -> float:
        """Share of them; 0 where there are none."""
        return float(self.by.sum()) / max(float(self.of.sum()), 1e-300)

    @property
    def error(self) -> float:
        """Standard error of the gain, over the blocks; 0 where there are none."""
        used = self.by[self.of > 0.0]
        spread = float(np.std(used) * np.sqrt(len(used))) if len(used) else 0.0
        return spread / max(float(self.of.sum()), 1e-300)

    @property
    def t(self) -> float:
        """The gain over its error."""
        return self.gain / max(self.error, 1e-300)

    def agree(self, strips: Sequence[Strip]) -> int:
        """Recordings in which it gains."""
        each = (self.by[np.unique(strip.block[strip.use])].sum() for strip in strips)
        return sum(bool(gained > 0.0) for gained in each)


def strips_of(
    pieces: Sequence[Piece], cutoff: float, limits: ControllerThresholds
) -> tuple[Strip, ...]:
    """The pieces in the band below a cut-off [Hz], blocks numbered through."""
    strips: list[Strip] = []
    for piece in pieces:
        first = int(strips[-1].block[-1]) + 1 if strips else 0
        strips.append(_strip(piece, cutoff, limits, first))
    return tuple(strips)


def _strip(piece: Piece, cutoff: float, limits: ControllerThresholds, first: int) -> Strip:
    cutoff = min(cutoff, _OF_RATE / piece.period)

    def smooth(values: FloatArray) -> FloatArray:
        return zero_phase(values, cutoff, piece.period)

    count = len(piece.q)
    turns = int(2.0 * limits.slow * count * piece.period) + 1
    phase = np.pi * (np.arange(count) + 0.5) / count
    reach = int(_REACH / (cutoff * piece.period))
    use = ~dilated(~piece.use, reach)
    use[:reach] = use[count - reach :] = False
    return Strip(
        period=piece.period,
        step=max(1, int(1.0 / (_PER_CUTOFF * cutoff * piece.period))),
        q=smooth(piece.q),
        aim=smooth(piece.error + piece.q),
        speed=smooth(piece.aim - piece.speed),
        pace=smooth(piece.aim),
        rate=smooth(piece.rate),
        gravity=smooth(piece.gravity),
        inertia=smooth(piece.inertia),
        mass=smooth(piece.mass),
        others=smooth(piece.others),
        effort=smooth(piece.effort),
        slow=np.cos(phase[:, None] * np.arange(turns + 1)),
        use=use,
        block=first + (np.arange(count) * piece.period / limits.law_block).astype(np.intp),
    )


def left_by(strips: Sequence[Strip], delay: float, lag: float) -> Left:
    """What the best law of commands so late and an effort that so lags leaves."""
    parts = [_beside_slow(strip, delay, lag) for strip in strips]
    A = _with_own_rates([columns for columns, _, _ in parts])
    b = np.concatenate([effort for _, effort, _ in parts])
    blocks = np.concatenate([block for _, _, block in parts])
    left = b - A @ solved(A, b)
    count = int(strips[-1].block[-1]) + 1
    return Left(
        squares=np.bincount(blocks, left**2, minlength=count).astype(np.float64),
        whole=np.bincount(blocks, b**2, minlength=count).astype(np.float64),
    )


def followed(strips: Sequence[Strip], judges: Sequence[Strip]) -> float:
    """Share of the effort of other recordings that the law of these explains; below 0: none."""
    left, whole = _missed(strips, judges)
    return 1.0 - left / max(whole, 1e-300)


def followed_by_others(strips: Sequence[Strip], delay: float = 0.0, lag: float = 0.0) -> float:
    """Share of each recording's effort that the law of the others explains.

    Of halves where there is only one; of commands so late and an effort that so lags [s].
    """
    parts = strips if len(strips) > 1 else _halves(strips[0])
    pairs = [
        _missed([*parts[:k], *parts[k + 1 :]], [part], delay, lag) for k, part in enumerate(parts)
    ]
    left, whole = np.sum(pairs, axis=0)
    return 1.0 - float(left) / max(float(whole), 1e-300)


def _halves(strip: Strip) -> list[Strip]:
    first = np.arange(len(strip.q)) < len(strip.q) // 2
    return [replace(strip, use=strip.use & half) for half in (first, ~first)]


def _missed(
    strips: Sequence[Strip], judges: Sequence[Strip], delay: float = 0.0, lag: float = 0.0
) -> tuple[float, float]:
    """Squares of other recordings' effort that the law of these leaves, and all of them."""
    parts = [_beside_slow(strip, delay, lag) for strip in strips]
    A = _with_own_rates([columns for columns, _, _ in parts])
    beta = solved(A, np.concatenate([effort for _, effort, _ in parts]))
    law = np.append(beta[:COMMON], beta[COMMON:].mean())
    left = whole = 0.0
    for columns, effort, _ in (_beside_slow(strip, delay, lag) for strip in judges):
        left += float(np.sum((effort - columns @ law) ** 2))
        whole += float(np.sum(effort**2))
    return left, whole


def _beside_slow(
    strip: Strip, delay: float, lag: float
) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Columns (N, 11), efforts (N,) and blocks, less what changes slowly."""
    at = _picked(strip)
    base, _ = np.linalg.qr(strip.slow[at])
    columns, effort = strip.columns(delay, lag)[at], strip.effort[at]
    return columns - base @ (base.T @ columns), effort - base @ (base.T @ effort), strip.block[at]


def _picked(strip: Strip) -> NDArray[np.intp]:
    """Rows that count, as many as the band has."""
    return np.flatnonzero(strip.use)[:: strip.step]


def _with_own_rates(parts: Sequence[FloatArray]) -> FloatArray:
    """Rows of all recordings: what a drive makes of a command's rate differs between them."""
    rows = []
    for k, columns in enumerate(parts):
        own = np.zeros((len(columns), COMMON + len(parts)))
        own[:, :COMMON], own[:, COMMON + k] = columns[:, :COMMON], columns[:, COMMON]
        rows.append(own)
    return np.concatenate(rows)


def explicit(
    strips: Sequence[Strip],
) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.intp]]:
    """Rows (N, p) with what changes slowly as columns, efforts, speeds and block numbers, (N,)."""
    picked = [_picked(strip) for strip in strips]
    pairs = list(zip(strips, picked, strict=True))
    rows = _with_own_rates([strip.columns(0.0, 0.0)[at] for strip, at in pairs])
    slow = linalg.block_diag(*(strip.slow[at] for strip, at in pairs))
    effort, speed = (
        np.concatenate([getattr(strip, name)[at] for strip, at in pairs])
        for name in ("effort", "speed")
    )
    block = np.concatenate([strip.block[at] for strip, at in pairs])
    return np.hstack([rows, slow]), effort, speed, block
