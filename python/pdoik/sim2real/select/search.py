"""Which effects, where: forward selection by what is gained on rows that were held out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..effects import CATALOGUE
from ..motion.balances import Balances
from ..regression.fit import Fit, Term
from ..regression.refine import polished, refined
from ..regression.screen import screen
from ..regression.trial import (
    Search,
    Trial,
    cross_validated,
    held_out_squares,
    level,
    without,
)
from .candidates import blurred, candidates, has_company, implausibility
from .harmonics import harmonic_terms

Tell = Callable[[Term, float], None]


def search(
    balances: Balances,
    nuisance: tuple[Term, ...],
    tell: Tell = lambda term, share: None,
    contacts: tuple[Term, ...] = (),
    begin: tuple[Term, ...] = (),
) -> Search:
    """Accept the best candidate until none is worth it; drop those no longer needed.

    Args:
        balances: of the recordings to fit.
        nuisance: terms that are always there (the model's inertias within the user's trust).
        tell: called with the term accepted and how far the search is, 0 to 1.
        contacts: found in what an earlier search left, accepted beforehand.
        begin: accepted beforehand too, but dropped where they turn out needless.
    """
    start = Fit(balances, nuisance)
    state = Search(balances=balances, nuisance=nuisance, fit=start, start=start, contacts=contacts)
    if contacts or begin:
        state = replace(state, fit=start.extended(*contacts, *begin))
    pool = candidates(balances)
    while len(state.accepted) < balances.thresholds.search.most_terms:
        trials = _trials(state, pool)
        state = replace(state, tried=(*state.tried, *trials))
        best = _best(state, trials)
        if best is None:
            break
        term = refined(state.fit, best.term)
        state = replace(state, fit=state.fit.extended(term))
        tell(term, min(0.9, 0.1 * len(state.accepted)))
        state = _pruned(polished(state, {*term.place.joints}))
    return polished(state)


def _trials(state: Search, pool: list[Term]) -> list[Trial]:
    """Candidates of a high training gain as they do on held-out rows, the best first."""
    least = state.balances.thresholds.search
    taken = {t.key for t in state.accepted}
    gone = taken | {name for name, times in state.dropped.items() if times > 1}
    fresh = [t for t in pool if t.key not in gone and has_company(t, taken)]
    fresh = [t for t in fresh if not blurred(t, state.accepted)]
    fresh += [t for t in harmonic_terms(state.fit) if t.key not in gone]
    screened = screen(state.fit, fresh)
    held = held_out_squares(state.fit)
    trials: list[Trial] = []
    best = 0.0  # gain of the best significant trial
    hopeless = 0
    for term, training_gain in screened:
        coarse = CATALOGUE[term.effect].costly  # its grid is: refined it may do far better
        if training_gain < (0.2 if coarse else 0.5) * best and len(trials) > 3:
            continue
        tried = refined(state.fit, term) if coarse else term
        trial = cross_validated(state, tried, held)
        trials.append(trial)
        if trial.significant:
            best = max(best, trial.gain)
        hopeless += not trial.significant
        if (len(trials) >= least.screened and best > 0.0) or hopeless >= least.hopeless:
            break
    return sorted(trials, key=lambda each: -each.gain)


def _best(state: Search, trials: list[Trial]) -> Trial | None:
    """The best significant one, the simplest where data cannot tell; None if none is."""
    good = [each for each in trials if each.significant]
    if not good:
        return None
    near = [each for each in good if level(good[0], each)]
    return min(near, key=lambda each: _simplicity(state, each))


def _simplicity(state: Search, trial: Trial) -> tuple[float, float]:
    """Order among candidates that data cannot tell apart."""
    complexity = float(CATALOGUE[trial.term.effect].complexity)
    return complexity + implausibility(state.fit, trial.term), -trial.gain


def _pruned(state: Search) -> Search:
    """Without accepted terms that the later ones have made needless."""
    while len(state.accepted) > 1:
        worst, weakest = None, np.inf
        for term in state.accepted[:-1]:
            if term in state.contacts:
                continue
            if blurred(term, state.accepted):
                worst, weakest = term, -np.inf
                continue
            trial = without(state, term)
            if not trial.needed and trial.t < weakest:
                worst, weakest = term, trial.t
        if worst is None:
            return state
        # Twice, and it would come and go for ever.
        dropped = {**state.dropped, worst.key: state.dropped.get(worst.key, 0) + 1}
        state = replace(state.without(worst), dropped=dropped)
    return state
