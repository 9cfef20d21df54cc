"""When a machine that is watched has changed."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class WatchThresholds(Group):
    """Thresholds of the CUSUM charts of `pdoik watch`."""

    alarms_per_day: float = threshold(
        1.0, "false alarms of all joints together in 24 h of motion", "1/day"
    )
    friction_change: float = threshold(
        0.15,
        "share of its friction by which a healthy joint may differ from the model",
        source="10 to 30 % from day to day, Simoni et al., IROS 2015, and the README",
    )
    friction_drift: float = threshold(
        0.03,
        "the same share within a day, of a minute: friction is learnt while it is watched",
        source="drives that warm up: 10 to 30 % in an hour",
    )
    bodies: float = threshold(
        0.05,
        "share of a link's mass and moments by which the model's are off, before healthy logs",
        source="CAD without cables and screws: 1 to 10 %",
    )
    told_within: float = threshold(
        1.0, "time after which a change of the smallest size that is looked for is reported", "s"
    )
    shortest: float = threshold(0.15, "time that evidence lasts before it is an alarm", "s")
    slides: float = threshold(
        2e-3,
        "travel since a joint turned or rested after which dry friction is at its level",
        "rad",
        source="presliding, Armstrong-Helouvry et al., Automatica 30(7), 1994",
    )
    memory: float = threshold(
        3.0, "time over which residuals are taken to be correlated at most", "s"
    )
    least_motion: float = threshold(
        5.0, "motion of a joint in healthy logs without which it is not watched", "s"
    )
    learn: float = threshold(
        10.0, "motion of the joint after an alarm from which the cause is learnt", "s"
    )
    learn_at_most: float = threshold(
        40.0, "time after an alarm at which the cause is reported", "s"
    )
    revise: float = threshold(
        120.0, "time after an onset within which its cause may be learnt anew", "s"
    )
    gain: float = threshold(
        0.2,
        "standard deviation of a change of a torque's gain",
        source="current sensors and torque constants, heated or demagnetised: 5 to 30 %",
    )
