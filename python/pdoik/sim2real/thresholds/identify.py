"""What is believed before data are looked at, and from when a cause is claimed."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentifyThresholds(Group):
    """Of the posterior over sets of causes."""

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
    fewest_days: int = threshold(
        3, "sessions from which their differences tell much of others", "sessions"
    )
    drive_zero: float = threshold(
        0.02, "standard deviation of a drive's zero, in usual torques", "", "current loops"
    )
    drive_scale: float = threshold(0.02, "the same of its scale beside its command")
    speed_scale: float = threshold(0.005, "the same of a speed's scale beside its position's")
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
        0.3, "part of a peculiar cause, as a share of what its balance usually is"
    )
    fixed_error: float = threshold(
        0.15, "standard deviation of a coefficient that is 1 by its meaning"
    )
    least_repeats: float = threshold(
        1.5, "rows that say the same at least: three a period of the cut-off, noise up to it"
    )
    worth: float = threshold(
        3.0,
        "log posterior odds from which a cause is taken",
        "",
        "Kass and Raftery, JASA 90(430), 1995: strong",
    )
    better: float = threshold(1.0, "log odds by which another set must be better to be taken")
    shape_price: float = threshold(
        1.5, "log odds that a nonlinear parameter costs which was moved to its best"
    )
    sure: float = threshold(
        3.0, "errors by which an ordinary part must differ from nothing", "s.e."
    )
    matters: float = threshold(
        0.3, "an ordinary part over what nothing explains, from which it is named"
    )
    matters_more: float = threshold(1.0, "the same of a peculiar cause")
    matters_common: float = threshold(0.7, "the same of one that many machines have")
    common: float = threshold(0.1, "probability of a cause at a place, from which many have it")
    judged: float = threshold(
        0.2,
        "share of what all else leaves of recordings that only judge, that a peculiar cause must"
        " explain",
    )
    alike: float = threshold(2.0, "factor within which joints' delays may be one cause's")
    left: float = threshold(
        1.35, "noise that a torque must leave for parts, moments and nameless causes", "sigma"
    )
    restless: float = threshold(1.5, "the same for causes that are simulated", "sigma")
    scale_off: float = threshold(
        0.08, "share by which a torque's scale must be off to be named, beyond calibration"
    )
    level: float = threshold(
        4.6, "log odds within which another name is a rival: a hundredth as likely"
    )
    beyond: float = threshold(
        3.0, "standard deviations of its trust beyond which a body is not within it", "s.e."
    )
    most: int = threshold(40, "peculiar causes at most")
    linear: float = threshold(
        0.5, "noise by which a cause must change another's columns for a new linearisation", "sigma"
    )
    tilt: float = threshold(
        0.02, "angle by which a base must be tilted for unknown bodies to weigh another way", "rad"
    )
    inside: float = threshold(
        0.02, "share of a cause's squared column on the rows that count; less is a filter's ringing"
    )
    harmonic_power: float = threshold(
        20.0,
        "power of a harmonic in what is left, from which it is a candidate",
        "sigma^2",
    )
    harmonic_rows: int = threshold(50, "rows from which a harmonic can be found", "rows")
    moment_better: float = threshold(
        0.3, "share by which a moment inside a recording must explain more than any border"
    )
    moment_away: float = threshold(2.0, "least time between such a moment and a border", "s")
