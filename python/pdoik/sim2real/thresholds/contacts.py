"""When something that pushes the robot is claimed."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactThresholds(Group):
    """Of windows of time in which a constant force may act."""

    least_gain: float = threshold(80.0, "decrease of the cost within the window", "sigma^2")
    least_size: float = threshold(1.0, "root mean square of every joint inside", "sigma")
    least_explained: float = threshold(0.5, "share of the squared residual inside")
    above_others: float = threshold(
        3.0, "times the gain of the third best window apart from it: contacts are rare"
    )
    above_usual: float = threshold(
        3.0, "times the mean square of what is left of the same joints at other times"
    )
    harm: float = threshold(
        0.002, "share of the gain by which a joint may be worse: a push is not quite constant"
    )
    shortest: float = threshold(0.2, "time that a contact lasts at least", "s")
    least_t: float = threshold(6.0, "Wald statistic of the force", "s.e.")
    felt: float = threshold(
        0.05, "share of the most that is felt, below which a row is a filter's ringing"
    )
    least_weight: float = threshold(
        0.01, "share of the first residual within its window that a contact must explain"
    )
    most_held_out: int = threshold(3, "contacts of held-out recordings at most")
