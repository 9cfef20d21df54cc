"""A stream of rows as overlapping windows, each a recording that filters can work on.

Where windows begin depends on the rows alone, never on the pieces they come in.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import GAP, FloatArray, Recording, glitches, on_grid, uniform_grid

from ..motion import thinned

NAME = "watched"
"""Every window's name as a recording."""

_FIRST = 50  # numerics: rows from which a stream's rate is known
_FILTERED = 2.0  # periods of the cut-off by which a window reaches beyond its core
_CORE = 0.5  # shortest core [s]
_LOWEST = 0.4  # numerics: highest cut-off as a share of the rate, as in `predict`
_OTHER_RATE = 1.5  # numerics: factor from which a stream's rate is another one


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rows:
    """Rows of a log: strictly rising times, no missing values."""

    time: FloatArray  # (R,) of the log's own clock [s]
    q: FloatArray  # (R, n)
    tau: FloatArray  # (R, n)

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)

    def __getitem__(self, part: slice) -> Rows:
        """Some of them."""
        return Rows(time=self.time[part], q=self.q[part], tau=self.tau[part])

    def followed_by(self, other: Rows) -> Rows:
        """These and then the others."""
        both = ((getattr(self, name), getattr(other, name)) for name in ("time", "q", "tau"))
        time, q, tau = (np.concatenate(pair) for pair in both)
        return Rows(time=time, q=q, tau=tau)

    def recording(self) -> Recording:
        """Recording on even times, without readings that jump, thinned as a diagnosis does it."""
        grid = uniform_grid(self.time - self.time[0])
        valid = np.ones(len(grid.time), dtype=np.bool_)
        q, tau = (np.empty((len(grid.time), self.q.shape[1])) for _ in range(2))
        for j in range(self.q.shape[1]):
            steady = np.where(glitches(self.q[:, j]), np.nan, self.q[:, j])
            q[:, j], backed = on_grid(grid, "q", steady)
            tau[:, j], _ = on_grid(grid, "tau", self.tau[:, j])
            valid &= backed
        made = Recording(
            name=NAME,
            role="validate",
            start=float(self.time[0]),
            time=grid.time,
            q=q,
            tau=tau,
            valid=valid,
            raw_period=grid.raw_period,
            jitter=grid.jitter,
        )
        return thinned(made)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Window:
    """Rows with what filters need around them."""

    rows: Rows
    core: tuple[float, float]  # from and before which times it speaks for [s]
    period: float  # of the stream [s]


class Windows:
    """Cuts one stream after another into windows."""

    def __init__(self, n: int, cutoff: float) -> None:
        """Cutter for n joints, for filters of this cut-off [Hz]."""
        self.cutoff = cutoff
        self._n = n
        self._rows = _none(n)
        self._period = 0.0
        self._every = self._pad = self._core = 0
        self.delay = _FILTERED / cutoff + max(_CORE, _FILTERED / cutoff)  # longest [s]

    def add(self, rows: Rows) -> Iterator[Window]:
        """Windows that are complete with these rows; a gap begins a new stream."""
        self._rows = self._rows.followed_by(rows)
        while self._has_rate():
            steps = np.diff(self._rows.time[: self._length + 1])
            gaps = np.flatnonzero(steps > GAP * self._period)
            if len(gaps):
                yield from self._rest(int(gaps[0]) + 1)
                continue
            if len(self._rows) < self._length:
                return
            if not 1 / _OTHER_RATE < float(np.median(steps)) / self._period < _OTHER_RATE:
                self._rows, self._period = self._rows[self._core :], 0.0
                continue
            window = self._rows[: self._length]
            core = window.time[self._pad], window.time[self._pad + self._core]
            yield Window(rows=window, core=(float(core[0]), float(core[1])), period=self._period)
            self._rows = self._rows[self._core :]

    def end(self) -> Iterator[Window]:
        """What is left of the stream; the next one may have another clock."""
        if self._has_rate():
            yield from self._rest(len(self._rows))
        self._rows, self._period = _none(self._n), 0.0

    @property
    def _length(self) -> int:
        return 2 * self._pad + self._core

    def _has_rate(self) -> bool:
        """Whether the stream's rate is known; it is looked at where it begins.

        Raises:
            ValueError: it is too low for the filter.
        """
        if self._period:
            return True
        time = self._rows.time
        if len(time) < _FIRST:
            return False
        steps = np.diff(time[:_FIRST])
        period = float(np.median(steps))
        if self.cutoff > _LOWEST / period:
            raise ValueError(
                f"the log has {1 / period:.4g} rows a second, expected at least"
                f" {self.cutoff / _LOWEST:.4g}: the model's filter passes {self.cutoff:.3g} Hz"
            )
        self._period = period
        self._every = max(1, int(1.0 / (period * 200.0)))
        self._pad = _multiple(_FILTERED / (self.cutoff * period), self._every)
        step = self._every * kept_every(self.cutoff, self._every * period)
        self._core = _multiple(max(_CORE, _FILTERED / self.cutoff) / period, step)
        return True

    def _rest(self, count: int) -> Iterator[Window]:
        """The last, shorter window of a stream of which `count` rows are left."""
        rows = self._rows[:count]
        if count > 2 * self._pad + self._every:
            core = float(rows.time[self._pad]), float(rows.time[count - self._pad])
            yield Window(rows=rows, core=core, period=self._period)
        self._rows, self._period = self._rows[count:], 0.0


def kept_every(cutoff: float, period: float) -> int:
    """Each how many-th filtered sample is kept, as in the balances."""
    return max(1, int(1.0 / (3.0 * cutoff * period) * (1.0 + 1e-6)))


def _multiple(count: float, of: int) -> int:
    return int(np.ceil(count / of)) * of


def _none(n: int) -> Rows:
    return Rows(time=np.empty(0), q=np.empty((0, n)), tau=np.empty((0, n)))
