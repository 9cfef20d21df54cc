"""Every effect at every plausible place: the candidates that need no look at what is left."""

from __future__ import annotations

from weakref import WeakKeyDictionary

from ..effects import CATALOGUE
from ..motion.balances import Balances
from ..motion.place import Key
from ..regression.fit import Term, term_of

_POOLS: WeakKeyDictionary[Balances, list[Term]] = WeakKeyDictionary()


def candidates(balances: Balances) -> list[Term]:
    """Every effect at every plausible place and first shape; made once for the same balances."""
    if balances not in _POOLS:
        _POOLS[balances] = _candidates(balances)
    return list(_POOLS[balances])


def _candidates(balances: Balances) -> list[Term]:
    terms: list[Term] = []
    for effect in CATALOGUE.values():
        if effect.sought != "candidates":
            continue
        for place in effect.places(balances.motions):
            if effect.per_joint_moving and not all(balances.excited[j] for j in place.joints):
                continue
            if effect.costly and not any(_restless(balances, j) for j in place.joints):
                continue
            for shape in effect.shapes(balances.motions, place):
                term = term_of(balances, effect, place, shape)
                if term is not None:
                    terms.append(term)
        for motion in balances.motions:
            motion.forget()
    return terms


def _restless(balances: Balances, j: int) -> bool:
    """Whether something is left in joint j's torque, or in the tip's pose."""
    keys: list[Key] = [("torque", j), *(("tip", axis) for axis in range(6))]
    least = balances.thresholds.diagnosis.restless
    return any(balances.rms(k) > least * balances.sigma[k] for k in keys if k in balances.residual)


def same_kind(one: str, other: str) -> bool:
    """Whether either is only a finer name for the other."""
    kind = CATALOGUE[one].one_of
    return bool(kind) and kind == CATALOGUE[other].one_of
