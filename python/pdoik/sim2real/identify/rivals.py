"""How likely each cause is beside all others, and which other names come near it."""

from __future__ import annotations

import numpy as np

from .company import fits_beside, wider
from .hypothesis import Hypothesis
from .model import Model
from .ordinary import days_of
from .pool import Pool
from .posterior import Posterior
from .weighing import Candidate, State, serious

_WEIGHED = 4  # rivals of a cause


def judged(posterior: Posterior, state: State) -> list[tuple[Hypothesis, float, list[Candidate]]]:
    """Every cause with its log odds beside all others, and the names that come near it."""
    level = posterior.balances.thresholds.identify.level
    found = []
    for each in state.chosen:
        rest = [other for other in state.chosen if other is not each]
        without = posterior.possible(posterior.with_causes(state, rest))
        own = state.log_posterior - without.log_posterior
        rivals = []
        least = _at_noise_of(posterior, without.model, each) - level
        for scored in serious(posterior.rivals_of(without, each))[:_WEIGHED]:
            apart = scored.hypothesis.log_odds - each.log_odds  # what was believed before
            if max(scored.log_odds, scored.log_odds - apart) < least:
                continue
            if not posterior.may_be(scored.hypothesis):
                continue
            odds = wider(without.model, scored.hypothesis).log_posterior
            odds -= without.log_posterior
            if max(odds, odds - apart) > own - level:
                rivals.append(Candidate(hypothesis=scored.hypothesis, log_odds=odds))
        found.append((each, own, sorted(rivals, key=lambda each: -each.log_odds)))
    return found


def in_place_of(posterior: Posterior, state: State, part: Hypothesis) -> list[Candidate]:
    """Causes that would explain what an ordinary part does, nearly as well; prior odds apart.

    What every machine has is the name; that rows do not tell it from another is said.
    """
    level = posterior.balances.thresholds.identify.level
    without = state.model.without(part, *_days(state, part))
    own = state.model.log_evidence - without.log_evidence
    least = _at_noise_of(posterior, without, part) - level
    found = []
    for scored in serious(
        [
            each
            for each in posterior.pool.scored(without)
            if each.hypothesis.term.place == part.term.place
            and each.hypothesis.term.effect != part.term.effect
            and each.hypothesis.term.columns.keys() == part.term.columns.keys()
            and fits_beside(each.hypothesis, state.chosen)
        ]
    )[:_WEIGHED]:
        hypothesis = scored.hypothesis
        if scored.log_odds - hypothesis.log_odds < least:
            continue
        if not posterior.may_be(hypothesis):
            continue
        whole = without.with_(hypothesis)
        gain = whole.log_evidence - without.log_evidence
        if whole.admissible and gain > own - level:
            found.append(Candidate(hypothesis=hypothesis, log_odds=gain))
    return sorted(found, key=lambda each: -each.log_odds)


def _at_noise_of(posterior: Posterior, model: Model, cause: Hypothesis) -> float:
    """A cause's log odds at the noise that is left without it: as its rivals are scored first.

    At the noise that is left with it, differences are larger, in the same order. What acts where no
    rows count has none, and any rival will do.
    """
    return max(
        (each.log_odds for each in Pool(posterior.data, [cause]).scored(model)), default=-np.inf
    )


def _days(state: State, part: Hypothesis) -> list[Hypothesis]:
    """What a part differs by in each session."""
    hypotheses = state.model.hypotheses
    own = days_of([h.term for h in hypotheses], part.term)
    return [h for h in hypotheses if any(h.term is day for day in own)]
