"""How a floating base moved, by its IMU or by its pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.spatial.transform import Rotation

from pdoik.recordings import FloatArray, Recording

from ..study import FloatingBase
from .rigid_body import RigidBody
from .signals import derivative, zero_phase


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


_UP = np.array([0.0, 0.0, 9.81])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BaseMotion:
    """The base's motion; arrays are (T, 3) in the base's axes unless said otherwise."""

    omega: FloatArray  # [rad/s]
    alpha: FloatArray  # [rad/s^2]
    felt: FloatArray  # specific force where the IMU sits, g upwards at rest [m/s^2]
    force: FloatArray  # the same at the base's origin
    rotation: FloatArray | None  # (T, 3, 3) to the world; None without a pose
    position: FloatArray | None  # in the world [m]
    imu_rotation: FloatArray  # (3, 3) IMU's axes to the base's
    of_imu: bool  # whether an IMU says so, the pose otherwise
    disagreement: FloatArray | None  # (T, 6) gyro and acc less what the pose says, IMU's axes

    @property
    def up(self) -> FloatArray:
        """Direction against gravity, (T, 3); by the specific force where there is no pose."""
        if self.rotation is not None:
            return self.rotation[:, 2]
        return np.asarray(self.force / np.linalg.norm(self.force, axis=1, keepdims=True))


def base_motion_of(recording: Recording, base: FloatingBase, cutoff: float) -> BaseMotion:
    """The base's motion, smooth.

    Its torques need no orientation: gravity is in the specific force that an accelerometer feels
    (Featherstone, Rigid Body Dynamics Algorithms, 2008, 5.2).

    Args:
        recording: with an IMU or a pose; one without was held level.
        base: where the IMU sits.
        cutoff: of the smoothing [Hz].
    """
    period, count = recording.period, len(recording.time)
    pose = None if recording.base is None else zero_phase(recording.base, cutoff, period)
    rotation = position = None
    by_pose = by_imu = None
    if pose is not None:
        turns = Rotation.from_quat(pose[:, [4, 5, 6, 3]])
        rotation, position = turns.as_matrix(), np.ascontiguousarray(pose[:, :3])
        by_pose = _of_pose(turns, position, period)
    if recording.gyro is not None and recording.acc is not None:
        by_imu = _of_imu(recording, base, cutoff)
    level = (np.zeros((count, 3)), np.zeros((count, 3)), np.tile(_UP, (count, 1)))
    omega, alpha, force = by_imu or by_pose or level
    return BaseMotion(
        omega=omega,
        alpha=alpha,
        felt=force + _at(base.imu_position, omega, alpha),
        force=force,
        rotation=rotation,
        position=position,
        imu_rotation=base.imu_rotation,
        of_imu=by_imu is not None,
        disagreement=_disagreement(recording, base, by_pose),
    )


def _of_imu(
    recording: Recording, base: FloatingBase, cutoff: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rates, their derivative, and the specific force at the base's origin."""
    period = recording.period
    assert recording.gyro is not None
    assert recording.acc is not None
    omega = zero_phase(recording.gyro, cutoff, period) @ base.imu_rotation.T
    felt = zero_phase(recording.acc, cutoff, period) @ base.imu_rotation.T
    alpha = derivative(omega, period)
    return omega, alpha, felt - _at(base.imu_position, omega, alpha)


def _of_pose(
    turns: Rotation, position: FloatArray, period: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    steps = np.zeros_like(position)  # turned from the sample before to the one after
    steps[1:-1] = (turns[:-2].inv() * turns[2:]).as_rotvec() / (2.0 * period)
    steps[0], steps[-1] = steps[1], steps[-2]
    acceleration = derivative(derivative(position, period), period)
    return steps, derivative(steps, period), turns.inv().apply(acceleration + _UP)


def _at(place: FloatArray, omega: FloatArray, alpha: FloatArray) -> FloatArray:
    """What a point of a turning body feels beyond its origin, (T, 3)."""
    return np.cross(alpha, place) + np.cross(omega, np.cross(omega, place))


def _disagreement(
    recording: Recording,
    base: FloatingBase,
    by_pose: tuple[FloatArray, FloatArray, FloatArray] | None,
) -> FloatArray | None:
    """Gyro and accelerometer as logged less what the pose's derivatives say, (T, 6)."""
    if by_pose is None or recording.gyro is None or recording.acc is None:
        return None
    omega, alpha, force = by_pose
    felt = force + _at(base.imu_position, omega, alpha)
    turn = base.imu_rotation
    return np.hstack([recording.gyro - omega @ turn, recording.acc - felt @ turn])
