"""A word of a simulator: read off a compiled model, written into a copy, named elsewhere."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from .user_model import UserModel

EVERY = -1  # the index of what all joints share

Place = Literal["joint", "link", "machine"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scales:
    """Typical sizes at one joint under the recorded commands, which units are made of."""

    torque: float  # root mean square of the drive's [N m]
    speed: float  # [rad/s]
    acceleration: float  # [rad/s^2]
    travel: float  # of the position about its mean [rad]
    mass: float  # of the link and all after it [kg]


class Property(ABC):
    """One word of a simulator. `index` is a place in the study's joints, -1 of the machine."""

    name: ClassVar[str]
    unit: ClassVar[str]
    place: ClassVar[Place] = "joint"
    lowest: ClassVar[float] = 0.0  # of its coordinate
    ends: ClassVar[bool] = False  # whether nothing real has its lowest coordinate
    mujoco: ClassVar[str] = ""  # what an MJCF calls it, if it is not the name
    turns: ClassVar[tuple[str, ...]] = ()  # other words of the same place that it is made of
    isaac: ClassVar[str]  # what Isaac Sim and Isaac Lab call it
    gazebo: ClassVar[str]  # SDF's element

    @abstractmethod
    def read(self, user: UserModel, index: int) -> float:
        """Its value in the user's model."""

    @abstractmethod
    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        """Put a value into a copy of the user's model."""

    @abstractmethod
    def step(self, scales: Scales, value: float) -> float:
        """A change that shows, and is still small."""

    def coordinate(self, value: float) -> float:
        """In which positions change nearest to a line: fits take their steps in it."""
        return value

    def value_at(self, coordinate: float) -> float:
        """Inverse of `coordinate`."""
        return coordinate

    def feigned(self, user: UserModel, index: int) -> float:
        """What torques that are held for a while look like; 0 where they look like none of it."""
        return 0.0


class Gain(Property):
    """A gain, by its inverse: what a torque moves a drive away by, and so what positions show.

    From gains four times too high a line in the gain itself leads below zero.
    """

    lowest, ends = 1e-9, True

    def coordinate(self, value: float) -> float:
        return 1.0 / value

    def value_at(self, coordinate: float) -> float:
        return 1.0 / coordinate


class OfArray(Property):
    """A number in one of the arrays of MuJoCo's model."""

    array: ClassVar[str]

    @abstractmethod
    def at(self, user: UserModel, index: int) -> int | tuple[int, int]:
        """Where in the array."""

    def read(self, user: UserModel, index: int) -> float:
        return float(getattr(user.model, self.array)[self.at(user, index)])

    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        getattr(model, self.array)[self.at(user, index)] = value


def held(user: UserModel) -> float:
    """By how much later torques may act that are held for a step [s].

    It is not known how long the machine's controller holds them, unless the study says it: then
    candidates are held against a motion under torques that are held as long.
    """
    known = user.law is not None and user.law.period is not None
    return 0.0 if known else 0.5 * user.timestep
