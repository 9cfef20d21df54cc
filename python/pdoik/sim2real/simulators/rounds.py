"""Rounds of choosing properties about a candidate and simulating it, from where gains may be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..study.recording import FloatArray
from ..thresholds.simulators import SimulatorThresholds
from .candidates import Knob, Term, Values, terms_of
from .experiment import Experiment
from .fits import cost, far_gains, fitted, lines, sigma_of
from .property import Scales
from .selection import Selection
from .sensitivities import knobs_of, scales_of
from .vocabulary import PROPERTIES

_ROUNDS = 4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """Where rounds came to."""

    chosen: tuple[Term, ...]
    values: dict[Knob, float]
    terms: tuple[Term, ...]  # that may be chosen: those that nothing real has are not
    scales: tuple[Scales, ...]


def searched(
    experiment: Experiment,
    noise: FloatArray,
    limits: SimulatorThresholds,
    say: Callable[[str], None],
    *,
    same_step: bool,
) -> Found:
    """The best of what rounds come to, by Schwarz's criterion.

    They begin at the user's model; where its gains are far off, at gains that do better. Lines laid
    at different gains lead to different places: friction and stiffness hide one another.
    """
    found = [
        _rounds(experiment, begin, noise, limits, say, same_step=same_step)
        for begin in far_gains(experiment, noise) or [{}]
    ]
    if len(found) == 1:
        return found[0]
    if not same_step:
        experiment.allow_for_step({})
    sigma = sigma_of(experiment, experiment.run({}), noise)
    count = int(experiment.block.max()) + 1

    def criterion(each: Found) -> float:
        left = cost(experiment, each.values, sigma)
        return count * float(np.log(left)) + len(knobs_of(each.chosen)) * float(np.log(count))

    return min(found, key=criterion)


def _rounds(
    experiment: Experiment,
    begin: Values,
    noise: FloatArray,
    limits: SimulatorThresholds,
    say: Callable[[str], None],
    *,
    same_step: bool,
) -> Found:
    terms = terms_of(experiment.user)
    knobs, scales = knobs_of(terms), scales_of(experiment, begin)
    chosen = tuple(term for term in terms if set(term.knobs) <= begin.keys())
    values = dict(begin)
    for k in range(1, _ROUNDS + 1):
        if not same_step:
            experiment.allow_for_step(values)
        about, sigma, blocks = lines(experiment, values, knobs, scales, noise)
        selection = Selection(blocks, knobs, terms, limits)
        before, chosen = chosen, selection.choose(chosen)
        values = fitted(experiment, about, blocks, chosen, sigma, scales)
        unreal = {term for term in chosen if is_unreal(term, values)}
        if unreal:
            terms = tuple(term for term in terms if term not in unreal)
            chosen = tuple(term for term in chosen if term not in unreal)
            values = fitted(experiment, about, blocks, chosen, sigma, scales)
        say(f"round {k}: {len(chosen)} properties differ")
        if set(before) == set(chosen):
            break
    return Found(chosen=chosen, values=values, terms=terms, scales=scales)


def is_unreal(term: Term, values: Values) -> bool:
    """Whether it was pushed to a value that nothing real has: no mass, an endless gain."""
    words = ((PROPERTIES[knob.property], values[knob]) for knob in term.knobs if knob in values)
    return any(
        word.ends and word.coordinate(value) <= word.lowest * (1.0 + 1e-6) for word, value in words
    )
