"""Bodies and where they are: masses, loads, geometry, which way is down."""

from .gravity_direction import GravityDirection
from .inertial import LinkInertials, Payload
from .kinematic_error import KinematicError
from .payload_error import PayloadError

__all__ = [
    "GravityDirection",
    "KinematicError",
    "LinkInertials",
    "Payload",
    "PayloadError",
]
