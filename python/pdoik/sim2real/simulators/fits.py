"""Figures fitted to a log by simulating candidates: sizes of errors, first lines, Gauss-Newton."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..simulation.stepper import SimulationError
from ..study.recording import FloatArray
from .blocks import Blocks
from .candidates import Knob, Term, Values, baseline, gains_of_all
from .experiment import Experiment
from .property import Scales
from .sensitivities import Sensitivities, knobs_of, scales_of, sensitivities

_STEPS = 3  # of Gauss-Newton within a round
_HALVINGS = 4
_OCTAVES = 6  # that gains may be off by, up or down, for the first lines to be laid well
_SCANS = 3  # of both, at most
_FINEST = {"q": 1e-5, "tau": 1e-3}
"""What no sensor shows [rad], [N m]: noise of logs that have none, those of simulators."""


def noise_of(experiment: Experiment) -> FloatArray:
    """White noise of each channel, from third differences of neighbouring samples, (C,)."""
    found = []
    for channel, k in experiment.channels:
        squares = []
        for each in experiment.recordings:
            values = getattr(each, channel)[:, k]
            squares.append(float(np.median(np.diff(values, 3) ** 2)) / 0.455 / 20.0)
        found.append(max(np.sqrt(np.mean(squares)), _FINEST[channel]))
    return np.array(found)


def sigma_of(experiment: Experiment, shown: FloatArray, noise: FloatArray) -> FloatArray:
    """What each channel leaves now, (C,): by that its errors count."""
    left = np.sqrt(np.mean((experiment.measured - shown) ** 2, axis=0))
    return np.maximum(np.maximum(left, noise), 1e-9)


def lines(
    experiment: Experiment,
    values: Values,
    knobs: Sequence[Knob],
    scales: Sequence[Scales],
    noise: FloatArray,
) -> tuple[Sensitivities, FloatArray, Blocks]:
    """About a candidate: how what it shows changes, what it leaves (C,), its normal equations."""
    about = sensitivities(experiment, values, knobs, scales)
    sigma = sigma_of(experiment, about.shown, noise)
    return about, sigma, Blocks.of(experiment, about, sigma)


def fitted(
    experiment: Experiment,
    about: Sensitivities,
    blocks: Blocks,
    chosen: Sequence[Term],
    sigma: FloatArray,
    scales: Sequence[Scales],
) -> dict[Knob, float]:
    """Gauss-Newton with halved steps; the first derivatives are there already."""
    mine = knobs_of(chosen)
    where = [about.knobs.index(knob) for knob in mine]
    start = np.zeros(len(about.knobs))
    start[where] = about.at[where]
    goal = blocks.solve(where)

    values = about.values(start)
    best = cost(experiment, values, sigma)
    for step in range(_STEPS):
        move, share = goal - start, 1.0
        for _ in range(_HALVINGS):
            now = cost(experiment, about.values(start + share * move), sigma)
            if now < best:
                break
            share *= 0.5
        else:
            break
        gained = best - now
        best, values = now, about.values(start + share * move)
        if not mine or gained < 1e-4 * best or step == _STEPS - 1:
            break
        about = sensitivities(experiment, values, mine, scales)
        start = about.at.copy()
        goal = Blocks.of(experiment, about, sigma).solve(range(len(mine)))
    return values


def far_gains(experiment: Experiment, noise: FloatArray) -> list[dict[Knob, float]]:
    """Gains of all drives about which to lay lines, where those that they were given are far off.

    About gains that are many times too high, positions hardly change with anything. A drive's
    stiffness and its damping are looked for by factors of two, together and apart; then both are
    fitted, which may come nearer, or to a place where they stand for friction.
    """
    sigma = sigma_of(experiment, experiment.run({}), noise)
    factors = [2.0**k for k in range(-_OCTAVES, _OCTAVES + 1) if k]
    shared = gains_of_all(experiment.user)
    values: dict[Knob, float] = {}
    best = cost(experiment, values, sigma)
    for _ in range(_SCANS):
        before = best
        for term in shared:
            now = {k: values.get(k, baseline(experiment.user, k)) for k in term.knobs}
            tried = [{**values, **{k: f * now[k] for k in now}} for f in factors]
            costs = [cost(experiment, each, sigma) for each in tried]
            k = int(np.argmin(costs))
            if costs[k] < best:
                best, values = costs[k], tried[k]
        if best == before:
            break
    if not values:
        return []
    scales = scales_of(experiment, values)
    about, sigma, blocks = lines(experiment, values, knobs_of(shared), scales, noise)
    return [values, fitted(experiment, about, blocks, shared, sigma, scales)]


def cost(experiment: Experiment, values: Values, sigma: FloatArray) -> float:
    """Sum of squared errors over sigma (C,); infinite where a candidate is unstable."""
    try:
        shown = experiment.run(values)
    except SimulationError:
        return np.inf
    return float((((experiment.measured - shown) / sigma) ** 2).sum())
