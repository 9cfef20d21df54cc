"""What is believed of a user's simulator compared with a machine."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold

_FITTED = (
    "logistic regression as in bench.sim2real.simulators.confidence, on 18 findings of seven pairs"
    " of development: few; by gains over all channels"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatorThresholds(Group):
    """Thresholds of candidates that are simulated under recorded commands."""

    false_alarms: float = threshold(
        0.05, "probability, before the data, that any of what few machines have differs"
    )
    differs: float = threshold(
        0.1, "probability, before the data, that what every machine has differs enough to be named"
    )
    least_confidence: float = threshold(
        0.75, "confidence below which a finding is suspected, not claimed"
    )
    least_suspected: float = threshold(
        0.5, "probability of holding on held-out data below which nothing is said of a term"
    )
    base: float = threshold(
        -1.0, "log odds that a finding is true which takes away half of the error", "", _FITTED
    )
    per_gain: float = threshold(
        1.96, "per log odds of the share of the error that a finding takes away", "", _FITTED
    )
    shows: float = threshold(
        0.5, "times a channel's noise that a finding must change its motion by"
    )
    of_step: float = threshold(
        1.5,
        "times what holding torques for a step looks like (damping kp T/2, armature kd T/2, delay"
        " T/2) up to which a finding may be nothing else, where the controller's period is unknown",
    )
    explained: float = threshold(
        0.8, "share of the squared error above noise that findings of an explained mismatch gain"
    )
    alike: float = threshold(
        1.5, "times the noise of its channel up to which a joint's error counts as none"
    )
    runs_away: float = threshold(
        20.0,
        "times its recorded range, and a turn, by which a joint of a stable simulator may stray",
    )
    of_its_step: float = threshold(
        1.0, "times its recorded motion by which a joint may move otherwise with a truer step"
    )
    rival: float = threshold(
        3.0,
        "log odds by which another term may explain the data worse and be named with it",
        "",
        "Kass and Raftery, JASA 90(430), 1995: strong",
    )
    moves: float = threshold(2e-3, "range from which a joint moved", "rad")
    base_shift: float = threshold(0.02, "by which a stand lets a base move", "m")
    base_spin: float = threshold(0.1, "root mean square at which it lets it turn", "rad/s")
    same_commands: float = threshold(
        0.95, "correlation of commands from which two runs are of the same ones"
    )
    clocks: float = threshold(2e-3, "share by which the clocks of two logs may run apart", "s/s")
