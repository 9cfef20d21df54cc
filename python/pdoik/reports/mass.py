"""Where the centre of mass is and how far outside of its box, by plain sums."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from .._core import Robot
from ..options import Options
from .requirements import Requirement
from .values import FloatArray


class MassBox:
    """What is asked of the centre of mass, but for standing on contacts.

    Args:
        robot: Its links' masses are taken.
        options: Of a box.
    """

    def __init__(self, robot: Robot, options: Options) -> None:
        _, links, *_ = robot.__getstate__()
        self._links = [(name, mass, np.array(at)) for name, mass, at, _ in links if mass > 0.0]
        balance = options.balance
        self._lower, self._upper = np.array(balance.com_lower), np.array(balance.com_upper)
        self._by_options = bool(np.isfinite([self._lower, self._upper]).any())
        self.is_judged = not balance.contacts

    def __call__(
        self, goals: Sequence[Requirement], poses: Mapping[str, FloatArray]
    ) -> tuple[FloatArray, float] | None:
        """The centre, (3,), and how far it is outside [m]; None if it is not asked for or judged.

        Args:
            goals: Those of other kinds are passed over.
            poses: T_base_link of every link, (4, 4) [m].
        """
        boxes = [goal for goal in goals if goal.kind == "center_of_mass"]
        if not self.is_judged or not (boxes or self._by_options):
            return None
        lower, upper = self._lower, self._upper
        for box in boxes:
            lower = np.maximum(lower, box.target[:3, 3] - box.position_slack)
            upper = np.minimum(upper, box.target[:3, 3] + box.position_slack)
        moments = [mass * (poses[name] @ [*at, 1.0])[:3] for name, mass, at in self._links]
        center = np.sum(moments, axis=0) / sum(mass for _, mass, _ in self._links)
        return center, max(float(np.max([lower - center, center - upper])), 0.0)
