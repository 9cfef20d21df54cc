"""What counts as explained."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class VerdictThresholds(Group):
    """Of what is left of the joints, and what is said of it."""

    near_floor: float = threshold(
        1.6, "times the noise floor, within which what is left counts as explained"
    )
    little: float = threshold(0.05, "share of what it was, within which it counts as explained too")
    quiet: float = threshold(2.0, "times the noise floor, within which what is left needs no name")
    of_the_model: float = threshold(
        0.03, "share of a torque's size, to which a simulator follows inverse dynamics"
    )
    of_the_rest: float = threshold(
        0.2, "share of a mismatch, below which the given simulation's own is not spoken of"
    )
    least_residue: float = threshold(
        0.1, "share of the residue that a variable must hold to be named"
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
    change_blocks: int = threshold(4, "blocks in which a recording must show a friction", "blocks")
    change_shown: float = threshold(
        0.1, "share of friction's power about its mean: a joint must turn back to show it"
    )
    outstanding: float = threshold(
        3.0,
        "times what the other joints leave beside their friction, from which one stands out",
        "",
        "2.7 standard deviations, where joints differ by a factor of 1.5",
    )
    more_than_friction: float = threshold(
        1.0, "what is left over a joint's friction, which stands out whatever the others leave"
    )
    level_error: float = threshold(
        0.002, "least error of a limit that only held-out recordings reach, as a share of it"
    )
