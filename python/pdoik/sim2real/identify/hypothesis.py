"""One cause at one place, with what is believed of it before the data are looked at."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import Balances, Gate, Key
from ..regression import Term, TermKey, usual_torque
from ..thresholds import PriorThresholds

_LEAST_FIXED, _MOST_FIXED = 0.6, 1.6


@dataclass(frozen=True, kw_only=True, eq=False)
class Hypothesis:
    """A term with a prior: coefficients are normal about `mean` with inverse variances `precision`.

    `log_odds` are those that it is there at all; 0 of ordinary physics, which always is.
    """

    term: Term
    mean: FloatArray  # (k,)
    precision: FloatArray  # (k,)
    log_odds: float = 0.0
    ordinary: bool = False
    positive: bool = False  # its coefficients cannot be negative: losses dissipate

    @property
    def key(self) -> TermKey:
        """What it is and where: the same for other shapes, and for other ends of its part."""
        effect, place = self.term.key
        if place.gate is None:
            return effect, place
        return effect, replace(place, gate=Gate(of=place.gate.of))

    @property
    def width(self) -> int:
        """Number of coefficients."""
        return len(self.mean)

    def admissible(self, beta: FloatArray) -> bool:
        """Whether coefficients make physical sense."""
        if self.ordinary:
            return True
        if not CATALOGUE[self.term.effect].possible(self.term.shape):
            return False
        if self.term.fixed:  # where the data want another multiple of it, it is something else
            return bool(_LEAST_FIXED < beta[0] < _MOST_FIXED)
        return CATALOGUE[self.term.effect].admissible(beta)


def ordinary(term: Term, size: float | FloatArray, *, positive: bool = False) -> Hypothesis:
    """A part of what every machine has; `size` is the standard deviation of its coefficients."""
    sizes = np.broadcast_to(np.asarray(size, dtype=np.float64), (term.width,))
    return Hypothesis(
        term=replace(term, prior=1.0 / sizes**2),
        mean=np.zeros(term.width),
        precision=1.0 / sizes**2,
        ordinary=True,
        positive=positive,
    )


def anomalous(balances: Balances, term: Term, *, among: float = 1.0) -> Hypothesis:
    """A cause that few machines have.

    Its size is what its effect says, else such that its part of a balance is usual: a share of a
    joint's usual torque, all of what a balance of another kind shows.

    Args:
        balances: of the study.
        term: of an effect of the catalogue.
        among: places, shapes, moments that were looked at for it, beyond those of the pool.
    """
    believed, effect = balances.thresholds.priors, CATALOGUE[term.effect]
    odds = float(np.log(effect.odds / (1.0 - effect.odds)) - np.log(among))
    odds += effect.log_prior(term.shape)
    if term.fixed:
        mean, precision = np.ones(1), np.full(1, believed.fixed_error**-2)
    else:
        mean = np.zeros(term.width)
        usual = effect.usual(term.shape, term.width)
        if usual is None:
            precision = np.maximum(term.prior, _usual_precision(balances, term, believed))
        else:
            precision = 1.0 / usual**2
    return Hypothesis(
        term=term if term.fixed else replace(term, prior=precision),
        mean=mean,
        precision=precision,
        log_odds=odds,
    )


def _usual_precision(balances: Balances, term: Term, believed: PriorThresholds) -> FloatArray:
    """Inverse variances with which each coefficient's part of the balances is of usual size."""
    if CATALOGUE[term.effect].is_body and np.all(term.prior > 0.0):
        return np.asarray(term.prior)
    energy, rows, usual = np.zeros(term.width), 0, 0.0
    for key, column in term.columns.items():
        own = balances.mask[key]
        count = int(np.count_nonzero(own))
        if count:
            acting = np.abs(column[own]).max(axis=1) > 0.0
            energy += np.sum(column[own] ** 2, axis=0)
            rows += max(int(np.count_nonzero(acting)), 1)
            usual = max(usual, believed.usual_part * usual_size(balances, key))
    if usual <= 0.0:
        return np.ones(term.width)
    size = np.sqrt(energy / max(rows, 1))
    return np.asarray(np.maximum((size / usual) ** 2, 1e-12))


def usual_size(balances: Balances, key: Key) -> float:
    """What a balance usually is: a joint's torque, or what a balance of another kind shows."""
    return usual_torque(balances, key[1]) if key[0] == "torque" else balances.rms(key)
