"""A load in the hand whose mass no motion shows is given by what motions do show of it."""

from __future__ import annotations

from dataclasses import replace

from ..effects.bodies import LinkInertials, Payload
from ..findings import ERRORS, Estimate
from ..identify import Identified, estimates
from ..motion import Place
from ..regression import Term

Estimates = dict[int, dict[str, Estimate]]


def by_moments(
    state: Identified, terms: tuple[Term, ...], values: Estimates, seed: int
) -> tuple[Identified, tuple[Term, ...], Estimates, frozenset[Place]]:
    """Payloads without a clear mass as the last link's moments, which are what their columns are.

    A centre of mass is a moment over a mass: where the mass may be nothing, it may be anywhere.

    Returns:
        What was identified with them, the terms, their estimates, and where a payload was put so.
    """
    loads = [i for i, t in enumerate(terms) if t.effect == Payload.id]
    shapeless = [i for i in loads if not has_shape(values[i])]
    if not shapeless:
        return state, terms, values, frozenset()
    kept = list(terms)
    for i in shapeless:
        kept[i] = replace(terms[i], effect=LinkInertials.id)
    gone = {terms[i].key for i in shapeless}
    swap = {old.key: new for old, new in zip(terms, kept, strict=True)}
    supports = {swap[key].key if key in swap else key: s for key, s in state.support.items()}
    state = replace(
        state.fitted([swap.get(t.key, t) for t in state.fit.terms]),
        rivals={key: each for key, each in state.rivals.items() if key not in gone},
        simulated={key: each for key, each in state.simulated.items() if key not in gone},
        confirmed=state.confirmed - gone,
        support=supports,
    )
    places = frozenset(terms[i].place for i in shapeless)
    return state, tuple(kept), estimates(state.fit, tuple(kept), seed), places


def has_shape(values: dict[str, Estimate]) -> bool:
    """Whether a payload's mass is clear, so that its centre and inertia are figures."""
    mass = values["mass"]
    return mass.value > ERRORS * mass.std
