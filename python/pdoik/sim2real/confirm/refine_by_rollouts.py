"""Figures of findings, moved to where a simulation of the arm agrees best with its recordings.

What recorded and simulated balances differ by is what the figures still get wrong; Gauss-Newton
steps move them, and a step stands only where the simulation comes nearer to the recordings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.errors import PdoikError
from pdoik.recordings import FloatArray

from ..effects import CATALOGUE, Effect
from ..findings import Estimate
from ..identify import Identified, values_and_errors
from ..motion import Key, Prepared
from ..regression import Fit, Term
from .rollouts import FAR, Arm, Rollout, Values, why_not


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


_ROUNDS = 4
_FARTHEST = 0.5  # of its value that a figure may move in one step


def refine_by_rollouts(
    arm: Arm,
    terms: Sequence[Term],
    start: Sequence[Values],
    errors: Sequence[Values],
    rounds: int = _ROUNDS,
) -> tuple[Rollout, Rollout]:
    """The rollout of the start and the best one: Gauss-Newton steps with Broyden's updates.

    The first derivatives are those of the regression's columns; every run then corrects them along
    its step, whether the step stood or not.

    Args:
        arm: what is simulated.
        terms: of the findings.
        start: their figures.
        errors: standard errors of these.
        rounds: steps at most.
    """
    first = best = arm.run(terms, start)
    figures = _figures(arm, terms, first, errors)
    if not figures:
        return first, best
    scale = np.array([each.scale for each in figures])
    A = _stacked(arm, figures, first.touched) * scale
    least = arm.prepared.study.thresholds.diagnosis.least_move
    for _ in range(rounds):
        y = best.flat
        weighted = A * np.minimum(1.0, FAR / np.maximum(np.abs(y), FAR))[:, None]
        move = np.linalg.solve(weighted.T @ A + np.eye(len(scale)), weighted.T @ y)
        most = np.array([each.most for each in figures]) / scale
        move = np.clip(move, -most, most)
        if np.all(np.abs(move * scale) < [least * each.error for each in figures]):
            break
        values = [dict(each) for each in best.values]
        for each, step in zip(figures, move * scale, strict=True):
            moved = values[each.term][each.name] + float(step)
            values[each.term][each.name] = float(np.clip(moved, each.lower, each.upper))
        try:
            there = arm.run(terms, values)
        except PdoikError:
            break
        A += np.outer(y - there.flat - A @ move, move) / float(move @ move)
        if there.cost < best.cost:
            best = there
    return first, best


@dataclass(frozen=True, kw_only=True, eq=False)
class _Figure:
    """One parameter of one term."""

    term: int
    name: str
    error: float
    scale: float  # how far it may be off by its nature, compared with what data say
    most: float  # that it may move in one step
    lower: float
    upper: float
    slope: dict[Key, FloatArray]  # change of the balances per unit


def _figures(
    arm: Arm, terms: Sequence[Term], at: Rollout, errors: Sequence[Values]
) -> list[_Figure]:
    result, kept = [], arm.prepared.study.thresholds.diagnosis.little
    for i, term in enumerate(terms):
        if not CATALOGUE[term.effect].refined:
            continue
        known = {each.name: each for each in CATALOGUE[term.effect].parameters}
        for name, value in at.values[i].items():
            if name in known and known[name].chosen:
                continue
            error = errors[i].get(name, 0.0)
            lower = known[name].lower if name in known else -np.inf
            upper = known[name].upper if name in known else np.inf
            if lower == 0.0 < value:
                lower = kept * value  # no sprung joint has a spring of nothing
            room = [0.5 * abs(value - bound) for bound in (lower, upper) if value != bound]
            h = min([max(0.02 * abs(value), 0.3 * error), *room])
            slope = _slope(arm, term, at.values[i], name, h)
            if slope:
                result.append(
                    _Figure(
                        term=i,
                        name=name,
                        error=error,
                        scale=max(3.0 * error, 0.2 * abs(value), 1e-9),
                        most=max(3.0 * error, _FARTHEST * abs(value)),
                        lower=lower,
                        upper=upper,
                        slope=slope,
                    )
                )
    return result


def _stacked(arm: Arm, figures: Sequence[_Figure], keys: frozenset[Key]) -> FloatArray:
    """Slopes on the rows that count, in sigmas, (rows, figures)."""
    data = arm.data
    parts = []
    for key, at in arm.rows.items():
        if key not in keys:
            continue
        none = np.zeros(len(at))
        each = [f.slope[key][at] if key in f.slope else none for f in figures]
        parts.append(np.stack(each, axis=1) / data.sigma[key])
    return np.concatenate(parts)


def _slope(arm: Arm, term: Term, values: Values, name: str, h: float) -> dict[Key, FloatArray]:
    """Change of a term's contribution per unit of one figure, (N,) for each balance."""
    effect = CATALOGUE[term.effect]
    if h <= 0.0:
        return {}
    sides = []
    for sign in (1.0, -1.0):
        moved = dict(values)
        moved[name] += sign * h
        shape, beta = effect.coefficients(moved, term.shape)
        if not effect.admissible(beta) and not effect.fixed:
            return {}
        sides.append({k: c @ beta for k, c in arm.data.compute(effect, term.place, shape).items()})
    return {
        key: (sides[0][key] - sides[1][key]) / (2.0 * h)
        for key in sides[0]
        if key in sides[1]
        and np.isfinite(sides[0][key] - sides[1][key]).all()
        and np.any(sides[0][key] != sides[1][key])
    }
