"""Figures, coefficients and bounds that must agree with one another."""

from __future__ import annotations

import math

import numpy as np

from pdoik.errors import PdoikError
from pdoik.recordings import FloatArray

from ..effects import Effect
from ..motion import Shape
from .outcome import Outcome, at_most, none_of, not_applicable
from .trial import Trial

THERE_AND_BACK = "there and back"
BOUNDS = "bounds"
NOTHING = "at zero nothing"
ROUNDING = 1e-8  # relative
SAME_MOTION = 5e-3  # of the torques' rms: a gear that gives nothing is still another body
_DRAWS = 200
_OUTSIDE = 0.1  # of a bound's size, that a figure is put beyond it


def there_and_back(trial: Trial) -> Outcome:
    """Largest relative change of figures read from coefficients and turned round again."""
    effect, rng = trial.effect, np.random.default_rng(0)
    worst, drawn = 0.0, 0
    for _ in range(_DRAWS):
        shape, beta = _drawn(trial, rng)
        if not effect.fixed and not effect.admissible(beta):
            continue
        drawn += 1
        values = effect.values(shape, beta)
        back_shape, back = effect.coefficients(values, shape)
        again = effect.values(back_shape, back)
        worst = max(worst, _change(values, again))
        worst = max(worst, _apart(np.array(shape), np.array(back_shape)))
        if len(beta) <= len(values) and not effect.shown_poorly and not effect.fixed:
            worst = max(worst, _apart(beta, back))
    read = effect.values(trial.shape, trial.beta)
    worst = max(worst, _change(dict(trial.example.values), read))
    if not drawn:
        return at_most(THERE_AND_BACK, math.inf, ROUNDING, "no draw near the example is admissible")
    return at_most(THERE_AND_BACK, worst, ROUNDING, f"{drawn} admissible draws")


def bounds(trial: Trial) -> Outcome:
    """How many bounds are out of order, or contradict the example, `admissible` or one another."""
    effect, example, wrong = trial.effect, trial.example, []
    for p in effect.parameters:
        if not p.lower <= p.upper:
            wrong.append(f"{p.name}: {p.lower:g} to {p.upper:g} is out of order")
        if p.chosen and not (math.isfinite(p.lower) and math.isfinite(p.upper)):
            wrong.append(f"{p.name} is chosen among a few values, but its bounds are not finite")
        value = example.values.get(p.name)
        if value is not None and not p.lower <= value <= p.upper:
            wrong.append(f"{p.name}: the example's {value:g} is outside {p.lower:g} to {p.upper:g}")
    known = {p.name for p in effect.parameters}
    if not known & set(example.values) and effect.refined:
        wrong.append(f"the example has none of its parameters: {', '.join(sorted(known))}")
    lower, upper = (each[: len(trial.beta)] for each in effect.bounds)
    if not (lower <= upper).all():
        wrong.append("bounds of the coefficients are out of order")
    if effect.fixed:
        lower, upper = np.full(1, -np.inf), np.full(1, np.inf)
    if not ((lower <= trial.beta) & (trial.beta <= upper)).all():
        wrong.append("the example's coefficients are outside their bounds")
    if not effect.fixed and not effect.admissible(trial.beta):
        wrong.append("the example's coefficients are not admissible")
    for i, side, limit in _finite(lower, upper):
        beta = trial.beta.copy()
        beta[i] = limit + side * _OUTSIDE * (abs(limit) or 1.0)
        if effect.admissible(beta):
            wrong.append(f"coefficient {i + 1} of {beta[i]:g} is admissible, beyond its bound")
    return none_of(BOUNDS, wrong + _shapes(effect, trial.shape), "all agree")


def nothing(trial: Trial) -> Outcome:
    """Torques of the arm with the effect at its zero less those without it, by their rms."""
    effect = trial.effect
    if trial.place is None or not trial.parts:
        return not_applicable(NOTHING, "it has no part in a simulation")
    if trial.example.nothing is not None:
        values = dict(trial.example.nothing)
    elif effect.fixed:
        return not_applicable(NOTHING, "its coefficient is 1: give its example `nothing`")
    else:
        values = effect.values(trial.shape, np.zeros(len(trial.beta)))
    shape = effect.coefficients({**trial.example.values, **values}, trial.shape)[0]
    try:
        parts = trial.parts_at({**trial.example.values, **values}, shape)
        logged = trial.arm.run((*trial.with_parts, *parts))
    except (PdoikError, ValueError, ZeroDivisionError) as error:
        return at_most(NOTHING, math.inf, SAME_MOTION, f"it cannot be simulated: {error}")
    plain = trial.plain_run.tau
    assert logged.tau is not None
    assert plain is not None
    share = float(np.sqrt(np.mean((logged.tau - plain) ** 2) / np.mean(plain**2)))
    said = ", ".join(f"{name} {value:g}" for name, value in list(values.items())[:3])
    return at_most(NOTHING, share, SAME_MOTION, f"change of the torques with {said}")


def _drawn(trial: Trial, rng: np.random.Generator) -> tuple[Shape, FloatArray]:
    """Shape and coefficients near the example's."""
    effect = trial.effect
    ends = [sorted(each) for each in effect.shape_bounds(trial.shape)]
    shape = tuple(float(rng.uniform(low, high)) for low, high in ends)
    if effect.fixed:
        return shape, np.ones(1)
    lower, upper = (each[: len(trial.beta)] for each in effect.bounds)
    beta = trial.beta * rng.uniform(0.5, 1.5, len(trial.beta))
    return shape, np.clip(beta, lower, upper)


def _change(values: dict[str, float], again: dict[str, float]) -> float:
    if set(values) != set(again):
        return math.inf
    return _apart(np.array(list(values.values())), np.array([again[name] for name in values]))


def _apart(one: FloatArray, other: FloatArray) -> float:
    if one.shape != other.shape:
        return math.inf
    if not one.size:
        return 0.0
    scale = max(float(np.max(np.abs(one))), 1e-9)
    each = np.maximum(np.abs(one), 1e-6 * scale)
    return float(np.max(np.abs(one - other) / each))


def _finite(lower: FloatArray, upper: FloatArray) -> list[tuple[int, float, float]]:
    ends = [(i, -1.0, float(each)) for i, each in enumerate(lower)]
    ends += [(i, 1.0, float(each)) for i, each in enumerate(upper)]
    return [each for each in ends if math.isfinite(each[2])]


def _shapes(effect: Effect, shape: Shape) -> list[str]:
    """What is wrong with the bounds that a shape is searched in."""
    found = effect.shape_bounds(shape)
    if len(found) != len(shape):
        return [f"shape_bounds gives {len(found)} pairs for a shape of {len(shape)}"]
    return [
        f"entry {i + 1} of the shape is searched in {low:g} to {high:g}, which has no {value:g}"
        for i, ((low, high), value) in enumerate(zip(found, shape, strict=True))
        if not low <= value <= high
    ]
