"""What touches a machine."""

from .external_contact import ORIGIN, ExternalContact
from .ground import FootFriction, FootSoftness, GroundHeight, GroundSlope

__all__ = [
    "ORIGIN",
    "ExternalContact",
    "FootFriction",
    "FootSoftness",
    "GroundHeight",
    "GroundSlope",
]
