"""A load in the hand whose mass no motion shows is told by what motions do show of it."""

from __future__ import annotations

from dataclasses import replace

from ..effects.inertial import LinkInertials, Payload
from ..findings import Estimate
from ..motion.place import Place
from ..regression.estimate import estimates
from ..regression.fit import Fit, Term
from ..regression.trial import Search

_CLEAR = 2.0  # standard errors that a body's mass must be above zero

Estimates = dict[int, dict[str, Estimate]]


def by_moments(
    state: Search, terms: tuple[Term, ...], values: Estimates, seed: int
) -> tuple[tuple[Term, ...], Estimates, frozenset[Place]]:
    """Payloads without a clear mass as the last link's moments, which are what their columns are.

    A centre of mass is a moment over a mass: where the mass may be nothing, it may be anywhere.

    Returns:
        The terms, their estimates, and where a payload was put so.
    """
    shapeless = [
        i for i, t in enumerate(terms) if t.effect == Payload.id and not _is_body(values[i])
    ]
    if not shapeless:
        return terms, values, frozenset()
    kept = list(terms)
    for i in shapeless:
        kept[i] = replace(terms[i], effect=LinkInertials.id)
        for known in (state.level, state.simulated, state.confirmed):
            known.pop(terms[i].key, None)
    swap = {old.key: new for old, new in zip(terms, kept, strict=True)}
    state.fit = Fit(state.balances, [swap.get(t.key, t) for t in state.fit.terms])
    places = frozenset(terms[i].place for i in shapeless)
    return tuple(kept), estimates(state.fit, tuple(kept), seed), places


def _is_body(values: dict[str, Estimate]) -> bool:
    mass = values["mass"]
    return mass.value > _CLEAR * mass.std
