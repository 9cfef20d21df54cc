"""A study: the model a user believes, recordings of the machine, and what is known besides."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ..thresholds import Thresholds
from .recording import FloatArray, Recording


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Controller:
    """Joint controller of the recorded machine.

    tau = kp (q_des - q) + kd (dq_des - dq) + g(q), clipped to the torque limit; dq_des is zero if
    it was not recorded, g(q) is there with gravity compensation only.
    """

    type: Literal["pd"] = "pd"
    kp: FloatArray  # (n,) [N m/rad]
    kd: FloatArray  # (n,) [N m s/rad]
    gravity_compensation: bool = False
    torque_limit: FloatArray | None = None  # (n,) [N m]
    period: float | None = None  # [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trust:
    """How far the model's figures may be off, relative; None: they are held to be right."""

    rigid_body: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Study:
    """What `diagnose` is given."""

    folder: Path
    robot: Path | None
    tip: str | None = None  # link whose pose the channel `tip` is; the last link otherwise
    joints: tuple[str, ...]
    recordings: tuple[Recording, ...]
    split: str  # how fit and validate were parted, in words
    controller: Controller | None = None
    simulation: tuple[Recording, ...] = ()
    trust: Trust = field(default_factory=Trust)
    rotor_inertia: FloatArray | None = None  # (n,) seen at the joint [kg m^2]
    notes: tuple[str, ...] = ()
    thresholds: Thresholds = field(default_factory=Thresholds)

    @property
    def fit(self) -> tuple[Recording, ...]:
        """Recordings to learn from."""
        return tuple(recording for recording in self.recordings if recording.role == "fit")

    @property
    def validate(self) -> tuple[Recording, ...]:
        """Recordings never used to fit or to choose."""
        return tuple(recording for recording in self.recordings if recording.role == "validate")
