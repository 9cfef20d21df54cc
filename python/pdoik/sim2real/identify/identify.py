"""From a study's balances to causes: one posterior, linearised again where a cause asks for it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..effects import CATALOGUE
from ..effects.inertial import LinkInertials
from ..effects.torque_gain import TorqueGain
from ..findings import Support
from ..motion.balances import Balances
from ..motion.prepare import Prepared
from ..regression.fit import Fit, Term, TermKey, term_of
from ..study.recording import FloatArray
from .confidence import confidence_of
from .hypothesis import Hypothesis, peculiar
from .identified import Identified, Part, Rival, Tried
from .model import Model
from .ordinary import DAYS, TRUST
from .posterior import Candidate, Posterior, State, likeliest
from .relinearised import relinearised
from .support import held_out_support

_ROUNDS = 4  # of linearisation
_WITHIN = 1.96  # errors of a 95 % interval
_FEW = 6  # causes after which one beginning is left

Tell = Callable[[str, str, float], None]


@dataclass(frozen=True, slots=True)
class _Told:
    """Says what is taken, with the share of the work that is done."""

    say: Tell
    share: float

    def __call__(self, text: str) -> None:
        self.say("name", text, self.share)


def identify(prepared: Prepared, say: Tell) -> tuple[Prepared, Identified]:
    """Causes of a study's mismatch, and the study as it is linearised beside them."""
    chosen: list[Hypothesis] = []
    for turn in range(_ROUNDS):
        posterior = Posterior.of(prepared.fit, _Told(say, 0.2 + 0.1 * turn))
        state = _likeliest(posterior, prepared, chosen)
        other = relinearised(prepared, posterior.fit_of(state.model))
        if other is None:
            break
        say("name", "once more, linearised beside what was found", 0.2 + 0.1 * turn)
        prepared = other
        chosen = _anew(prepared, state)
    return prepared, _identified(prepared, posterior, state)


def _likeliest(posterior: Posterior, prepared: Prepared, chosen: list[Hypothesis]) -> State:
    """From two beginnings: a model as wrong as drawings are, and one that is nearly right.

    The likelier after a few causes goes on; at its end the other share is asked again.
    """
    believed = prepared.study.thresholds.identify
    told = prepared.study.trust.rigid_body
    most = believed.bodies if told is None else told
    shares = [most]
    if prepared.body is not None and most > believed.good_bodies:
        shares.append(believed.good_bodies)
    few = len(chosen) + _FEW
    begun = [posterior.grown(posterior.begun(share, chosen), few) for share in shares]
    state = posterior.grown(likeliest(begun))
    for share in shares:
        other = posterior.with_bodies(state, share)
        if share != state.ordinary.bodies and other.log_posterior > state.log_posterior:
            return posterior.grown(other)
    return state


def _anew(prepared: Prepared, state: State) -> list[Hypothesis]:
    """What was chosen, on other balances."""
    found = []
    for each in state.chosen:
        effect = CATALOGUE[each.term.effect]
        term = term_of(prepared.fit, effect, each.term.place, each.term.shape)
        if term is not None:
            fresh = peculiar(prepared.fit, term)
            found.append(replace(fresh, log_odds=each.log_odds))
    return found


def _identified(prepared: Prepared, posterior: Posterior, state: State) -> Identified:
    """The model of a state, and which of its parts are claimed."""
    model = state.model
    at = [
        (h, span)
        for h, span in zip(model.hypotheses, model.spans, strict=True)
        if model.active[span].any()
    ]
    noisy = prepared.fit.with_noise({key: model.weight(key) ** -0.5 for key in model.noise})
    fit, start = Fit(noisy, [h.term for h, _ in at]), Fit(noisy, ())
    support: dict[TermKey, Support] = {}
    claimed: list[Term] = []
    doubtful: list[Term] = []
    rivals: dict[TermKey, tuple[Rival, ...]] = {}
    judged = posterior.judged(state)
    peculiar_ones = [hypothesis.term for hypothesis, _, _ in judged]
    for hypothesis, odds, others in judged:
        seen = held_out_support(fit, start, hypothesis.term, odds, len(others), peculiar_ones)
        support[hypothesis.key] = seen
        rivals[hypothesis.key] = _as_rivals(others)
        sure = _is_claimed(noisy, seen) and not _may_be_nothing(model, hypothesis)
        (claimed if sure else doubtful).append(hypothesis.term)
    parts: list[Part] = []
    instead: dict[int, Term] = {}  # bodies that are not within trust
    deviations = np.sqrt(model.variances)
    for hypothesis, span in at:
        if hypothesis.term.effect == DAYS or not hypothesis.ordinary:
            continue
        beta, std = model.beta[span], deviations[span]
        errors = float(np.sqrt(np.mean((beta / std) ** 2))) if std.all() else 0.0
        named = hypothesis.key not in support and _is_sure(noisy, hypothesis, beta, errors)
        if hypothesis.term.effect == TRUST:
            named = named and _is_beyond(noisy, hypothesis, beta)
            if named:
                body = replace(hypothesis.term, effect=LinkInertials.id)
                whole = [body if t is hypothesis.term else t for t in fit.terms]
                seen = held_out_support(Fit(noisy, whole), start, body, 0.5 * errors**2 - 1.0)
                named = body.key not in support and seen.size > noisy.thresholds.identify.matters
                if named:
                    support[body.key] = seen
                    instead[id(hypothesis.term)] = body
                    claimed.append(body)
        elif named:
            odds = 0.5 * errors**2 - 1.0  # beside nothing of it, by a prior of its own size
            others = posterior.in_place_of(state, hypothesis)
            seen = held_out_support(fit, start, hypothesis.term, odds, len(others))
            named = seen.size > noisy.thresholds.identify.matters
            if named:
                rivals[hypothesis.key] = _as_rivals(others)
                support[hypothesis.key] = seen
                claimed.append(hypothesis.term)
        parts.append(
            Part(
                term=hypothesis.term,
                value=float(beta[0]),
                std=float(std[0]),
                negligible=not named,
            )
        )
    claimed, unsure = _parted_by_confidence(noisy, claimed, support)
    wanted = {id(term) for term in claimed}
    nuisance = tuple(
        term for term in (instead.get(id(h.term), h.term) for h, _ in at) if id(term) not in wanted
    )
    return Identified(
        balances=noisy,
        nuisance=nuisance,
        fit=Fit(noisy, [*nuisance, *claimed]),
        start=start,
        bodies=state.ordinary.bodies,
        support=support,
        rivals=rivals,
        tried=tuple(
            Tried(term=hypothesis.term, log_odds=odds)
            for hypothesis, odds in posterior.tried.values()
        ),
        ordinary=tuple(parts),
        doubtful=(*doubtful, *unsure),
    )


def _as_rivals(others: Sequence[Candidate]) -> tuple[Rival, ...]:
    return tuple(Rival(term=each.hypothesis.term, log_odds=each.log_odds) for each in others)


def _is_claimed(balances: Balances, seen: Support) -> bool:
    """Whether a peculiar cause is likely, and large beside what nothing explains."""
    believed = balances.thresholds.identify
    return seen.log_odds >= believed.worth and seen.size > believed.matters_more


def _is_beyond(balances: Balances, hypothesis: Hypothesis, beta: FloatArray) -> bool:
    """Whether a body is farther from the model's than it was trusted to be."""
    far = float(np.sqrt(np.sum(hypothesis.precision * beta**2)))
    return far > balances.thresholds.identify.beyond


def _may_be_nothing(model: Model, hypothesis: Hypothesis) -> bool:
    """Whether nothing at all lies within the intervals of a cause's coefficients."""
    if hypothesis.term.fixed:
        return False
    at = next(i for i, each in enumerate(model.hypotheses) if each is hypothesis)
    span = model.spans[at]
    beta, own = model.beta[span], model.inverse[span, span]
    errors = np.sqrt(beta @ np.linalg.lstsq(own, beta, rcond=None)[0] / len(beta))
    first = abs(beta[0]) / max(float(np.sqrt(own[0, 0])), 1e-300)
    by_size = CATALOGUE[hypothesis.term.effect].size_first
    return bool(min(errors, first) < _WITHIN if by_size else errors < _WITHIN)


def _is_sure(balances: Balances, hypothesis: Hypothesis, beta: FloatArray, errors: float) -> bool:
    """Whether an ordinary part surely is not nothing."""
    believed = balances.thresholds.identify
    if errors < believed.sure:
        return False
    return hypothesis.term.effect != TorqueGain.id or abs(float(beta[0])) > believed.scale_off


def _parted_by_confidence(
    balances: Balances, terms: list[Term], support: dict[TermKey, Support]
) -> tuple[list[Term], list[Term]]:
    """What is sure enough to be claimed, and the rest."""
    thresholds = balances.thresholds
    least = thresholds.confidence.suspected
    sure = [confidence_of(thresholds, support[t.key]) >= least for t in terms]
    return (
        [t for t, is_sure in zip(terms, sure, strict=True) if is_sure],
        [t for t, is_sure in zip(terms, sure, strict=True) if not is_sure],
    )
