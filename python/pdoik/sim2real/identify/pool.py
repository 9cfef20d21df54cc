"""All candidates of a study, and what each would be worth added to a model: all at once.

In closed form at the model's noise, everything else refitted (Schur's complement). What is worth
most there is then compared at the noise that it leaves itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import Key
from .hypothesis import Hypothesis
from .identified import Weighed
from .linearisation import Linearisation
from .model import Model

_AT_ONCE = 64  # columns that are taken together


@dataclass(frozen=True, slots=True)
class Scored:
    """A hypothesis and its log odds: added to a model, or in the place of a cause."""

    hypothesis: Hypothesis
    log_odds: float

    @property
    def weighed(self) -> Weighed:
        """The same for the next stages."""
        return Weighed(term=self.hypothesis.term, log_odds=self.log_odds)


@dataclass(kw_only=True, eq=False)
class _Of:
    """Columns at one balance, rounded: sums are exact, of columns that are a little others."""

    columns: NDArray[np.float32]  # (N, w)
    index: NDArray[np.intp]  # (w,) of the pool's coefficients
    moment: FloatArray  # (w,)
    cross: FloatArray  # (columns of the series, w)
    known: NDArray[np.bool_]  # (columns of the series,) which of these were asked for


class Pool:
    """Candidates whose columns and sums are made once."""

    def __init__(self, data: Linearisation, candidates: Sequence[Hypothesis]) -> None:
        self.data = data
        self.candidates = [each for each in candidates if data.acts(each.term)]
        ends = np.cumsum([0, *(each.width for each in self.candidates)])
        self._spans = [slice(int(a), int(b)) for a, b in pairwise(ends)]
        self._size = int(ends[-1])
        self._of: dict[Key, _Of] = {}
        self._own: list[dict[Key, FloatArray]] = [{} for _ in self.candidates]
        for key, series in data.series.items():
            parts: list[NDArray[np.float32]] = []
            index, moments = [], []
            for number, (each, span) in enumerate(zip(self.candidates, self._spans, strict=True)):
                if key in each.term.columns:
                    rounded = each.term.columns[key][series.rows].astype(np.float32)
                    part = rounded.astype(np.float64)
                    parts.append(rounded)
                    moments.append(part.T @ series.target)
                    index.append(np.arange(span.start, span.stop))
                    self._own[number][key] = part.T @ part
            if parts:
                columns = np.hstack(parts)
                self._of[key] = _Of(
                    columns=columns,
                    index=np.concatenate(index),
                    moment=np.concatenate(moments),
                    cross=np.zeros((0, columns.shape[1])),
                    known=np.zeros(0, dtype=np.bool_),
                )

    def scored(self, model: Model) -> list[Scored]:
        """Every candidate added to a model, the likeliest first; what cannot be is left out."""
        if not self.candidates:
            return []
        moment, cross = np.zeros(self._size), np.zeros((model.size, self._size))
        for key, of in self._of.items():
            own, there = model.index[key]
            weight = model.weight(key)
            moment[of.index] += weight * of.moment
            if len(own):
                here = weight * self._cross(key, there)
                cross[np.ix_(own, of.index)] += here
                moment[of.index] -= model.beta[own] @ here
        at = np.flatnonzero(model.active)
        taken = np.zeros_like(cross[at])
        if len(at):
            taken = linalg.solve_triangular(
                model._factor, model._scale[:, None] * cross[at], lower=True, check_finite=False
            )
        found = []
        for number, (each, span) in enumerate(zip(self.candidates, self._spans, strict=True)):
            gram = np.zeros((each.width, each.width))
            for key, own_gram in self._own[number].items():
                gram += model.weight(key) * own_gram
            part = taken[:, span]
            odds = log_bayes(each, moment[span], gram - part.T @ part)
            if np.isfinite(odds):
                found.append(Scored(each, odds + each.log_odds))
        return sorted(found, key=lambda scored: -scored.log_odds)

    def _cross(self, key: Key, there: NDArray[np.intp]) -> FloatArray:
        """Products of some of the series' columns with the pool's, each worked out once."""
        series, of = self.data.series[key], self._of[key]
        more = series.width - len(of.known)
        if more > 0:
            of.cross = np.vstack([of.cross, np.empty((more, of.columns.shape[1]))])
            of.known = np.concatenate([of.known, np.zeros(more, dtype=np.bool_)])
        new = there[~of.known[there]]
        if len(new):
            columns = series.columns[:, new].T
            for k in range(0, of.columns.shape[1], _AT_ONCE):
                part = of.columns[:, k : k + _AT_ONCE].astype(np.float64)
                of.cross[new, k : k + _AT_ONCE] = columns @ part
            of.known[new] = True
        return of.cross[there]


def log_bayes(each: Hypothesis, moment: FloatArray, gram: FloatArray) -> float:
    """Log Bayes factor of one hypothesis more.

    Args:
        each: the hypothesis.
        moment: (k,) of its weighted columns with what is left.
        gram: (k, k) of its columns, less what others take of them.
    """
    prior = each.precision
    whole = gram + np.diag(prior)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(whole), 1e-300))
    even = whole * np.outer(scale, scale) + 1e-10 * np.eye(len(prior))
    try:
        lower = np.linalg.cholesky(even)
    except np.linalg.LinAlgError:
        return -np.inf
    right = moment + prior * each.mean
    half = np.linalg.solve(lower, scale * right)
    beta = scale * np.linalg.solve(lower.T, half)
    if each.positive and (beta < 0.0).any():
        return 0.0  # it would rest on its bound, and change nothing
    if each.term.fixed:  # its shape may yet move
        low, high = CATALOGUE[each.term.effect].reach
        if not low < beta[0] < high:
            return -np.inf
    elif not each.admissible(beta):
        return -np.inf
    gain = 0.5 * float(half @ half) - 0.5 * float(np.sum(prior * each.mean**2))
    occam = float(np.sum(np.log(np.diag(lower)) - np.log(scale))) - 0.5 * float(
        np.sum(np.log(prior))
    )
    return gain - occam
