"""How likely each cause is with all others, and which other names come near it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .company import fits_with, wider
from .hypothesis import Hypothesis
from .model import Model
from .ordinary import days_of
from .pool import Pool, Scored
from .posterior import Posterior
from .weighing import State, serious

_MOST_RIVALS = 4  # rivals of a cause


def judged(posterior: Posterior, state: State) -> list[tuple[Scored, list[Scored]]]:
    """Every cause with its log odds given all others, and the names that come near it."""
    found = []
    for each in state.chosen:
        rest = [other for other in state.chosen if other is not each]
        without = posterior.possible(posterior.with_causes(state, rest))
        own = Scored(each, state.log_posterior - without.log_posterior)
        pool = posterior.rivals_of(without, each)
        found.append((own, _near(posterior, without.model, own, pool)))
    return found


def in_place_of(posterior: Posterior, state: State, part: Hypothesis) -> list[Scored]:
    """Causes that would explain what an ordinary part does, nearly as well; prior odds apart.

    What every machine has is the name; that rows do not distinguish it from another is said.
    """
    without = state.model.without(part, *_days(state, part))
    own = Scored(part, state.model.log_evidence - without.log_evidence)
    pool = [
        each
        for each in posterior.pool.scored(without)
        if each.hypothesis.term.place == part.term.place
        and each.hypothesis.term.effect != part.term.effect
        and each.hypothesis.term.columns.keys() == part.term.columns.keys()
        and fits_with(each.hypothesis, state.chosen)
    ]
    return _near(posterior, without, own, pool)


def _near(
    posterior: Posterior, without: Model, own: Scored, pool: Sequence[Scored]
) -> list[Scored]:
    """What comes near a cause in its place, whatever was believed before of either."""
    level, cause = posterior.balances.thresholds.diagnosis.level, own.hypothesis
    least = _at_noise_of(posterior, without, cause) - level
    found = []
    for scored in serious(pool)[:_MOST_RIVALS]:
        hypothesis = scored.hypothesis
        apart = hypothesis.log_odds - cause.log_odds  # what was believed before
        if max(scored.log_odds, scored.log_odds - apart) < least:
            continue
        if not posterior.may_be(hypothesis, without):
            continue
        whole = without.with_(hypothesis) if cause.ordinary else wider(without, hypothesis)
        odds = whole.log_posterior - without.log_posterior
        if max(odds, odds - apart) > own.log_odds - level:
            found.append(Scored(hypothesis, odds - apart if cause.ordinary else odds))
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
