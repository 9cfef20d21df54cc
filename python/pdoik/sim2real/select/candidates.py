"""Which hypotheses there are, and which make no sense beside what was found."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from ..effects import CATALOGUE
from ..effects.inertial import LinkInertials
from ..motion.balances import Balances
from ..motion.place import Key
from ..regression.fit import Fit, Term, TermKey, term_of

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
    return terms


def _restless(balances: Balances, j: int) -> bool:
    """Whether something is left in joint j's torque, or in the tip's pose."""
    keys: list[Key] = [("torque", j), *(("tip", axis) for axis in range(6))]
    return any(balances.rms(k) > 1.5 * balances.sigma[k] for k in keys if k in balances.residual)


def implausibility(fit: Fit, term: Term) -> float:
    """0 to 1: how large a link's error is beside the link; 0 for all other effects."""
    body = fit.balances.motions[0].body
    if term.effect != LinkInertials.id or body is None or term.place.link is None:
        return 0.0
    scale = body.inertial_scale(term.place.link)
    beta = fit.extended(term).beta[-term.width :]
    size = float(np.sqrt(np.sum((beta / scale)[:4] ** 2)))
    return size / (1.0 + size)


def same_kind(one: str, other: str) -> bool:
    """Whether either is only a finer name for the other."""
    kind = CATALOGUE[one].one_of
    return bool(kind) and kind == CATALOGUE[other].one_of


def has_company(term: Term, taken: set[TermKey]) -> bool:
    """Whether what the effect only comes beside was found at its place."""
    beside = CATALOGUE[term.effect].beside
    if any((effect, term.place) in taken for effect in CATALOGUE[term.effect].instead):
        return False
    return not beside or any((effect, term.place) in taken for effect in beside)


def blurred(term: Term, others: tuple[Term, ...]) -> bool:
    """Whether the effect is only what is left at the edge of another at its place."""
    effect = CATALOGUE[term.effect]
    return any(
        effect.is_edge_of(term.shape, t.effect, t.shape) for t in others if t.place == term.place
    )
