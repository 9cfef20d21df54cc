"""The obstacles on the page: the cloud, the points kept of it, the ball, and the binding point."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import viser

from pdoik._hulls import placed_hulls
from pdoik.solids import binding

from ..shown import Shown
from .gizmos import Dragged, Gizmo
from .shapes import gap_colors, wxyz_of

FloatArray = npt.NDArray[np.float64]

_SURFACE, _KEPT, _BALL, _BINDING = (176, 180, 186), (245, 154, 35), (147, 103, 189), (211, 21, 27)
_MOST_SURFACE_POINTS = 60_000  # shown
_MOST_COLORED_POINTS = 4_000  # coloured anew at each posture


class ObstacleScene:
    """The nodes below /obstacles and their two gizmos, the cloud's hidden at first.

    Args:
        server: Where to draw.
        size: Of the gizmos [m].
        on_ball, on_cloud: Called with each pose of the gizmos; the cloud's is T_base_cloud.
    """

    def __init__(
        self, server: viser.ViserServer, size: float, on_ball: Dragged, on_cloud: Dragged
    ) -> None:
        self._server = server
        self._drawn: tuple[FloatArray, FloatArray] | None = None  # surface and points, as drawn
        self._surface: Any = None
        self._kept: Any = None
        self._visible = True
        self._handle = np.zeros(3)  # the cloud's gizmo in the cloud's frame
        self.ball = Gizmo(
            server, "/obstacles/ball", np.eye(4), size, on_ball, turns=False, visible=False
        )
        self._ball_mesh = server.scene.add_icosphere(
            "/obstacles/ball/mesh", radius=1.0, color=_BALL
        )
        self.cloud = Gizmo(
            server,
            "/obstacles/handle",
            np.eye(4),
            1.4 * size,
            lambda T: on_cloud(T @ _translation(-self._handle)),
            visible=False,
        )
        self._binding = server.scene.add_icosphere(
            "/obstacles/binding", radius=0.03 * size, color=_BINDING, visible=False
        )
        self._binding_radius = 0.03 * size

    def show_cloud(self, visible: bool) -> None:
        self._visible = visible
        for node in (self._surface, self._kept):
            if node is not None:
                node.visible = visible

    def show(self, shown: Shown) -> None:
        """Draw what has changed, colour the points by their gap, mark the binding one."""
        self._show_ball(shown)
        cloud = shown.cloud
        points = shown.obstacles if cloud.ball is None else shown.obstacles[:-1]
        if self._drawn is None or self._drawn[0] is not cloud.surface:
            self._draw_surface(cloud.surface)
            self.place_handle(cloud.T_base_cloud)
        if self._surface is not None:
            self._surface.wxyz = wxyz_of(cloud.T_base_cloud[:3, :3])
            self._surface.position = cloud.T_base_cloud[:3, 3]
        if self._drawn is None or not np.array_equal(self._drawn[1], points):
            self._draw_kept(points, shown)
        elif self._kept is not None and len(points) <= _MOST_COLORED_POINTS:
            self._kept.colors = self._colors(points, shown)
        self._drawn = cloud.surface, points

        found = binding(shown.result, shown.robot, [shape.name for shape in cloud.shapes])
        mark = found.obstacle is not None and found.obstacle < len(points)
        self._binding.visible = mark
        if mark:
            self._binding.position = shown.obstacles[found.obstacle, :3]

    def place_handle(self, T_base_cloud: FloatArray) -> None:
        """Put the cloud's gizmo on the cloud's middle."""
        self.cloud.place(T_base_cloud @ _translation(self._handle))

    def _show_ball(self, shown: Shown) -> None:
        ball = shown.cloud.ball
        self.ball.show(ball is not None)
        if ball is not None:
            self._ball_mesh.scale = ball.radius

    def _draw_surface(self, surface: FloatArray) -> None:
        if self._surface is not None:
            self._surface.remove()
            self._surface = None
        if not len(surface):
            return
        self._handle = (surface.min(axis=0) + surface.max(axis=0)) / 2
        every = max(1, len(surface) // _MOST_SURFACE_POINTS)
        self._surface = self._server.scene.add_point_cloud(
            "/obstacles/surface",
            surface[::every],
            _SURFACE,
            point_size=0.0025,
            point_shape="circle",
            precision="float32",
            visible=self._visible,
        )

    def _draw_kept(self, points: FloatArray, shown: Shown) -> None:
        if self._kept is not None and len(points) == len(self._kept.points):
            self._kept.points = points[:, :3].astype(np.float32)
            self._kept.colors = self._colors(points, shown)
            return
        if self._kept is not None:
            self._kept.remove()
            self._kept = None
        if len(points):
            self._kept = self._server.scene.add_point_cloud(
                "/obstacles/kept",
                points[:, :3],
                self._colors(points, shown),
                point_size=0.011,
                point_shape="circle",
                precision="float32",
                visible=self._visible,
            )

    def _colors(self, points: FloatArray, shown: Shown) -> npt.NDArray[np.uint8]:
        if len(points) > _MOST_COLORED_POINTS or not len(shown.robot.occupancy):
            return np.tile(np.array(_KEPT, dtype=np.uint8), (len(points), 1))
        return gap_colors(placed_hulls(shown.robot, shown.q), points)


def _translation(xyz: FloatArray) -> FloatArray:
    T = np.eye(4)
    T[:3, 3] = xyz
    return T
