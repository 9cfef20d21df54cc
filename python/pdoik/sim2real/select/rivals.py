"""What else would explain the same data, and whether it explains them better."""

from __future__ import annotations

from dataclasses import replace

from ..effects import CATALOGUE
from ..findings import Equivalent
from ..motion.prepare import Prepared
from ..regression.fit import Fit, Term
from ..regression.naming import link_of
from ..regression.refine import refined
from ..regression.screen import screen
from ..regression.trial import Search, Trial, cross_validated, held_out_squares, level
from .candidates import candidates, has_company, implausibility, same_kind

_TRIED = 8
_MOST = 3  # equivalents listed


def level_trials(state: Search, term: Term) -> tuple[Trial, list[Trial]]:
    """The term's own trial, and those of others that take its place as well or better.

    A coarser law of the same kind does if it explains nearly all of it: dry friction where it has
    presliding besides. More is asked of no plainer rival than the term itself shows.
    """
    others = state.without(term).fit
    held = held_out_squares(others)
    own = cross_validated(state, term, held, others)
    pool = [
        t
        for t in candidates(state.balances)
        if t.key != term.key
        and not any(t.key == a.key for a in others.terms)
        and not set(t.columns).isdisjoint(term.columns)
    ]
    taken = {t.key for t in others.terms}
    pool = [t for t in pool if has_company(t, taken)]
    rivals, least = [], state.balances.thresholds.selection
    for rival, training_gain in screen(others, pool)[:_TRIED]:
        if training_gain < least.rival_gain * own.gain and not _alike(rival, term):
            continue
        better = refined(others, rival)
        trial = cross_validated(state, better, held, others)
        plainer = _complexity(trial.term) <= _complexity(term)
        clear = trial.significant or (plainer and trial.needed and not own.significant)
        if clear and _is_listed(max(own, trial, key=lambda t: t.gain), trial):
            rivals.append(trial)
    rivals.sort(key=lambda trial: -trial.gain)
    return own, rivals


def _is_listed(best: Trial, other: Trial) -> bool:
    """Whether another name is said beside the best: what is level, or nearly as good and coarser.

    A finer law than the best, and clearly worse, is none: at its bound it comes near any coarser.
    """
    nearly = other.gain > best.thresholds.same_kind * best.gain
    coarser = _complexity(other.term) <= _complexity(best.term)
    return level(best, other) or (nearly and coarser and _alike(best.term, other.term))


def _complexity(term: Term) -> float:
    return CATALOGUE[term.effect].complexity


def _is_no_more(one: Trial, other: Trial) -> bool:
    """Whether it is the other law and more of which the data show nothing.

    Laws of another family are of another part of the machine: a gear's, where one is a sensor's.
    """
    if not _alike(one.term, other.term) or _complexity(one.term) <= _complexity(other.term):
        return False
    if CATALOGUE[one.term.effect].family != CATALOGUE[other.term.effect].family:
        return False
    return one.gain <= other.gain or level(one, other)


def _alike(one: Term, other: Term) -> bool:
    return one.place == other.place and same_kind(one.effect, other.effect)


def swapped(state: Search) -> Search:
    """Accepted terms replaced by rivals that do clearly better; what is level is kept beside."""
    for term in state.accepted:
        if CATALOGUE[term.effect].sought in ("windows", "last"):
            continue
        own, rivals = level_trials(state, term)
        winners = [rival for rival in rivals if _wins(state, rival, own)]
        best = winners[0] if winners else None
        if best is not None:
            terms = [best.term if t is term else t for t in state.fit.terms]
            state = state.fitted(terms)
            rivals = [r for r in rivals if r is not best] + ([own] if _is_listed(best, own) else [])
            term, own = best.term, best
        others = tuple(each for each in rivals if not _is_no_more(each, own))
        state = replace(state, level={**state.level, term.key: others})
    return state


def _wins(state: Search, rival: Trial, own: Trial) -> bool:
    if _alike(rival.term, own.term):
        coarse, fine = sorted((rival, own), key=lambda t: _complexity(t.term))
        little = coarse.gain > own.thresholds.no_finer * fine.gain or level(fine, coarse)
        return (rival is coarse) == little
    if not level(rival, own):
        return rival.gain > own.gain
    others = state.without(own.term).fit
    rank = [_rank(others, each.term) for each in (rival, own)]
    return rank[0] < rank[1] and level(own, rival)


def _rank(others: Fit, term: Term) -> float:
    """Order of names that data cannot tell apart, the likelier first."""
    return CATALOGUE[term.effect].complexity + implausibility(others, term)


def equivalents_of(state: Search, term: Term, prepared: Prepared) -> tuple[Equivalent, ...]:
    """At most three other effects that held-out rows cannot tell from the term."""
    result: list[Equivalent] = []
    for trial in state.level.get(term.key, []):
        each = Equivalent(
            effect=trial.term.effect,
            joints=tuple(prepared.study.joints[j] for j in trial.term.place.joints),
            links=link_of(prepared, trial.term),
        )
        if each not in result:
            result.append(each)
    return tuple(result[:_MOST])
