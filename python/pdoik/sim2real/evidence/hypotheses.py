"""Every hypothesis that was tried, with its held-out score and what became of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..motion.place import Place
from ..regression.fit import Fit, TermKey
from ..regression.trial import Trial, activity, cross_validated, held_out_squares, without
from ..report.data import Hypothesis
from ..report.words import effect_name

if TYPE_CHECKING:
    from ..infer.conclude import Examination

_DRAWS = 400


def hypotheses_of(examination: Examination) -> tuple[Hypothesis, ...]:
    """In the order they were first tried, each once.

    The score is what a hypothesis gains beside everything that was found, on blocks of time that
    its fit did not see: of an accepted one what would be lost without it, of another what it would
    add.
    """
    state = examination.state
    found = {term.key for terms in examination.terms for term in terms}
    accepted = {term.key: term for term in state.accepted}
    rivals = {
        trial.term.key: effect_name(term.effect)
        for term in state.accepted
        for trial in state.level.get(term.key, ())
    }
    first: dict[TermKey, Trial] = {}
    for trial in (*state.tried, *(t for trials in state.level.values() for t in trials)):
        first.setdefault(trial.term.key, trial)
    held = held_out_squares(state.fit)
    rng = np.random.default_rng(0)
    result = []
    for name, alone in first.items():
        if name in accepted:
            trial = without(state, accepted[name])
        else:
            trial = cross_validated(state, alone.term, held)
        score = float(np.clip(trial.share, -1.0, 1.0))
        tiny = name in accepted and name not in found
        result.append(
            Hypothesis(
                effect=name[0],
                place=place_words(examination, name[1]) + " (tiny)" * tiny,
                score=score,
                interval95=_interval(state.start, trial, score, rng),
                accepted=name in found,
                reason="" if name in found else _reason(alone, trial, tiny, rivals.get(name)),
            )
        )
    return (*result, *_events(examination, set(first)))


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


def _interval(
    start: Fit, trial: Trial, score: float, rng: np.random.Generator
) -> tuple[float, float]:
    """Of the gain's share, by a bootstrap over blocks of time; centred on the score."""
    began = np.zeros(len(trial.blocks))
    acting = activity(start, trial.term)[1]
    for key in trial.term.columns:
        rows = start.rows[key][acting[key]]
        squares = start.target[key][acting[key]] ** 2
        began += np.bincount(start.balances.block[rows], squares, minlength=len(began))
    used = np.flatnonzero((began > 0.0) | (trial.blocks != 0.0))
    if len(used) < 2:
        return score, score
    drawn = used[rng.integers(0, len(used), (_DRAWS, len(used)))]
    shares = trial.blocks[drawn].sum(axis=1) / np.maximum(began[drawn].sum(axis=1), 1e-12)
    middle = trial.blocks.sum() / max(float(began.sum()), 1e-12)
    low, high = np.quantile(shares, (0.025, 0.975)) - middle + score
    return float(np.clip(low, -1.0, 1.0)), float(np.clip(high, -1.0, 1.0))


def _reason(alone: Trial, trial: Trial, tiny: bool, rival: str | None) -> str:
    """Why it was not accepted; `alone` is how it did when it was first tried."""
    if tiny:
        return "less than the recordings' sampling and the controller's ticks can tell"
    if rival is not None:
        return f"data cannot tell it from {rival}; listed as its equivalent"
    if alone.significant and not trial.significant:
        share = f"{100 * min(alone.share, 1.0):.2g} %"
        return f"would have gained {share} at first; beside what was found it gains nothing"
    if trial.t == 0.0:
        return "the data want another multiple of it: it is something else"
    if trial.gain <= 0.0:
        return "makes data worse that it was not fitted to"
    return (
        "no gain beyond chance"
        if trial.t < trial.thresholds.least_t
        else "real, but too little to matter"
    )
