"""The line on the page from the robot to the nearest obstacle."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from ..shown import Shown

_CLEAR, _TOUCHING = (43, 47, 54), (211, 21, 27)
_BALL = 0.008  # radius of what is at both ends [m]


class NearestScene:
    """The nodes below /nearest, there while there is an obstacle."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._scene = server.scene
        self._color: tuple[int, int, int] | None = None  # as drawn
        self._visible = True
        self._shown: Shown | None = None  # the last
        self._line: Any = None
        self._label: Any = None
        self._ends: tuple[Any, Any] = None, None

    def show_line(self, visible: bool) -> None:
        self._visible = visible
        if not visible:
            self.remove()
        elif self._shown is not None:
            self.show(self._shown)

    def show(self, shown: Shown) -> None:
        """Follow the posture; red where they are nearer than is asked for."""
        self._shown = shown
        nearest = shown.nearest
        if nearest is None or nearest.line is None or not self._visible:
            self.remove()
            return
        fails = shown.result.room < -shown.options.clearance_tolerance
        color = _TOUCHING if fails else _CLEAR
        line = nearest.line.astype(np.float32)
        if color != self._color:
            self.remove()
            self._add(line, color)
        self._line.points = line[None]
        for ball, end in zip(self._ends, nearest.line, strict=True):
            ball.position = end
        self._label.position = nearest.line.mean(axis=0)
        self._label.text = f"{1e3 * nearest.distance:.1f} mm"

    def remove(self) -> None:
        if self._color is not None:
            self._scene.remove_by_name("/nearest")
            self._color = None

    def _add(self, line: Any, color: tuple[int, int, int]) -> None:
        scene = self._scene
        scene.add_frame("/nearest", show_axes=False)
        self._line = scene.add_line_segments(
            "/nearest/line", line[None], color, thickness=3.0, thickness_units="screen"
        )
        a, b = (
            scene.add_icosphere(f"/nearest/{name}", radius=_BALL, color=color)
            for name in ("hull", "obstacle")
        )
        self._ends = a, b
        self._label = scene.add_label("/nearest/distance", "", anchor="bottom-center")
        self._color = color
