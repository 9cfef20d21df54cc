"""The centre of mass on the page: a ball, a line down to the ground, and the support polygon."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import viser

from ..humanoid import support_polygon
from ..shown import Shown

FloatArray = npt.NDArray[np.float64]

_HELD, _LOST = (27, 127, 59), (211, 21, 27)
_ABOVE_FLOOR = 0.004  # so that the floor's grid does not show through [m]


class BalanceScene:
    """The nodes below /balance, there while the options ask for a support polygon."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._scene = server.scene
        self._drawn: tuple[int, bool] | None = None  # corners, and whether balance held
        self._ball: Any = None
        self._foot: Any = None
        self._lines: Any = None

    def remove(self) -> None:
        if self._drawn is not None:
            self._scene.remove_by_name("/balance")
            self._drawn = None

    def show(self, shown: Shown) -> None:
        """Follow the posture; red where the centre of mass is not over the polygon."""
        if not shown.options.balance.contacts:
            self.remove()
            return
        com = np.asarray(shown.robot.center_of_mass(shown.q))
        corners = support_polygon(shown.robot, shown.q, shown.options.balance)
        corners[:, 2] += _ABOVE_FLOOR
        ground = np.array([*com[:2], corners[0, 2]])
        lines = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)  # (K, 2, 3)
        lines = np.concatenate([lines, [[com, ground]]]).astype(np.float32)
        now = len(corners), shown.result.balance_violation <= 0
        if now != self._drawn:
            self.remove()
            self._add(lines, _HELD if now[1] else _LOST)
            self._drawn = now
        self._lines.points = lines
        self._ball.position, self._foot.position = com, ground

    def _add(self, lines: FloatArray, color: tuple[int, int, int]) -> None:
        scene = self._scene
        scene.add_frame("/balance", show_axes=False)
        self._ball = scene.add_icosphere("/balance/com", radius=0.035, color=color)
        self._foot = scene.add_cylinder(
            "/balance/ground", radius=0.022, height=0.004, color=color, cast_shadow=False
        )
        self._lines = scene.add_line_segments("/balance/lines", lines, color, thickness=0.008)
