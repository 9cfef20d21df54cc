"""What is believed of machines, drawings and sensors before data are looked at."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class PriorThresholds(Group):
    """Usual sizes: standard deviations of priors, and of what no recording shows."""

    friction: float = threshold(
        1.0, "standard deviation of each part of a joint's friction, in its usual torques"
    )
    offset: float = threshold(0.3, "the same of a torque's zero", "", "drive calibration")
    torque: float = threshold(
        0.05, "the same of a torque's scale", "", "current sensors and torque constants: 3 to 5 %"
    )
    rotor: float = threshold(
        0.3, "the same of a rotor's torque at the joint's usual acceleration", "", "geared arms"
    )
    bodies: float = threshold(
        0.1,
        "the same of masses, first moments and inertias where the study says nothing",
        "",
        "drawings against identified arms",
    )
    good_bodies: float = threshold(
        0.01, "the same of a model that was identified or is the machine's own, the other choice"
    )
    days: float = threshold(
        0.1,
        "the same of friction between sessions, as a share of it, where one alone was recorded",
        "",
        "repeated identifications: 10 to 30 % from day to day",
    )
    days_more: float = threshold(3.0, "factor by which sessions may differ more or less than that")
    drive_zero: float = threshold(
        0.02, "standard deviation of a drive's zero, in usual torques", "", "current loops"
    )
    drive_scale: float = threshold(0.02, "the same of its scale against its command")
    speed_scale: float = threshold(0.005, "the same of a speed's scale against its position's")
    imu_tilt: float = threshold(
        0.01,
        "standard deviation of an IMU's mounting about each axis",
        "rad",
        "surfaces and boards: half a degree",
    )
    imu_acc: float = threshold(
        0.1,
        "the same of an accelerometer's zero",
        "m/s^2",
        "data sheets of MEMS sensors: 5 to 40 mg",
    )
    imu_gyro: float = threshold(
        0.01, "the same of a gyro's zero", "rad/s", "data sheets of MEMS sensors: 0.1 to 1 degree/s"
    )
    usual_part: float = threshold(
        0.3, "part of an anomalous cause, as a share of what its balance usually is"
    )
    fixed_error: float = threshold(
        0.15, "standard deviation of a coefficient that is 1 by its meaning"
    )
    least_repeats: float = threshold(
        1.5, "rows that say the same at least: three a period of the cut-off, noise up to it"
    )
    torque_scale: float = threshold(
        0.04,
        "standard deviation of a torque's own scale, which intervals of all that follows from"
        " torques include; 'trust: {torque: ...}' of a study says another",
        "",
        "gain errors of current sensors and torque constants: data sheets, 3 to 5 %",
    )
    position_delay: float = threshold(
        0.03,
        "standard deviation of a position's delay by sampling, in periods",
        "",
        "forty studies with nothing wrong: 0.013 root mean square, 0.06 at most",
    )
    torque_delay: float = threshold(
        0.15,
        "the same of a torque's",
        "",
        "twice the 0.08 of such studies: machines differ in when within a tick a torque acts",
    )
    unknown_delay: float = threshold(0.3, "the same of any where the period is not known")
    log_delay: float = threshold(0.01, "part of the same by interpolation, in the log's periods")
    discretisation: float = threshold(
        0.0015, "share of a value that differentiation and sampling may take"
    )
    of_the_model: float = threshold(
        0.03, "share of a torque's size, to which a simulator follows inverse dynamics"
    )
    usual_residue: float = threshold(
        0.1, "what catalogue laws leave of a joint's friction, at least", "", "identified arms"
    )
    usual_change: float = threshold(
        0.08,
        "by which friction differs between recordings at least, as a share",
        "",
        "repeated identifications of one arm: 10 % from day to day",
    )
