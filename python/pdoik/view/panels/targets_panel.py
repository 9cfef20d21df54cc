"""Where each tip is wanted as numbers, for those who type."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import viser
from viser import transforms

from ..goals import TipGoal
from ..session import Session

FloatArray = npt.NDArray[np.float64]

_METRES, _DEGREES = 4, 2  # decimals


class TargetsPanel:
    """A folder with six numbers for each target of each tip, which follow what is dragged.

    Args:
        gui: Where; call it inside the container.
        session: Whose tips.
        on_type: Called with the tip, the pose that was typed, T_base_tip (4, 4), and which of its
            targets it is.
    """

    def __init__(
        self, gui: viser.GuiApi, session: Session, on_type: Callable[[str, FloatArray, int], None]
    ) -> None:
        self._gui, self._on_type = gui, on_type
        self._folder = gui.add_folder("Targets as numbers", expand_by_default=False, order=-50.0)
        self._goals = session.tip_goals
        self._pairs: dict[str, list[tuple[Any, Any]]] = {tip: [] for tip in self._goals}
        self.follow(self._goals)

    @property
    def by_tip(self) -> dict[str, tuple[Any, Any]]:
        """The position and the turn of each tip's first target."""
        return {tip: pairs[0] for tip, pairs in self._pairs.items()}

    def show(self, goals: Mapping[str, TipGoal]) -> None:
        """Follow targets that were dragged."""
        self._goals = dict(goals)
        for tip, pairs in self._pairs.items():
            for (xyz, turn), T in zip(pairs, goals[tip].targets, strict=False):
                rpy = transforms.SO3.from_matrix(T[:3, :3]).as_rpy_radians()
                _set(xyz, T[:3, 3], _METRES)
                _set(turn, np.degrees([rpy.roll, rpy.pitch, rpy.yaw]), _DEGREES)

    def follow(self, goals: Mapping[str, TipGoal]) -> None:
        """Show as many as there are targets; free tips have none, positions no turn."""
        for tip, pairs in self._pairs.items():
            count, kind = len(goals[tip].targets), goals[tip].kind
            while len(pairs) > count:
                for control in pairs.pop():
                    control.remove()
            while len(pairs) < count:
                pairs.append(self._add(tip, len(pairs)))
            for xyz, turn in pairs:
                xyz.visible, turn.visible = kind != "free", kind in ("pose", "axis")
        self.show(goals)

    def remove(self) -> None:
        self._folder.remove()

    def _add(self, tip: str, which: int) -> tuple[Any, Any]:
        name = f" of {tip}" if len(self._pairs) > 1 else ""
        name = f"{which + 1}: " * (which > 0) + "{}" + name
        with self._folder:
            pair = (
                self._gui.add_vector3(name.format("x y z [m]"), (0.0, 0.0, 0.0), step=0.001),
                self._gui.add_vector3(
                    name.format("roll pitch yaw [deg]"),
                    (0.0, 0.0, 0.0),
                    step=0.1,
                    hint="About the base's x, then y, then z",
                ),
            )
        for control in pair:
            control.on_update(self._callback(tip, self._on_type, which))
        return pair

    def _callback(
        self, tip: str, on_type: Callable[[str, FloatArray, int], None], which: int = 0
    ) -> Callable[[viser.GuiEvent[Any]], None]:
        def typed(event: viser.GuiEvent[Any]) -> None:
            if event.client is None:  # not a hand, but `show`
                return
            xyz, turn = self._pairs[tip][which]
            T = self._goals[tip].targets[which].copy()  # what was not typed is not rounded
            if event.target is xyz:
                T[:3, 3] = xyz.value
            else:
                rpy = np.radians(turn.value)
                T[:3, :3] = transforms.SO3.from_rpy_radians(*rpy.tolist()).as_matrix()
            on_type(tip, T, which)

        return typed


def _set(control: Any, values: FloatArray, decimals: int) -> None:
    rounded = tuple(float(x) + 0.0 for x in np.round(values, decimals))
    if not np.allclose(control.value, rounded, atol=0.6 * 10.0**-decimals):
        control.value = rounded
