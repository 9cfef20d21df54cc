"""A base that does not stand upright."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from pdoik.recordings import FloatArray

from ...motion import STANDARD_GRAVITY, Columns, Motion, Place, Shape
from ...simulation import GravityTilt, Part
from ..effect import Effect, Example, Parameter
from ..site import Site

_USUAL = 0.005  # share that a tilt takes from gravity
_TILT = 0.1  # of a base that is not quite level [rad]
_ANY = 1.0  # shape of a base that is mounted some other way


class GravityDirection(Effect):
    """Gravity seen from a base turned by R_x(tilt_x) R_y(tilt_y)."""

    id = "gravity_direction"
    name = "direction of gravity"
    family = "body"
    on = "base"
    odds = 0.05
    equation = "tau = G(q; R^T g) - G(q; g), R = R_x(tilt_x) R_y(tilt_y)"
    parameters = (
        Parameter("tilt_x", "rad"),
        Parameter("tilt_y", "rad"),
    )
    confused_with = ("link_inertial_error", "joint_offset", "torque_offset")
    decided_by = "slow motion of the first joint with the arm stretched out, or a level on the base"
    source = "a rotation of the base; torques are linear in gravity's components"
    off = 0.15  # share of gravity by which masses that are wrong may change its size
    level = 0.3  # the same per squared sine: bodies were fitted under the level base's gravity
    example = Example(values={"tilt_x": 0.03, "tilt_y": -0.05})
    complexity = 2
    against = "q"

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """A base that stands; one that moves feels gravity itself."""
        return [] if any(motion.base is not None for motion in motions) else [Place()]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Torques per sine of the tilts about x and y, and what the cosine takes from gravity."""
        by = STANDARD_GRAVITY * motion.dtau_dgravity
        return motion.on_rows(np.stack([-by[:, :, 1], by[:, :, 0], by[:, :, 2]], axis=2))

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """A base that is not quite level; one that is mounted some other way."""
        return [(), (_ANY,)]

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """It is the one or the other."""
        return [(each, each) for each in shape]

    def prior(self, width: int) -> FloatArray:
        """The cosine of a tilt of less than a tenth of a radian."""
        return np.array([0.0, 0.0, 1.0 / _USUAL**2])

    def usual(self, shape: Shape, width: int) -> FloatArray | None:
        """A few degrees, or any angle."""
        return np.ones(3) if shape else np.array([_TILT, _TILT, _USUAL])

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Gravity does not grow, within errors."""
        more = 1.0 + self.off
        return np.array([-more, -more, -self.off]), np.array([more, more, 1.0 + more])

    def admissible(self, beta: FloatArray) -> bool:
        """Whether gravity keeps its size, within errors of the model."""
        size = float(np.linalg.norm([beta[0], beta[1], 1.0 - beta[2]]))
        return (
            abs(size - 1.0) <= self.off + float(np.hypot(beta[0], beta[1])) ** 2 / 2.0 * self.level
        )

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Both tilts."""
        x = np.arctan2(beta[0], np.hypot(beta[1], 1.0 - beta[2]))
        y = np.arctan2(beta[1], 1.0 - beta[2])
        return {"tilt_x": float(x), "tilt_y": float(y)}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """Both tilts, and what their cosines take from gravity."""
        x, y = values["tilt_x"], values["tilt_y"]
        return (), np.array([np.sin(x), np.sin(y) * np.cos(x), 1.0 - np.cos(x) * np.cos(y)])

    def of_amount(
        self, amount: float, motions: Sequence[Motion], place: Place, shape: Shape, width: int
    ) -> tuple[Shape, FloatArray]:
        """Tilt of an amount [rad], as far about x as about y."""
        return shape, np.array([amount, amount, 0.0])

    def gravity(self, values: Mapping[str, float]) -> FloatArray | None:
        """Gravity in the tilted base's frame, (3,) [m/s^2]."""
        base = Rotation.from_euler("XY", [values["tilt_x"], values["tilt_y"]])
        return np.asarray(base.inv().apply([0.0, 0.0, -STANDARD_GRAVITY]))

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        return (GravityTilt(x=site.get("tilt_x"), y=site.get("tilt_y")),)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        x, y = np.degrees(values["tilt_x"]), np.degrees(values["tilt_y"])
        return f"The base is tilted by {x:.2g} degrees about its x axis and {y:.2g} about y."

    def regime(self, where: str) -> str:
        """When it shows."""
        return "every pose, also at rest"
