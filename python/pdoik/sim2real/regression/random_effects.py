"""Sessions that differ by more than their errors: the spread between them, and the mean's error.

Each session's figure is the mean of all such sessions, plus the session's own difference, plus an
error of known size (DerSimonian and Laird, Controlled Clinical Trials 7(3), 1986).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from ..study.recording import FloatArray

_TELLS = 0.05  # of the weight of the session that tells most


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Between sessions of one figure."""

    mean: float  # over sessions, those of small errors no more than those that tell as much
    std: float  # from session to session, the sessions' own errors taken off
    p: float  # probability of such differences, or larger, between sessions that are alike
    error: float  # that the differences leave in the mean over the recorded sessions
    sessions: int  # that tell something of the figure

    def half_width(self, within: float) -> float:
        """Half of the mean's 95 % interval, `within` being its error if sessions were alike.

        By Student's t with one degree of freedom less than sessions (Hartung and Knapp, Statistics
        in Medicine 20(24), 2001); where the sessions are no more apart than their errors, the
        normal distribution's.
        """
        if self.std == 0.0:
            return 1.96 * within
        return float(stats.t.ppf(0.975, self.sessions - 1) * np.hypot(within, self.error))

    @property
    def of_another(self) -> float:
        """Standard deviation of a session that was not among these, their small number counted."""
        if self.std == 0.0:
            return 0.0
        few = float(stats.t.ppf(0.975, self.sessions - 1)) / 1.96
        return few * self.std * float(np.sqrt(1.0 + 1.0 / self.sessions))


def spread_between(values: FloatArray, variances: FloatArray, freedom: int) -> Spread:
    """Spread between sessions.

    Args:
        values: (S,) a figure as each session has it.
        variances: (S,) of their errors; infinite where a session tells nothing.
        freedom: degrees of freedom of the variances together.
    """
    weight = 1.0 / np.maximum(variances, 1e-300)
    tells = weight > _TELLS * weight.max()
    count = int(tells.sum())
    if count < 2:
        mean = float(values[tells][0])
        return Spread(mean=mean, std=0.0, p=1.0, error=0.0, sessions=count)
    value, weight = values[tells], weight[tells]
    total = float(weight.sum())
    mean = float(weight @ value) / total
    Q = float(weight @ (value - mean) ** 2)
    beyond = (Q - (count - 1)) / (total - float(weight @ weight) / total)
    std = float(np.sqrt(max(beyond, 0.0)))
    even = 1.0 / (1.0 / weight + std**2)
    return Spread(
        mean=float(even @ value / even.sum()),
        std=std,
        p=float(stats.f.sf(Q / (count - 1), count - 1, max(freedom, 1))),
        error=std * float(np.sqrt(weight @ weight)) / total,
        sessions=count,
    )
