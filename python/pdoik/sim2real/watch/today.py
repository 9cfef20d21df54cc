"""Friction as it is today, learnt while the machine is watched."""

from __future__ import annotations

import numpy as np

from pdoik.recordings import FloatArray

from ..effects.friction import CoulombFriction, ViscousFriction
from ..model import Healthy
from ..motion import Place
from ..thresholds import WatchThresholds
from .calibrate import variance_of
from .changes import Change
from .residuals import AT_MOST, ResidualRows, friction_columns

_WAIT = 60.0  # time after which rows that a chart doubts are forgotten [s]


class FrictionToday:
    """Coulomb and viscous friction of each joint less the model's, by a Kalman filter.

    It begins as in the healthy logs, within what days differ by, and then walks at random. It is
    learnt only from rows before which every chart of the joint was at zero, so that a change is
    not taken for it.
    """

    def __init__(self, healthy: Healthy, limits: WatchThresholds) -> None:
        """Starts with the friction of the healthy logs."""
        self._healthy = healthy
        size = np.stack([healthy.friction, healthy.friction / healthy.speed], axis=1)
        self._first = (limits.friction_change / AT_MOST * size) ** 2  # (n, 2)
        self._drift = (limits.friction_drift * size) ** 2 / 60.0  # (n, 2) per second
        self.reset()

    def reset(self) -> None:
        """Begin another day."""
        self.mean = self._healthy.friction_off.copy()  # (n, 2) [N m], [N m s/rad]
        self.covariance = self._first[:, :, None] * np.eye(2)  # (n, 2, 2)
        self._until = np.full(len(self.mean), -np.inf)  # rows that were learnt [s]
        self.forget()

    def forget(self) -> None:
        """Drop the rows that wait: they may be those of a machine that has changed."""
        self._waiting: list[tuple[ResidualRows, FloatArray]] = []

    def learn(self, rows: ResidualRows, healthy_until: FloatArray) -> None:
        """Add rows, and learn from those that are known to be healthy by now.

        Args:
            rows: their residual is less the friction that was known.
            healthy_until: (n,) time up to which no chart of a joint doubts its rows [s].
        """
        X = friction_columns(rows)
        self._waiting.append((rows, rows.residual + np.einsum("tjk,jk->tj", X, self.mean)))
        oldest = max(float(rows.time[-1]) - _WAIT, float(self._until.min()))
        self._waiting = [each for each in self._waiting if each[0].time[-1] > oldest]
        for j in np.flatnonzero(self._healthy.friction > 0.0).tolist():
            self._learn(j, healthy_until[j])

    def _learn(self, j: int, until: float) -> None:
        first = self._until[j]
        if until <= first:
            return
        gram, moment = np.zeros((2, 2)), np.zeros(2)
        for rows, off in self._waiting:
            some = (rows.time > first) & (rows.time <= until)
            if not some.any():
                continue
            memory = max(1.0, self._healthy.density[j, 1] / rows.step)
            weight = rows.moving[some, j] / variance_of(self._healthy, rows.features[some])[:, j]
            X = friction_columns(rows)[some, j]
            gram += X.T @ (X * (weight / memory)[:, None])
            moment += X.T @ (off[some, j] * weight / memory)
        passed = until - first if np.isfinite(first) else 0.0
        before = np.linalg.inv(self.covariance[j] + passed * np.diag(self._drift[j]))
        self.covariance[j] = np.linalg.inv(before + gram)
        self.mean[j] = self.covariance[j] @ (before @ self.mean[j] + moment)
        self._until[j] = until

    @property
    def changes(self) -> tuple[Change, ...]:
        """Friction less the model's, as changes of the model with their variances."""
        kinds = (CoulombFriction.id, (0.0,)), (ViscousFriction.id, ())
        return tuple(
            Change(
                effect=effect,
                place=Place(joints=(j,)),
                shape=shape,
                beta=self.mean[j, k : k + 1],
                covariance=self.covariance[j, k : k + 1, k : k + 1],
            )
            for j in np.flatnonzero(self._healthy.friction > 0.0).tolist()
            for k, (effect, shape) in enumerate(kinds)
        )
