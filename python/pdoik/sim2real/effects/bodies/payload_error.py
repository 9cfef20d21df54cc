"""A body that a recording is known to hold, and that is another than the study says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import Inertial, LinkChange, Part
from ...study import Payload
from ..effect import Example
from ..site import Site
from .inertial import INERTIAS, LinkInertials

_LEAST_REACH = 0.1  # of a body's mass from its link's frame, for the size of its moments [m]


class PayloadError(LinkInertials):
    """Ten inertial parameters added to a known body, in the recordings that hold it."""

    id = "payload_error"
    name = "a known payload that is another"
    equation = "tau = Y(q, dq, ddq) dpi, ten parameters of a known body, where it is held"
    confused_with = ("link_inertial_error", "payload", "torque_gain")
    decided_by = "the body on a scale; the same motion with it and without"
    example = Example(
        values={"d_mass": -0.2, "d_first_moment_x": -0.04, "d_first_moment_y": -0.01}
        | {"d_first_moment_z": 0.01}
        | {f"d_{name}": 0.0 if name in ("ixy", "ixz", "iyz") else -0.004 for name in INERTIAS},
        held=Payload(link="tool", mass=1.0, com=(0.02, 0.0, 0.05)),
    )
    complexity = 2  # simpler than a link's or a load's that other recordings do not show

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """Every known body, at the link that carries it."""
        found = {}
        for motion in motions:
            payload = motion.setup.payload
            if payload is not None and motion.body is not None:
                found[payload] = Place(link=motion.body.carrier(payload)[0], held=payload)
        return list(found.values())

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The carrying link's part of the regressor, where the body is held."""
        if place.held is None or motion.setup.payload != place.held:
            return {}
        return super().columns(motion, place, shape)

    def prior_at(self, motion: Motion, place: Place, width: int) -> FloatArray:
        """Precision of the prior, (width,), by the body's own size."""
        if motion.body is None or place.held is None:
            return self.prior(width)
        mass, *moments = motion.body.carrier(place.held)[1][:4].tolist()
        reach = max(float(np.linalg.norm(moments)) / mass, _LEAST_REACH)
        size = mass * np.array([1.0] + [reach] * 3 + [reach**2] * 6)
        return np.asarray(1.0 / size**2)

    def beneath(self, motion: Motion, place: Place) -> FloatArray | None:
        """The body as the study has it."""
        if motion.body is None or place.held is None:
            return None
        return motion.body.carrier(place.held)[1]

    def of_amount(
        self, amount: float, motions: Sequence[Motion], place: Place, shape: Shape, width: int
    ) -> tuple[Shape, FloatArray]:
        """So much more of it."""
        own = self.beneath(motions[0], place)
        return shape, amount * np.eye(width)[0] if own is None else amount / own[0] * own

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation of a recording that holds it is given."""
        ten = [site.get(each.name) for each in self.parameters]
        return (LinkChange(link=site.link, inertial=Inertial.from_ten(ten), held=site.variant),)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        h = np.linalg.norm([values[f"d_first_moment_{axis}"] for axis in "xyz"])
        return (
            f"{where} is not as the study says: {values['d_mass']:+.3g} kg and {h:.3g} kg m of"
            " first moment."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"recordings in which {where} is held"
