"""An IMU of a floating base that does not say what the base feels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ..effect import Effect, Parameter

_AXES = "xyz"


class _OfImu(Effect):
    """Shown by the torques, which follow from what the IMU says, and by the base's pose."""

    family = "sensor"
    on = "base"
    complexity = 2
    of_floating_base = True
    per_joint_moving = False

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """The base, where its motion is known from its IMU."""
        return [Place()] if any(m.base is not None and m.base.of_imu for m in motions) else []

    def _columns(
        self, motion: Motion, rates: FloatArray, turns: FloatArray, forces: FloatArray
    ) -> Columns:
        """Columns of errors of rates, derivatives and forces, (T, 3, k) each, in the IMU's axes."""
        base = motion.base
        if base is None or not base.of_imu:
            return {}
        # Where it says too much, the model's torques are too large: as gravity the other way.
        by_force = np.einsum("trb,ba->tra", motion.dtau_dgravity, base.imu_rotation)
        torques = np.einsum("tra,tak->trk", by_force, forces)
        if np.any(turns):
            by_turn = motion.dtau_dturn() @ base.imu_rotation
            torques -= np.einsum("tra,tak->trk", by_turn, turns)
        columns = motion.on_rows(torques)
        if base.disagreement is not None:
            columns |= {("imu", axis): rates[:, axis] for axis in range(3)}
            columns |= {("imu", 3 + axis): forces[:, axis] for axis in range(3)}
        return columns

    def not_simulated(self, values: Mapping[str, float]) -> str:
        """It acts in a log only."""
        return "an IMU's error is none of the machine's motion"


class ImuTilt(_OfImu):
    """The IMU's axes are rotated by a small angle against those that the study gives."""

    id = "imu_tilt"
    name = "an IMU that is tilted"
    equation = "acc, gyro = R(tilt)^T what the base feels, small tilt"
    parameters = tuple(Parameter(f"tilt_{a}", "rad", lower=-0.5, upper=0.5) for a in _AXES)
    confused_with = ("imu_offset", "payload", "joint_offset")
    decided_by = "the base rolled and pitched at rest, with its pose measured"
    source = "rotation of the sensor's frame to first order"

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """What it takes from rates and forces: their cross product with the tilt."""
        base = motion.base
        if base is None:
            return {}
        R = base.imu_rotation
        axes = np.eye(3)
        felt = (base.omega @ R, base.alpha @ R, base.felt @ R)
        turned = [np.stack([-np.cross(a, x) for a in axes], axis=2) for x in felt]
        return self._columns(motion, *turned)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        x, y, z = (np.degrees(values[f"tilt_{a}"]) for a in _AXES)
        return (
            f"The IMU is mounted {x:.2g}, {y:.2g} and {z:.2g} degrees (about x, y, z) from where"
            " the study has it."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return "always, most where the base is pitched or rolled"


class ImuOffset(_OfImu):
    """Constants that it adds to what the base feels."""

    id = "imu_offset"
    name = "offsets of an IMU"
    equation = "acc, gyro = what the base feels + b"
    parameters = (
        *(Parameter(f"acc_{a}", "m/s^2") for a in _AXES),
        *(Parameter(f"gyro_{a}", "rad/s") for a in _AXES),
    )
    confused_with = ("imu_tilt", "payload")
    decided_by = "the base at rest in two attitudes, with its pose measured"
    source = "IEEE Std 952: bias"

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """One for each axis of each."""
        if motion.base is None:
            return {}
        rates, forces = np.zeros((2, len(motion.time), 3, 6))
        forces[:, :, :3] = np.eye(3)
        rates[:, :, 3:] = np.eye(3)
        return self._columns(motion, rates, np.zeros_like(rates), forces)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        acc = ", ".join(f"{values[f'acc_{a}']:.2g}" for a in _AXES)
        gyro = ", ".join(f"{values[f'gyro_{a}']:.2g}" for a in _AXES)
        return (
            f"The IMU's zeros are off: its accelerometer's by ({acc}) m/s^2, its gyro's by"
            f" ({gyro}) rad/s."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return "always"
