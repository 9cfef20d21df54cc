"""A drive that gives less torque the faster its motor turns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape, SpeedTorqueLimit, speed_torque_limit
from ...simulation import DriveChange, Part
from ..effect import Effect, Example, Parameter
from ..site import Site
from .torque_saturation import OF_COMMAND, OF_LAW, asked_of, given_of, kinds


class TorqueSpeedLimit(Effect):
    """tau = clip(tau_cmd, -S (1 + dq / w), S (1 - dq / w)), no less than 0 in the driving way.

    What a supply's voltage leaves besides the motor's own (back-EMF): along the motion at most
    S (1 - |dq| / w).
    """

    id = "torque_speed_limit"
    name = "torque that falls with speed"
    family = "torque"
    on = "joint"
    equation = "tau = clip(tau_cmd, -S (1 + dq / w), S (1 - dq / w))"
    parameters = (
        Parameter("stall_torque", "N m", lower=0.0),
        Parameter("no_load_speed", "rad/s", lower=0.0),
    )
    confused_with = ("torque_saturation", "torque_gain", "actuator_lag")
    decided_by = "full torque asked for at two speeds, one twice the other, with its command"
    source = "Hughes and Drury, Electric Motors and Drives, 2013, Sec. 3.4 (torque-speed curves)"
    at_top = 0.15  # share by which a line's figures may be off
    near_top = 0.225  # log factor by which a line that was fitted may be off
    example = Example(
        values={"stall_torque": 16.0, "no_load_speed": 4.0},
        shape=(OF_COMMAND, 16.0, 4.0),
        nothing={"stall_torque": 1e9, "no_load_speed": 1e9},
    )
    fixed = True
    least_of_rest = 0.5
    complexity = 3
    against = "speed"
    makes_up_for_misfit = True
    of_commands = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """The line that torques keep to where more is asked for."""
        (j,) = place.joints
        tops = [(kind, speed_torque_limit_of(motions, j, kind)) for kind in kinds(motions[0], j)]
        return [
            (kind, top.stall_torque, top.no_load_speed) for kind, top in tops if top is not None
        ]

    def asked(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Shapes for the recorded torques; at the fastest a third of the torque is left."""
        (j,) = place.joints
        fastest = max(float(np.max(np.abs(m.dq[:, j]))) for m in motions)
        return [(kind, np.inf, 1.5 * fastest) for kind in kinds(motions[0], j) if fastest > 0.0]

    def of_amount(
        self, amount: float, motions: Sequence[Motion], place: Place, shape: Shape, width: int
    ) -> tuple[Shape, FloatArray]:
        """The line that a share of the time would be cut at, the amount."""
        (j,), (kind, _, no_load) = place.joints, shape
        stall = []
        for motion in motions:
            asked = asked_of(motion, j, kind)
            left = 1.0 - np.sign(asked) * motion.dq[:, j] / no_load
            stall.append(np.abs(asked) / np.maximum(left, 1e-3))
        return (kind, float(np.quantile(np.concatenate(stall), 1.0 - amount)), no_load), np.ones(1)

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """What is missing beyond the line."""
        (j,) = place.joints
        kind, stall, no_load = shape
        asked, along = asked_of(motion, j, kind), motion.dq[:, j] / no_load
        most, least = stall * np.maximum(1.0 - along, 0.0), -stall * np.maximum(1.0 + along, 0.0)
        beyond = asked - np.clip(asked, least, most)
        return {("law" if kind == OF_LAW else "drive", j): -beyond[:, None]}

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Torque at rest, and the speed at which nothing is left of it."""
        return {"stall_torque": shape[1], "no_load_speed": shape[2]}

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Near the line found first."""
        low, high = 1.0 - self.at_top, 1.0 / (1.0 - self.at_top)
        return [(shape[0], shape[0]), *((low * value, high * value) for value in shape[1:])]

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The coefficient is 1."""
        kind = shape[0] if shape else OF_COMMAND
        return (kind, values["stall_torque"], values["no_load_speed"]), np.ones(1)

    def variant(self, shape: Shape) -> str:
        """What is larger than the torque given."""
        return "law" if shape[0] == OF_LAW else "command"

    def plausible(self, motions: Sequence[Motion], place: Place, shape: Shape) -> bool:
        """Whether what is given keeps to such a line."""
        top = speed_torque_limit_of(motions, place.joints[0], shape[0])
        if top is None:
            return False
        near = (shape[1] / top.stall_torque, shape[2] / top.no_load_speed)
        return all(abs(np.log(each)) < self.near_top for each in near)

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        stall, no_load = site["stall_torque"], site["no_load_speed"]
        return site.each(lambda j: DriveChange(joint=j, stall_torque=stall, no_load_speed=no_load))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"The drive of {where} gives at most {values['stall_torque']:.3g} N m at rest and less"
            f" the faster it turns, nothing at {values['no_load_speed']:.3g} rad/s: its voltage is"
            " used up."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"high torque along fast motion of {where}"


def speed_torque_limit_of(
    motions: Sequence[Motion], j: int, kind: float
) -> SpeedTorqueLimit | None:
    """The line that joint j's torque keeps to where a command or the law asks for more."""
    pairs = [(given_of(m, j, kind), asked_of(m, j, kind), m.valid, m.period) for m in motions]
    if not all(np.isfinite(given).all() and np.isfinite(asked).all() for given, asked, *_ in pairs):
        return None
    speeds = [m.dq[:, j] for m in motions]
    return speed_torque_limit(pairs, speeds, motions[0].thresholds.limits)
