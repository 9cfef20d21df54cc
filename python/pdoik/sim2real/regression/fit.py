"""Least squares of many terms over all balances at once, and cross-validated."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, optimize

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE, Effect
from ..motion import Balances, Key, Place, Shape
from .real_bodies import with_real_bodies

_RIDGE = 1e-9  # relative to the largest diagonal entry
TRACE = 1e-11  # of ridge, where columns are scaled to one


TermKey = tuple[str, Place]
Weighted = list[tuple["Term", FloatArray]]
"""Terms with their coefficients, 1 of a fixed one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Term:
    """One effect at one place: its columns in the balances."""

    effect: str
    place: Place
    shape: Shape
    columns: dict[Key, FloatArray]
    prior: FloatArray  # (k,) inverse variances of the coefficients
    beneath: FloatArray | None = None  # (10,) what a body's coefficients are added to

    @property
    def key(self) -> TermKey:
        """What it is and where: the same for other shapes, and on other recordings."""
        return self.effect, self.place

    @property
    def width(self) -> int:
        """Number of coefficients."""
        return len(self.prior)

    @property
    def fixed(self) -> bool:
        """Whether the one coefficient is 1 by its meaning."""
        return self.effect in CATALOGUE and CATALOGUE[self.effect].fixed


def term_of(balances: Balances, effect: Effect, place: Place, shape: Shape) -> Term | None:
    """The term of an effect; None where it changes nothing."""
    columns = balances.columns(effect, place, shape)
    if not columns:
        return None
    width = next(iter(columns.values())).shape[1]
    prior = effect.prior_at(balances.motions[0], place, width)
    return Term(
        effect=effect.id,
        place=place,
        shape=shape,
        columns=columns,
        prior=prior,
        beneath=effect.beneath(balances.motions[0], place),
    )


Index = NDArray[np.intp]
Spans = tuple[tuple[int, slice], ...]  # of neighbouring rows of the same fold


def _spans(fold: Index) -> Spans:
    if not len(fold):
        return ()
    ends = [0, *(np.flatnonzero(np.diff(fold)) + 1).tolist(), len(fold)]
    return tuple((int(fold[a]), slice(a, b)) for a, b in pairwise(ends))


class Fit:
    """Terms fitted to balances by weighted least squares.

    Minimises sum of ((y - A beta) / sigma)^2 + beta' P beta over the rows that count. Terms whose
    coefficient is fixed are subtracted before.
    """

    def __init__(self, balances: Balances, terms: Sequence[Term]) -> None:
        """Fits at once."""
        self.balances = balances
        self.terms: tuple[Term, ...] = ()
        self.folds = int(balances.fold.max()) + 1
        self.fold_gram = np.zeros((self.folds, 0, 0))
        self.fold_moment = np.zeros((self.folds, 0))
        # By key, on the rows that count and by sigma.
        self.rows: dict[Key, Index] = {k: np.flatnonzero(balances.mask[k]) for k in balances.keys}
        self.spans = {key: _spans(balances.fold[rows]) for key, rows in self.rows.items()}
        self.target: dict[Key, FloatArray] = {
            key: balances.residual[key][rows] / balances.sigma[key]
            for key, rows in self.rows.items()
        }
        self.design: dict[Key, FloatArray] = {
            k: np.zeros((len(r), 0)) for k, r in self.rows.items()
        }
        self.index: dict[Key, Index] = {
            key: np.zeros(0, np.intp) for key in self.rows
        }  # of columns
        self._add(terms)

    def extended(self, *terms: Term) -> Fit:
        """The fit with more terms, by the same sums."""
        other = self._copy()
        other._add(terms)
        return other

    def without(self, *terms: Term) -> Fit:
        """The fit without some of its terms, by the same sums."""
        other = self._copy()
        gone = np.array([any(t is each for each in terms) for t in self.terms], dtype=np.bool_)
        kept = ~np.repeat(gone, np.diff(self.offsets))
        place = np.cumsum(kept) - 1
        for key, index in self.index.items():
            stays = kept[index]
            other.index[key] = place[index[stays]]
            if not stays.all():
                other.design[key] = self.design[key][:, stays]
        other.fold_gram = self.fold_gram[:, kept][:, :, kept]
        other.fold_moment = self.fold_moment[:, kept]
        for term, out in zip(self.terms, gone, strict=True):
            if out and term.fixed:
                for key, column in other._columns(term):
                    other._shift(key, column[:, 0])
        other._of(t for t, out in zip(self.terms, gone, strict=True) if not out)
        return other

    def _copy(self) -> Fit:
        other = copy(self)
        other.target, other.design = dict(self.target), dict(self.design)
        other.index, other.fold_moment = dict(self.index), self.fold_moment.copy()
        return other

    def _add(self, terms: Sequence[Term]) -> None:
        """Add terms to those that are there."""
        first = len(self.terms)
        before, moment = self.fold_gram, self.fold_moment
        size = moment.shape[1] + sum(0 if t.fixed else t.width for t in terms)
        self.fold_gram = np.zeros((self.folds, size, size))
        self.fold_moment = np.zeros((self.folds, size))
        self.fold_gram[:, : before.shape[1], : before.shape[1]] = before
        self.fold_moment[:, : moment.shape[1]] = moment
        parts: dict[Key, list[FloatArray]] = {}
        index: dict[Key, list[Index]] = {}
        at = moment.shape[1]
        for term in terms:
            for key, column in self._columns(term):
                if term.fixed:
                    self._shift(key, -column[:, 0])
                else:
                    parts.setdefault(key, []).append(column)
                    index.setdefault(key, []).append(np.arange(at, at + term.width))
            at += 0 if term.fixed else term.width
        for key, columns in parts.items():
            self._append(key, np.hstack(columns), np.concatenate(index[key]))
        self._of((*self.terms[:first], *terms))

    def _append(self, key: Key, new: FloatArray, at: Index) -> None:
        """Append columns (N, k) to a balance, and their sums."""
        old, there = self.design[key], self.index[key]
        for f, span in self.spans[key]:
            part = new[span]
            if len(there):
                cross = old[span].T @ part
                self.fold_gram[f][np.ix_(there, at)] += cross
                self.fold_gram[f][np.ix_(at, there)] += cross.T
            self.fold_gram[f][np.ix_(at, at)] += part.T @ part
            self.fold_moment[f, at] += part.T @ self.target[key][span]
        self.design[key] = np.hstack([old, new]) if len(there) else new
        self.index[key] = np.concatenate([there, at])

    def _columns(self, term: Term) -> Iterator[tuple[Key, FloatArray]]:
        """A term's columns on the rows that count, in sigmas."""
        for key, column in term.columns.items():
            if key in self.rows:
                yield key, column[self.rows[key]] * (1.0 / self.balances.sigma[key])

    def _shift(self, key: Key, by: FloatArray) -> None:
        """Add to a balance's target."""
        self.target[key] = self.target[key] + by
        for f, span in self.spans[key]:
            self.fold_moment[f, self.index[key]] += self.design[key][span].T @ by[span]

    def _of(self, terms: Iterable[Term]) -> None:
        """The sums are of these terms: their coefficients."""
        self.terms = tuple(terms)
        widths = [0 if t.fixed else t.width for t in self.terms]
        self.offsets = np.concatenate([[0], np.cumsum(widths)]).astype(np.intp)
        self.size = int(self.offsets[-1])
        self.prior = np.concatenate([np.zeros(0)] + [t.prior for t in self.terms if not t.fixed])
        self.gram = self.fold_gram.sum(axis=0)
        self.moment = self.fold_moment.sum(axis=0)
        self.beta = self.solve(self.gram, self.moment)
        self._bounded: FloatArray | None = None

    def span(self, term: Term) -> slice:
        """Where a term's coefficients are; nowhere if it is fixed."""
        at = next(i for i, each in enumerate(self.terms) if each is term)
        return slice(int(self.offsets[at]), int(self.offsets[at + 1]))

    def beta_of(self, term: Term) -> FloatArray:
        """Coefficients of one of its terms, 1 of a fixed one."""
        return np.ones(1) if term.fixed else self.beta[self.span(term)]

    def part(self, term: Term, key: Key) -> FloatArray:
        """What a term adds to a balance, on its rows that count."""
        return np.asarray(term.columns[key][self.rows[key]] @ self.beta_of(term))

    @property
    def weighted(self) -> Weighted:
        """The fit's terms with their coefficients."""
        return [(term, self.beta_of(term)) for term in self.terms]

    def solve(self, gram: FloatArray, moment: FloatArray) -> FloatArray:
        """Coefficients from normal equations; nothing is bounded here."""
        if not self.size:
            return np.zeros(0)
        scale, even = self.even(gram)
        try:
            factor = linalg.cho_factor(even, check_finite=False)
        except linalg.LinAlgError:
            return np.asarray(scale * np.linalg.lstsq(even, scale * moment, rcond=TRACE)[0])
        return np.asarray(scale * linalg.cho_solve(factor, scale * moment, check_finite=False))

    def even(self, gram: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Scales of the coefficients, (size,), and the normal matrix with columns scaled to one.

        Columns differ by many powers of ten.
        """
        regular = self.regular(gram)
        scale = 1.0 / np.sqrt(np.diag(regular))
        return scale, regular * np.outer(scale, scale) + TRACE * np.eye(self.size)

    def regular(self, gram: FloatArray) -> FloatArray:
        """Normal matrix with the prior and a trace of ridge."""
        ridge = _RIDGE * np.maximum(np.diag(gram), 1e-12) + 1e-12
        return gram + np.diag(self.prior + ridge)

    def bounded(self) -> FloatArray:
        """Coefficients within every effect's bounds, bodies real ones (SciPy's least squares)."""
        if self._bounded is None:
            self._bounded = self._within_bounds()
        return self._bounded.copy()

    def _within_bounds(self) -> FloatArray:
        if not self.size:
            return np.zeros(0)
        lower, upper = np.full(self.size, -np.inf), np.full(self.size, np.inf)
        for term in self.terms:
            if not term.fixed and term.effect in CATALOGUE:
                span, (low, high) = self.span(term), CATALOGUE[term.effect].bounds
                lower[span], upper[span] = low[: term.width], high[: term.width]
        regular, beta = self.regular(self.gram), self.beta
        if (beta < lower).any() or (beta > upper).any():
            factor = linalg.cholesky(regular)
            right = linalg.solve_triangular(factor, self.moment, trans="T")
            beta = np.asarray(optimize.lsq_linear(factor, right, (lower, upper)).x)
        bodies = [(self.span(t), t.beneath) for t in self.terms if t.beneath is not None]
        return with_real_bodies(beta, regular, bodies) if bodies else beta

    def constrained(self) -> Fit:
        """The same with its coefficients bounded: what is claimed, and judged."""
        other = copy(self)
        other.beta = self.bounded()
        return other

    def residual(self, key: Key) -> FloatArray:
        """What is left on the rows that count, in sigmas."""
        return np.asarray(self.target[key] - self.design[key] @ self.beta[self.index[key]])

    def cost(self) -> float:
        """Sum of squares and penalty."""
        left = sum(float(np.sum(self.residual(key) ** 2)) for key in self.design)
        return left + float(np.sum(self.prior * self.beta**2))

    def held_out(self) -> dict[Key, FloatArray]:
        """Residuals in sigmas of rows that their fit did not see."""
        sums = zip(self.fold_gram, self.fold_moment, strict=True)
        betas = [self.solve(self.gram - gram, self.moment - moment) for gram, moment in sums]
        result = {}
        for key, design in self.design.items():
            result[key] = self.target[key].copy()
            for f, span in self.spans[key]:
                result[key][span] -= design[span] @ betas[f][self.index[key]]
        return result
