"""What a user may ask of a motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path as File
from typing import Literal

from pdoik.recordings import FloatArray

from .clear import Clear

SHORTEST = 5.0  # numerics:
"""Shortest duration of a motion [s]: less leaves no room to go somewhere and back."""

_RATES = (20.0, 2000.0)  # of a motion's rows [Hz]
_EFFORT = 400  # motions that are looked at
_SEARCH = 60.0  # that the search takes at most [s]

Base = Literal["hang", "stand"]
"""How a base that floats is carried."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wishes:
    """What a user may ask of a motion."""

    seconds: float = 20.0
    base: Base | None = None  # of one that floats; None: as it was recorded
    rate: float = 100.0  # of the rows [Hz]
    speed_share: float = 0.7
    torque_share: float = 0.8
    acceleration: float | None = None  # of every joint [rad/s^2]
    max_speed: float | None = None  # of joints whose description has none [rad/s]
    max_torque: float | None = None  # [N m]
    figures: bool = False  # of all joints, as exact as can be, instead of what is open
    start: FloatArray | None = None  # (n,) None: where the first recording began
    random: bool = False
    seed: int = 0
    effort: int = _EFFORT
    search: float = _SEARCH  # [s]
    study: File | None = None  # where it is now, if it was moved
    clear: Callable[[tuple[str, ...], str, str | None], Clear | None] | None = None
    """Makes what judges obstacles, of the joints, the robot's text and its tip."""

    def __post_init__(self) -> None:
        """Raises ValueError where a number is out of range."""
        if not self.seconds >= SHORTEST:
            raise ValueError(
                f"{self.seconds:g} s is too short: a motion that starts and ends at rest needs"
                f" {SHORTEST:g} s, and 20 s settle most"
            )
        if not _RATES[0] <= self.rate <= _RATES[1]:
            raise ValueError(f"rate is {self.rate:g} Hz, expected 20 to 2000")
