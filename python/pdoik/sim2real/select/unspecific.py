"""Terms of many figures that are another cause and a rest whose place nothing tells.

A rotor that nobody told of and a trunk a little too heavy are, taken together, nearly a wrong
thigh: its ten figures hold both, better than either alone, and the search takes it first. So what a
term of many figures has beside a narrower one is asked for its place: where the same effect
elsewhere explains it as well, and would not have explained the whole, the narrower is the cause.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..regression.fit import Term
from ..regression.refine import refined
from ..regression.screen import screen
from ..regression.trial import Search, Trial, cross_validated, held_out_squares, level, without
from .candidates import candidates, has_company

_TRIED = 8  # narrower ones, and other places for what they leave


def without_unspecific(state: Search) -> Search:
    """Accepted terms of many figures replaced by what they mostly are."""
    for term in state.accepted:
        narrower = None if term.width == 1 else _mostly(state, term)
        state = state if narrower is None else narrower
    return state


def _mostly(state: Search, term: Term) -> Search | None:
    """With a narrower term instead, and what explains the rest if that matters; None without."""
    least = state.balances.thresholds.selection.rival_gain
    for base, narrow in _narrower(state, term):
        whole, part = _trial(base, term), _trial(base, narrow)
        if not part.significant or part.gain < 0.5 * whole.gain:
            continue
        beside = base.fitted([*base.fit.terms, narrow])
        rest = _trial(beside, term)
        for other in _elsewhere(beside, term):
            tried = _trial(beside, other)
            as_well = tried.gain >= rest.gain or level(rest, tried)
            if as_well and _trial(base, other).gain < least * whole.gain:
                more = [other] if tried.significant else []
                return beside.fitted([*beside.fit.terms, *more])
    return None


def _narrower(state: Search, term: Term) -> Iterator[tuple[Search, Term]]:
    """Terms of fewer figures that may be most of it, each with the search that has neither."""
    base = state.without(term)
    for each in base.accepted:
        if _is_narrower(each, term) and not without(state, each).needed:
            yield base.without(each), each
    own = _trial(base, term)
    pool = [t for t in _pool(base, term) if _is_narrower(t, term)]
    for each, gain in screen(base.fit, pool)[:_TRIED]:
        if gain > 0.5 * own.gain:
            yield base, refined(base.fit, each)


def _elsewhere(state: Search, term: Term) -> list[Term]:
    """The same effect at other places, those that gain most beside the others."""
    pool = [t for t in _pool(state, term) if t.effect == term.effect]
    return [each for each, _ in screen(state.fit, pool)[:_TRIED]]


def _pool(state: Search, term: Term) -> list[Term]:
    """Candidates that make sense beside what is accepted, but the term."""
    gone, taken = {term.key, *(t.key for t in state.fit.terms)}, {t.key for t in state.accepted}
    pool = candidates(state.balances)
    return [t for t in pool if t.key not in gone and has_company(t, taken)]


def _is_narrower(one: Term, term: Term) -> bool:
    return one.width < term.width and not set(one.columns).isdisjoint(term.columns)


def _trial(state: Search, term: Term) -> Trial:
    return cross_validated(state, term, held_out_squares(state.fit))
