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

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import stats

from pdoik.recordings import FloatArray

from ..identify.support import acting
from ..motion.place import Key
from ..thresholds import Thresholds
from .beside import Beside, Contribution, Noise, energy_of, error_of, inflation_of

SEEN = 0.9
"""Probability with which an effect of the smallest size is seen."""

_Z = float(stats.norm.ppf(SEEN))


@dataclass(frozen=True, slots=True, kw_only=True)
class Stand:
    """What a contribution, times an amount, shows beside the whole background."""

    energy: float  # sum of squares of what is left of it there, sigma^2
    error: float  # standard error of the amount there
    inflated: float  # factor of that error where figures are many beside the clusters of rows
    left: float  # sum of squares on all rows of its balances that nothing explains, sigma^2

    def clarity(self, amount: float, width: int, limits: Thresholds) -> float:
        """By how much more than is asked an amount stands."""
        believed, t = limits.search, amount / self.error
        by_errors = t / self.inflated / (believed.stands_t * np.sqrt(width) + _Z)
        asked = believed.large / (1.0 - believed.large) * self.left
        by_size = np.sqrt(_least_gain(amount, self.energy, t) / asked)
        return float(max(by_errors, min(by_size, t / (believed.stands_t + _Z))))


@dataclass(frozen=True, slots=True, kw_only=True)
class Asks:
    """What an effect is asked for."""

    width: int  # figures that are fitted for it
    least_of_rest: float  # that it asks for by itself
    price: float | None = None  # of its figures in a set of ordinary effects; None: it is in none
    noise: float = 1.0  # of the set's balance, with its rows that say the same, sigma^2


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
            asked = (self.asks.price + search.better_set) * self.asks.noise
            in_set = (
                np.sqrt(gain / asked),
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


def least_share(limits: Thresholds) -> float:
    """Share of what is left that a finding must explain to be claimed, by its confidence."""
    weights, least = limits.confidence, limits.diagnosis.suspected
    odds = np.log(least / (1.0 - least))
    return float(1.0 / (1.0 + np.exp(-(odds - weights.base) / weights.gain)))


def _least_gain(amount: float, energy: float, t: float) -> float:
    """Sum of squares that an amount explains at least, with a probability of SEEN."""
    return amount**2 * energy * max(1.0 - 2.0 * _Z / max(t, 1e-12), 0.0)


def sight_of(
    contribution: Contribution,
    asks: Asks,
    simple: Beside,
    noise: Noise,
    whole: Beside | None = None,
    figures: int | None = None,
) -> Sight:
    """Of a contribution.

    Args:
        contribution: of one amount.
        asks: what its effect is asked for.
        simple: what it must be told from to be found.
        noise: of the balances.
        whole: what it must stand beside; None where that is not asked.
        figures: that the search fits beside it; all of `simple` if None.
    """
    b, fit = simple.fit.balances, simple.fit
    own = {k: values for k, values in contribution.items() if k in fit.rows and len(fit.rows[k])}
    seen, rest = simple.seen(own), noise.of(own)
    columns = {key: values[fit.rows[key]] for key, values in own.items()}
    energy, raw = energy_of(simple, columns, seen), energy_of(simple, columns, columns)
    acts = {key: acting(column[:, None]) for key, column in columns.items()}
    beside = fit.size if figures is None else figures

    def power(values: Mapping[Key, FloatArray]) -> float:
        return sum(float(np.sum(values[k][acts[k]] ** 2)) / b.sigma[k] ** 2 for k in columns)

    return Sight(
        energy=energy,
        share=energy / raw if raw > 0.0 else 0.0,
        error=error_of(simple, own, seen, rest) * inflation_of(fit, own, beside),
        stand=None if whole is None else _stand(whole, own, rest),
        rows=sum(int(each.sum()) for each in acts.values()),
        left=power(rest),
        began=power({k: b.residual[k][fit.rows[k]] for k in columns}),
        asks=asks,
    )


def _stand(whole: Beside, own: Contribution, rest: Contribution) -> Stand:
    seen, fit = whole.seen(own), whole.fit
    columns = {key: values[fit.rows[key]] for key, values in own.items()}
    return Stand(
        energy=energy_of(whole, columns, seen),
        error=error_of(whole, own, seen, rest),
        inflated=inflation_of(fit, own, fit.size),
        left=energy_of(whole, {k: rest[k] for k in columns}, rest),
    )
