"""A rigid body on a base that moves as it was recorded."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from pdoik.recordings import FloatArray

from .base_motion import BaseMotion
from .rigid_body import RigidBody


class CarriedBody(RigidBody):
    """A robot whose base has the rates and specific force of a recording, sample by sample.

    Seen from the base, which stands still for Pinocchio: forces depend on rates, accelerations
    and the specific force alone, which contains gravity.
    """

    base: BaseMotion

    @classmethod
    def on(cls, body: RigidBody, base: BaseMotion) -> CarriedBody:
        """The body moved along a recording of as many samples as `base` has."""
        other = cls.__new__(cls)
        other.__dict__.update(body.__dict__)
        other.base = base
        other.model = body.model.copy()
        other.model.gravity.linear = np.zeros(3)
        other._data = other.model.createData()
        return other

    def _velocity(self, dq: FloatArray) -> FloatArray:
        velocity = super()._velocity(dq)
        velocity[:, 3:6] = self.base.omega
        return velocity

    def _acceleration(self, ddq: FloatArray) -> FloatArray:
        acceleration = super()._velocity(ddq)
        acceleration[:, :3] = self.base.force
        acceleration[:, 3:6] = self.base.alpha
        return acceleration

    def _by_gravity(self, configuration: FloatArray) -> FloatArray:
        """Torques per gravity, (T, rows, 3): to pull is to accelerate the other way."""
        return -self._by_base(configuration)[:, :, :3]

    def base_inertia(self, q: FloatArray) -> FloatArray:
        """Torques per acceleration of the base, linear and angular, (T, rows, 6)."""
        return self._by_base(self._position(q))

    def _by_base(self, configuration: FloatArray) -> FloatArray:
        result = np.empty((len(configuration), self.rows, 6))
        for t, row in enumerate(configuration):
            mass = np.triu(pin.crba(self.model, self._data, row))
            result[t] = (mass + np.triu(mass, 1).T)[self._rows, :6]
        return result

    def gravity(self, q: FloatArray) -> FloatArray:
        """Torques that hold the robot still in the field that its base feels, (T, n)."""
        configuration, rest = self._position(q), np.zeros(self.model.nv)
        acceleration = np.zeros((len(q), self.model.nv))
        acceleration[:, :3] = self.base.force
        rows = zip(configuration, acceleration, strict=True)
        return np.stack([pin.rnea(self.model, self._data, a, rest, b)[self._v] for a, b in rows])
