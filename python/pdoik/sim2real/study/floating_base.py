"""A base that is not fixed: where its IMU sits, and on which feet it stands."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pdoik.recordings import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Foot:
    """A link that touches the ground."""

    link: str
    flat: bool  # it can take moments, as a sole does; a point otherwise
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)  # its middle in the link's frame [m]
    sole: float | None = None  # from there down to the ground [m]; None: not known


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """What the user's simulator has under the feet: a level plane."""

    friction: float | None = None  # coefficient; None: not known
    height: float = 0.0  # in the world of the base's pose [m]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FloatingBase:
    """What a study says of a robot whose base moves."""

    link: str  # that floats
    imu_position: FloatArray = field(default_factory=lambda: np.zeros(3))  # on that link [m]
    imu_rotation: FloatArray = field(default_factory=lambda: np.eye(3))  # IMU axes to the link's
    feet: tuple[Foot, ...] = ()
    ground: Ground = field(default_factory=Ground)
