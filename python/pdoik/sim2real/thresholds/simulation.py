"""What a simulation of the whole arm may change."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationThresholds(Group):
    """Of rollouts from the recorded commands, held against the recordings."""

    settling: float = threshold(0.7, "beginning of each run that is not judged", "s")
    nearer_t: float = threshold(
        2.5, "errors, over blocks, by which one simulation is nearer than another", "s.e."
    )
    nearer_share: float = threshold(
        0.02, "share of the mean loss below which two simulations are as near"
    )
    least_move: float = threshold(
        0.3, "errors that a figure must move to be worth another run", "s.e."
    )
    least_kept: float = threshold(
        0.05, "share of its value that a figure which cannot be negative keeps"
    )
    strays: float = threshold(
        3.0, "times the loss of the regression, beyond which a simulation teaches nothing"
    )
    own_error: float = threshold(0.25, "share of a correction that is added to its figure's error")
