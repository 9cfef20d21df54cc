"""What accepted terms come to: figures with intervals, and which of them are nothing after all.

Only recordings to learn from are looked at here. A load in the hand whose mass no motion shows is
given by what motions do show of it. Currents and torque constants are known to a few percent; no
recording shows it, and all that is in newtons or kilograms grows with them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np

from ..confirm import simulated_estimates
from ..effects import CATALOGUE, Effect
from ..effects.bodies import LinkInertials, Payload
from ..findings import ERRORS, Estimate
from ..identify import Identified, estimates
from ..motion import Place, Prepared
from ..regression import Fit, Term, described, to_second_order
from ..study import Study
from .sampling import widened, without_sampling

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


OF_TORQUE = re.compile(r"\b(N|kg)\b")


def with_torque_scale(study: Study, values: dict[str, Estimate]) -> dict[str, Estimate]:
    """Estimates with the error of the torque's scale: of forces, torques and masses."""
    given = study.trust.torque
    share = study.thresholds.priors.torque_scale if given is None else given
    return {
        name: each.wider(share * abs(each.value)) if OF_TORQUE.search(each.unit) else each
        for name, each in values.items()
    }


@dataclass(frozen=True, kw_only=True, eq=False)
class Figures:
    """Terms that stand with what they come to."""

    state: Identified  # without those that came to nothing
    terms: tuple[tuple[Term, dict[str, Estimate]], ...]
    loads: frozenset[Place]  # payloads that are given by their moments
    notes: tuple[str, ...]  # what was done, and what came to nothing


def figures_of(prepared: Prepared, state: Identified, seed: int) -> Figures:
    """Estimates of all accepted terms, refined by simulation, widened by what data hide."""
    motions = prepared.fit.motions
    accepted = tuple(
        term
        for term in state.accepted
        if not CATALOGUE[term.effect].negligible(motions, term.shape)
    )
    accepted, notes = without_sampling(prepared, state.fit, accepted)
    values = estimates(state.fit, accepted, seed)
    state, accepted, values, loads = by_moments(state, accepted, values, seed)
    values = {i: to_second_order(state.fit, t, values[i]) for i, t in enumerate(accepted)}
    values, simulated = simulated_estimates(prepared, state, accepted, values)
    if simulated:
        notes = [simulated, *notes]
    kept: list[tuple[Term, dict[str, Estimate]]] = []
    lost: list[Term] = []
    for number, term in enumerate(accepted):
        figures = _as_simple(CATALOGUE[term.effect], widened(prepared.fit, term, values[number]))
        plain = {name: each.value for name, each in figures.items()}
        if CATALOGUE[term.effect].trifling(plain, motions[0], term.place):
            continue
        said = ""
        if term not in state.contacts and _is_lost_in_its_error(term, figures):
            said = "suggested, but not larger than its error."
        elif beyond := at_bound(state.fit, term, figures):
            said = f"{beyond}, so it explains nothing."
        if said:
            notes.append(f"{described(prepared, term)}: {said}")
            lost.append(term)
            continue
        figures = with_torque_scale(prepared.study, figures)
        kept.append((term, within_bounds(CATALOGUE[term.effect], figures)))
    if lost:
        state = state.without(*lost)
    state = replace(state, fit=state.fit.constrained())
    return Figures(state=state, terms=tuple(kept), loads=loads, notes=tuple(notes))


def _as_simple(effect: Effect, figures: dict[str, Estimate]) -> dict[str, Estimate]:
    """Figures with what the simplicity of their law may take of them."""
    if not effect.simplified:
        return figures
    return {name: e.wider(effect.simplified * abs(e.value)) for name, e in figures.items()}


def within_bounds(effect: Effect, figures: dict[str, Estimate]) -> dict[str, Estimate]:
    """Intervals over sessions no farther than figures may go: few sessions leave them wide."""
    bounds = {each.name: (each.lower, each.upper) for each in effect.parameters}
    result = {}
    for name, each in figures.items():
        (low, high), (least, most) = each.interval95, bounds.get(name, (-np.inf, np.inf))
        if each.spread and least <= each.value <= most:
            each = replace(each, interval95=(max(low, least), min(high, most)))
        result[name] = each
    return result


def _is_lost_in_its_error(term: Term, figures: dict[str, Estimate]) -> bool:
    """Whether the size of what was found may as well be zero.

    Of a body each figure may be nothing while what they do together, which is what motors feel and
    other sessions confirm, is not.
    """
    if not CATALOGUE[term.effect].size_first:
        return False
    size = next(iter(figures.values()))
    return abs(size.value) < ERRORS * size.std


def at_bound(fit: Fit, term: Term, values: dict[str, Estimate]) -> str:
    """Which figure of a term lies on a bound of its effect, in words; "" where none does.

    A figure that would go on beyond what it may be is pulled by something else.
    """
    effect, near = CATALOGUE[term.effect], fit.balances.thresholds.diagnosis.on_bound
    for each in effect.parameters:
        if each.name not in values or each.chosen:
            continue
        value = values[each.name].value
        for bound, beyond in ((each.lower, each.lower - value), (each.upper, value - each.upper)):
            if bound and np.isfinite(bound) and beyond >= -near * abs(bound):
                return f"its {each.name.replace('_', ' ')} lies on its bound, {bound:g} {each.unit}"
    if term.fixed or term.width != 1 or effect.shown_poorly:  # the last are judged by simulations
        return ""
    beta = fit.bounded()[fit.span(term).start]
    for bound in (float(limit[0]) for limit in effect.bounds):
        if bound and np.isfinite(bound) and abs(beta - bound) <= near * abs(bound):
            figures = ", ".join(f"{name} {each.value:.3g}" for name, each in values.items())
            return f"it lies on a bound of what it may be ({figures})"
    return ""
