"""Least squares of many terms over all balances at once, and cross-validated."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, optimize

from ..effects import CATALOGUE, Effect
from ..motion.balances import Balances
from ..motion.place import Key, Place, Shape
from ..study.recording import FloatArray
from .design import Design
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

    def __init__(self, balances: Balances, terms: Sequence[Term], base: Fit | None = None) -> None:
        """Fits at once. With a base, `terms` are added to the base's and its sums are used."""
        self.balances = balances
        self.terms: tuple[Term, ...] = (*(base.terms if base else ()), *terms)
        widths = [0 if t.fixed else t.width for t in self.terms]
        self.offsets = np.concatenate([[0], np.cumsum(widths)]).astype(np.intp)
        self.size = int(self.offsets[-1])
        self.prior = np.concatenate([np.zeros(0)] + [t.prior for t in self.terms if not t.fixed])
        self.folds = int(balances.fold.max()) + 1
        # By key, on the rows that count and by sigma; what a base has of other keys is its own.
        self.rows: dict[Key, Index] = dict(base.rows) if base else {}
        self.target: dict[Key, FloatArray] = dict(base.target) if base else {}
        self.design: dict[Key, Design] = dict(base.design) if base else {}
        self.index: dict[Key, Index] = dict(base.index) if base else {}  # of the columns
        self.spans: dict[Key, Spans] = base.spans if base else {}
        self.fold_gram = np.zeros((self.folds, self.size, self.size))
        self.fold_moment = np.zeros((self.folds, self.size))
        if base is not None:
            self.fold_gram[:, : base.size, : base.size] = base.fold_gram
            self.fold_moment[:, : base.size] = base.fold_moment
        else:
            for key in balances.keys:
                self._begin(key)
        for key in balances.keys:
            if any(key in term.columns for term in terms):
                self._assemble(key, terms)
        self._finish()

    def _finish(self) -> None:
        """The sums of all folds, and their coefficients."""
        self.gram = self.fold_gram.sum(axis=0)
        self.moment = self.fold_moment.sum(axis=0)
        self.beta = self.solve(self.gram, self.moment)
        self._bounded: FloatArray | None = None

    def _begin(self, key: Key) -> None:
        b = self.balances
        rows = np.flatnonzero(b.mask[key])
        self.rows[key], self.spans[key] = rows, _spans(b.fold[rows])
        self.target[key] = b.residual[key][rows] / b.sigma[key]
        self.index[key], self.design[key] = np.zeros(0, dtype=np.intp), Design(len(rows))

    def _assemble(self, key: Key, added: Sequence[Term]) -> None:
        rows, scale = self.rows[key], 1.0 / self.balances.sigma[key]
        old, old_index, before = self.design[key], self.index[key], self.target[key]
        first = len(self.terms) - len(added)
        target = before
        parts: list[FloatArray] = []
        index: list[int] = []
        for term, offset in zip(added, self.offsets[first:], strict=False):
            if key not in term.columns:
                continue
            column = term.columns[key][rows] * scale
            if term.fixed:
                target = target - column[:, 0]
            else:
                parts.append(column)
                index.extend(range(offset, offset + term.width))
        self.target[key] = target
        if target is not before and len(old_index):
            for f, span in self.spans[key]:
                self.fold_moment[f, old_index] += old.at(span).against(target[span] - before[span])
        if not parts:
            return
        new, new_index = np.hstack(parts), np.array(index, dtype=np.intp)
        self.index[key] = np.concatenate([old_index, new_index])
        self.design[key] = old.beside(new)
        for f, span in self.spans[key]:
            part = new[span]
            if len(old_index):
                cross = old.at(span).against(part)
                self.fold_gram[f][np.ix_(old_index, new_index)] += cross
                self.fold_gram[f][np.ix_(new_index, old_index)] += cross.T
            self.fold_gram[f][np.ix_(new_index, new_index)] += part.T @ part
            self.fold_moment[f, new_index] += part.T @ target[span]

    def extended(self, *terms: Term) -> Fit:
        """The fit with more terms."""
        return Fit(self.balances, terms, self)

    def without(self, *terms: Term) -> Fit:
        """The fit without some of its terms, by the same sums."""
        other = copy(self)
        gone = np.array([any(t is each for each in terms) for t in self.terms], dtype=np.bool_)
        widths = np.array([0 if t.fixed else t.width for t in self.terms], dtype=np.intp)
        kept = ~np.repeat(gone, widths)
        other.terms = tuple(t for t, out in zip(self.terms, gone, strict=True) if not out)
        other.offsets = np.concatenate([[0], np.cumsum(widths[~gone])]).astype(np.intp)
        other.size = int(other.offsets[-1])
        other.prior = self.prior[kept]
        place = np.cumsum(kept) - 1
        other.design, other.target, other.index = {}, dict(self.target), {}
        for key, index in self.index.items():
            stays = kept[index]
            whole = bool(stays.all())
            other.index[key] = place[index if whole else index[stays]]
            other.design[key] = self.design[key] if whole else self.design[key].kept(stays)
        other.fold_gram = self.fold_gram[:, kept][:, :, kept]
        other.fold_moment = self.fold_moment[:, kept]
        for term, out in zip(self.terms, gone, strict=True):
            if out and term.fixed:
                other._put_back(term)
        other._finish()
        return other

    def _put_back(self, term: Term) -> None:
        """A fixed term's column into the targets again."""
        for key in term.columns.keys() & self.design.keys():
            column = term.columns[key][self.rows[key], 0] / self.balances.sigma[key]
            self.target[key] = self.target[key] + column
            for f, span in self.spans[key]:
                part = self.design[key].at(span)
                self.fold_moment[f, self.index[key]] += part.against(column[span])

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
        for term, offset in zip(self.terms, self.offsets, strict=False):
            if not term.fixed and term.effect in CATALOGUE:
                span = slice(offset, offset + term.width)
                low, high = CATALOGUE[term.effect].bounds
                lower[span], upper[span] = low[: term.width], high[: term.width]
        regular, beta = self.regular(self.gram), self.beta
        if (beta < lower).any() or (beta > upper).any():
            factor = linalg.cholesky(regular)
            right = linalg.solve_triangular(factor, self.moment, trans="T")
            beta = np.asarray(optimize.lsq_linear(factor, right, (lower, upper)).x)
        bodies = [
            (slice(int(offset), int(offset) + term.width), term.beneath)
            for term, offset in zip(self.terms, self.offsets, strict=False)
            if term.beneath is not None
        ]
        return with_real_bodies(beta, regular, bodies) if bodies else beta

    def constrained(self) -> Fit:
        """The same with its coefficients bounded: what is claimed, and judged."""
        other = copy(self)
        other.beta = self.bounded()
        return other

    @property
    def weighted(self) -> Weighted:
        """Its terms with their coefficients."""
        return [
            (term, np.ones(1) if term.fixed else self.beta[offset : offset + term.width])
            for term, offset in zip(self.terms, self.offsets, strict=False)
        ]

    def residual(self, key: Key, beta: FloatArray | None = None) -> FloatArray:
        """What is left on the rows that count, in sigmas."""
        beta = self.beta if beta is None else beta
        return np.asarray(self.target[key] - self.design[key] @ beta[self.index[key]])

    def cost(self) -> float:
        """Sum of squares and penalty."""
        left = sum(float(np.sum(self.residual(key) ** 2)) for key in self.design)
        return left + float(np.sum(self.prior * self.beta**2))

    def held_out(self) -> dict[Key, FloatArray]:
        """Residuals in sigmas of rows that their fit did not see."""
        betas = self.fold_betas()
        result = {}
        for key, design in self.design.items():
            left, index = self.target[key].copy(), self.index[key]
            if len(index):
                for f, span in self.spans[key]:
                    left[span] -= design.at(span) @ betas[f][index]
            result[key] = left
        return result

    def fold_betas(self) -> list[FloatArray]:
        """Coefficients fitted without each fold."""
        pairs = zip(self.fold_gram, self.fold_moment, strict=True)
        return [self.solve(self.gram - g, self.moment - m) for g, m in pairs]
