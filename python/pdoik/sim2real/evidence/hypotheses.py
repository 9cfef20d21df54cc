"""Every hypothesis that was tried, with its held-out score and what became of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..identify import Weighed, held_out_support
from ..motion import Place
from ..regression import TermKey
from ..report import Hypothesis, effect_name

if TYPE_CHECKING:
    from ..infer import Examination

_SHOWN = 60  # of the causes that were compared and not taken, the likeliest


def hypotheses_of(examination: Examination) -> tuple[Hypothesis, ...]:
    """What is claimed, then what was compared and is not, the likeliest first.

    The score is what a hypothesis gains given everything that is in the model, on rows that its
    coefficients were not learnt from: of one in the model what would be lost without it, of another
    what it would add.
    """
    state = examination.state
    found = {term.key for terms in examination.terms for term in terms}
    inside = {t.key: t for t in state.accepted}
    others = {
        rival.term.key: effect_name(term.effect)
        for term in state.accepted
        for rival in state.rivals.get(term.key, ())
    }
    listed = [
        (key, Weighed(term=t, log_odds=state.support[key].odds))
        for key, t in inside.items()
        if key in state.support
    ]
    rest = sorted(state.tried, key=lambda each: -each.log_odds)
    listed += [(t.term.key, t) for t in rest if t.term.key not in inside][:_SHOWN]
    result = []
    for key, each in listed:
        if key in inside:
            support = state.support[key]
        else:
            wider = state.fit.extended(each.term)
            support = held_out_support(wider, state.start, each.term, each.log_odds)
        score = float(np.clip(support.gain, -1.0, 1.0))
        error = abs(support.gain / support.t) if support.t else 0.0
        tiny = key in inside and key not in found
        result.append(
            Hypothesis(
                effect=key[0],
                place=place_words(examination, key[1]) + " (tiny)" * tiny,
                score=score,
                interval95=(
                    float(np.clip(score - 1.96 * error, -1.0, 1.0)),
                    float(np.clip(score + 1.96 * error, -1.0, 1.0)),
                ),
                accepted=key in found,
                reason="" if key in found else _reason(each, score, tiny, others.get(key)),
            )
        )
    return (*result, *_events(examination, {key for key, _ in listed}))


def _events(examination: Examination, listed: set[TermKey]) -> list[Hypothesis]:
    """Findings that were looked for in the residual itself, such as contacts."""
    found = zip(examination.diagnosis.findings, examination.terms, strict=True)
    return [
        Hypothesis(
            effect=finding.effect,
            place=place_words(examination, terms[0].place),
            score=finding.evidence.validation_gain,
            interval95=finding.evidence.interval95,
            accepted=True,
        )
        for finding, terms in found
        if terms and terms[0].key not in listed
    ]


def place_words(examination: Examination, place: Place) -> str:
    """Joints, or the link, or the base; and when, for a window."""
    prepared = examination.prepared
    words = ", ".join(prepared.study.joints[j] for j in place.joints) or "base"
    if place.link is not None and prepared.body is not None:
        words = prepared.body.links[place.link]
    if place.held is not None:
        words = place.held.label
    if place.window is not None:
        words += f", {place.window[0]:.1f} to {place.window[1]:.1f} s of {place.recording}"
    return words


def _reason(each: Weighed, score: float, tiny: bool, rival: str | None) -> str:
    """Why it is not claimed."""
    if tiny:
        return "less than the recordings' sampling and the controller's ticks can show"
    if rival is not None:
        return f"nearly as likely as {rival}; listed as its equivalent"
    if each.log_odds == -np.inf:
        return "the data want figures of it that cannot be: it is something else"
    if score <= 0.0:
        return "given what is in the model it gains nothing on rows it was not fitted to"
    if each.log_odds < 0.0:
        return "less likely than nothing: its evidence does not pay its price"
    return "likely when it was tried; given what was taken it is too little to be claimed"
