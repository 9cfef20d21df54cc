"""An encoder whose zero is off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape, torque_turned
from ...simulation import Part, SensorChange
from ..effect import Effect, Example, Parameter, on_torque_and_tip
from ..site import Site

_SMALL = 2e-3  # numerics: below it the derivative is as good [rad]


class JointOffset(Effect):
    """q_true = q + b: seen in gravity's torques and in the tip's pose."""

    id = "joint_offset"
    family = "geometry"
    on = "joint"
    equation = "q_true = q + b"
    parameters = (Parameter("offset", "rad", lower=-0.6, upper=0.6),)
    confused_with = ("link_inertial_error", "gravity_direction", "kinematic_error")
    decided_by = "the tip's pose measured in ten spread poses"
    source = "Hollerbach et al., Springer Handbook of Robotics, Model Identification"
    example = Example(values={"offset": 0.05}, shape=(0.05,))
    complexity = 1.9
    per_joint_moving = False
    against = "q"

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """The derivative first; `refined` moves on to the secant at the offset itself."""
        return [(0.0,)]

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """A third of a radian either way."""
        return [(-0.35, 0.35)]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Change of torques and tip per offset, on the way to the offset in the shape."""
        (j,) = place.joints
        if motion.body is None:
            return {("servo", j): -np.ones((len(motion.time), 1))}
        torque = motion.dtau_dq[:, :, j]
        tip = None if motion.tip_jacobian is None else motion.tip_jacobian[:, :, j]
        if abs(shape[0]) > _SMALL:
            moved = torque_turned(motion, j, shape[0])
            torque = (moved - motion.tau_without_rotor()) / shape[0]
            if "dtau_dq by feet" in motion.cache:
                torque += motion.cache["dtau_dq by feet"][:, :, j]
            if tip is not None:
                q = motion.q.copy()
                q[:, j] += shape[0]
                tip = motion.tip_moved(q) / shape[0]
        return on_torque_and_tip(motion, torque, tip) | motion.soles_by_joint(j)

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The offset, along the secant to it."""
        return shape or (values["offset"],), np.array([values["offset"]])

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        return site.each(lambda j: SensorChange(joint=j, channel="q", offset=site["offset"]))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        degrees = np.degrees(values["offset"])
        return f"The zero of {where} is wrong: its true position is {degrees:.2g} degrees further."

    def regime(self, where: str) -> str:
        """When it shows."""
        return "every pose, also at rest"
