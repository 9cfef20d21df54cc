"""The path on the page: a line coloured by room, and where it breaks."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from ..followed_path import FollowedPath
from .shapes import room_colors

_ASKED, _STOP, _MOVE = (150, 156, 166), (211, 21, 27), (123, 94, 167)
_BALL, _DOT = 0.012, 0.006  # radius where it breaks, and at stations without a solution [m]


class PathScene:
    """The nodes below /path."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._scene = server.scene
        self._there = False

    def show(self, path: FollowedPath) -> None:
        """Instead of the one before."""
        self.remove()
        self._there = True
        self._scene.add_frame("/path", show_axes=False)
        if len(path.asked) > 1:
            self._line("asked", path.asked, np.tile(_ASKED, (len(path.asked), 1)), 1.5)
        colors = room_colors(path.room) if len(path.room) else np.empty((0, 3))
        for k, line in enumerate(path.lines):
            if len(line) > 1:
                shown = np.where(path.is_move[:, None], np.array(_MOVE), colors)
                self._line(f"followed_{k}", line, shown, 5.0)
        for k, place in enumerate(path.unsolved):
            self._scene.add_icosphere(
                f"/path/unsolved_{k}", radius=_DOT, color=_STOP, position=place
            )
        for k, each in enumerate(path.breaks):
            self._scene.add_icosphere(
                f"/path/break_{k}", radius=_BALL, color=_STOP, position=each.place
            )
            self._scene.add_label(f"/path/break_{k}/reason", each.text, anchor="bottom-center")

    def remove(self) -> None:
        if self._there:
            self._scene.remove_by_name("/path")
            self._there = False

    def _line(self, name: str, places: Any, colors: Any, thickness: float) -> None:
        """Draw a line through all places; a piece has the colour of the place it leads to."""
        ends = np.stack([places[:-1], places[1:]], axis=1).astype(np.float32)
        self._scene.add_line_segments(
            f"/path/{name}",
            ends,
            np.repeat(colors[1:, None], 2, axis=1).astype(np.uint8),
            thickness=thickness,
            thickness_units="screen",
        )
