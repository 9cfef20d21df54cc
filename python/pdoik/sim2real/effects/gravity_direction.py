"""A base that does not stand upright."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..motion import Motion
from ..recording import FloatArray
from ..rigid_body import STANDARD_GRAVITY
from .effect import Columns, Effect, Parameter, Place, Shape


class GravityDirection(Effect):
    """Gravity seen from a base tilted by small angles about its x and y axes."""

    id = "gravity_direction"
    on = "base"
    equation = "tau = dG/dg (g sin(tilt_y), -g sin(tilt_x), 0)"
    parameters = (
        Parameter("tilt_x", "rad", lower=-1.0, upper=1.0),
        Parameter("tilt_y", "rad", lower=-1.0, upper=1.0),
    )
    confused_with = ("link_inertial_error", "joint_offset", "torque_offset")
    decided_by = "slow motion of the first joint with the arm stretched out, or a level on the base"
    source = "a rotation of the base, to first order"
    complexity = 2

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """The base."""
        return [Place()]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Torques per tilt about x and about y, and what the cosine takes from gravity."""
        by = STANDARD_GRAVITY * motion.dtau_dgravity
        return {
            ("torque", j): np.stack([-by[:, j, 1], by[:, j, 0], by[:, j, 2]], axis=1)
            for j in range(motion.n)
        }

    def prior(self, width: int) -> FloatArray:
        """The cosine of a tilt of less than a tenth of a radian."""
        return np.array([0.0, 0.0, 1.0 / 0.005**2])

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """A radian at most; gravity does not grow."""
        return np.array([-1.0, -1.0, -1e-3]), np.array([1.0, 1.0, 0.5])

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Both tilts."""
        return {"tilt_x": float(beta[0]), "tilt_y": float(beta[1])}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """Both tilts, and what their cosines take from gravity."""
        x, y = values["tilt_x"], values["tilt_y"]
        return (), np.array([x, y, 1.0 - np.cos(x) * np.cos(y)])

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        x, y = np.degrees(values["tilt_x"]), np.degrees(values["tilt_y"])
        return f"The base is tilted by {x:.2g} degrees about its x axis and {y:.2g} about y."

    def regime(self, where: str) -> str:
        """When it shows."""
        return "every pose, also at rest"
