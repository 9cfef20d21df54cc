"""Rows, terms and hypotheses of made-up numbers, and dense algebra of them by NumPy and SciPy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy import stats

from pdoik.sim2real.identify import Hypothesis, Linearisation, Model, Series
from pdoik.sim2real.motion import Place
from pdoik.sim2real.regression import Term

TORQUES = (("torque", 0), ("torque", 1), ("velocity", 0))
STUDY = 160  # rows of the study, of which some count
NOWHERE = Place()


def data_of(
    rng: np.random.Generator, floor: float | Sequence[float] = 1e-6, keys: Any = TORQUES
) -> Linearisation:
    """White noise of other sizes in every balance, on some of the study's rows."""
    floors = np.broadcast_to(floor, len(keys))
    series = {}
    for k, key in enumerate(keys):
        rows = np.flatnonzero(rng.random(STUDY) < 0.8)
        target = (0.5 + k) * rng.standard_normal(len(rows))
        every = (slice(0, len(rows)),)
        series[key] = Series(rows=rows, target=target, floor=float(floors[k]), parts=every)
    return Linearisation(series)


def term(
    rng: np.random.Generator,
    width: int = 1,
    keys: Any = TORQUES,
    effect: str = "unknown",
    place: Place = NOWHERE,
) -> Term:
    """Columns of units that differ by many powers of ten, and lean on one another."""
    scale = 10.0 ** rng.uniform(-3, 3, width)
    mixed = np.eye(width) + 0.3 * rng.standard_normal((width, width))
    columns = {key: rng.standard_normal((STUDY, width)) @ mixed * scale for key in keys}
    return Term(effect=effect, place=place, shape=(), columns=columns, prior=np.zeros(width))


def believed(
    rng: np.random.Generator, of: Term, mean: float = 0.0, size: float = 0.3, **options: Any
) -> Hypothesis:
    """That each coefficient's part of the rows is about `size`."""
    rms = np.sqrt(np.mean(np.concatenate(list(of.columns.values())) ** 2, axis=0))
    sizes = size * rng.uniform(0.5, 2.0, of.width) / rms
    return Hypothesis(term=of, mean=mean * sizes, precision=sizes**-2, **options)


def add(data: Linearisation, of: Term, beta: Sequence[float] | np.ndarray) -> None:
    """As if the machine had this: before any model looks at the series."""
    for key, column in of.columns.items():
        series = data.series[key]
        assert series.width == 0
        series.target = series.target + column[series.rows] @ np.asarray(beta)
        series.square = float(series.target @ series.target)


def weights(model: Model) -> dict[Any, float]:
    """Of a row, by the noise that the model says."""
    return {
        key: series.independent / len(series.rows) / model.noise[key]
        for key, series in model.data.series.items()
    }


def stacked(
    data: Linearisation, hypotheses: Sequence[Hypothesis], weight: Mapping[Any, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Design and target of all rows in their noise."""
    design, target = [], []
    for key, series in data.series.items():
        rows, root = series.rows, np.sqrt(weight[key])
        parts = [
            h.term.columns[key][rows] if key in h.term.columns else np.zeros((len(rows), h.width))
            for h in hypotheses
        ]
        design.append(np.hstack([np.zeros((len(rows), 0)), *parts]) * root)
        target.append(series.target * root)
    return np.vstack(design), np.concatenate(target)


def priors(hypotheses: Sequence[Hypothesis]) -> tuple[np.ndarray, np.ndarray]:
    """Means and inverse variances of all coefficients."""
    none = np.zeros(0)
    return (
        np.concatenate([none, *(h.mean for h in hypotheses)]),
        np.concatenate([none, *(h.precision for h in hypotheses)]),
    )


def log_likelihood(
    data: Linearisation, hypotheses: Sequence[Hypothesis], weight: Mapping[Any, float]
) -> float:
    """Of the rows, all coefficients integrated out, as one normal density of all of them."""
    design, target = stacked(data, hypotheses, weight)
    mean, precision = priors(hypotheses)
    covariance = np.eye(len(target)) + (design / precision) @ design.T
    value = stats.multivariate_normal(design @ mean, covariance).logpdf(target)
    of_units = sum(0.5 * len(s.rows) * np.log(weight[k]) for k, s in data.series.items())
    return float(value + of_units)
