"""Rows of a study and their sums: all that models of it are fitted and compared by.

Rows come from balances: a target, columns per unit of each coefficient, and the noise that nobody
can expect to explain. Sums are kept per balance and not weighted, so that another noise costs
nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..motion import Balances, Key
from ..regression import Term, repeats

_ROOM = 64  # columns that are taken at once

Index = NDArray[np.intp]


@dataclass(kw_only=True, eq=False)
class Series:
    """One balance: its rows that count, and the columns of all terms that were ever added."""

    rows: Index  # among all rows of the study
    target: FloatArray  # (N,)
    floor: float  # standard deviation of noise that no cause explains
    parts: tuple[slice, ...]  # of one recording each
    least_repeats: float = 1.0  # rows that say the same, as they are filtered
    independent: float = 0.0  # rows that say something new; all but `least_repeats` at first
    width: int = 0
    columns: FloatArray = field(init=False)  # (N, room), the first `width` of them are there
    gram: FloatArray = field(init=False)  # (room, room)
    moment: FloatArray = field(init=False)  # (room,)
    square: float = field(init=False)

    def __post_init__(self) -> None:
        count = len(self.rows)
        self.independent = self.independent or count / self.least_repeats
        self.columns = np.empty((count, _ROOM), order="F")
        self.gram, self.moment = np.zeros((_ROOM, _ROOM)), np.zeros(_ROOM)
        self.square = float(self.target @ self.target)

    def add(self, column: FloatArray) -> slice:
        """More columns, (N, k); which they are."""
        first, last = self.width, self.width + column.shape[1]
        while last > self.columns.shape[1]:
            self._grow()
        span = slice(first, last)
        self.columns[:, span] = column
        self.width = last
        cross = self.columns[:, :last].T @ column
        self.gram[:last, span] = cross
        self.gram[span, :last] = cross.T
        self.moment[span] = column.T @ self.target
        return span

    def _grow(self) -> None:
        room = 2 * self.columns.shape[1]
        columns = np.empty((len(self.rows), room), order="F")
        columns[:, : self.width] = self.columns[:, : self.width]
        gram, moment = np.zeros((room, room)), np.zeros(room)
        gram[: self.width, : self.width] = self.gram[: self.width, : self.width]
        moment[: self.width] = self.moment[: self.width]
        self.columns, self.gram, self.moment = columns, gram, moment

    def repeats(self, left: FloatArray) -> float:
        """Rows that say the same, by what is left."""
        return max(repeats(left[part] for part in self.parts), self.least_repeats)


class Linearisation:
    """The series of a study, and where terms stand in them."""

    def __init__(self, series: Mapping[Key, Series]) -> None:
        self.series = dict(series)
        self._spans: dict[int, dict[Key, slice]] = {}
        self._kept: list[Term] = []  # so that no other term gets the id of one

    @classmethod
    def of_balances(cls, balances: Balances) -> Linearisation:
        """The linearisation of all balances that have rows which count."""
        series = {}
        for key in balances.keys:
            rows = np.flatnonzero(balances.mask[key])
            if not len(rows):
                continue
            ends = np.searchsorted(rows, balances.starts)
            parts = tuple(slice(int(a), int(b)) for a, b in pairwise(ends))
            series[key] = Series(
                rows=rows,
                target=balances.residual[key][rows],
                floor=balances.sigma[key],
                parts=parts,
                least_repeats=balances.thresholds.priors.least_repeats,
            )
        return cls(series)

    def spans(self, term: Term) -> Mapping[Key, slice]:
        """Where a term's columns are, which are added if they are not there yet."""
        name = id(term.columns)  # the same for other priors
        if name not in self._spans:
            self._kept.append(term)
            self._spans[name] = {
                key: self.series[key].add(column[self.series[key].rows])
                for key, column in term.columns.items()
                if key in self.series
            }
        return self._spans[name]

    def acts(self, term: Term) -> bool:
        """Whether a term changes any row that counts."""
        return any(
            key in self.series and np.any(column[self.series[key].rows])
            for key, column in term.columns.items()
        )
