"""Every effect at every plausible place: the candidates that need no look at what is left."""

from __future__ import annotations

from collections.abc import Mapping
from weakref import WeakKeyDictionary

from ..effects import CATALOGUE
from ..motion import Balances, Key, Place
from ..regression import Term, term_of

_POOLS: WeakKeyDictionary[Balances, list[Term]] = WeakKeyDictionary()


def candidates(balances: Balances) -> list[Term]:
    """Every effect at every plausible place and first shape; made once for the same balances."""
    if balances not in _POOLS:
        _POOLS[balances] = _candidates(balances)
    return list(_POOLS[balances])


def _candidates(balances: Balances) -> list[Term]:
    terms: list[Term] = []
    least = balances.thresholds.diagnosis.restless
    left = {key: balances.rms(key) for key in balances.residual}
    for effect in CATALOGUE.values():
        if effect.sought != "candidates":
            continue
        for place in effect.places(balances.motions):
            if effect.per_joint_moving and not all(balances.excited[j] for j in place.joints):
                continue
            if effect.costly and not is_restless(left, balances.sigma, place, least):
                continue
            for shape in effect.shapes(balances.motions, place):
                term = term_of(balances, effect, place, shape)
                if term is not None:
                    terms.append(term)
        for motion in balances.motions:
            motion.forget()
    return terms


def is_restless(
    left: Mapping[Key, float], noise: Mapping[Key, float], place: Place, least: float
) -> bool:
    """Whether more than noise is left, `least` times, of a joint's torque or of the tip's pose."""
    keys: list[Key] = [("torque", j) for j in place.joints]
    if keys:
        keys += [("tip", axis) for axis in range(6)]
    return any(left[key] > least * noise[key] for key in keys if key in left)


def same_kind(one: str, other: str) -> bool:
    """Whether either is only a finer name for the other."""
    kind = CATALOGUE[one].one_of
    return bool(kind) and kind == CATALOGUE[other].one_of
