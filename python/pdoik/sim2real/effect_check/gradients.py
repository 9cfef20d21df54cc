"""Can the search move the figures that enter nonlinearly?"""

from __future__ import annotations

import numpy as np

from pdoik.recordings import FloatArray

from ..motion import Balances, Place, Shape
from ..simulation import JointTorque, StatefulLaw
from .outcome import Outcome, at_most, not_applicable
from .trial import Trial

GRADIENTS = "gradients"
STIFFNESS = "stiffness of its law"
SMOOTH = 0.1  # relative difference of two central differences
STIFF = 1.01  # what a law may change with position, by what it says itself
_STEP = 0.02  # of the room for the parameter, or of its size where that is less
_TINY = 1e-6  # of the law's own scale [rad]


def gradients(trial: Trial) -> Outcome:
    """Largest relative difference of the columns' central differences at a step and at half."""
    effect, place = trial.effect, trial.place
    if not trial.shape or place is None:
        return not_applicable(GRADIENTS, "all of its figures are linear")
    if effect.costly:
        return not_applicable(GRADIENTS, "its shapes are tried on a grid, not by their slope")
    columns = trial.plain.compute(effect, place, trial.shape)
    if not columns:
        return not_applicable(GRADIENTS, "it has no columns for the arm's channels")
    worst, tried = 0.0, 0
    for i, (low, high) in enumerate(effect.shape_bounds(trial.shape)):
        here = trial.shape[i]
        step = _STEP * min(high - low, abs(here) or np.inf)
        if high - low <= 1e-9:
            continue
        step = min(step, here - low, high - here) if low < here < high else step
        tried += 1
        coarse, fine = (_slope(trial.plain, trial, place, i, h) for h in (step, 0.5 * step))
        size = float(np.sqrt(max(np.mean(coarse**2), np.mean(fine**2))))
        change = float(np.sqrt(np.mean((coarse - fine) ** 2)))
        worst = max(worst, change / size if size > 0.0 else np.inf)  # nothing to search by
    if not tried:
        return not_applicable(GRADIENTS, "its shape is what it is: nothing is searched")
    return at_most(GRADIENTS, worst, SMOOTH, f"{tried} nonlinear figure{'s' * (tried > 1)}")


def stiffness(trial: Trial) -> Outcome:
    """How much faster than it says a law with a memory changes with position: steps rest on it."""
    laws = [
        part.law
        for part in (trial.parts if trial.place is not None else ())
        if isinstance(part, JointTorque) and isinstance(part.law, StatefulLaw)
    ]
    if not laws:
        return not_applicable(STIFFNESS, "no law of it has a memory")
    return at_most(STIFFNESS, max(map(_by_said, laws)), STIFF, "steepest change by the said")


def _slope(b: Balances, trial: Trial, place: Place, i: int, step: float) -> FloatArray:
    """Central difference of columns times coefficients over the i-th entry of the shape."""

    def at(change: float) -> FloatArray:
        shape: Shape = tuple(value + change * (k == i) for k, value in enumerate(trial.shape))
        columns = b.compute(trial.effect, place, shape)
        return np.concatenate([columns[key] @ trial.beta for key in sorted(columns)])

    return np.asarray((at(step) - at(-step)) / (2.0 * step))


def _by_said(law: StatefulLaw) -> float:
    """Largest finite difference over positions moved to and fro, by the law's stiffness."""
    fresh = law.fresh()
    said = abs(fresh.stiffness)
    if said == 0.0:
        return np.inf
    q, before, steepest = 0.0, fresh(0.0, 0.0, 0.0, 0.0), 0.0
    for way in np.repeat([1.0, -1.0, 1.0], 400):
        dq = 1e-4 * way
        q += dq
        fresh.advance(q, dq / 1e-3, 1e-3)
        now = fresh(0.0, q, dq / 1e-3, 0.0)
        steepest, before = max(steepest, abs(now - before) / abs(dq)), now
    return steepest / said
