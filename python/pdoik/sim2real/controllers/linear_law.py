"""Linear controller regression: a joint's effort by all that any linear law is made of.

A log is coarser than a controller's ticks: with gains of thousands the steps of an encoder are
most of what it shows of the effort. Within the band of the motion they are not, and there each law
of PD, PID or cascade, with what is fed forward, is linear in the same few columns: error, its
integral, speeds, gravity and rotors. All of them are fitted together with priors: whose law it is,
nobody has to know to see that it acts late, or is cut off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from pdoik.recordings import FloatArray

from ..findings import Evidence, Support
from ..identify import Hypothesis, Linearisation, Model, Series
from ..motion import Key, Place, dilated, lagged, shifted, zero_phase
from ..regression import Term, share_by_blocks
from ..thresholds import ControllerThresholds
from .rows import Piece

_KEY: Key = ("law", 0)
_LARGE = 10.0  # standard deviation of a coefficient's part, in root mean squares of the target
_FLOOR = 1e-6  # noise at least, as a share of the target


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Parameter:
    """Coefficients of one name, normal about `mean`; or of a part as large as the target."""

    name: str
    columns: FloatArray  # (N,) or (N, k)
    mean: float = 0.0
    std: float | None = None  # None: by the size of the target
    positive: bool = False  # of one column alone

    def hypothesis(self, size: float) -> Hypothesis:
        """The kernel's; `size` is the target's root mean square."""
        columns = self.columns.reshape(len(self.columns), -1)
        varied = np.std(columns, axis=0)  # a constant takes up the mean
        varied = np.where(varied > 0.0, varied, np.sqrt(np.mean(columns**2, axis=0)))
        usual = _LARGE * size / np.where(varied > 0.0, varied, 1.0)
        precision = (usual if self.std is None else np.full(len(usual), self.std)) ** -2
        return Hypothesis(
            term=Term(
                effect=self.name,
                place=Place(),
                shape=(),
                columns={_KEY: columns},
                prior=precision,
            ),
            mean=np.full(len(usual), self.mean),
            precision=precision,
            ordinary=True,
            positive=self.positive,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearModel:
    """Parameters fitted together to one target."""

    target: FloatArray  # (N,)
    parameters: tuple[Parameter, ...]
    parts: tuple[slice, ...]  # rows of one recording each
    rows: float = 0.0  # that say something new; 0: by what the model leaves
    kernel: Model = field(init=False)

    def __post_init__(self) -> None:
        """Fits at once."""
        size = max(float(np.sqrt(np.mean(self.target**2))), 1e-300)
        series = Series(
            rows=np.arange(len(self.target)),
            target=self.target,
            floor=_FLOOR * size,
            parts=self.parts,
            independent=self.rows,
        )
        hypotheses = [each.hypothesis(size) for each in self.parameters]
        model = Model(Linearisation({_KEY: series}), hypotheses)
        if not self.rows:
            series.independent = len(series.rows) / series.repeats(model.left(_KEY))
            model = Model(model.data, hypotheses, model)
        object.__setattr__(self, "kernel", model)
        object.__setattr__(self, "rows", series.independent)

    @property
    def left(self) -> FloatArray:
        """What it leaves, (N,)."""
        return self.kernel.left(_KEY)

    @property
    def rss(self) -> float:
        """Sum of squares that it leaves."""
        return float(self.left @ self.left)

    def of(self, name: str) -> FloatArray:
        """Coefficients of a parameter, (k,)."""
        return np.asarray(self.kernel.beta[self._span(name)])

    def value(self, name: str) -> float:
        """The first coefficient of a parameter."""
        return float(self.of(name)[0])

    def std(self, name: str) -> float:
        """Standard error of the first coefficient of a parameter."""
        return float(np.sqrt(self.kernel.variances[self._span(name)][0]))

    def with_prior(self, name: str, mean: float, std: float) -> LinearModel:
        """The model with another prior of one name, if it is there."""
        parameters = tuple(
            replace(each, mean=mean, std=std) if each.name == name else each
            for each in self.parameters
        )
        return replace(self, parameters=parameters)

    def over(self, other: LinearModel, least: float = 0.0) -> float:
        """Log evidence beyond another model of the same rows.

        As many of them say something new as this one leaves, or as are known to at least.
        """
        rows = max(self.rows, least)
        mine, others = (replace(each, rows=rows).kernel for each in (self, other))
        return mine.log_evidence - others.log_evidence

    def _span(self, name: str) -> slice:
        return next(span for each, span in self.kernel.placed if each.term.effect == name)


def parts_of(lengths: Sequence[int]) -> tuple[slice, ...]:
    """Neighbouring stretches of such lengths."""
    ends = np.cumsum([0, *lengths])
    return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))


_PER_CUTOFF = 6.0  # rows in a period of the cut-off
_REACH = 0.5  # periods of the cut-off that a filter smears
_OF_RATE = 0.35  # of the log's rate, above which nothing is kept
_COMMON = 10  # columns of a law that are the same in every recording
_SEED = 0  # of the blocks that are drawn for intervals


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Strip(Piece):
    """One recording of a joint in the motion's band, rows every `step`."""

    step: int
    block: NDArray[np.intp]  # numbered through all recordings
    slow: FloatArray  # (T, s) what changes within seconds: an integral's errors, a sensor's zero

    @property
    def picked(self) -> NDArray[np.intp]:
        """Rows that count, as many as the band has."""
        return np.flatnonzero(self.use)[:: self.step]

    def moved(self, time: float) -> Strip:
        """The strip with its effort taken so much later [s]: the channel was logged that late."""
        return replace(self, effort=shifted(self.effort, -time, self.period))

    def columns(self, delay: float = 0.0, lag: float = 0.0) -> FloatArray:
        """The law's parts for commands that come late and an effort that lags, (T, 11)."""
        late = self.commanded_late(delay)
        error, speed = late.error, late.speed_error
        parts = [error, late.column("integral"), speed, late.dq_des, self.gravity, late.inertia]
        parts += [self.mass * error, self.mass * speed, *self.others.T, late.rate]
        every = np.stack(parts, axis=1)
        return lagged(every, lag, self.period) if lag > 0.0 else every

    def less_slow(self, delay: float, lag: float) -> tuple[FloatArray, FloatArray]:
        """Columns (N, 11) and efforts (N,) of picked rows, less what changes slowly."""
        at = self.picked
        base, _ = np.linalg.qr(self.slow[at])
        columns, effort = self.columns(delay, lag)[at], self.effort[at]
        return columns - base @ (base.T @ columns), effort - base @ (base.T @ effort)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gained:
    """Squares that something takes from what a law leaves, block by block, (B,)."""

    by: FloatArray
    of: FloatArray  # that were left without it

    @property
    def share(self) -> float:
        """The share taken; 0 where nothing was left."""
        return float(self.by.sum()) / max(float(self.of.sum()), 1e-300)

    def evidence(self, channels: tuple[str, ...]) -> Evidence:
        """Evidence by recordings that nothing was learnt from."""
        return replace(share_by_blocks(self.by, self.of, _SEED), channels=channels)

    def support(self, strips: Sequence[Strip], log_odds: float) -> Support:
        """Support by the strips that it was learnt from."""
        used = self.by[self.of > 0.0]
        error = float(np.std(used) * np.sqrt(len(used)))
        each = [self.by[np.unique(strip.block[strip.use])].sum() for strip in strips]
        return Support(
            weight=self.share,
            gain=self.share,
            t=float(self.by.sum()) / max(error, 1e-300),
            size=float(np.sqrt(self.share / max(1.0 - self.share, 1e-3))),
            agree=sum(bool(gained > 0.0) for gained in each),
            sessions=len(strips),
            blocks=len(used),
            left=1.0,
            rivals=1,
            log_odds=log_odds,
        )


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
    count = len(piece.q)
    turns = int(2.0 * limits.slow * count * piece.period) + 1
    phase = np.pi * (np.arange(count) + 0.5) / count
    reach = int(_REACH / (cutoff * piece.period))
    use = ~dilated(~piece.use, reach)
    use[:reach] = use[count - reach :] = False
    whole = {each.name: getattr(piece, each.name) for each in fields(Piece)}
    smooth = {
        name: zero_phase(values, cutoff, piece.period)
        for name, values in whole.items()
        if name not in ("name", "period", "use")
    }
    return Strip(
        **{**whole, **smooth, "use": use},
        block=first + (np.arange(count) * piece.period / limits.law_block).astype(np.intp),
        step=max(1, int(1.0 / (_PER_CUTOFF * cutoff * piece.period))),
        slow=np.cos(phase[:, None] * np.arange(turns + 1)),
    )


def law_of(strips: Sequence[Strip], delay: float = 0.0, lag: float = 0.0) -> LinearModel:
    """The best law of commands so late and an effort that so lags, with what changes slowly."""
    pairs = [strip.less_slow(delay, lag) for strip in strips]
    return LinearModel(
        target=np.concatenate([effort for _, effort in pairs]),
        parameters=(Parameter(name="law", columns=_with_own_rates([c for c, _ in pairs])),),
        parts=parts_of([len(effort) for _, effort in pairs]),
    )


def blocks_of(strips: Sequence[Strip]) -> NDArray[np.intp]:
    """Block of each row that is picked, (N,)."""
    return np.concatenate([strip.block[strip.picked] for strip in strips])


def gained(strips: Sequence[Strip], before: FloatArray, after: FloatArray) -> Gained:
    """The gain, by what is left of the picked rows before and after, (N,) each."""
    block = blocks_of(strips)
    return Gained(
        by=np.bincount(block, before**2 - after**2).astype(np.float64),
        of=np.bincount(block, before**2).astype(np.float64),
    )


def followed(
    strips: Sequence[Strip], judges: Sequence[Strip], delay: float = 0.0, lag: float = 0.0
) -> float:
    """Share of the effort of other recordings that the law of these explains; below 0: none."""
    left, whole = _missed(strips, judges, delay, lag)
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
    strips: Sequence[Strip], judges: Sequence[Strip], delay: float, lag: float
) -> tuple[float, float]:
    """Squares of other recordings' effort that the law of these leaves, and all of them."""
    beta = law_of(strips, delay, lag).of("law")
    law = np.append(beta[:_COMMON], beta[_COMMON:].mean())
    left = whole = 0.0
    for columns, effort in (strip.less_slow(delay, lag) for strip in judges):
        left += float(np.sum((effort - columns @ law) ** 2))
        whole += float(np.sum(effort**2))
    return left, whole


def _with_own_rates(parts: Sequence[FloatArray]) -> FloatArray:
    """Rows of all recordings: what a drive makes of a command's rate differs between them."""
    rates = linalg.block_diag(*(columns[:, _COMMON:] for columns in parts))
    return np.hstack([np.concatenate([columns[:, :_COMMON] for columns in parts]), rates])


def explicit(strips: Sequence[Strip]) -> FloatArray:
    """Columns (N, p) of the picked rows, what changes slowly among them."""
    rows = _with_own_rates([strip.columns()[strip.picked] for strip in strips])
    return np.hstack([rows, linalg.block_diag(*(s.slow[s.picked] for s in strips))])
