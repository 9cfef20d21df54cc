"""An encoder whose zero is off."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..motion import Motion
from ..recording import FloatArray
from .effect import Columns, Effect, Key, Parameter, Place, Shape


class JointOffset(Effect):
    """q_true = q + b: seen in gravity's torques and in the tip's pose."""

    id = "joint_offset"
    on = "joint"
    equation = "q_true = q + b"
    parameters = (Parameter("offset", "rad", lower=-0.6, upper=0.6),)
    confused_with = ("link_inertial_error", "gravity_direction", "kinematic_error")
    decided_by = "the tip's pose measured in ten spread poses"
    source = "Hollerbach et al., Springer Handbook of Robotics, Model Identification"
    complexity = 2
    per_joint_moving = False

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Derivatives by the joint's position."""
        (j,) = place.joints
        columns: dict[Key, FloatArray] = {
            ("torque", i): motion.dtau_dq[:, i, j, None] for i in range(motion.n)
        }
        if motion.tip_jacobian is not None:
            for axis in range(6):
                columns["tip", axis] = motion.tip_jacobian[:, axis, j, None]
        if motion.body is None:
            return {("servo", j): -np.ones((len(motion.time), 1))}
        return columns

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The offset."""
        return {"offset": float(beta[0])}

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        degrees = np.degrees(values["offset"])
        return f"The zero of {where} is off: it truly stands {degrees:.2g} degrees further."

    def regime(self, where: str) -> str:
        """When it shows."""
        return "every pose, also at rest"
