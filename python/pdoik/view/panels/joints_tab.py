"""The tab with a slider per joint."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import viser

import pdoik

from ..limits import limit_text, nearest_limit
from ..message import Message

FloatArray = npt.NDArray[np.float64]

_STEP = 1e-3  # [rad] or [m]
_MARK = "● "  # before the name of the joint that is nearest to a limit


class JointsTab:
    """Sliders that pose the robot, and follow it.

    Args:
        gui: Where; call it inside the tab.
        robot: Whose joints.
        on_slide: Called with the joint's index and its position [rad] or [m].
    """

    def __init__(
        self, gui: viser.GuiApi, robot: pdoik.Robot, on_slide: Callable[[int, float], None]
    ) -> None:
        self._robot = robot
        self._kinds = robot.joint_types
        self._marked: int | None = None
        self.limit = Message(gui)
        self.lower = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
        self.upper = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
        middle = robot.mid_configuration()
        self.sliders: list[Any] = [  # mypy cannot see that their value may be set
            gui.add_slider(
                name,
                float(self.lower[i]),
                float(self.upper[i]),
                _STEP,
                float(np.clip(middle[i], self.lower[i], self.upper[i])),
                hint="metres" if self._kinds[i] == "prismatic" else "radians",
            )
            for i, name in enumerate(robot.joint_names)
        ]
        for i, slider in enumerate(self.sliders):
            slider.on_update(self._callback(i, on_slide))

    def show(self, q: FloatArray) -> None:
        """Follow a posture without posing the robot; what turns freely is shown within a turn."""
        for i, slider in enumerate(self.sliders):
            value = q[i]
            if self._kinds[i] == "continuous":
                value = (value + np.pi) % (2 * np.pi) - np.pi
            slider.value = round(float(np.clip(value, self.lower[i], self.upper[i])), 4)

    def show_limit(self, q: FloatArray) -> None:
        """Say which joint is nearest to a limit, and mark its slider."""
        nearest = nearest_limit(self._robot, q)
        joint = None if nearest is None else nearest.joint
        if nearest is not None:
            text = f"{_MARK}nearest joint limit: {limit_text(nearest, self._robot)}"
            if text != self.limit.text:
                self.limit.say(text)
        if joint == self._marked:
            return
        for which, mark in ((self._marked, ""), (joint, _MARK)):
            if which is not None:
                self.sliders[which].label = mark + self._robot.joint_names[which]
        self._marked = joint

    def remove(self) -> None:
        self.limit.remove()
        for slider in self.sliders:
            slider.remove()

    @staticmethod
    def _callback(
        index: int, on_slide: Callable[[int, float], None]
    ) -> Callable[[viser.GuiEvent[viser.GuiSliderHandle[float]]], None]:
        def slid(event: viser.GuiEvent[viser.GuiSliderHandle[float]]) -> None:
            if event.client is not None:  # a hand, not `show`
                on_slide(index, event.target.value)

        return slid
