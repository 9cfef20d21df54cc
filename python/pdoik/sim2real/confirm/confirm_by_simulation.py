"""Names that a regression confuses, distinguished by simulating the arm with either."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from pdoik.errors import PdoikError

from ..effects import CATALOGUE
from ..identify import Identified, Weighed, candidates, estimates, values_and_errors
from ..motion import Key, Prepared
from ..regression import OneMore, Term, TermKey, described, refined
from .refine_by_rollouts import refine_by_rollouts
from .rollouts import Arm, Rollout, Values, huber, why_not

_ROUNDS = 2  # of refinement, before names are compared
_SKETCH = 12_000  # steps of a rollout that looks for a shape
_CLOSER = (1.2, 1.1)  # factors by which shapes are tried around the best
Tell = Callable[[str], None]


def confirmed_by_simulation(
    prepared: Prepared, state: Identified, seed: int, say: Tell
) -> Identified:
    """Findings whose rival's simulation is nearer swapped, what a simulation does without dropped.

    Nothing is done where there is nothing to simulate the arm by.
    """
    doubtful = [term for term in state.accepted if _is_doubtful(state, term)]
    if not doubtful or why_not(prepared.study):
        return state
    arm = Arm(prepared, state.fit)
    sketch = Arm(prepared, state.fit, steps=_SKETCH)
    clearly = prepared.study.thresholds.diagnosis.sure
    for term in doubtful:
        if term not in state.accepted:
            continue
        stand_ins = _stand_ins(state, term)
        bare = _with(state, [t for t in state.accepted if t not in stand_ins])
        own, bare = _simulated(arm, sketch, bare, seed)
        for rival in _rivals(bare, term):
            other = _with(bare, [rival if t is term else t for t in bare.accepted])
            tried, other = _simulated(arm, sketch, other, seed)
            if tried is None:
                continue
            keys = {*term.columns, *rival.columns}
            by = np.inf if own is None else nearer(arm, tried, own, keys)
            if by >= clearly:
                say(f"{described(prepared, rival)} in the place of {described(prepared, term)}")
                term, own, bare = rival, tried, other
            else:
                bare = _with_rival(bare, term, rival, listed=by > -clearly)
        if own is None:
            continue
        for each in stand_ins:
            wider = _with(bare, [*bare.accepted, each])
            tried, wider = _simulated(arm, sketch, wider, seed)
            keys = {*term.columns, *each.columns}
            if tried is not None and nearer(arm, tried, own, keys) >= clearly:
                own, bare = tried, wider
        state = bare
    return replace(state, confirmed=_confirmed(arm, state))


def _stand_ins(state: Identified, term: Term) -> list[Term]:
    """What may have been added to a term to make up for what its columns miss."""
    if not CATALOGUE[term.effect].shown_poorly:
        return []
    return [
        t
        for t in state.accepted
        if t.place == term.place and CATALOGUE[t.effect].makes_up_for_misfit
    ]


def _is_doubtful(state: Identified, term: Term) -> bool:
    """Whether the regression is not to be trusted with a term's name."""
    effect = CATALOGUE[term.effect]
    if effect.negligible(state.balances.motions, term.shape):
        return False
    level = {rival.term.effect for rival in state.rivals.get(term.key, ())}
    return effect.shown_poorly or not level.isdisjoint(effect.simulated_rivals)


def _with(state: Identified, accepted: Sequence[Term]) -> Identified:
    """The state as if these had been accepted."""
    return state.fitted((*state.nuisance, *accepted))


def _confirmed(arm: Arm, state: Identified) -> frozenset[TermKey]:
    """What only a simulation shows well, and is nearer to the recordings with than without."""
    terms, values = state.accepted, state.figures_simulated
    doubtful = [t for t in terms if CATALOGUE[t.effect].shown_poorly]
    if values is None:
        return frozenset()
    try:
        whole = arm.run(terms, values)
        return frozenset(
            term.key
            for term in doubtful
            if nearer(arm, whole, run_without(arm, terms, values, term), {*term.columns})
            >= arm.prepared.study.thresholds.diagnosis.sure
        )
    except (PdoikError, ValueError):
        return frozenset()


def run_without(arm: Arm, terms: Sequence[Term], values: Sequence[Values], term: Term) -> Rollout:
    """The rollout of all terms but one."""
    at = terms.index(term)
    return arm.run([*terms[:at], *terms[at + 1 :]], [*values[:at], *values[at + 1 :]])


def _simulated(
    arm: Arm, sketch: Arm, state: Identified, seed: int
) -> tuple[Rollout | None, Identified]:
    """The rollout of what was accepted, its figures refined, and these kept; None if it ran away.

    Shapes that columns show poorly are first looked for in shorter rollouts.
    """
    terms = state.accepted
    values, errors = values_and_errors(estimates(state.fit, terms, seed))
    values = [state.simulated.get(t.key, v) for t, v in zip(terms, values, strict=True)]
    try:
        for i, term in enumerate(terms):
            if CATALOGUE[term.effect].costly and term.key not in state.simulated:
                values[i] = _nearest_shape(sketch, terms, values, i)
        best = refine_by_rollouts(arm, terms, values, errors, _ROUNDS)[1]
    except (PdoikError, ValueError):
        return None, state
    figures = {term.key: each for term, each in zip(terms, best.values, strict=True)}
    return best, replace(state, simulated={**state.simulated, **figures})


def _nearest_shape(arm: Arm, terms: Sequence[Term], values: list[Values], i: int) -> Values:
    """Figures of the i-th term whose rollout is nearest: of its effect's shapes, then closer."""
    effect = CATALOGUE[terms[i].effect]

    def cost(shape: tuple[float, ...]) -> float:
        figures = effect.values(shape, np.ones(1))
        return arm.run(terms, [*values[:i], figures, *values[i + 1 :]]).cost

    costs = {shape: cost(shape) for shape in effect.shapes(arm.data.motions, terms[i].place)}
    for factor in _CLOSER:
        best = min(costs, key=lambda shape: costs[shape])
        for near in (factor, 1.0 / factor):
            shape = tuple(near * value for value in best)
            costs[shape] = cost(shape)
    return effect.values(min(costs, key=lambda shape: costs[shape]), np.ones(1))


def _rivals(state: Identified, term: Term) -> list[Term]:
    """The best of each rival's shapes at the term's place."""
    names = CATALOGUE[term.effect].simulated_rivals
    others = state.without(term).fit
    pool = [
        each
        for each in candidates(state.balances)
        if each.effect in names
        and each.place == term.place
        and not any(t.key == each.key for t in others.terms)
    ]
    one_more = OneMore(others)
    best: dict[str, Term] = {}
    for each in sorted(pool, key=one_more.gain):
        best[each.effect] = each
    return [refined(others, each) for each in best.values()]


def nearer(arm: Arm, one: Rollout, other: Rollout, keys: set[Key]) -> float:
    """How many standard errors `one` leaves less than the other; negative if more."""
    blocks = np.zeros(int(arm.data.block.max()) + 1)
    total = 0.0
    for key in keys & set(arm.rows):
        difference = huber(other.left[key]) - huber(one.left[key])
        blocks += np.bincount(arm.data.block[arm.rows[key]], difference, minlength=len(blocks))
        total += float(huber(other.left[key]).sum() + huber(one.left[key]).sum()) / 2
    if abs(blocks.sum()) < arm.prepared.study.thresholds.diagnosis.nothing * total:
        return 0.0
    error = float(np.std(blocks) * np.sqrt(len(blocks)))
    return float(blocks.sum()) / max(error, 1e-12)


def _with_rival(state: Identified, term: Term, rival: Term, *, listed: bool) -> Identified:
    """The state with, or without, the rival among the names that fit the data as well."""
    rest = [r for r in state.rivals.get(term.key, ()) if r.term.effect != rival.effect]
    own = state.support[term.key].odds if term.key in state.support else 0.0
    first = [Weighed(term=rival, log_odds=own)] if listed else []
    return replace(state, rivals={**state.rivals, term.key: (*first, *rest)})
