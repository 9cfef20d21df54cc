"""What was found to have changed since the model was made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import Motion, Place, Shape, columns_of


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Change:
    """An effect that has come, grown or gone."""

    effect: str
    place: Place
    shape: Shape
    beta: FloatArray  # (k,) coefficients, more than the model has
    covariance: FloatArray  # (k, k)

    @property
    def key(self) -> tuple[str, Place, Shape]:
        """Identity of what has changed: changes with the same key add up."""
        return self.effect, self.place, self.shape


def added(known: Sequence[Change], new: Sequence[Change]) -> tuple[Change, ...]:
    """Changes known before and new ones, one for each effect, place and shape."""
    total = {each.key: each for each in known}
    for each in new:
        before = total.get(each.key)
        total[each.key] = each if before is None else _sum(before, each)
    return tuple(total.values())


def _sum(first: Change, second: Change) -> Change:
    return Change(
        effect=second.effect,
        place=second.place,
        shape=second.shape,
        beta=first.beta + second.beta,
        covariance=second.covariance,  # the level was learnt anew
    )


def torque_of_changes(changes: Sequence[Change], motion: Motion) -> tuple[FloatArray, FloatArray]:
    """What changes add along a motion and its variance, (T, n) each."""
    torque, variance = np.zeros_like(motion.tau), np.zeros_like(motion.tau)
    for each in changes:
        columns = columns_of(CATALOGUE[each.effect], motion, each.place, each.shape)
        for (balance, j), column in columns.items():
            if balance == "torque":
                torque[:, j] += column @ each.beta
                variance[:, j] += np.einsum("ti,ij,tj->t", column, each.covariance, column)
    return torque, variance
