"""What can be dragged: arrows, arcs and squares at a frame."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import viser

from .shapes import pose_of, wxyz_of

FloatArray = npt.NDArray[np.float64]
Dragged = Callable[[FloatArray], None]  # gets the pose, (4, 4) in the base frame


class Gizmo:
    """Three arrows along a frame's axes (`scale` long), squares between them, and arcs.

    Args:
        on_drag: Called with each pose that the mouse gives it, in order; must return at once.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        name: str,
        T: FloatArray,
        scale: float,
        on_drag: Dragged,
        *,
        turns: bool = True,
        visible: bool = True,
    ) -> None:
        self.name = name
        self.scale = scale
        self._handle = server.scene.add_transform_controls(
            name,
            scale=scale,
            line_width=3.0,
            disable_rotations=not turns,
            depth_test=False,
            wxyz=wxyz_of(T[:3, :3]),
            position=T[:3, 3],
            visible=visible,
        )

        @self._handle.on_update
        async def _(_: viser.TransformControlsEvent) -> None:  # async: these arrive in order
            on_drag(self.pose)

    @property
    def pose(self) -> FloatArray:
        """(4, 4)."""
        return pose_of(self._handle.wxyz, self._handle.position)

    def place(self, T: FloatArray) -> None:
        """Put it elsewhere without calling `on_drag`."""
        self._handle.wxyz, self._handle.position = wxyz_of(T[:3, :3]), T[:3, 3]

    def show(self, visible: bool) -> None:
        self._handle.visible = visible

    def turn(self, turns: bool) -> None:
        """Show arcs to turn it by, or none."""
        self._handle.disable_rotations = not turns

    def remove(self) -> None:
        self._handle.remove()
