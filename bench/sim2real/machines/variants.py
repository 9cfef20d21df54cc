"""The diagnosis with one part switched off, and what else may take its place.

Where a part has a threshold, that is changed; the others are replaced in a process that does
nothing else. They are switched off by the bench: the tool has no such options.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.machines.regression import named_by_regression, named_stepwise
from pdoik.sim2real import diagnose
from pdoik.sim2real.identify import Model, Posterior
from pdoik.sim2real.thresholds import Thresholds

Method = Callable[[Path], list[dict[str, Any]]]

BEFORE = "before"
_estimated = Model._settle


def noise_of_ordinary_alone(model: Model, noise: Mapping[Any, float], rounds: int) -> None:
    """In the place of Model's: noise that ordinary physics leaves, never less with causes added."""
    ordinary = [each for each in model.hypotheses if each.ordinary]
    if len(ordinary) == len(model.hypotheses):
        _estimated(model, noise, rounds)
    else:
        model.noise = dict(noise or Model(model.data, ordinary).noise)
        model._solve(model._sums())


def bic(model: Model) -> float:
    """In the place of the evidence: the likelihood, less half the log of all rows per figure.

        log L - k / 2 log n
    with n the independent rows (Schwarz, Annals of Statistics 6(2), 1978). It has no priors on
    figures, so it takes friction's days and bodies as free as they are offered.
    """
    total, count = 0.0, sum(series.independent for series in model.data.series.values())
    for key, variance in model.noise.items():
        left, rows = model.left(key), model.data.series[key].independent
        total -= 0.5 * rows * (np.log(variance) + float(left @ left) / len(left) / variance)
    return total - 0.5 * int(np.count_nonzero(model.active)) * float(np.log(count))


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """The diagnosis with other thresholds and functions, or another method in its place."""

    says: str
    thresholds: dict[str, float] = field(default_factory=dict)
    replaced: tuple[tuple[type, str, object], ...] = ()  # functions: of what, name, by what
    method: Method | None = None


VARIANTS = {
    "whole": Variant(says="As it is."),
    "bodies free": Variant(
        says="No prior on bodies: inertial figures may be wrong by ten times their size.",
        thresholds={"priors.bodies": 10.0, "priors.good_bodies": 10.0},
    ),
    "bodies exact": Variant(
        says="Bodies are as the model says: only causes with a name can be wrong with them.",
        thresholds={"priors.bodies": 0.0},
    ),
    "no days": Variant(
        says="Friction is the same in all sessions.", thresholds={"priors.days": 0.0}
    ),
    "no swaps": Variant(
        says="What was taken stays: no cause is dropped for, or gives its place to, another.",
        replaced=(
            (Posterior, "_swept", lambda self, state, added, gone: state),
            (Posterior, "_instead", lambda self, state: None),
        ),
    ),
    "fixed noise": Variant(
        says="Noise is what ordinary physics leaves; it does not fall where causes explain it.",
        replaced=((Model, "_settle", noise_of_ordinary_alone),),
    ),
    "BIC": Variant(
        says="Sets of causes are compared by the Bayesian information criterion; prior odds stay.",
        replaced=((Model, "log_evidence", property(bic)),),
    ),
    BEFORE: Variant(says="The search of another checkout."),
    "least squares, friction free": Variant(
        says="The textbook's identification.", method=partial(named_by_regression, bodies=False)
    ),
    "least squares, bodies free too": Variant(
        says="The same, bodies a tenth wrong.", method=partial(named_by_regression, bodies=True)
    ),
    "our library, stepwise by BIC": Variant(
        says="The plainest search over our effects: none is ordinary.", method=named_stepwise
    ),
}


def switched_off(name: str, study: Path) -> dict[str, Any]:
    """A variant's diagnosis as its file would have it; what is replaced stays replaced."""
    variant = VARIANTS[name]
    if variant.method is not None:
        return {"verdict": "", "joints": {}, "notes": [], "findings": variant.method(study)}
    for owner, what, by in variant.replaced:
        setattr(owner, what, by)
    thresholds = Thresholds().changed(variant.thresholds)
    return dict(json.loads(diagnose(study, thresholds=thresholds).to_json()))
