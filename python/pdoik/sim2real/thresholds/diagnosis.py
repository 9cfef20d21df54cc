"""Every number by which a diagnosis decides: what is taken, claimed, suspected or explained."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagnosisThresholds(Group):
    """Standards that all stages share come first; then those of one question each."""

    worth: float = threshold(
        3.0,
        "log posterior odds from which a cause is taken",
        "",
        "Kass and Raftery, JASA 90(430), 1995: strong",
    )
    better: float = threshold(1.0, "log odds by which another set must be better to be taken")
    level: float = threshold(
        4.6, "log odds within which another name is a rival: a hundredth as likely"
    )
    shape_price: float = threshold(
        1.5, "log odds that a nonlinear parameter costs which was moved to its best"
    )
    sure: float = threshold(
        3.0,
        "errors by which something must differ from nothing, or from another, to be clear",
        "s.e.",
    )
    most_of: float = threshold(0.5, "share that is most of something", "", "the meaning of most")
    little: float = threshold(0.05, "share of something that is little of it")
    nothing: float = threshold(0.02, "share of something that is next to nothing of it")
    shown: float = threshold(
        0.1, "share of a variance that must depend on a variable for the data to show that"
    )
    rare: float = threshold(
        3.0,
        "times what others, or other times, show, from which something stands out",
        "",
        "2.7 standard deviations, where joints differ by a factor of 1.5",
    )
    matters: float = threshold(
        0.3, "an ordinary part over what nothing explains, from which it is named"
    )
    matters_more: float = threshold(
        1.0, "the same of an anomalous cause: less is the misfit of another's law"
    )
    matters_common: float = threshold(0.7, "the same of one that many machines have")
    common: float = threshold(
        0.1, "probability of a cause at a place, from which many machines have it"
    )
    judged: float = threshold(
        0.2,
        "share of what all else leaves of recordings that only judge, that an anomalous cause must"
        " explain; of a mismatch, that another source of it must be",
    )
    suspected: float = threshold(0.75, "confidence below which a finding is suspected, not claimed")
    restless: float = threshold(
        1.35,
        "noise that a torque must leave for parts, moments, nameless and simulated causes",
        "sigma",
    )
    scale_off: float = threshold(
        0.08, "share by which a torque's scale must be off to be named, beyond calibration"
    )
    alike: float = threshold(2.0, "factor within which joints' delays may be one cause's")
    linear: float = threshold(
        0.5, "noise by which a cause must change another's columns for a new linearisation", "sigma"
    )
    tilt: float = threshold(
        0.02, "angle of a base from which the weight of unknown bodies acts another way", "rad"
    )
    harmonic_power: float = threshold(
        20.0, "power of a harmonic in what is left, from which it is a candidate", "sigma^2"
    )
    harmonic_rows: int = threshold(50, "rows from which a harmonic can be found", "rows")
    moment_better: float = threshold(
        0.3, "share by which a moment inside a recording must explain more than any border"
    )
    push_gain: float = threshold(80.0, "decrease of the cost within a push's window", "sigma^2")
    push_harm: float = threshold(
        0.002, "share of the gain by which a joint may be worse: a push is not quite constant"
    )
    push_t: float = threshold(
        6.0, "Wald statistic of a push's force: hundreds of windows are looked at", "s.e."
    )
    push_share: float = threshold(
        0.01, "share of the first residual within its window that a held-out push must explain"
    )
    shortest: float = threshold(
        0.2, "time that a push, or a stretch of rows that err alike, lasts at least", "s"
    )
    fewest_stretches: int = threshold(
        12, "stretches in which a term acts, from which its error is estimated", "stretches"
    )
    on_bound: float = threshold(1e-3, "share of a bound within which a figure lies on it")
    silent: float = threshold(
        10.0, "times the variance before any row, from which a session says nothing of a figure"
    )
    spread_p: float = threshold(
        0.01,
        "probability of differences between sessions, below which they are said",
        "",
        "a standard: 1 %",
    )
    delay_given: float = threshold(
        1 / 3, "share of a delay, below which another joint's error says whether it is late too"
    )
    near_floor: float = threshold(
        1.6, "times the noise floor, within which what is left counts as explained"
    )
    quiet: float = threshold(2.0, "times the noise floor, within which what is left needs no name")
    change_blocks: int = threshold(4, "blocks in which a recording must show a friction", "blocks")
    settling: float = threshold(0.7, "beginning of each simulated run that is not judged", "s")
    least_move: float = threshold(
        0.3, "errors that a figure must move by simulation to be worth another run", "s.e."
    )
    own_error: float = threshold(
        0.25, "share of a simulation's correction that is added to its figure's error"
    )
