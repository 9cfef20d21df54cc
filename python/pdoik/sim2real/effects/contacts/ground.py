"""A ground that is not where or what the simulation has it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Balance, Columns, FootMotion, Motion, Place, Shape, tilt_key
from ...thresholds import FeetThresholds
from ..effect import Effect, Parameter


class _OfGround(Effect):
    """Shown by the heights of the soles that stand, or by forces of those that slip."""

    family = "contact"
    on = "ground"
    of_floating_base = True
    per_joint_moving = False

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """The ground, where heights of feet and the base's pose show it."""
        return [Place()] if any(foot.height is not None for foot in motions[0].feet) else []

    def not_simulated(self, values: Mapping[str, float]) -> str:
        """Simulations here have no ground."""
        return "simulations have no ground"

    def regime(self, where: str) -> str:
        """When it shows."""
        return "feet that stand"


class GroundHeight(_OfGround):
    """The floor is higher than in the simulation."""

    id = "ground_height"
    name = "height of the ground"
    equation = "z_sole = h"
    parameters = (Parameter("height", "m"),)
    confused_with = ("joint_offset", "ground_slope")
    decided_by = "one foot after the other on a measured spot"
    source = "geometry"
    complexity = 1

    def admissible(self, beta: FloatArray) -> bool:
        """Nearer than soles are known to be, nothing is said: each sinks in a little."""
        return super().admissible(beta) and abs(float(beta[0])) > FeetThresholds().height

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """One for every sole."""
        one = np.ones((len(motion.time), 1))
        return {("foot", k): one for k, foot in enumerate(motion.feet) if foot.height is not None}

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return f"The ground is {1e3 * values['height']:.3g} mm higher than the simulation has it."


class GroundSlope(_OfGround):
    """The floor is inclined: shown by where soles stand and, of flat ones, how."""

    id = "ground_slope"
    name = "slope of the ground"
    equation = "z_sole = h + s_x x + s_y y"
    parameters = (
        Parameter("slope_x", "-", lower=-0.5, upper=0.5),
        Parameter("slope_y", "-", lower=-0.5, upper=0.5),
        Parameter("height", "m"),  # at the world's origin
    )
    confused_with = ("ground_height", "joint_offset", "imu_tilt")
    decided_by = "the same stance turned about by a quarter"
    source = "geometry"
    complexity = 2

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """The ground, where a sole's tilt or heights of soles show it."""
        tilted = any(foot.tilt is not None for foot in motions[0].feet)
        return [Place()] if tilted else super().places(motions)

    def admissible(self, beta: FloatArray) -> bool:
        """Less than soles' tilts are known to be, nothing is said."""
        steep = float(np.hypot(beta[0], beta[1])) > FeetThresholds().tilt
        return super().admissible(beta) and steep

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Where each sole is."""
        columns: Columns = {}
        for k, foot in enumerate(motion.feet):
            if foot.height is not None and foot.world is not None:
                columns["foot", k] = np.column_stack([foot.world[:, :2], np.ones(len(motion.time))])
            if foot.tilt is not None:
                for axis in range(2):
                    columns[tilt_key(k, axis)] = np.tile(np.eye(3)[axis], (len(motion.time), 1))
        return columns

    def prior(self, width: int) -> FloatArray:
        """A floor's own height is free within centimetres."""
        return np.array([0.0, 0.0, 1.0 / 0.05**2])

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        x, y = (np.degrees(np.arctan(values[f"slope_{axis}"])) for axis in "xy")
        return f"The ground rises by {x:.2g} degrees along x and {y:.2g} along y."


class _OfFoot(_OfGround):
    """An effect at one foot, or at all alike."""

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """Each foot, and all."""
        feet = motions[0].feet
        if not super().places(motions):
            return []
        return [Place(), *(Place(foot=k) for k in range(len(feet)))]

    def _pressed(self, motion: Motion, place: Place, balance: Balance, size: float) -> Columns:
        """`size` times what presses each foot of a place, in one of the feet's balances."""
        feet = range(len(motion.feet)) if place.foot is None else (place.foot,)
        columns: Columns = {}
        for k in feet:
            normal = motion.feet[k].normal
            if motion.feet[k].of(balance) is not None and normal is not None:
                columns[balance, k] = size * normal[:, None]
        return columns


class FootSoftness(_OfFoot):
    """A sole that gives way under load, or the ground beneath it."""

    id = "foot_softness"
    name = "softness of a foot"
    on = "foot"
    equation = "z_sole = -c f_n"
    parameters = (Parameter("compliance", "m/N", lower=0.0),)
    confused_with = ("ground_height", "joint_offset")
    decided_by = "weight shifted from foot to foot"
    source = "Hunt and Crossley, J. Applied Mechanics 42(2), 1975, at rest"
    complexity = 1.5

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """It sinks by the force that presses it."""
        return self._pressed(motion, place, "foot", -1.0)

    def trifling(self, values: Mapping[str, float], motion: Motion, place: Place) -> bool:
        """Less than a sole's height is known to, whatever presses it."""
        pressed = self._pressed(motion, place, "foot", values["compliance"])
        least = motion.thresholds.feet.height
        return bool(pressed) and all(float(each.max()) < least for each in pressed.values())

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return f"{where} sinks in by {1e5 * values['compliance']:.2g} mm for every 100 N."


def _slips(foot: FootMotion, k: int) -> bool:
    return foot.of("grip") is not None and bool(foot.judged(("grip", k)).any())


class FootFriction(_OfFoot):
    """A sole that slips at another force than the simulation's."""

    id = "foot_friction"
    name = "friction of a foot"
    on = "foot"
    equation = "|f_t| = mu f_n while it slips"
    parameters = (Parameter("change", "-"),)
    confused_with = ("foot_softness",)
    decided_by = "a foot pushed sideways until it slips"
    source = "Coulomb's law"
    complexity = 1

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """Feet that slip, and all alike where two of them do."""
        every = super().places(motions)
        slip = {k for m in motions for k, foot in enumerate(m.feet) if _slips(foot, k)}
        own = [place for place in every if place.foot in slip]
        return own if len(own) < 2 else [Place(), *own]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The normal force."""
        return self._pressed(motion, place, "grip", 1.0)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        change = values["change"]
        return (
            f"{where} slips at a coefficient of friction that is {abs(change):.2g}"
            f" {'lower' if change < 0 else 'higher'} than the simulation's."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"{where} slipping"
