"""What is asked of each tip."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from .session import GOALS, Session


class GoalsPanel:
    """A dropdown for each tip, above everything else in its container.

    Args:
        gui: Where; call it inside the container.
        session: Whose tips.
        on_change: Told the tip and its kind of goal, "free" for none.
    """

    def __init__(
        self, gui: viser.GuiApi, session: Session, on_change: Callable[[str, str], None]
    ) -> None:
        kinds = session.goals
        several = len(kinds) > 1
        self.by_tip: dict[str, Any] = {
            tip: gui.add_dropdown(
                tip.removesuffix("_link").replace("_", " ") if several else "Goal",
                GOALS if several else GOALS[:-1],
                initial_value=kind,
                hint=f"What {tip} has to match of its target" + "; free: nothing" * several,
                order=i - 100.0,
            )
            for i, (tip, kind) in enumerate(kinds.items())
        }
        for tip, control in self.by_tip.items():
            control.on_update(self._callback(tip, on_change))

    @property
    def has_axis(self) -> bool:
        return any(control.value == "axis" for control in self.by_tip.values())

    def remove(self) -> None:
        for control in self.by_tip.values():
            control.remove()

    @staticmethod
    def _callback(
        tip: str, on_change: Callable[[str, str], None]
    ) -> Callable[[viser.GuiEvent[Any]], None]:
        return lambda event: on_change(tip, event.target.value)
