"""A study: the model a user believes, recordings of the machine, and what else is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pdoik.recordings import FloatArray, Recording

from ..thresholds import Thresholds
from .controller import Controller as Controller
from .controller import GivenController
from .floating_base import FloatingBase
from .payload import Payload
from .simulator_file import SimulatorFile


@dataclass(frozen=True, slots=True, kw_only=True)
class Trust:
    """How far the model's figures and the torques may be off, relative."""

    rigid_body: float | None = None  # None: they are believed to be right
    torque: float | None = None  # standard deviation of their scale; None: as sensors usually are


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Setup:
    """How one recording was made, as far as it differs from the study."""

    robot: Path | None = None  # its description, of the study's joints and links
    payload: Payload | None = None  # the known attached body
    controller: Controller | None = None  # its gains instead of the study's
    compensated: bool = False
    """Whether the controller's gravity compensation knows this robot and payload; it knows the
    study's robot with nothing attached otherwise."""
    session: str = ""  # the day, or whatever else was the same
    held: bool = False  # whether its base was held fixed, by unknown forces
    temperature: FloatArray | None = None  # (n,) of the joints [deg C]
    surface: str = ""  # what it stood on or moved along, in words

    @property
    def is_plain(self) -> bool:
        """Whether robot, load and gains are the study's."""
        return self.robot is None and self.payload is None and self.controller is None

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the diagnosis should know of it, in words."""
        said = []
        if self.robot is not None:
            said.append(f"of the robot in {self.robot.name}")
        if self.payload is not None:
            said.append(f"holds {self.payload.label}")
        if self.compensated:
            said.append("its controller's gravity compensation knows that")
        if self.controller is not None:
            said.append("has a controller of its own")
        if self.held:
            said.append("its base was held")
        if self.temperature is not None:
            degrees = dict.fromkeys(f"{each:g}" for each in self.temperature.tolist())
            said.append(f"at {', '.join(degrees)} deg C")
        if self.surface:
            said.append(f"surface {self.surface}")
        return tuple(said)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Study:
    """What `diagnose` is given."""

    folder: Path
    source: Path | None = None  # the YAML file it was read from
    robot: Path | None
    base: FloatingBase | None = None  # None: it is fixed
    tip: str | None = None  # link whose pose the channel `tip` is; the last link otherwise
    joints: tuple[str, ...]
    recordings: tuple[Recording, ...]
    split: str  # how fit and validate were parted, in words
    controller: Controller | None = None  # a law that is known
    told: GivenController | None = None  # what the study says of one that may not be
    simulation: tuple[Recording, ...] = ()
    simulator: SimulatorFile | None = None  # the user's own model, of `pdoik compare`
    trust: Trust = field(default_factory=Trust)
    rotor_inertia: FloatArray | None = None  # (n,) seen at the joint [kg m^2]
    notes: tuple[str, ...] = ()
    thresholds: Thresholds = field(default_factory=Thresholds)
    setups: Mapping[str, Setup] = field(default_factory=dict)  # by recording, where they differ

    @property
    def floats(self) -> bool:
        """Whether the robot's base floats."""
        return self.base is not None

    def setup_of(self, recording: Recording) -> Setup:
        """What is known of a recording, or of the one it is a part of."""
        return self.setups.get(recording.file or recording.name, Setup())

    @property
    def shared_controller(self) -> Controller | None:
        """The controller of all recordings; None where one has its own."""
        own = any(each.controller is not None for each in self.setups.values())
        return None if own else self.controller

    @property
    def fit(self) -> tuple[Recording, ...]:
        """Recordings to learn from."""
        return tuple(recording for recording in self.recordings if recording.role == "fit")

    @property
    def validate(self) -> tuple[Recording, ...]:
        """Recordings never used to fit or to choose."""
        return tuple(recording for recording in self.recordings if recording.role == "validate")
