"""A force on the robot for some time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...motion import Columns, Motion, Place, Shape
from ...simulation import ExternalForce, Part
from ..effect import Effect, Example, Parameter
from ..site import Site

ORIGIN: Shape = (1.0,)
"""Shape of a push at the last link's origin instead of the tip."""


class ExternalContact(Effect):
    """tau = -J^T f within a window of one recording, f constant in the base's axes.

    J is that of the link's origin; of the last link's tip, or with a shape of its origin too.
    """

    id = "external_contact"
    name = "contact from outside"
    family = "contact"
    on = "window"
    equation = "tau = -J(q)^T f, from t0 to t1"
    parameters = tuple(Parameter(f"force_{axis}", "N") for axis in "xyz")
    confused_with = ("payload", "torque_offset")
    decided_by = "the same motion once more with nothing near the robot"
    source = "Haddadin, De Luca and Albu-Schaeffer, IEEE T-RO 33(6), 2017"
    example = Example(
        values={"force_x": 6.0, "force_y": -8.0, "force_z": 5.0},
        place=Place(link=1, recording="example", window=(3.0, 6.0)),
    )
    complexity = 4
    per_joint_moving = False
    against = "q"
    sought = "windows"
    refined = False
    jumps = True

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """None: windows are looked for in the residual."""
        return []

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Torques per newton on the link, zero outside the window."""
        assert place.link is not None
        inside = np.zeros(len(motion.time), dtype=bool)
        if place.window is not None and place.recording == motion.recording.name:
            inside = (motion.time >= place.window[0]) & (motion.time < place.window[1])
        jacobian = motion.link_jacobian(place.link, at_tip=not shape)  # (T, 3, n)
        part = np.where(inside[:, None, None], -jacobian, 0.0)
        return {("torque", j): np.ascontiguousarray(part[:, :, j]) for j in range(motion.n)}

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """A point is what it is."""
        return [(value, value) for value in shape]

    def variant(self, shape: Shape) -> str:
        """Where the last link is pushed, if not at the tip."""
        return "origin" if shape else ""

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        push = ExternalForce(
            link=site.link,
            force=(site.get("force_x"), site.get("force_y"), site.get("force_z")),
            window=site.window,
            recordings=site.recordings,
            at_origin=site.variant == "origin",
        )
        return (push,)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        force = np.array([values[f"force_{axis}"] for axis in "xyz"])
        size = float(np.linalg.norm(force))
        direction = ", ".join(f"{f:.2g}" for f in force / max(size, 1e-12))
        return f"Something pushed {where} with {size:.3g} N along ({direction}) of the base."

    def regime(self, where: str) -> str:
        """When it shows."""
        return "a stretch of one recording"
