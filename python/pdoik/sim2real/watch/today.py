"""Friction and bodies as they are today, learnt while the machine is watched."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..model import Healthy
from ..thresholds import WatchThresholds
from .residuals import AT_MOST, ResidualRows, friction_columns

_WAIT = 60.0  # numerics: time after which rows that a chart doubts are forgotten [s]


class OrdinaryToday:
    """What every machine differs by from its model, by a Kalman filter.

    Coulomb and viscous friction of each joint begin as in the healthy logs, within what days
    differ by, and then walk at random. The links' inertial parameters begin as these logs left
    them, and stay. All are learnt only from rows before which every chart of the joint was at
    zero, so that a change is not taken for them.
    """

    def __init__(self, healthy: Healthy, limits: WatchThresholds) -> None:
        """Starts as the healthy logs were."""
        self._healthy = healthy
        n = len(healthy.friction)
        size = np.stack([healthy.friction, healthy.friction / healthy.speed], axis=1)  # (n, 2)
        self._rubs = healthy.friction > 0.0
        self._drift = (limits.friction_drift * size) ** 2 / 60.0  # (n, 2) per second
        days = np.where(size > 0.0, limits.friction_change / AT_MOST * size, 1.0)
        bodies = np.sqrt(np.diag(healthy.bodies_covariance))
        self._scale = np.concatenate([days.ravel(), np.where(bodies > 0.0, bodies, 1.0)])  # (p,)
        self._frictions = np.arange(2 * n).reshape(n, 2)
        self._bodies = np.arange(2 * n, len(self._scale))
        self.reset()

    def reset(self) -> None:
        """Begin another day."""
        healthy = self._healthy
        self._mean = np.concatenate([healthy.friction_off.ravel(), healthy.bodies_off])
        self._covariance: FloatArray = np.eye(len(self._mean))  # over the scale
        within = np.ix_(self._bodies, self._bodies)
        scale = self._scale[self._bodies]
        self._covariance[within] = healthy.bodies_covariance / np.outer(scale, scale)
        self._until = np.full(len(self._rubs), -np.inf)  # rows that were learnt [s]
        self.forget()

    def forget(self) -> None:
        """Drop the rows that wait: they may be those of a machine that has changed."""
        self._waiting: list[tuple[ResidualRows, FloatArray]] = []

    @property
    def friction(self) -> FloatArray:
        """Coulomb [N m] and viscous [N m s/rad] friction, (n, 2), less the model's."""
        return self._mean[self._frictions]

    def friction_covariance(self, j: int) -> FloatArray:
        """Of joint j's friction, (2, 2)."""
        return self._part(self._frictions[j])

    @property
    def bodies(self) -> FloatArray:
        """Inertial parameters of the links, (k,), less the model's."""
        return self._mean[self._bodies]

    @property
    def bodies_covariance(self) -> FloatArray:
        """Of the links' parameters, (k, k)."""
        return self._part(self._bodies)

    def _part(self, index: NDArray[np.intp]) -> FloatArray:
        scale = self._scale[index]
        return np.asarray(self._covariance[np.ix_(index, index)] * np.outer(scale, scale))

    def torque(self, friction: FloatArray, bodies: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What these make of columns (T, n, 2) and (T, n, k): mean and variance, (T, n)."""
        mean, variance = np.zeros(friction.shape[:2]), np.zeros(friction.shape[:2])
        for j in range(friction.shape[1]):
            index, X = self._columns(j, friction, bodies)
            mean[:, j] = X @ self._mean[index]
            variance[:, j] = np.einsum("ti,ij,tj->t", X, self._part(index), X, optimize=True)
        return mean, np.maximum(variance, 0.0)

    def _columns(
        self, j: int, friction: FloatArray, bodies: FloatArray
    ) -> tuple[NDArray[np.intp], FloatArray]:
        """Parameters that joint j's torque depends on, and the torque per unit of each."""
        index = np.concatenate([self._frictions[j], self._bodies])
        X = np.concatenate([friction[:, j] * self._rubs[j], bodies[:, j, : len(self._bodies)]], 1)
        return index, X

    def learn(self, rows: ResidualRows, healthy_until: FloatArray) -> None:
        """Add rows, and learn from those that are known to be healthy by now.

        Args:
            rows: their residual is less what was known.
            healthy_until: (n,) time up to which no chart of a joint doubts its rows [s].
        """
        known, _ = self.torque(friction_columns(rows), rows.bodies)
        self._waiting.append((rows, rows.residual + known))
        oldest = max(float(rows.time[-1]) - _WAIT, float(self._until.min()))
        self._waiting = [each for each in self._waiting if each[0].time[-1] > oldest]
        new = np.flatnonzero(healthy_until > self._until)
        if not len(new):
            return
        gram, moment = np.zeros_like(self._covariance), np.zeros_like(self._mean)
        for j in new.tolist():
            passed = healthy_until[j] - self._until[j]
            walked = passed * self._drift[j] if np.isfinite(passed) else np.zeros(2)
            place = self._frictions[j]
            self._covariance[place, place] += walked / self._scale[place] ** 2
            self._add(j, healthy_until[j], gram, moment)
            self._until[j] = healthy_until[j]
        before = np.linalg.inv(self._covariance)
        after = np.linalg.inv(before + gram)
        self._covariance = np.asarray(0.5 * (after + after.T), dtype=np.float64)
        scaled = self._covariance @ (before @ (self._mean / self._scale) + moment)
        self._mean = scaled * self._scale

    def _add(self, j: int, until: float, gram: FloatArray, moment: FloatArray) -> None:
        """Information of joint j's new rows, over the scale."""
        for rows, off in self._waiting:
            some = (rows.time > self._until[j]) & (rows.time <= until)
            if not some.any():
                continue
            part = rows[some]
            memory = max(1.0, self._healthy.density[j, 1] / rows.step)
            weight = part.moving[:, j] / (memory * self._healthy.variance_at(part.features)[:, j])
            index, X = self._columns(j, friction_columns(part), part.bodies)
            X = X * self._scale[index]
            gram[np.ix_(index, index)] += X.T @ (X * weight[:, None])
            moment[index] += X.T @ (off[some, j] * weight)
