"""The other solutions on the page, as lines through their joints."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from pdoik._hulls import skeleton

from ..shown import AllSolutions
from .shapes import segments

_COLOR = (120, 140, 190)
_MOST = 64  # drawn, the nearest ones


class Ghosts:
    """The node /ghosts."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._node: Any = None

    def show(self, found: AllSolutions, shown: int) -> None:
        """All but the one that is shown."""
        self.remove()
        robot = found.robot
        lines = [
            segments(list(skeleton(robot, np.asarray(result.q), tip)))
            for k, result in enumerate(found.found)
            if k != shown and k < _MOST
            for tip in robot.tip_links
        ]
        if lines:
            self._node = self._server.scene.add_line_segments(
                "/ghosts",
                np.concatenate(lines).astype(np.float32),
                _COLOR,
                thickness=1.5,
                thickness_units="screen",
            )

    def remove(self) -> None:
        if self._node is not None:
            self._node.remove()
            self._node = None
