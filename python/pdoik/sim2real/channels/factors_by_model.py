"""Factor between a torque and the model's, with all that an ordinary machine has.

Friction, rotors, drawings that are a tenth wrong, a payload and a base that is mounted some other
way are fitted with it, so that none of them is taken for a factor. Where the factor itself cannot
be known, friction gives the sign: it takes power, and a joint whose friction drives it has its
torque the wrong way round.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.bodies import GravityDirection
from ..motion import Balances, Key
from ..regression import (
    BACKGROUND,
    TRUST,
    Fit,
    Term,
    background,
    friction_at,
    is_scale,
    robust,
    term_of,
)

_ANY = 1e4  # times the usual error: a scale may have any value
_LOADED = 30.0  # times the usual error: a load may be some times the last link


def factors_by_model(balances: Balances) -> dict[int, tuple[float, float]]:
    """Joints whose torque is not what it should be, with factor and error."""
    first = balances.motions[0]
    if first.body is None or first.torque is None:
        return {}
    b, ordinary = background(balances)
    terms = [*(_loaded(t, first.body.last) for t in ordinary), *_gravity(b)]
    found: dict[int, tuple[float, float]] = {}
    while True:
        base = Fit(b, terms)
        tried = [each for t in terms if (each := _judged(base, t, found)) is not None]
        if not tried:
            return found
        _, j, factor, error, terms = max(tried, key=lambda each: each[0])
        found[j] = factor, error


def _gravity(balances: Balances) -> list[Term]:
    """Gravity along any direction: an arm that lies on its side is no arm of wrong sensors."""
    effect = CATALOGUE[GravityDirection.id]
    made = [term_of(balances, effect, place, ()) for place in effect.places(balances.motions)]
    return [replace(term, effect=BACKGROUND, prior=np.ones(3)) for term in made if term is not None]


def _loaded(term: Term, last: int) -> Term:
    """The term without the prior that keeps the last link's body near the model's."""
    body = term.effect == TRUST and term.place.link == last
    return replace(term, prior=term.prior / _LOADED**2) if body else term


def _judged(
    base: Fit, scale: Term, found: dict[int, tuple[float, float]]
) -> tuple[float, int, float, float, list[Term]] | None:
    """What is gained by one joint's scale set free, which joint, factor, error, all terms."""
    if not is_scale(scale) or scale.place.joints[0] in found:
        return None
    b, j = base.balances, scale.place.joints[0]
    limits = b.thresholds.channels
    key: Key = ("torque", j)
    if not len(base.rows[key]):  # it rests wherever anything could be known
        return None
    own = replace(scale, prior=scale.prior / _ANY**2)
    fit = base.without(scale).extended(own)
    factor = 1.0 + float(fit.beta[-1])
    error = float(np.sqrt(robust(fit, own)[0, 0]))
    part = factor * own.columns[key][fit.rows[key]][:, 0]
    left = fit.residual(key) * b.sigma[key]
    explained = float(np.std(part)) / max(float(np.std(part + left)), 1e-12)
    # A torque far below what it should be drowns in its noise: its smallness is what is sure.
    tiny = abs(factor) < limits.tiny and error < limits.tiny_error * limits.tiny
    outside = not limits.least_factor < factor < limits.most_factor
    clear = abs(factor - 1.0) > limits.factor_t * error
    power = _power(fit, j)
    gained, terms = base.cost() - fit.cost(), list(fit.terms)
    if outside and clear and (explained > limits.least_correlation or tiny):
        # Friction may say that the sign is right after all.
        return None if factor < 0.0 < power - limits.factor_t else (gained, j, factor, error, terms)
    drives = power < -limits.factor_t and factor - error < 0.0
    # The sign alone is known, as surely as friction drives: the two that it may be are 2 apart.
    return (gained, j, -1.0, 2.0 / abs(power), terms) if drives else None


def _power(fit: Fit, j: int) -> float:
    """Power that friction takes, by its error over blocks; negative where it drives the joint."""
    b = fit.balances
    key: Key = ("torque", j)
    rows = fit.rows[key]
    speed = b.sampled([m.dq[:, j] for m in b.motions])[rows]
    return _by_blocks(friction_at(fit, j) * speed, b.block[rows])


def _by_blocks(values: FloatArray, block: NDArray[np.intp]) -> float:
    sums = np.bincount(block, values)
    sums = sums[sums != 0.0]
    if len(sums) < 3:
        return 0.0
    error = float(np.std(sums) * np.sqrt(len(sums)))
    return float(sums.sum()) / max(error, 1e-300)
