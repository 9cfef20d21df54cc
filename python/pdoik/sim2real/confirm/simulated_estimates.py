"""Figures of the findings, moved by what simulating the whole arm with them leaves."""

from __future__ import annotations

import numpy as np

from pdoik.errors import PdoikError

from ..effects import CATALOGUE, Effect
from ..findings import Estimate
from ..identify import Identified, values_and_errors
from ..motion import Prepared
from ..regression import Fit, Term
from .refine_by_rollouts import refine_by_rollouts
from .rollouts import Arm, Rollout, Values, why_not


def simulated_estimates(
    prepared: Prepared,
    state: Identified,
    terms: tuple[Term, ...],
    estimates: dict[int, dict[str, Estimate]],
) -> tuple[dict[int, dict[str, Estimate]], str]:
    """Estimates of the terms after simulation, and what was done, in words.

    A quarter of each correction is added to its figure's error, or what an effect does not take of
    it: where regression and simulation are as good, the middle.

    Args:
        prepared: the study.
        state: whose fit the terms are of; figures simulated before are where this begins.
        terms: accepted.
        estimates: by the terms' index, of the regression.
    """
    if not terms:
        return estimates, ""
    reason = why_not(prepared.study)
    if reason:
        return estimates, f"The figures were not refined by simulating the arm: {reason}."
    values, errors = values_and_errors(estimates)
    least = prepared.study.thresholds.diagnosis
    start = [state.simulated.get(t.key, v) for t, v in zip(terms, values, strict=True)]
    try:
        arm = Arm(prepared, state.fit)
        first, best = refine_by_rollouts(arm, terms, start, errors)
    except (PdoikError, ValueError) as error:
        return estimates, f"The figures were not refined by simulating the arm: {error}."
    if best.cost > least.rare * max(_regression_loss(state.fit, first), 1.0):
        return estimates, (
            "The figures were not refined by simulating the arm: the simulation of its commands"
            f" departs from its recordings by {np.sqrt(best.cost):.2g} times the noise."
        )
    seconds = sum(float(r.time[-1]) for r in arm.recordings)
    said = (
        f"The figures were refined by simulating the arm for {seconds:.0f} s of its commands: the"
        f" loss went from {first.cost:.3g} to {best.cost:.3g} squared noise floors."
    )
    moved = {
        i: _moved(estimates[i], best.values[i], CATALOGUE[term.effect], least.own_error)
        for i, term in enumerate(terms)
    }
    return moved, said


def _regression_loss(fit: Fit, rollout: Rollout) -> float:
    squares = np.concatenate([fit.residual(key) for key in fit.design if key in rollout.touched])
    return float(np.mean(squares**2))


def _moved(
    before: dict[str, Estimate], values: Values, effect: Effect, own_error: float
) -> dict[str, Estimate]:
    taken, left = effect.corrected, max(own_error, 1.0 - effect.corrected)
    moved = {}
    for name, each in before.items():
        away = values[name] - each.value
        value = each.value + taken * away
        moved[name] = each.moved(value).wider(left * abs(away))
    return moved
