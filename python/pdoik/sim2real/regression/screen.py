"""Which candidates would lower a fit's cost most, by sums that are made once for each two terms.

A search looks at hundreds of candidates again after every step. What changes then are coefficients:
the sums of two terms' columns stay, and all that is asked follows from these.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from weakref import WeakKeyDictionary

import numpy as np
from scipy import linalg

from ..effects import CATALOGUE
from ..motion.balances import Balances
from ..motion.place import Key
from ..study.recording import FloatArray
from .fit import Fit, Term, TermKey

_Beside = WeakKeyDictionary[Term, FloatArray]


class _Sums:
    """Of terms' columns over the rows that count, weighted."""

    def __init__(self, balances: Balances) -> None:
        self._residual = balances.residual
        self._weight = {key: balances.mask[key] / balances.sigma[key] ** 2 for key in balances.keys}
        self._own: WeakKeyDictionary[Term, tuple[FloatArray, FloatArray]] = WeakKeyDictionary()
        self._beside: WeakKeyDictionary[Term, _Beside] = WeakKeyDictionary()

    def own(self, term: Term) -> tuple[FloatArray, FloatArray]:
        """Its columns times what was measured (w,), and times themselves (w, w)."""
        if term not in self._own:
            moment, gram = np.zeros(term.width), np.zeros((term.width, term.width))
            for key, column in self._there(term):
                weighted = column * self._weight[key][:, None]
                moment += weighted.T @ self._residual[key]
                gram += weighted.T @ column
            self._own[term] = moment, gram
        return self._own[term]

    def beside(self, ones: Sequence[Term], others: Sequence[Term]) -> list[FloatArray]:
        """The columns of each of some terms times those of all others, (w, all of theirs)."""
        known = [self._beside.setdefault(one, WeakKeyDictionary()) for one in ones]
        fresh: dict[tuple[int, ...], list[Term]] = {}
        for other in others:
            without = tuple(i for i, each in enumerate(known) if other not in each)
            fresh.setdefault(without, []).append(other)
        for without, some in fresh.items():
            self._add([ones[i] for i in without], some)
        return [np.hstack([each[other] for other in others]) for each in known]

    def _add(self, ones: Sequence[Term], others: Sequence[Term]) -> None:
        """Sums that are not there yet, in one pass over the others' columns."""
        ends = np.cumsum([0, *(one.width for one in ones)])
        spans = [slice(a, b) for a, b in pairwise(ends.tolist())]
        found = [np.zeros((ends[-1], other.width)) for other in others]
        for key, weight in self._weight.items():
            there = [
                (one, span) for one, span in zip(ones, spans, strict=True) if key in one.columns
            ]
            if not there:
                continue
            rows = np.concatenate([np.arange(span.start, span.stop) for _, span in there])
            stacked = np.vstack([(one.columns[key] * weight[:, None]).T for one, _ in there])
            for total, other in zip(found, others, strict=True):
                if key in other.columns:
                    total[rows] += stacked @ other.columns[key]
        for one, span in zip(ones, spans, strict=True):
            self._beside[one].update(
                (other, total[span]) for other, total in zip(others, found, strict=True)
            )

    def _there(self, term: Term) -> list[tuple[Key, FloatArray]]:
        return [(key, column) for key, column in term.columns.items() if key in self._weight]


_SUMS: WeakKeyDictionary[Balances, _Sums] = WeakKeyDictionary()


def screen(fit: Fit, terms: Sequence[Term]) -> list[tuple[Term, float]]:
    """Admissible candidates by training gain, the best shape of each effect and place."""
    best: dict[TermKey, tuple[Term, float]] = {}
    least = fit.balances.thresholds.search.least_training_gain
    for term, gain in zip(terms, _training_gains(fit, terms), strict=True):
        if gain > least and (term.key not in best or gain > best[term.key][1]):
            best[term.key] = (term, gain)
    return sorted(best.values(), key=lambda each: -each[1])


def _training_gains(fit: Fit, terms: Sequence[Term]) -> list[float]:
    """Decrease of the cost where each term is added and all else refitted; -1 if inadmissible."""
    if not terms:
        return []
    if fit.balances not in _SUMS:
        _SUMS[fit.balances] = _Sums(fit.balances)
    sums = _SUMS[fit.balances]
    ends = np.cumsum([0, *(term.width for term in terms)])
    own = [sums.own(term) for term in terms]
    moment, cross = np.concatenate([each for each, _ in own]), np.zeros((fit.size, ends[-1]))
    every = sums.beside(fit.terms, terms)
    for (term, beta), offset, beside in zip(fit.weighted, fit.offsets, every, strict=False):
        moment -= beta @ beside
        if not term.fixed:
            cross[offset : offset + term.width] = beside
    taken = linalg.cho_solve(linalg.cho_factor(fit.regular(fit.gram)), cross) if fit.size else cross
    spans = [slice(a, b) for a, b in pairwise(ends.tolist())]
    return [
        _training_gain(term, moment[span], gram, cross[:, span].T @ taken[:, span])
        for term, (_, gram), span in zip(terms, own, spans, strict=True)
    ]


def _training_gain(term: Term, moment: FloatArray, gram: FloatArray, taken: FloatArray) -> float:
    """By a term's moment and Gram matrix, and what of this the fit's own terms take."""
    if not np.diag(gram).max() > 0.0:
        return -1.0
    reduced = gram + np.diag(term.prior + 1e-9 * np.diag(gram).max()) - taken
    if term.fixed:
        return float(2 * moment[0] - reduced[0, 0])
    values, vectors = np.linalg.eigh(reduced)
    keep = values > 1e-8 * np.diag(gram).max()
    along = vectors[:, keep].T @ moment
    beta = vectors[:, keep] @ (along / values[keep])
    effect = CATALOGUE[term.effect]
    if not effect.admissible(beta):
        beta = np.clip(beta, *[bound[: len(beta)] for bound in effect.bounds])
        if not effect.admissible(beta):
            return -1.0
        return float(2 * beta @ moment - beta @ reduced @ beta)
    return float(along @ (along / values[keep]))
