"""When a controller's law is believed, and when it contradicts what the study gives."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerThresholds(Group):
    """Thresholds of laws that are estimated from commands, motion and effort."""

    least_rows: int = threshold(200, "samples below which no law is estimated", "rows")
    most_rows: int = threshold(12_000, "samples of a joint that are used at most", "rows")
    settling: float = threshold(0.15, "time at a recording's begin that is left out", "s")
    least_gain: float = threshold(
        0.05, "share of what a simpler law leaves that a further term must save"
    )
    worth: float = threshold(
        5.0,
        "log odds from which a further term, a delay, a limit or another gain is taken",
        "",
        "Kass and Raftery, JASA 90(430), 1995: very strong",
    )
    gain_t: float = threshold(
        3.0, "standard errors by which a position gain must be above nothing", "s.e."
    )
    gain_error: float = threshold(
        0.005, "least error of a gain, as a share of it: a log's samples are not the controller's"
    )
    believed: float = threshold(
        0.8, "share of the held-out effort that a law must explain to be believed"
    )
    used: float = threshold(0.95, "the same for its gains to stand in for gains not known")
    given_off: float = threshold(
        0.05, "share by which a gain that the study gives must be off to be said wrong"
    )
    given_usual: float = threshold(
        0.3, "by which such a gain usually is off where it is wrong, as a share of it"
    )
    flat: float = threshold(0.002, "share of the highest effort within which its top is flat")
    flat_rows: int = threshold(8, "samples at a flat top", "rows")
    let_go: float = threshold(0.08, "time without effort after which a drive may have let go", "s")
    let_go_over: float = threshold(
        5.0, "error of the law over its usual one where a drive has let go"
    )
    no_effort: float = threshold(1e-3, "share of the highest effort that is none")
    longest_delay: float = threshold(0.12, "delay, and time constant, that are sought", "s")
    slow: float = threshold(
        0.2, "frequency below which a law's error is an integral's or a sensor's zero", "Hz"
    )
    law_block: float = threshold(1.0, "time within which a law's errors count as one", "s")
    followed: float = threshold(
        0.95, "share of the effort in the motion's band that some law must explain to be asked more"
    )
    followed_itself: float = threshold(
        0.9, "the same of a joint that may be late, where the other joints reach it"
    )
    followed_elsewhere: float = threshold(
        0.5,
        "share of other recordings' effort that a law must explain for what it misses, or asks for"
        " beyond a limit, to mean anything: most of it",
    )
    late_gain: float = threshold(
        0.1, "share of what a law leaves that coming late, or a limit, must save"
    )
    later: float = threshold(
        0.008, "by which one joint must act later than the others do: current loops differ", "s"
    )
    most_at: float = threshold(0.6, "share of all rows that may be at a limit for it to be one")
    most_over: float = threshold(0.1, "share of what is at a limit that may lie over it")
    as_given: float = threshold(
        0.9, "share of the limit that the robot's description has, from which a limit is no news"
    )
    steady: float = threshold(
        0.8, "share of an effort's changes that come in time where a controller holds it"
    )
    trifle: float = threshold(
        0.15,
        "share of a sample up to which a delay is none: channels are logged one after the other",
    )
    drive_error: float = threshold(
        0.1,
        "share by which a motor's torque per volt differs from the given one",
        "",
        "copper's resistance grows by 0.4 % per K: windings 25 K warmer",
    )
