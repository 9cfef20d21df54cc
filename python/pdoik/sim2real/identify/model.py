"""A set of hypotheses fitted together, the noise that they leave, and the evidence for them.

Coefficients are the likeliest under their priors (MacKay, Neural Computation 4(3), 1992). Noise is
what is left, balance by balance, with as few rows as are independent; its variance is integrated
out as the maximum of the evidence, so that a cause which explains most of what is left is worth the
logarithm of that, and not all of it once for every row.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import Key
from .hypothesis import Hypothesis
from .linearisation import Linearisation

_ROUNDS = 40  # at most, of coefficients and noise in turn
_SETTLED = 0.02  # numerics: relative change of a variance that is none
_LEAST_FREE = 0.25  # share of the independent rows that coefficients leave at least
_NO_PULL = 1e-9  # numerics: against a bound, of the largest there is
_ACTS = 0.0025  # numerics: of a part's largest square, from which it acts
_EXACT = 1e-7  # numerics: of a sum of squares, below which differences of sums are not used
_TRACE = 1e-11  # of ridge, where columns are scaled to one

LEAST_OWN = 0.5  # of a mean square, that is no noise of sensors, however small


_Sums = tuple[tuple[NDArray[np.intp], ...], FloatArray, NDArray[np.intp], FloatArray]
"""Of a balance: where its coefficients' products stand, these, where they stand, their moments."""


def unexplained(left: float, noise: float) -> float:
    """The part of the mean square `left` that is no noise of sensors."""
    return max(left - noise, LEAST_OWN * max(left, noise), 1e-300)


class Model:
    """Hypotheses with coefficients, noise and evidence."""

    def __init__(
        self,
        data: Linearisation,
        hypotheses: Sequence[Hypothesis],
        like: Model | None = None,
        rounds: int = _ROUNDS,
        noise: Mapping[Key, float] | None = None,
    ) -> None:
        """Fits at once.

        Args:
            data: rows and sums.
            hypotheses: all that is in the model.
            like: a model like it, of the same data, whose noise and bounds it begins with.
            rounds: of coefficients and noise in turn, at most.
            noise: variance of each balance's rows where that is known; as in `like` if None.
        """
        self.data = data
        self._known: Mapping[Key, float] | None = noise
        if noise is None and like is not None:
            self._known = like._known
        self.hypotheses = tuple(hypotheses)
        ends = np.cumsum([0, *(each.width for each in self.hypotheses)])
        spans = [slice(int(a), int(b)) for a, b in pairwise(ends)]
        self.placed = list(zip(self.hypotheses, spans, strict=True))
        self.size = int(ends[-1])
        nothing = np.zeros(0)
        self.precision = np.concatenate([nothing, *(h.precision for h in self.hypotheses)])
        self.mean = np.concatenate([nothing, *(h.mean for h in self.hypotheses)])
        self._positive = np.concatenate(
            [np.zeros(0, bool), *(np.full(h.width, h.positive) for h in self.hypotheses)]
        ).astype(bool)
        self.index: dict[Key, tuple[NDArray[np.intp], NDArray[np.intp]]] = {}
        self._place()
        self.noise: dict[Key, float] = {}  # variance of what is left, per row
        self._left: dict[Key, FloatArray] = {}
        self.active = self._begun_active(like)
        self._settle({} if like is None else like.noise, rounds)

    def span(self, hypothesis: Hypothesis) -> slice:
        """Where a hypothesis' coefficients are."""
        return next(span for each, span in self.placed if each is hypothesis)

    def _begun_active(self, like: Model | None) -> NDArray[np.bool_]:
        """Coefficients that rested on their bound in a model like this one rest at first."""
        active = np.ones(self.size, dtype=bool)
        if like is not None:
            resting = {
                id(each.term.columns)
                for each, span in like.placed
                if each.positive and each.width == 1 and not like.active[span].any()
            }
            for each, span in self.placed:
                if each.positive and id(each.term.columns) in resting:
                    active[span] = False
        return active

    def _place(self) -> None:
        """Which coefficients act in each balance, and which of its columns are theirs."""
        own: dict[Key, list[int]] = {}
        there: dict[Key, list[int]] = {}
        for hypothesis, span in self.placed:
            for key, local in self.data.spans(hypothesis.term).items():
                own.setdefault(key, []).extend(range(span.start, span.stop))
                there.setdefault(key, []).extend(range(local.start, local.stop))
        for key in self.data.series:
            self.index[key] = (
                np.array(own.get(key, ()), dtype=np.intp),
                np.array(there.get(key, ()), dtype=np.intp),
            )

    def _sums(self) -> dict[Key, _Sums]:
        """Sums of what is in the model, balance by balance."""
        return {
            key: (
                np.ix_(own, own),
                self.data.series[key].gram[np.ix_(there, there)],
                own,
                self.data.series[key].moment[there],
            )
            for key, (own, there) in self.index.items()
            if len(own)
        }

    def _settle(self, noise: Mapping[Key, float], rounds: int) -> None:
        sums = self._sums()
        if self._known is not None:
            self.noise = dict(self._known)
            self._solve(sums)
            return
        for key, series in self.data.series.items():
            first = max(series.square / len(series.rows), series.floor**2)
            self.noise[key] = noise.get(key, first)
        for _ in range(rounds):
            self._solve(sums)
            before = self.noise
            self.noise = {key: self._variance_of(key) for key in before}
            if all(abs(self.noise[k] / before[k] - 1.0) < _SETTLED for k in before):
                break
        self._solve(sums)

    def weight(self, key: Key) -> float:
        """Weight of a row of a balance: the share of independent rows over the variance."""
        series = self.data.series[key]
        return series.independent / len(series.rows) / self.noise[key]

    _variances: FloatArray | None = None

    def _solve(self, sums: Mapping[Key, _Sums]) -> None:
        """Coefficients, those that cannot be negative at least 0."""
        gram, moment = np.diag(self.precision), self.precision * self.mean
        for key, (grid, own_gram, own, own_moment) in sums.items():
            weight = self.weight(key)
            gram[grid] += weight * own_gram
            moment[own] += weight * own_moment
        self.gram = gram
        self._left, self._variances = {}, None
        size = np.sqrt(np.diag(gram))
        for _ in range(3 * self.size + 1):  # by turns: out, or in again (Lawson and Hanson)
            self.beta = self._free(gram, moment)
            scaled = np.where(self._positive & self.active, self.beta * size, 0.0)
            if self.size and scaled.min() < 0.0:
                self.active[int(np.argmin(scaled))] = False
                continue
            pull = np.where(self.active, 0.0, (moment - gram @ self.beta) / size)
            if not self.size or pull.max() <= _NO_PULL * np.abs(moment / size).max():
                break
            self.active[int(np.argmax(pull))] = True

    def _free(self, gram: FloatArray, moment: FloatArray) -> FloatArray:
        """The likeliest of the active coefficients, the others at 0."""
        at = np.flatnonzero(self.active)
        scale = 1.0 / np.sqrt(np.diag(gram)[at])
        even = gram[np.ix_(at, at)] * np.outer(scale, scale) + _TRACE * np.eye(len(at))
        self._scale, self._factor = scale, linalg.cholesky(even, lower=True)
        return self.solved(moment)

    def solved(self, right: FloatArray) -> FloatArray:
        """Coefficients of another right side than that of the targets, (size,)."""
        at, taken = np.flatnonzero(self.active), np.zeros(self.size)
        if len(at):
            taken[at] = self._scale * linalg.cho_solve(
                (self._factor, True), self._scale * right[at]
            )
        return taken

    def left(self, key: Key) -> FloatArray:
        """What is left of a balance, (N,) on its rows that count."""
        if key not in self._left:
            series, (own, there) = self.data.series[key], self.index[key]
            left = series.target
            if len(own):
                left = left - series.columns[:, there] @ self.beta[own]
            self._left[key] = left
        return self._left[key]

    def mean_square(self, key: Key) -> float:
        """Mean square of what is left of a balance, by sums where these are exact enough."""
        series, (own, there) = self.data.series[key], self.index[key]
        beta = self.beta[own]
        gram, moment = series.gram[np.ix_(there, there)], series.moment[there]
        square = series.square + float(beta @ (gram @ beta - 2.0 * moment))
        if square < _EXACT * series.square:
            left = self.left(key)
            square = float(left @ left)
        return square / len(series.rows)

    def _variance_of(self, key: Key) -> float:
        """The likeliest variance, coefficients that the balance determines taken off the rows."""
        series = self.data.series[key]
        rows = series.independent
        free = max(rows - self._used(key), _LEAST_FREE * rows)
        return max(self.mean_square(key) * rows / free, series.floor**2)

    def _used(self, key: Key) -> float:
        """How many coefficients this balance determines, MacKay's gamma."""
        own, there = self.index[key]
        if not len(own):
            return 0.0
        mine = self.weight(key) * np.diag(self.data.series[key].gram)[there]
        by_data = np.diag(self.gram)[own] - self.precision[own]
        determined = np.clip(1.0 - self.precision[own] * self.variances[own], 0.0, 1.0)
        determined = np.where(self.active[own], determined, 0.0)
        return float(np.sum(determined * mine / np.maximum(by_data, 1e-300)))

    @property
    def inverse(self) -> FloatArray:
        """Covariance of the coefficients, (size, size); 0 of those that rest on their bound."""
        at = np.flatnonzero(self.active)
        result = np.zeros((self.size, self.size))
        if len(at):
            root = linalg.solve_triangular(self._factor, np.diag(self._scale), lower=True)
            result[np.ix_(at, at)] = root.T @ root
        return result

    @property
    def variances(self) -> FloatArray:
        """Variances of the coefficients, (size,)."""
        if self._variances is None:
            self._variances = np.diag(self.inverse).copy()
        return self._variances

    @property
    def log_evidence(self) -> float:
        """Log evidence of the model's rows, all that no model changes left out."""
        total = 0.0
        for key, variance in self.noise.items():
            rows = self.data.series[key].independent
            total -= 0.5 * rows * (np.log(variance) + self.mean_square(key) / variance)
        away = self.beta - self.mean
        total -= 0.5 * float(np.sum(self.precision * away**2))
        at = self.active
        total += 0.5 * float(np.sum(np.log(self.precision[at])))
        total -= float(np.sum(np.log(np.diag(self._factor)) - np.log(self._scale)))
        return total

    @property
    def log_prior(self) -> float:
        """Log odds of what is anomalous in it."""
        return float(sum(each.log_odds for each in self.hypotheses))

    @property
    def admissible(self) -> bool:
        """Whether all coefficients make physical sense."""
        return not self.impossible

    @property
    def impossible(self) -> list[Hypothesis]:
        """Causes whose coefficients make no physical sense."""
        return [
            each
            for each, span in self.placed
            if not (each.admissible(self.beta[span]) and self._is_within(each, span))
        ]

    def _is_within(self, hypothesis: Hypothesis, span: slice) -> bool:
        """Whether a cause that is a part of an ordinary one is no more than its share of it."""
        if hypothesis.ordinary:
            return True
        of, share = CATALOGUE[hypothesis.term.effect].part_of
        if not of:
            return True
        joints, kind = hypothesis.term.place.joints, CATALOGUE[of].one_of
        whole = sum(
            float(self.beta[at][0])
            for each, at in self.placed
            if each.term.place.joints == joints
            and each.term.effect in CATALOGUE
            and CATALOGUE[each.term.effect].one_of == kind
        )
        return bool(np.all(self.beta[span] <= share * whole))

    def with_(self, *more: Hypothesis) -> Model:
        """The model with more hypotheses; noise is estimated again."""
        return Model(self.data, (*self.hypotheses, *more), self)

    def without(self, *gone: Hypothesis) -> Model:
        """The model without some of its hypotheses; noise is estimated again."""
        kept = [h for h in self.hypotheses if all(h is not each for each in gone)]
        return Model(self.data, kept, self)

    @property
    def log_posterior(self) -> float:
        """Log posterior up to a constant of the study; -inf where it cannot be."""
        return self.log_evidence + self.log_prior if self.admissible else -np.inf

    def size_of(self, hypothesis: Hypothesis) -> float:
        """A hypothesis' part over what nothing explains, in the balance where that is largest.

        Sensors' noise does not count as that; of an event, only rows where it acts do.
        """
        largest = 0.0
        for key, part in self.part(hypothesis).items():
            power = part**2
            if hypothesis.term.place.window is not None:
                power = power[power > _ACTS * power.max(initial=0.0)]
            if not len(power):
                continue
            left = float(np.mean(self.left(key) ** 2))
            rest = unexplained(left, self.data.series[key].floor ** 2)
            largest = max(largest, float(np.sqrt(np.mean(power) / rest)))
        return largest

    def part(self, hypothesis: Hypothesis) -> dict[Key, FloatArray]:
        """What a hypothesis adds to the balances where it acts, (N,) each."""
        beta = self.beta[self.span(hypothesis)]
        return {
            key: self.data.series[key].columns[:, local] @ beta
            for key, local in self.data.spans(hypothesis.term).items()
        }
