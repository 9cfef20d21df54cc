"""What only seems peculiar: a spring, a coupling or a limit that ordinary errors explain as well.

Selected among what was found before it, such a term may stand for a mass that is a tenth off or for
friction that no law has quite. Beside a background of all that it is not needed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..effects import CATALOGUE
from ..motion.balances import Balances
from ..regression.background import background, has_its_like, without_its_like
from ..regression.fit import Fit, Term
from ..regression.trial import Search, cross_validated, held_out_squares


@dataclass(frozen=True, kw_only=True, eq=False)
class Ordinary:
    """The background of a study, fitted once, and only where something is held against it."""

    of: Balances

    @cached_property
    def _background(self) -> tuple[Balances, tuple[Term, ...]]:
        return background(self.of)

    def without_need(self, state: Search) -> list[tuple[Term, float]]:
        """Accepted terms that are not needed beside it and each other, and by how many errors."""
        sure = {*(t.key for t in state.contacts), *state.confirmed}
        judged = [t for t in state.accepted if t.key not in sure and _is_judged(t)]
        if not judged:
            return []
        noisy, terms = self._background
        if not terms:
            return []
        least = noisy.thresholds.background.stands_t
        found = []
        for term in judged:
            nuisance = without_its_like(terms, term, noisy.thresholds.background)
            fit = Fit(noisy, [*nuisance, *judged])
            beside = Search(balances=noisy, nuisance=nuisance, fit=fit, start=state.start)
            found.append((term, _by(beside, term, least)))
        return [(term, by) for term, by in found if by < least]


def _by(beside: Search, term: Term, least: float) -> float:
    """Errors by which a term is not zero; as many as the search asks where priors call for it.

    What explains a large part of all that the background leaves, on rows that were held out and
    again and again, stands by how surely it does.
    """
    others = beside.without(term).fit
    held = held_out_squares(others)
    trial = cross_validated(beside, term, held, others)
    rest = sum(float(np.sum(held[key])) for key in term.columns)
    large = trial.blocks.sum() > others.balances.thresholds.background.large * rest
    if trial.t >= least or trial.t <= 0.0 or not large:
        return trial.t
    acting = trial.blocks[trial.blocks != 0.0]
    return max(trial.t, float(acting.sum() / (np.std(acting) * np.sqrt(len(acting)) + 1e-300)))


def _is_judged(term: Term) -> bool:
    """Whether it is seen in a torque alone, and the background has nothing of its kind."""
    effect = CATALOGUE[term.effect]
    named = effect.sought != "last" and not effect.costly
    of_torque = all(balance == "torque" for balance, _ in term.columns)
    return named and of_torque and not has_its_like(effect)
