"""What is left of a contribution beside other terms, and how far noise lets its amount be told."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from pdoik.recordings import FloatArray

from ..motion.balances import Balances
from ..motion.place import Key, Place
from ..regression.fit import Fit, Term
from ..regression.wald import clusters_of

_NONE = 1e-9  # share of a contribution that is left of it where nothing is

Contribution = Mapping[Key, FloatArray]
"""What one amount of something adds to balances, (N,) for each key."""


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


def energy_of(beside: Beside, one: Contribution, other: Contribution) -> float:
    """Sum of products over rows, in sigmas of the fit's balances."""
    sigma = beside.fit.balances.sigma
    return sum(float(each @ other[key]) / sigma[key] ** 2 for key, each in one.items())


def inflation_of(fit: Fit, own: Contribution, figures: int) -> float:
    """By how much clusters make an error larger beside so many figures, see `robust`."""
    count = clusters_of(fit, as_term(own))[1]
    return float(np.sqrt(count / max(count - figures - 1, 1)))


def error_of(
    beside: Beside, own: Contribution, seen: Mapping[Key, FloatArray], rest: Contribution
) -> float:
    """Standard error of an amount fitted beside others; inf where nothing is left of it."""
    fit, sigma = beside.fit, beside.fit.balances.sigma
    columns = {key: values[fit.rows[key]] for key, values in own.items()}
    energy, raw = energy_of(beside, columns, seen), energy_of(beside, columns, columns)
    if energy <= _NONE * raw:
        return np.inf
    variance = sum(
        _variance(fit.balances, fit.rows[k], each, rest[k]) / sigma[k] ** 4
        for k, each in seen.items()
    )
    return float(np.sqrt(variance) / energy)


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


def as_term(contribution: Contribution) -> Term:
    """As a regression has it, with a free coefficient."""
    return Term(
        effect="asked",
        place=Place(),
        shape=(),
        columns={key: values[:, None] for key, values in contribution.items()},
        prior=np.zeros(1),
    )
