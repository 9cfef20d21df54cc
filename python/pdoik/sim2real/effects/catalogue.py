"""Every effect by its id: pdoik's own, and those that other packages or users register."""

from __future__ import annotations

import importlib.metadata

from .bodies import GravityDirection, KinematicError, LinkInertials, Payload, PayloadError
from .contacts import ExternalContact, FootFriction, FootSoftness, GroundHeight, GroundSlope
from .drives import (
    ActuatorLag,
    CommandDelay,
    TorqueGain,
    TorqueOffset,
    TorqueSaturation,
    TorqueSpeedLimit,
)
from .effect import Effect
from .friction import (
    AsymmetricFriction,
    CoulombFriction,
    FrictionDrift,
    LoadDependentFriction,
    PreslidingHysteresis,
    StribeckFriction,
    ViscousFriction,
)
from .sensors import ImuOffset, ImuTilt, JointOffset, SensorGain, SensorNoise, TimestampSkew
from .transmission import (
    Backlash,
    GearEfficiency,
    JointCoupling,
    JointElasticity,
    PositionDependentSpring,
    RotorInertia,
    StrainWaveError,
    TorqueRipple,
)
from .unknown import Unknown

GROUP = "pdoik.effects"
"""Entry points of this group are classes of effects, or instances."""

CATALOGUE: dict[str, Effect] = {}
"""Effects by their id."""


def register(effect: Effect | type[Effect]) -> Effect:
    """Add an effect to the catalogue, so that it is tried, simulated, listed and reported.

    Args:
        effect: an instance, or a class that needs no arguments.

    Raises:
        ValueError: it has no id, or that of another effect.
    """
    made = effect() if isinstance(effect, type) else effect
    name = getattr(made, "id", "")
    if not name:
        raise ValueError(f"{type(made).__name__} has no id, expected a name such as 'stiction'")
    if name in CATALOGUE and type(CATALOGUE[name]) is not type(made):
        raise ValueError(f"there is another effect {name!r}: {type(CATALOGUE[name]).__name__}")
    CATALOGUE[name] = made
    return made


def known(effect: str) -> Effect:
    """The effect of an id.

    Raises:
        ValueError: there is none.
    """
    if effect not in CATALOGUE:
        raise ValueError(f"no effect {effect!r}, expected one of {', '.join(CATALOGUE)}")
    return CATALOGUE[effect]


for _effect in (
    ViscousFriction(),
    CoulombFriction(),
    StribeckFriction(),
    AsymmetricFriction(),
    LoadDependentFriction(),
    GearEfficiency(),
    PreslidingHysteresis(),
    FrictionDrift(),
    RotorInertia(),
    Payload(),
    PayloadError(),
    LinkInertials(),
    GravityDirection(),
    ImuTilt(),
    ImuOffset(),
    GroundHeight(),
    GroundSlope(),
    FootSoftness(),
    FootFriction(),
    TorqueGain(),
    TorqueOffset(),
    TorqueSaturation(),
    TorqueSpeedLimit(),
    TorqueRipple(),
    PositionDependentSpring(),
    CommandDelay(),
    ActuatorLag(),
    Backlash(),
    JointElasticity(),
    JointOffset(),
    KinematicError(),
    StrainWaveError(),
    JointCoupling(),
    TimestampSkew(),
    SensorGain(),
    SensorNoise(),
    ExternalContact(),
    Unknown(),
):
    register(_effect)

for _entry in importlib.metadata.entry_points(group=GROUP):
    register(_entry.load())
