"""What accepted terms come to: figures with intervals, and which of them are nothing after all.

Only recordings to learn from are looked at here. A load in the hand whose mass no motion shows is
given by what motions do show of it. Currents and torque constants are known to a few percent; no
recording shows it, and all that is in newtons or kilograms grows with them.

What samples and ticks leave open of a delay: the law, or the command, is known at the log's samples
and kept over the controller's period, half of which is accounted for. Forty studies with nothing
wrong show what remains, as a share of that period: of a position's delay 0.013 root mean square and
0.06 at most where its own error is small, of a torque's 0.08 and 0.22. What they cannot show is
that a machine logs its command a tick before it acts, or its torque a tick after: then all joints
seem late by up to a period.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray

from ..confirm import simulated_estimates
from ..effects import CATALOGUE, Effect
from ..effects.bodies import LinkInertials, Payload
from ..effects.drives import OF_POSITION, OF_TORQUE, CommandDelay, period_of
from ..findings import ERRORS, Estimate
from ..identify import Identified, estimates
from ..motion import Balances, Key, Place, Prepared
from ..regression import Fit, Term, described, effect_of, robust, to_second_order
from ..study import Study

_SMALL = 0.2  # of a period: the step of a derivative by the delay


def blur(b: Balances, shape: tuple[float, ...]) -> float:
    """Standard deviation that sampling gives a delay or a lag [s]."""
    first, by = b.motions[0], b.thresholds.priors
    period, known = period_of(first)
    of_kind = by.position_delay if shape[0] == OF_POSITION else by.torque_delay
    share = of_kind if known else by.unknown_delay
    return float(np.hypot(share * period, by.log_delay * first.recording.raw_period))


def widened(b: Balances, term: Term, values: dict[str, Estimate]) -> dict[str, Estimate]:
    """A delay's, lag's or skew's estimates with the error that sampling adds."""
    effect = CATALOGUE[term.effect]
    if not effect.blurred_by_sampling or b.motions[0].source == "":
        return values
    by = blur(b, term.shape if effect.is_delay else (OF_TORQUE,))
    return {name: each.wider(by) for name, each in values.items()}


def without_sampling(
    prepared: Prepared, fit: Fit, terms: tuple[Term, ...]
) -> tuple[tuple[Term, ...], list[str]]:
    """The terms that sampling does not explain, and what was left out, in words."""
    shared = [term for term in terms if shared_by_all(fit, term)]
    notes = [
        f"{described(prepared, term)}: {1e3 * term.shape[1]:.2g} ms, not more than a period and not"
        " different from what all joints show; sampling and the controller's period explain it, so"
        " it is not claimed."
        for term in shared
    ]
    return tuple(term for term in terms if term not in shared), notes


def shared_by_all(fit: Fit, term: Term) -> bool:
    """Whether a delay not clearly above a period is one that the other joints show as well.

    Or cannot be distinguished from such a one. Then the order in which a machine acts and logs
    explains it.
    """
    motions, limits = fit.balances.motions, fit.balances.thresholds.diagnosis
    if not effect_of(term).is_delay or motions[0].source == "":
        return False
    delay = abs(term.shape[1])
    if delay > period_of(motions[0])[0] + limits.sure * blur(fit.balances, term.shape):
        return False
    others = [t for t in fit.terms if not (effect_of(t).is_delay and t.shape[0] == term.shape[0])]
    bare = Fit(fit.balances, others)
    seen = []
    for j in range(fit.balances.n):
        if (j,) == term.place.joints or not fit.balances.excited[j]:
            continue
        value, error = lateness(bare, j, term.shape[0])
        if error < limits.delay_given * delay:
            seen.append(value)
    return not seen or float(np.median(seen)) > limits.most_of * delay


def lateness(fit: Fit, j: int, what: float) -> tuple[float, float]:
    """How late a joint's commands act given a fit, to first order, and its error [s].

    Infinite where no balance shows it.
    """
    b, effect = fit.balances, CATALOGUE[CommandDelay.id]
    place = Place(joints=(j,))
    if not effect.shapes(b.motions, place):
        return 0.0, np.inf
    step = _SMALL * period_of(b.motions[0])[0]
    late, early = (b.compute(effect, place, (what, sign * step)) for sign in (1.0, -1.0))
    slope = {key: (late[key] - early[key]) / 2 for key in late if key in early}
    if not slope:
        return 0.0, np.inf
    middle = {key: (late[key] + early[key]) / 2 for key in slope}
    wider = fit.extended(_term(effect.id, place, middle), _term("slope", place, slope))
    error = float(np.sqrt(robust(wider, wider.terms[-1])[0, 0]))
    return float(wider.beta[-1]) * step, error * step


def _term(effect: str, place: Place, columns: dict[Key, FloatArray]) -> Term:
    return Term(effect=effect, place=place, shape=(), columns=columns, prior=np.zeros(1))


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


IN_TORQUE = re.compile(r"\b(N|kg)\b")


def with_torque_scale(study: Study, values: dict[str, Estimate]) -> dict[str, Estimate]:
    """Estimates with the error of the torque's scale: of forces, torques and masses."""
    given = study.trust.torque
    share = study.thresholds.priors.torque_scale if given is None else given
    return {
        name: each.wider(share * abs(each.value)) if IN_TORQUE.search(each.unit) else each
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
