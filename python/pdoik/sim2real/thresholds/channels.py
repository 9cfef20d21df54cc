"""When a channel is not what it says, or noisier than it should be."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelThresholds(Group):
    """Thresholds of factors, copies and noise in what was logged."""

    least_factor: float = threshold(
        0.4, "times it should be, below which a torque's channel lies: no drive's gain is less"
    )
    most_factor: float = threshold(2.5, "the same above which it lies")
    factor_t: float = threshold(4.0, "errors by which a factor must differ from one", "s.e.")
    least_correlation: float = threshold(
        0.7, "share of a torque's deviation that what it should be must explain"
    )
    tiny: float = threshold(0.15, "size of a factor that noise may drown and is sure all the same")
    tiny_error: float = threshold(0.2, "share of `tiny` that its error may be")
    law_agrees: float = threshold(
        2.0, "factor within which the model must agree with a factor of the controller's law"
    )
    copy_floor: float = threshold(
        1.5, "times the noise, within which a torque copies the model's for the commanded motion"
    )
    copy_nearer: float = threshold(
        0.7, "times what the motion leaves, within which the commanded one must come"
    )
    copied_joints: float = threshold(0.6, "share of the joints that must be such copies")
    slowest: float = threshold(
        0.02, "standard deviation of a speed that says how it is scaled", "rad/s"
    )
    smallest: float = threshold(0.01, "the same of a position", "rad")
    late: float = threshold(
        1 / 3, "share of a period by which a drive may follow its law later than the others"
    )
    drive_gain: float = threshold(
        3.0, "factor within which a torque is its law's, whatever the drive's gain"
    )
    usual_spread: float = threshold(
        1.5, "factor by which sound joints' noise differs, as one standard deviation"
    )
    spread_weight: float = threshold(10.0, "joints that the usual spread counts as", "joints")
    false_alarm: float = threshold(
        0.01, "chance that a sound channel is called noisy", "", "a standard: 1 %"
    )
    unheard: float = threshold(
        0.5, "share of the others' noise in commands, below which a joint's is in the file only"
    )
    unheard_t: float = threshold(4.0, "errors by which that must be clear", "s.e.")
    least_heard: float = threshold(0.05, "share of noise that controllers must hear to be asked")
    heard_scatter: float = threshold(
        0.1, "share of it by which sound joints' shares differ at least"
    )
    noise_gain: float = threshold(
        0.5, "share of the noise's power beyond what is sound, in either half of the recordings"
    )
    white: float = threshold(
        0.5,
        "share of a noise that is as strong in most of the spectrum, without what hums or rings",
    )
    noise_error: float = threshold(0.03, "least error of a noise, as a share of it")
    noise_blur: float = threshold(
        0.3, "the same per jitter over period, as rows are interpolated to even times"
    )
