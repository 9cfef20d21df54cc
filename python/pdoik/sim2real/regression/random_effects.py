"""Sessions that differ by more than their errors: the spread between them, and the mean's error.

Each session's figure is the mean of all such sessions, plus the session's own difference, plus an
error of known size (DerSimonian and Laird, Controlled Clinical Trials 7(3), 1986; the spread by
Paule and Mandel's equation, Journal of Research NBS 87(5), 1982, which is the plain standard
deviation where errors are small, however unequal).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import optimize, stats

from pdoik.recordings import FloatArray

from ..findings import ERRORS

_LEAST_WEIGHT = 0.05  # numerics: of the weight of the session that says most
_HOPELESS = 1e6  # times the least variance


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Spread of one figure between sessions."""

    mean: float  # over sessions, each by its own error and the spread
    std: float  # from session to session, the sessions' own errors taken off
    p: float  # probability of such differences, or larger, between sessions that are alike
    error: float  # that the differences leave in the mean over the recorded sessions
    sessions: int  # that say something of the figure

    def half_width(self, within: float) -> float:
        """Half of the mean's 95 % interval, `within` being its error if sessions were alike.

        By Student's t with one degree of freedom less than sessions (Hartung and Knapp, Statistics
        in Medicine 20(24), 2001); where the sessions are no more apart than their errors, the
        normal distribution's.
        """
        if self.std == 0.0:
            return ERRORS * within
        return float(stats.t.ppf(0.975, self.sessions - 1) * np.hypot(within, self.error))


def spread_between(values: FloatArray, variances: FloatArray, freedom: int) -> Spread:
    """Spread between sessions.

    Args:
        values: (S,) a figure as each session has it.
        variances: (S,) of their errors; infinite where a session says nothing.
        freedom: degrees of freedom of the variances together.
    """
    informative = variances < _HOPELESS * max(float(variances.min()), 1e-300)
    beyond = _variance_between(values[informative], variances[informative])
    weight = np.where(informative, 1.0 / (np.maximum(variances, 1e-300) + beyond), 0.0)
    informative = weight > _LEAST_WEIGHT * weight.max()
    value, variance = values[informative], np.maximum(variances[informative], 1e-300)
    count = len(value)
    if count < 2:
        mean = float(value[0]) if count else np.nan
        return Spread(mean=mean, std=0.0, p=1.0, error=0.0, sessions=count)
    std = float(np.sqrt(_variance_between(value, variance)))
    Q, _ = _squares(value, variance)
    pooled = 1.0 / variance  # as least squares over all sessions weights them
    return Spread(
        mean=_squares(value, variance + std**2)[1],
        std=std,
        p=float(stats.f.sf(Q / (count - 1), count - 1, max(freedom, 1))),
        error=std * float(np.linalg.norm(pooled) / pooled.sum()),
        sessions=count,
    )


def _variance_between(values: FloatArray, variances: FloatArray) -> float:
    """The variance with which the weighted squares about the mean are as expected; or 0."""
    variances = np.maximum(variances, 1e-300)
    free = len(values) - 1

    def surplus(beyond: float) -> float:
        return _squares(values, variances + beyond)[0] - free

    if free < 1 or surplus(0.0) <= 0.0:
        return 0.0
    highest = float(np.sum((values - values.mean()) ** 2))  # there they are fewer
    return float(optimize.brentq(surplus, 0.0, highest, xtol=1e-12 * highest))


def _squares(values: FloatArray, variances: FloatArray) -> tuple[float, float]:
    """Sum of squares about the mean, in variances, and the mean."""
    weight = 1.0 / variances
    mean = float(weight @ values / weight.sum())
    return float(weight @ (values - mean) ** 2), mean
