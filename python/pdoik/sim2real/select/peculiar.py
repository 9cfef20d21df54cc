"""What is peculiar beside all that an ordinary machine has: found first, before it can drown."""

from __future__ import annotations

import numpy as np

from ..effects import CATALOGUE
from ..motion.balances import Balances
from ..regression.background import background
from ..regression.fit import Term
from ..regression.trial import Search, cross_validated, held_out_squares
from ..regression.wald import wald
from .search import search


def peculiar(balances: Balances) -> Search | None:
    """What a search finds beside the background, and held-out rows bear out there; None: nothing.

    The background is the search's nuisance.
    """
    noisy, ordinary = background(balances)
    if not ordinary:
        return None
    state = search(noisy, ordinary)
    standing = [t for t in state.accepted if _is_peculiar(t) and _stands(state, t)]
    return state.fitted([*ordinary, *standing]) if standing else None


def _is_peculiar(term: Term) -> bool:
    """Whether it changes a torque, by an amount, and is none of what every joint has."""
    effect = CATALOGUE[term.effect]
    of_torque = any(balance == "torque" for balance, _ in term.columns)
    return of_torque and not effect.ordinary and not effect.fixed and not effect.costly


def _stands(state: Search, term: Term) -> bool:
    """Whether its own gain on held-out rows is large, whatever priors would have."""
    least = state.balances.thresholds.background
    others = state.without(term).fit
    held = held_out_squares(others)
    trial = cross_validated(state, term, held, others)
    rest = sum(float(np.sum(held[key])) for key in term.columns)
    gained = float(trial.blocks.sum()) > least.peculiar * rest
    return gained and wald(others.extended(term), term)[0] > least.peculiar_t
