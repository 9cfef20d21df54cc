"""The ring on the page around the joint that is nearest to a limit."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
import viser

import pdoik

from ..limits import NearestLimit, amount_text, nearest_limit
from ..shown import Shown
from .shapes import turns_of_x

FloatArray = npt.NDArray[np.float64]

_FAR, _NEAR, _AT = (92, 104, 122), (240, 140, 20), (224, 20, 20)
_NEAR_SHARE, _AT_SHARE = 0.1, 0.01  # of the joint's range, left on one side


class LimitScene:
    """The nodes below /limit: a ring about the joint's axis, and how far it is from its limit."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._scene = server.scene
        self._movers: dict[str, frozenset[int]] = {}  # joints that move each link
        self._size = 1.0
        self._visible = True
        self._shown: Shown | None = None  # the last
        self._color: tuple[int, int, int] | None = None  # as drawn
        self._ring: Any = None
        self._label: Any = None

    def follow_robot(self, robot: pdoik.Robot, size: float) -> None:
        """Another robot, which stretches about so far [m]."""
        self._movers, self._size, self._shown = moved_by(robot), size, None

    def show_mark(self, visible: bool) -> None:
        self._visible = visible
        if not visible:
            self.remove()
        elif self._shown is not None:
            self.show(self._shown)

    def show(self, shown: Shown) -> None:
        """Follow the posture; orange where a tenth of the range is left, red where nothing is."""
        self._shown = shown
        limit = nearest_limit(shown.robot, shown.q)
        if limit is None or not self._visible:
            self.remove()
            return
        color = _color_of(limit)
        if color != self._color:
            self.remove()
            self._add(color)
        place, axis = joint_axis(shown.robot, shown.q, limit.joint, self._movers)
        self._ring.position, self._ring.wxyz = place, turns_of_x(axis[None])[0]
        self._label.position = place
        name = shown.robot.joint_names[limit.joint]
        self._label.text = f"{name}: {amount_text(limit, shown.robot)}"

    def remove(self) -> None:
        if self._color is not None:
            self._scene.remove_by_name("/limit")
            self._color = None

    def _add(self, color: tuple[int, int, int]) -> None:
        scene = self._scene
        scene.add_frame("/limit", show_axes=False)
        ring = trimesh.creation.torus(0.085 * self._size, 0.007 * self._size)
        ring.apply_transform(np.eye(4)[[2, 0, 1, 3]])  # z, its axis, becomes x
        self._ring = scene.add_mesh_simple(
            "/limit/ring",
            np.asarray(ring.vertices),
            np.asarray(ring.faces),
            color=color,
            cast_shadow=False,
            receive_shadow=False,
        )
        self._label = scene.add_label("/limit/distance", "", anchor="bottom-center")
        self._color = color


def moved_by(robot: pdoik.Robot) -> dict[str, frozenset[int]]:
    """Which joints move each link."""
    q = robot.mid_configuration()
    return {
        link: frozenset(
            np.flatnonzero(np.abs(robot.jacobian(q, link)).max(axis=0) > 1e-12).tolist()
        )
        for link in robot.link_names
    }


def joint_axis(
    robot: pdoik.Robot, q: FloatArray, joint: int, movers: dict[str, frozenset[int]]
) -> tuple[FloatArray, FloatArray]:
    """A place on a joint's axis next to the link that it moves, and the axis, (3,) each [m].

    Args:
        robot: Whose.
        q: Posture, (n,).
        joint: Which.
        movers: See `moved_by`.
    """
    moved = [link for link in movers if joint in movers[link]]
    link = min(moved, key=lambda each: len(movers[each]))  # the first behind the joint
    linear, angular = np.split(robot.jacobian(q, link)[:, joint], 2)
    place = robot.fk(q, link)[:3, 3]
    turns = float(np.linalg.norm(angular))
    if turns < 1e-9:
        return place, linear / np.linalg.norm(linear)
    axis = angular / turns
    return place + np.cross(axis, linear / turns), axis


def _color_of(limit: NearestLimit) -> tuple[int, int, int]:
    if limit.share < _AT_SHARE:
        return _AT
    return _NEAR if limit.share < _NEAR_SHARE else _FAR
