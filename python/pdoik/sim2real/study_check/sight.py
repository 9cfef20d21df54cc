"""How large a contribution must be to be seen, by what the diagnosis asks of it.

A contribution c along the recorded motion, filtered as the balances are, is seen by what is left of
it beside the simple effects that every joint may have (dry and viscous friction, offset, rotor) and
the bodies within the user's trust. With E its sum of squares there, R what nothing explains on the
rows where it acts and s its amount, the search asks

    s / e       >= least_t            e: the standard error of s, by the noise's autocorrelation
    s^2 E / n   >= least_size^2       n: the rows on which it acts; in sigmas of the balances
    s^2 E       >= least_of_rest (R + s^2 E)
    s^2 |c|^2   >= least_share of what the balances began with, for it is taken before the others

What a joint ordinarily has is also taken where the Bayesian criterion of sets asks for it. What no
ordinary machine has must stand beside the whole background, too: by stands_t errors, or by a large
part of what that leaves. A finding is claimed where its share of R + s^2 E is enough for its
confidence. All of these hold with a probability of about SEEN where s / e is above by Z, and s^2 E,
whose standard deviation is 2 s E e, is above by Z of those. The noise is what is left beside the
background with bodies of any mass.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, stats

from ..motion.balances import Balances
from ..motion.place import Key, Place
from ..regression.fit import Fit, Term, clusters_of
from ..regression.trial import activity
from ..study.recording import FloatArray
from ..thresholds import Thresholds

SEEN = 0.9
"""Probability with which an effect of the smallest size is seen."""

_Z = float(stats.norm.ppf(SEEN))
_NONE = 1e-9  # share of a contribution that is left of it where nothing is

Contribution = Mapping[Key, FloatArray]
"""What one amount of something adds to balances, (N,) for each key."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stand:
    """What a contribution, times an amount, shows beside the whole background."""

    energy: float  # sum of squares of what is left of it there, sigma^2
    error: float  # standard error of the amount there
    inflated: float  # factor of that error where figures are many beside the clusters of rows
    left: float  # sum of squares on all rows of its balances that nothing explains, sigma^2

    def clarity(self, amount: float, width: int, limits: Thresholds) -> float:
        """By how much more than is asked an amount stands."""
        believed, t = limits.background, amount / self.error
        by_errors = t / self.inflated / (believed.stands_t * np.sqrt(width) + _Z)
        asked = believed.large / (1.0 - believed.large) * self.left
        by_size = np.sqrt(_least_gain(amount, self.energy, t) / asked)
        return float(max(by_errors, min(by_size, t / (believed.stands_t + _Z))))


@dataclass(frozen=True, slots=True, kw_only=True)
class Sight:
    """What one contribution, times an amount, shows."""

    energy: float  # sum of squares of what is left of it beside what is simple, sigma^2
    share: float  # of all of it
    error: float  # standard error of the amount beside what is simple
    stand: Stand | None  # beside the whole background; None where that is not asked
    rows: int  # on which it acts
    left: float  # sum of squares on these rows that nothing explains, sigma^2
    began: float  # the same before anything was fitted
    asks: Asks

    def clarity(self, amount: float, limits: Thresholds) -> float:
        """By how much more than is asked an amount is seen: 1 for just so."""
        if self.rows == 0 or not 0.0 < self.error < np.inf:
            return 0.0
        search, t = limits.search, amount / self.error
        gain = _least_gain(amount, self.energy, t)
        share = max(search.least_of_rest, self.asks.least_of_rest)
        asked = max(
            search.least_size**2 * self.rows,
            search.least_share * self.began * self.share,
            share / (1.0 - share) * self.left,
        )
        least = search.least_t * np.sqrt(self.asks.width)  # a Wald statistic is by figure
        found = min(t / (least + _Z), np.sqrt(gain / asked))
        if self.asks.price is not None:
            claimed = least_share(limits)
            of_set = np.sqrt(self.asks.price + search.better_set)
            in_set = (
                t / (of_set + _Z),
                t / (search.still_needed * least + _Z),
                np.sqrt(gain * (1.0 - claimed) / (claimed * self.left)),
            )
            found = max(found, min(in_set))
        if self.stand is not None:
            found = min(found, self.stand.clarity(amount, self.asks.width, limits))
        return float(found)

    def smallest(self, limits: Thresholds) -> float:
        """The amount of clarity 1, where contributions are in proportion to it; inf for none."""
        if self.rows == 0 or not 0.0 < self.error < np.inf:
            return np.inf
        if self.stand is not None and not self.stand.error < np.inf:
            return np.inf
        low, high = 0.0, self.error
        while self.clarity(high, limits) < 1.0 and high < 1e30:
            low, high = high, 2.0 * high
        for _ in range(30):
            middle = 0.5 * (low + high)
            seen = self.clarity(middle, limits) >= 1.0
            low, high = (low, middle) if seen else (middle, high)
        return high


@dataclass(frozen=True, slots=True, kw_only=True)
class Asks:
    """What an effect is asked for."""

    width: int  # figures that are fitted for it
    least_of_rest: float  # that it asks for by itself
    price: float | None  # of its figures in a set of ordinary effects; None where it is in none


def least_share(limits: Thresholds) -> float:
    """Share of what is left that a finding must explain to be claimed, by its confidence."""
    weights = limits.confidence
    odds = np.log(weights.suspected / (1.0 - weights.suspected))
    return float(1.0 / (1.0 + np.exp(-(odds - weights.base) / weights.gain)))


def _least_gain(amount: float, energy: float, t: float) -> float:
    """Sum of squares that an amount explains at least, with a probability of SEEN."""
    return amount**2 * energy * max(1.0 - 2.0 * _Z / max(t, 1e-12), 0.0)


class Beside:
    """What is left of contributions beside the terms of a fit."""

    def __init__(self, balances: Balances, terms: Sequence[Term]) -> None:
        """Fits at once."""
        self.fit = Fit(balances, terms)
        fit = self.fit
        self._factor = linalg.cho_factor(fit.regular(fit.gram)) if fit.size else None

    def seen(self, contribution: Contribution) -> dict[Key, FloatArray]:
        """Of one, on the rows that count, in its own unit; (rows,) for each key."""
        fit, sigma = self.fit, self.fit.balances.sigma
        columns = {
            key: values[fit.rows[key]] / sigma[key]
            for key, values in contribution.items()
            if key in fit.rows and len(fit.rows[key])
        }
        if self._factor is None:
            return {key: column * sigma[key] for key, column in columns.items()}
        cross = np.zeros(fit.size)
        for key, column in columns.items():
            cross[fit.index[key]] += fit.design[key].T @ column
        taken = np.asarray(linalg.cho_solve(self._factor, cross))
        left = {}
        for key, design in fit.design.items():
            change = design @ taken[fit.index[key]]
            if key in columns or np.any(change):
                left[key] = (columns.get(key, 0.0) - change) * sigma[key]
        return left

    def left(self, key: Key) -> FloatArray:
        """What the fit leaves of a balance, on the rows that count, in its own unit."""
        return np.asarray(self.fit.residual(key) * self.fit.balances.sigma[key])


@dataclass(frozen=True, kw_only=True, eq=False)
class Noise:
    """What is left of the balances beside all that is ordinary."""

    flexible: Beside

    def of(self, contribution: Contribution) -> dict[Key, FloatArray]:
        """Without what a contribution explains of it, on the rows that count; (rows,) each."""
        balances = self.flexible.fit.balances
        seen = self.flexible.seen(contribution)
        rest = {key: self.flexible.left(key) for key in balances.keys}
        weight = {key: 1.0 / balances.sigma[key] ** 2 for key in balances.keys}
        power = sum(weight[k] * float(each @ each) for k, each in seen.items())
        moment = sum(weight[k] * float(each @ rest[k]) for k, each in seen.items())
        whole = sum(
            weight[k] * float(np.sum(values[self.flexible.fit.rows[k]] ** 2))
            for k, values in contribution.items()
            if k in rest
        )
        if power <= _NONE * whole:
            return rest
        return {k: each - moment / power * seen.get(k, 0.0) for k, each in rest.items()}


def sight_of(
    contribution: Contribution, asks: Asks, simple: Beside, noise: Noise, whole: Beside | None
) -> Sight:
    """Of a contribution.

    Args:
        contribution: of one amount.
        asks: what its effect is asked for.
        simple: what it must be told from to be found.
        noise: of the balances.
        whole: what it must stand beside; None where that is not asked.
    """
    b, fit = simple.fit.balances, simple.fit
    own = {k: values for k, values in contribution.items() if k in fit.rows and len(fit.rows[k])}
    seen, rest = simple.seen(own), noise.of(own)
    columns = {key: values[fit.rows[key]] for key, values in own.items()}
    energy, raw = _energy(simple, columns, seen), _energy(simple, columns, columns)
    rows, acting = activity(fit, _term(own))

    def power(values: Mapping[Key, FloatArray]) -> float:
        return sum(float(np.sum(values[k][acting[k]] ** 2)) / b.sigma[k] ** 2 for k in columns)

    return Sight(
        energy=energy,
        share=energy / raw if raw > 0.0 else 0.0,
        error=_error(simple, own, seen, rest) * _inflation(fit, own),
        stand=None if whole is None else _stand(whole, own, rest),
        rows=rows,
        left=power(rest),
        began=power({k: b.residual[k][fit.rows[k]] for k in columns}),
        asks=asks,
    )


def _stand(whole: Beside, own: Contribution, rest: Contribution) -> Stand:
    seen, fit = whole.seen(own), whole.fit
    columns = {key: values[fit.rows[key]] for key, values in own.items()}
    return Stand(
        energy=_energy(whole, columns, seen),
        error=_error(whole, own, seen, rest),
        inflated=_inflation(fit, own),
        left=_energy(whole, {k: rest[k] for k in columns}, rest),
    )


def _energy(beside: Beside, one: Contribution, other: Contribution) -> float:
    """Sum of products over rows, in sigmas of the fit's balances."""
    sigma = beside.fit.balances.sigma
    return sum(float(each @ other[key]) / sigma[key] ** 2 for key, each in one.items())


def _inflation(fit: Fit, own: Contribution) -> float:
    """By how much clusters make an error larger where figures are as many, see `Fit.robust`."""
    count = clusters_of(fit, _term(own))[1]
    return float(np.sqrt(count / max(count - fit.size - 1, 1)))


def _error(
    beside: Beside, own: Contribution, seen: Mapping[Key, FloatArray], rest: Contribution
) -> float:
    """Standard error of an amount fitted beside others; inf where nothing is left of it."""
    fit, sigma = beside.fit, beside.fit.balances.sigma
    columns = {key: values[fit.rows[key]] for key, values in own.items()}
    energy, raw = _energy(beside, columns, seen), _energy(beside, columns, columns)
    if energy <= _NONE * raw:
        return np.inf
    variance = sum(
        _variance(fit.balances, fit.rows[k], each, rest[k]) / sigma[k] ** 4
        for k, each in seen.items()
    )
    return float(np.sqrt(variance) / energy)


def _term(contribution: Contribution) -> Term:
    return Term(
        effect="asked",
        place=Place(),
        shape=(),
        columns={key: values[:, None] for key, values in contribution.items()},
        prior=np.zeros(1),
    )


def _variance(b: Balances, rows: NDArray[np.intp], seen: FloatArray, rest: FloatArray) -> float:
    """Of the sum of a contribution times the noise, whose autocorrelation is the residual's.

    Autocovariances up to twice the lag at which the residual forgets itself count, by Bartlett's
    weights (Newey and West, Econometrica 55(3), 1987).
    """
    noise, signal = np.zeros(b.count), np.zeros(b.count)
    noise[rows], signal[rows] = rest, seen
    length = int(np.max(np.diff(b.starts)))
    of_noise, of_signal = np.zeros(length), np.zeros(length)
    for first, last in zip(b.starts[:-1], b.starts[1:], strict=True):
        of_noise[: last - first] += _products(noise[first:last])
        of_signal[: last - first] += _products(signal[first:last])
    if not of_noise[0] > 0.0:
        return 0.0
    negative = np.flatnonzero(of_noise < 0.0)
    lags = np.arange(min(2 * int(negative[0]) if len(negative) else length, length))
    weights = np.where(lags == 0, 1.0, 2.0 * (1.0 - lags / len(lags)))
    covariance = of_noise[lags] / max(len(rows), 1)
    return float(max(np.sum(weights * covariance * of_signal[lags]), 0.0))


def _products(values: FloatArray) -> FloatArray:
    """Sums of products with the same, later by 0, 1, ... rows."""
    spectrum = np.abs(np.fft.rfft(values, 2 * len(values))) ** 2
    return np.asarray(np.fft.irfft(spectrum)[: len(values)])
