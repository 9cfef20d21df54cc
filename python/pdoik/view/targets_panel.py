"""Where each tip is wanted as numbers, for those who type."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import viser
from viser import transforms

from .session import GoalKind, Session

FloatArray = npt.NDArray[np.float64]

_METRES, _DEGREES = 4, 2  # decimals


class TargetsPanel:
    """A folder with six numbers for each tip, which follow what is dragged.

    Args:
        gui: Where; call it inside the container.
        session: Whose tips.
        on_type: Told the tip and the pose that was typed, T_base_tip (4, 4).
    """

    def __init__(
        self, gui: viser.GuiApi, session: Session, on_type: Callable[[str, FloatArray], None]
    ) -> None:
        self._folder = gui.add_folder("Targets as numbers", expand_by_default=False, order=-50.0)
        self.by_tip: dict[str, tuple[Any, Any]] = {}
        with self._folder:
            for tip in session.targets:
                name = f" of {tip}" if len(session.targets) > 1 else ""
                self.by_tip[tip] = (
                    gui.add_vector3(f"x y z [m]{name}", (0.0, 0.0, 0.0), step=0.001),
                    gui.add_vector3(
                        f"turn [deg]{name}",
                        (0.0, 0.0, 0.0),
                        step=0.1,
                        hint="Roll, pitch, yaw: about the base's x, then y, then z",
                    ),
                )
        self._targets = session.targets
        self.show(self._targets)
        self.follow(session.goals)
        for tip, pair in self.by_tip.items():
            for control in pair:
                control.on_update(self._callback(tip, on_type))

    def show(self, targets: Mapping[str, FloatArray]) -> None:
        """Follow targets that were dragged."""
        self._targets = dict(targets)
        for tip, (xyz, turn) in self.by_tip.items():
            rpy = transforms.SO3.from_matrix(targets[tip][:3, :3]).as_rpy_radians()
            _set(xyz, targets[tip][:3, 3], _METRES)
            _set(turn, np.degrees([rpy.roll, rpy.pitch, rpy.yaw]), _DEGREES)

    def follow(self, goals: Mapping[str, GoalKind]) -> None:
        """Free tips have no target, positions no turn."""
        for tip, (xyz, turn) in self.by_tip.items():
            xyz.visible, turn.visible = goals[tip] != "free", goals[tip] in ("pose", "axis")

    def remove(self) -> None:
        self._folder.remove()

    def _callback(
        self, tip: str, on_type: Callable[[str, FloatArray], None]
    ) -> Callable[[viser.GuiEvent[Any]], None]:
        def typed(event: viser.GuiEvent[Any]) -> None:
            if event.client is None:  # not a hand, but `show`
                return
            xyz, turn = self.by_tip[tip]
            T = self._targets[tip].copy()  # what was not typed is not rounded
            if event.target is xyz:
                T[:3, 3] = xyz.value
            else:
                rpy = np.radians(turn.value)
                T[:3, :3] = transforms.SO3.from_rpy_radians(*rpy.tolist()).as_matrix()
            on_type(tip, T)

        return typed


def _set(control: Any, values: FloatArray, decimals: int) -> None:
    rounded = tuple(float(x) + 0.0 for x in np.round(values, decimals))
    if not np.allclose(control.value, rounded, atol=0.6 * 10.0**-decimals):
        control.value = rounded
