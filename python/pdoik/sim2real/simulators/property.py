"""A word of a simulator: read off a compiled model, written into a copy, named elsewhere."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Literal

from .user_model import UserModel

EVERY = -1  # the index of what all joints share

Place = Literal["joint", "link", "machine"]


class Property(ABC):
    """One word of a simulator. `index` is a place in the study's joints, -1 of the machine."""

    name: ClassVar[str]
    unit: ClassVar[str]
    place: ClassVar[Place] = "joint"
    mujoco: ClassVar[str] = ""  # what an MJCF calls it, if it is not the name
    isaac: ClassVar[str]  # what Isaac Sim and Isaac Lab call it
    gazebo: ClassVar[str]  # SDF's element

    @abstractmethod
    def read(self, user: UserModel, index: int) -> float:
        """The property's value in the user's model."""

    @abstractmethod
    def write(self, user: UserModel, model: Any, index: int, value: float) -> None:
        """Put a value into a copy of the user's model."""

    def feigned(self, user: UserModel, index: int) -> float:
        """What torques that are held for a while look like; 0 where they look like none of it."""
        return 0.0


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
    """The delay of torques that may be held for a step [s].

    It is not known how long the machine's controller holds them, unless the study says it: then
    candidates are compared with a motion under torques that are held as long.
    """
    known = user.law is not None and user.law.period is not None
    return 0.0 if known else 0.5 * user.timestep
