"""The first search, and again where the base is found tilted: gravity then acts another way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..effects import CATALOGUE
from ..motion.balances import Balances
from ..motion.prepare import Prepared
from ..motion.rigid_body import STANDARD_GRAVITY
from ..regression.fit import Term, term_of
from ..regression.naming import described
from ..regression.trial import Search, held_out_squares
from ..regression.trusted_bodies import effect_of, trusted
from ..study.recording import FloatArray
from .search import search

Tell = Callable[[str, str, float], None]

_LEANINGS = 6  # searches at most, each with the tilt that the last found


def first_search(
    prepared: Prepared, say: Tell, begin: tuple[Term, ...] = ()
) -> tuple[Prepared, Search]:
    """Accept effects; again where the base is tilted so far that it matters to unknown bodies.

    Args:
        prepared: the study.
        say: told what is accepted.
        begin: accepted beforehand, and dropped where they turn out needless.

    Returns:
        The study with its bodies under gravity as the tilted base has it, and the search of that.
    """
    assumed = np.array([0.0, 0.0, -STANDARD_GRAVITY])
    matters = prepared.study.thresholds.selection.tilt * STANDARD_GRAVITY
    state = _searched(prepared, say, begin)
    for turn in range(_LEANINGS):
        gravity = tilted_gravity(state)
        if gravity is None or np.linalg.norm(gravity - assumed) < matters:
            break
        say("name", "once more, with the base tilted as found", 0.6)
        if turn > 0:  # too heavy a body goes with too small a tilt: half way
            gravity = (gravity + assumed) / 2.0
        tilted = _pulled_by(prepared, gravity)
        again = searched_again(tilted, state, say)
        if _missed(again) > _missed(state):
            break
        prepared, state, assumed = tilted, again, gravity
    return prepared, state


def searched_again(prepared: Prepared, state: Search, say: Tell) -> Search:
    """The search of a study that has changed, begun with what was accepted before."""
    same = [anew(prepared.fit, term) for term in state.accepted]
    return _searched(prepared, say, tuple(term for term in same if term is not None))


def _searched(prepared: Prepared, say: Tell, begin: tuple[Term, ...] = ()) -> Search:
    """The search beside the model's inertias within the user's trust."""
    return search(
        prepared.fit,
        trusted(prepared.fit, prepared.study.trust.rigid_body),
        lambda term, share: say("name", described(prepared, term), 0.15 + 0.5 * share),
        begin=begin,
    )


def _pulled_by(prepared: Prepared, gravity: FloatArray) -> Prepared:
    held_out = prepared.validate
    return replace(
        prepared,
        fit=prepared.fit.pulled_by(gravity),
        validate=None if held_out is None else held_out.pulled_by(gravity),
    )


def anew(balances: Balances, term: Term) -> Term | None:
    """A term on other balances; None where it changes nothing there."""
    return term_of(balances, CATALOGUE[term.effect], term.place, term.shape)


def _missed(state: Search) -> float:
    """Squared residual of rows that their fit did not see."""
    return sum(float(np.sum(left)) for left in held_out_squares(state.fit).values())


def tilted_gravity(state: Search) -> FloatArray | None:
    """Gravity in the frame of the base, if that was found to be tilted, (3,) [m/s^2]."""
    for term, offset in zip(state.fit.terms, state.fit.offsets, strict=False):
        effect = effect_of(term)
        if effect.on == "base":
            beta = state.fit.beta[offset : offset + term.width]
            return effect.gravity(effect.values(term.shape, beta))
    return None
