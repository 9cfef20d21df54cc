"""When feet show the ground."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class FeetThresholds(Group):
    """Thresholds of a robot that stands on its feet."""

    height: float = threshold(
        1e-3, "to which a sole's height follows from joints and pose", "m", "calibrated legs: 1 mm"
    )
    tilt: float = threshold(
        5e-3,
        "to which a sole's tilt follows from joints and pose",
        "rad",
        "elastic soles; no rocking",
    )
    friction: float = threshold(
        0.1, "by which a coefficient of friction differs from slip to slip", "", "rubber on floors"
    )
    slipping: float = threshold(
        0.05, "speed of a sole that slips", "m/s", "beyond the creep of elastic soles"
    )
