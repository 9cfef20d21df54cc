"""Which parts of a model are claimed, how likely each is with all others, and its rivals.

Claimed is what is surely there, and large compared with what nothing explains. An ordinary part is
named where it is some errors from nothing and not negligible; a body where it is not within its
trust. An anomalous cause is claimed where its odds are worth it, it is as large as what nothing
explains, and what held-out rows gain makes it sure enough. What else is likely is doubtful: in the
model, and only suspected.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..effects import CATALOGUE
from ..effects.bodies import LinkInertials
from ..effects.drives import TorqueGain
from ..findings import ERRORS, Support
from ..motion import Balances
from ..regression import DAYS, TRUST, Fit, Term, TermKey, Tolerance, term_of
from .confidence import confidence_of
from .hypothesis import Hypothesis
from .identified import Identified, Part, Weighed
from .model import Model
from .ordinary import days_of
from .pool import Pool, Scored
from .posterior import Posterior
from .support import as_trusted, held_out_support, machines_with
from .weighing import State, fits_with, serious, wider

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


_UNNAMED = (DAYS, Tolerance.id)


def identified(posterior: Posterior, state: State) -> Identified:
    """What a state comes to."""
    claims = _Claims.of(posterior, state)
    claims.judge_anomalous()
    claims.judge_ordinary()
    return claims.made()


@dataclass(kw_only=True, eq=False)
class _Claims:
    """Claims, filled by two passes over the model: what is anomalous, then what is ordinary."""

    posterior: Posterior
    state: State
    noisy: Balances
    start: Fit  # of nothing
    fit: Fit  # of all that is in the model
    claimed: list[Term] = field(default_factory=list)
    doubtful: list[Term] = field(default_factory=list)
    support: dict[TermKey, Support] = field(default_factory=dict)
    rivals: dict[TermKey, tuple[Weighed, ...]] = field(default_factory=dict)
    parts: list[Part] = field(default_factory=list)

    @classmethod
    def of(cls, posterior: Posterior, state: State) -> _Claims:
        """The claims of a state, before anything is judged."""
        model = state.model
        noisy = posterior.noisy(model)
        active = [h.term for h, span in model.placed if model.active[span].any()]
        return cls(
            posterior=posterior,
            state=state,
            noisy=noisy,
            start=Fit(noisy, ()),
            fit=Fit(noisy, active),
        )

    def judge_anomalous(self) -> None:
        """Causes that were chosen."""
        scored = judged(self.posterior, self.state)
        everything = [own.hypothesis.term for own, _ in scored]
        believed, fit = self.noisy.thresholds.diagnosis, as_trusted(self.fit, everything)
        for own, others in scored:
            hypothesis, odds = own.hypothesis, own.log_odds
            term = hypothesis.term
            had_by = machines_with(term, believed)
            seen = held_out_support(fit, self.start, term, odds, len(others), everything, had_by)
            least = believed.matters_common if had_by == "many" else believed.matters_more
            likely = odds >= believed.worth and seen.size > least
            sure = likely and not _may_be_nothing(self.state.model, hypothesis)
            self._take(term, seen, others, sure=sure)
        self._claim_shared(believed.worth)

    def _claim_shared(self, worth: float) -> None:
        """What most joints have is all joints', where it is likely and about as large."""
        alike_by = self.noisy.thresholds.diagnosis.alike
        for term in tuple(self.doubtful):
            if not CATALOGUE[term.effect].shared or self.support[term.key].odds < worth:
                continue
            alike = [each for each in self.claimed if each.effect == term.effect]
            usual = float(np.median([sum(each.shape[1:]) for each in alike])) if alike else 0.0
            near = usual / alike_by < sum(term.shape[1:]) < usual * alike_by
            if near and len(alike) > sum(t.effect == term.effect for t in self.doubtful):
                self.doubtful = [each for each in self.doubtful if each is not term]
                self.claimed.append(term)

    def judge_ordinary(self) -> None:
        """Parts that every machine has, each stated and some of them named."""
        model = self.state.model
        deviations = np.sqrt(model.variances)
        for hypothesis, span in model.placed:
            ordinary = hypothesis.ordinary and hypothesis.term.effect not in _UNNAMED
            if not ordinary or not model.active[span].any():
                continue
            beta, std = model.beta[span], deviations[span]
            errors = float(np.sqrt(np.mean((beta / std) ** 2))) if std.all() else 0.0
            named = self._is_named(hypothesis, beta, errors)
            self.parts.append(
                Part(
                    term=hypothesis.term,
                    value=float(beta[0]),
                    std=float(std[0]),
                    negligible=not named,
                )
            )

    def _is_named(self, hypothesis: Hypothesis, beta: np.ndarray, errors: float) -> bool:
        """Whether an ordinary part is named; it is claimed if so."""
        believed = self.noisy.thresholds.diagnosis
        if errors < believed.sure or hypothesis.key in self.support:
            return False
        term, others = hypothesis.term, list[Scored]()
        if term.effect == TRUST:
            far = float(np.sqrt(np.sum(hypothesis.precision * beta**2)))
            if far <= believed.sure or (LinkInertials.id, term.place) in self.support:
                return False
            term = self._as_body(term)
        elif term.effect not in CATALOGUE or (
            term.effect == TorqueGain.id and abs(float(beta[0])) <= believed.scale_off
        ):
            return False
        else:
            others = in_place_of(self.posterior, self.state, hypothesis)
        odds = 0.5 * errors**2 - 1.0  # over nothing of it, by a prior of its own size
        seen = held_out_support(self.fit, self.start, term, odds, len(others))
        if seen.size <= believed.matters:
            return False
        return self._take(term, seen, others, sure=True)

    def _as_body(self, term: Term) -> Term:
        """A body that is not within trust, as the finding that it is; in the fit too.

        There, what its rows say is no longer limited by a trust that it is beyond.
        """
        own = term_of(self.posterior.balances, CATALOGUE[LinkInertials.id], term.place, ())
        prior = term.prior if own is None else own.prior
        body = replace(term, effect=LinkInertials.id, prior=prior)
        self.fit = Fit(self.noisy, [body if each is term else each for each in self.fit.terms])
        return body

    def _take(self, term: Term, seen: Support, others: Sequence[Scored], *, sure: bool) -> bool:
        """Keep what was judged; whether it is claimed."""
        thresholds = self.noisy.thresholds
        self.support[term.key] = seen
        self.rivals[term.key] = tuple(each.weighed for each in others)
        sure = sure and confidence_of(thresholds, seen) >= thresholds.diagnosis.suspected
        (self.claimed if sure else self.doubtful).append(term)
        return sure

    def made(self) -> Identified:
        """All of it, what is claimed last in the fit."""
        wanted = {id(term) for term in self.claimed}
        nuisance = tuple(term for term in self.fit.terms if id(term) not in wanted)
        tried = self.posterior.tried.values()
        return Identified(
            balances=self.noisy,
            nuisance=nuisance,
            fit=Fit(self.noisy, [*nuisance, *self.claimed]),
            start=self.start,
            bodies=self.state.ordinary.bodies,
            support=self.support,
            rivals=self.rivals,
            tried=tuple(each.weighed for each in tried),
            ordinary=tuple(self.parts),
            doubtful=tuple(self.doubtful),
        )


def _may_be_nothing(model: Model, hypothesis: Hypothesis) -> bool:
    """Whether nothing at all lies within the intervals of a cause's coefficients."""
    if hypothesis.term.fixed:
        return False
    span = model.span(hypothesis)
    beta, own = model.beta[span], model.inverse[span, span]
    errors = np.sqrt(beta @ np.linalg.lstsq(own, beta, rcond=None)[0] / len(beta))
    first = abs(beta[0]) / max(float(np.sqrt(own[0, 0])), 1e-300)
    by_size = CATALOGUE[hypothesis.term.effect].size_first
    return bool(min(errors, first) < ERRORS if by_size else errors < ERRORS)
