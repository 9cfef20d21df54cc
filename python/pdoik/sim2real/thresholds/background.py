"""What every machine has, whatever its model says."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class BackgroundThresholds(Group):
    """Standard deviations of what is fitted beside the search for what is peculiar."""

    offset: float = threshold(
        0.1, "of a torque's zero beside friction of one way, as a share of the joint's usual torque"
    )
    stands_t: float = threshold(
        3.0, "errors by which what is peculiar must stand beside all that may be ordinary", "s.e."
    )
    large: float = threshold(
        1.0 / 3.0, "share of what the background leaves on held-out rows that is no misfit of it"
    )
    imu_tilt: float = threshold(
        0.01, "of an IMU's mounting about each axis", "rad", "surfaces and boards: half a degree"
    )
    imu_acc: float = threshold(
        0.1, "of an accelerometer's zero", "m/s^2", "data sheets of MEMS sensors: 5 to 40 mg"
    )
    imu_gyro: float = threshold(
        0.01, "of a gyro's zero", "rad/s", "data sheets of MEMS sensors: 0.1 to 1 degree/s"
    )
