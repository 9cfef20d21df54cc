"""How well the figures that every joint has are known: their Fisher information in a motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..identify import OF_JOINTS, Model

Information = Mapping[tuple[str, int], float]
"""What rows say of each parameter of a joint beyond its prior: an inverse variance."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One figure of a joint."""

    effect: str
    joint: str
    before: float  # standard error by the recordings
    after: float  # expected, with the motion

    @property
    def gain(self) -> float:
        """Log of how many times smaller the error is."""
        return float(np.log(self.before / self.after))


def information(model: Model) -> Information:
    """Information on the joints' parameters, with bodies, sensors and other joints open."""
    variances = model.variances
    return {
        (each.term.effect, each.term.place.joints[0]): max(
            float(1.0 / variances[span][0] - each.precision[0]), 0.0
        )
        for each, span in model.placed
        if each.ordinary and each.term.effect in OF_JOINTS
    }


def figures(model: Model, more: Model, joints: Sequence[str]) -> tuple[Figure, ...]:
    """Errors of every joint's parameters that recordings have rows for, before and after.

    Args:
        model: of the recordings.
        more: of a motion's rows.
        joints: by name.
    """
    added, found = information(more), []
    for each, span in model.placed:
        key = each.term.effect, each.term.place.joints[0] if each.term.place.joints else -1
        if not each.ordinary or each.term.effect not in OF_JOINTS:
            continue
        before = float(1.0 / model.variances[span][0])
        found.append(
            Figure(
                effect=each.term.effect,
                joint=joints[key[1]],
                before=before**-0.5,
                after=(before + added.get(key, 0.0)) ** -0.5,
            )
        )
    return tuple(found)


def known_better(found: Sequence[Figure]) -> float:
    """Mean log of how many times smaller the figures' errors are."""
    return float(np.mean([each.gain for each in found])) if found else 0.0
