"""What a simulation can be given beyond the model its user believes.

A law's torque is what the drive must add to the rigid body's inverse dynamics, so friction is
positive for positive speed; on the joint it acts with the other sign.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from .inertial import Inertial

Law = Callable[[float, float, float, float], float]
"""Torque or level [N m] by time [s], position [rad], speed [rad/s], torque in the gear [N m]."""

Vector = tuple[float, float, float]
SensedChannel = Literal["q", "dq", "tau"]


class StatefulLaw(ABC):
    """A law with a memory."""

    stiffness: float = 0.0  # largest change of torque with position, for the step's length

    @abstractmethod
    def fresh(self) -> StatefulLaw:
        """The same law before anything happened."""

    @abstractmethod
    def __call__(self, t: float, q: float, dq: float, load: float) -> float:
        """Torque now."""

    @abstractmethod
    def advance(self, q: float, dq: float, dt: float) -> None:
        """Go on by a step of dt at whose end the joint is at q with speed dq."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointTorque:
    """A torque law at one joint."""

    joint: str
    law: Law | StatefulLaw
    of: str = ""  # the joint whose position and speed the law sees, if another
    at_link: bool = False  # beyond the gear's play and elasticity, and of the link's position
    needs_load: bool = False  # or the load it sees is 0
    by_clock: bool = False  # the time it sees is the study's clock, not since the start


@dataclass(frozen=True, slots=True, kw_only=True)
class HardFriction:
    """Friction that holds a resting joint and opposes a moving one with a level that may vary."""

    joint: str
    level: float | Law  # [N m]; levels of one joint add up, less than none is none
    needs_load: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class DofChange:
    """What is added to a joint's figures."""

    joint: str
    damping: float = 0.0  # [N m s/rad]
    armature: float = 0.0  # [kg m^2]
    stiffness: float = 0.0  # [N m/rad]
    rest: float = 0.0  # where the spring is slack [rad]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinkChange:
    """Inertial parameters added to a link's, or put in their place."""

    link: str  # the last joint's for ""
    inertial: Inertial
    replace: bool = False
    held: str = ""  # label of the attached body without which it is not there; "": always there


@dataclass(frozen=True, slots=True, kw_only=True)
class GravityTilt:
    """The base stands rolled by R = R_x(x) R_y(y): gravity in its frame is R^T g."""

    x: float = 0.0  # [rad]
    y: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Placement:
    """A joint's frame shifted in its parent's axes, then moved and turned in its own."""

    joint: str
    shift: Vector = (0.0, 0.0, 0.0)  # in the parent's axes [m]
    translation: Vector = (0.0, 0.0, 0.0)  # [m]
    rotation: Vector = (0.0, 0.0, 0.0)  # rotation vector [rad]


@dataclass(frozen=True, slots=True, kw_only=True)
class Wave:
    """A sin(h q + phase)."""

    amplitude: float  # [rad]
    harmonic: float  # cycles per turn
    phase: float = 0.0  # [rad]

    def __call__(self, q: float) -> tuple[float, float, float]:
        """Value, slope and curvature at q."""
        angle = self.harmonic * q + self.phase
        value, slope = self.amplitude * math.sin(angle), self.amplitude * math.cos(angle)
        return value, self.harmonic * slope, -(self.harmonic**2) * value


@dataclass(frozen=True, slots=True, kw_only=True)
class GearPlay:
    """Between motor and link: play, a spring with a damper, or both in series.

    The link is where they let it be, and `waves` of the motor's position further.

    Encoder, friction and rotor inertia stay at the motor.
    """

    joint: str
    gap: float = 0.0  # whole play [rad]
    stiffness: float = float("inf")  # [N m/rad]
    damping: float = 0.0  # [N m s/rad]
    waves: tuple[Wave, ...] = ()

    @property
    def is_rigid(self) -> bool:
        """Whether the link's place follows from the motor's."""
        return math.isinf(self.stiffness) and not self.gap

    def error(self, q: float) -> tuple[float, float, float]:
        """How far the waves put the link with the motor at q, with slope and curvature."""
        each = [wave(q) for wave in self.waves]
        return sum(e[0] for e in each), sum(e[1] for e in each), sum(e[2] for e in each)


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveChange:
    """What a drive makes of commands.

    The command acts `delay` later, is limited, lags; the result y is what the drive reports, and
    (y - offset) / gain what it exerts. Of a controller's commands that is the desired position;
    the torque it makes of that may come late, too.
    """

    joint: str
    delay: float = 0.0  # of commands from outside [s]
    command_lag: float = 0.0  # time constant by which desired positions lag [s]
    torque_delay: float = 0.0  # of commanded torques, within the loop [s]
    limit: float = float("inf")  # [N m]
    stall_torque: float = float("inf")  # the most at rest, less the faster the joint turns [N m]
    no_load_speed: float = float("inf")  # at which nothing is left of that [rad/s]
    time_constant: float = 0.0  # [s]
    gain: float = 1.0
    offset: float = 0.0  # [N m]
    command_gain: float = 1.0  # the command is first changed to command_gain * command
    command_offset: float = 0.0  # + command_offset [N m]


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorChange:
    """What is measured of a joint: gain (truth - offset), logged `skew` late.

    The controller sees positions and speeds with gain and offset, but without skew, and without the
    gain where that is the log's alone.
    """

    joint: str
    channel: SensedChannel = "q"
    offset: float = 0.0
    gain: float = 1.0
    skew: float = 0.0  # [s]
    log_only: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupling:
    """The motor of `by` moves `joint` too: true = motor + ratio motor_by.

    So the motor of `by` has ratio times the torque of `joint` in addition to its own.
    """

    joint: str
    by: str
    ratio: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalForce:
    """A force at the origin of a link's frame for a while."""

    link: str
    force: Vector  # in the base frame [N]
    window: tuple[float, float] | None = None  # [s]; None: always
    recordings: tuple[str, ...] = ()  # only in these; () for all
    at_origin: bool = False  # of the link, even where the tip is on it


Part = (
    JointTorque
    | HardFriction
    | DofChange
    | LinkChange
    | GravityTilt
    | Placement
    | GearPlay
    | DriveChange
    | SensorChange
    | Coupling
    | ExternalForce
)
