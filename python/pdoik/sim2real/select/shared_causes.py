"""A delay or a lag that most joints share is all joints': where data do not speak against it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..effects import CATALOGUE
from ..motion.place import Place
from ..regression.fit import Term, term_of
from ..regression.naming import near_the_median
from ..regression.trial import Search


def with_shared_causes(state: Search) -> Search:
    """Give joints whose noise hides it the delay, lag or skew that the others agree on.

    Only where its figure lowers the joint's training cost.
    """
    b, most = state.balances, state.balances.thresholds.selection.shared_by
    moving = [j for j in range(b.n) if b.excited[j]]
    for effect in [each for each in CATALOGUE.values() if each.shared]:
        terms = [t for t in state.accepted if t.effect == effect.id]
        alike = near_the_median(np.array([t.shape[-1] for t in terms])) if terms else []
        shown = [terms[i] for i in alike]
        if len(shown) < 2 or len(shown) < most * len(moving):
            continue
        taken = {t.place.joints for t in terms}
        shape = (*shown[0].shape[:-1], float(np.median([t.shape[-1] for t in shown])))
        for j in moving:
            if (j,) in taken:
                continue
            term = term_of(b, effect, Place(joints=(j,)), shape)
            if term is not None and _helps(state, term):
                state = replace(state, fit=state.fit.extended(term))
    return state


def _helps(state: Search, term: Term) -> bool:
    return state.fit.extended(term).cost() < state.fit.cost()
