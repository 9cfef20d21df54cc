"""What is asked of each tip."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numpy as np
import viser

from ..goals import GOALS, WITH_CONE, GoalKind
from ..session import Session

_WIDEST = 90.0  # of a cone [deg]


class GoalsPanel:
    """A dropdown for each tip, above everything else in its container, and the axis' cone.

    Args:
        gui: Where; call it inside the container.
        session: Whose tips.
        on_change: Called with the tip and its kind of goal, "free" for none.
        on_cone: Called with the tip and how far its axis may point off [rad].
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        session: Session,
        on_change: Callable[[str, GoalKind], None],
        on_cone: Callable[[str, float], None],
    ) -> None:
        goals = session.tip_goals
        several = len(goals) > 1
        kinds = [kind.replace("_", " ") for kind in GOALS]
        self.by_tip: dict[str, Any] = {}
        self.cones: dict[str, Any] = {}
        for i, (tip, goal) in enumerate(goals.items()):
            name = tip.removesuffix("_link").replace("_", " ")
            self.by_tip[tip] = gui.add_dropdown(
                name if several else "Goal",
                kinds if several else kinds[:-1],
                initial_value=goal.kind.replace("_", " "),
                hint=f"What {tip} has to match of its target; axis: the position and where an axis"
                " points; look at: only that the axis points at it" + "; free: nothing" * several,
                order=i - 100.0,
            )
            self.cones[tip] = gui.add_slider(
                f"Axis tolerance of {name} [deg]" if several else "Axis tolerance [deg]",
                0.0,
                _WIDEST,
                1.0,
                min(float(np.degrees(goal.cone)), _WIDEST),
                hint="How far the axis may point off its target; it may turn about itself",
                order=i - 99.5,
            )
            self.by_tip[tip].on_update(self._chosen(tip, on_change))
            self.cones[tip].on_update(self._widened(tip, on_cone))
        self._show_cones()

    @property
    def has_axis(self) -> bool:
        return any(self._kind(tip) in WITH_CONE for tip in self.by_tip)

    @property
    def turns(self) -> bool:
        """Whether an orientation is asked for that the position may come before."""
        return any(self._kind(tip) in ("pose", "axis") for tip in self.by_tip)

    def remove(self) -> None:
        for control in (*self.by_tip.values(), *self.cones.values()):
            control.remove()

    def _kind(self, tip: str) -> GoalKind:
        return cast(GoalKind, self.by_tip[tip].value.replace(" ", "_"))

    def _show_cones(self) -> None:
        for tip, cone in self.cones.items():
            cone.visible = self._kind(tip) in WITH_CONE

    def _chosen(
        self, tip: str, on_change: Callable[[str, GoalKind], None]
    ) -> Callable[[viser.GuiEvent[Any]], None]:
        def chosen(_: viser.GuiEvent[Any]) -> None:
            self._show_cones()
            on_change(tip, self._kind(tip))

        return chosen

    @staticmethod
    def _widened(
        tip: str, on_cone: Callable[[str, float], None]
    ) -> Callable[[viser.GuiEvent[Any]], None]:
        return lambda event: on_cone(tip, float(np.radians(event.target.value)))
