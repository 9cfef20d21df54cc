"""One of the robots on the page: as recorded, or as simulated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
import viser

from ..drawing.shapes import turns_of_x, wxyz_of
from .colors import NOT_JUDGED, Rgb
from .drawn_robot import DrawnRobot

FloatArray = npt.NDArray[np.float64]

_RING: Rgb = (20, 90, 200)


class RobotCopy:
    """The nodes below /robots/<name>.

    Args:
        server: Where to draw.
        name: Of the node.
        drawn: What to draw.
    """

    def __init__(self, server: viser.ViserServer, name: str, drawn: DrawnRobot) -> None:
        self._drawn = drawn
        scene, root = server.scene, f"/robots/{name}"
        self._root = scene.add_frame(root, show_axes=False)
        self._base = scene.add_frame(f"{root}/base", show_axes=False)
        self._links: dict[str, Any] = {}
        for k, (link, mesh) in enumerate(drawn.meshes.items()):
            self._links[link] = scene.add_mesh_simple(
                f"{root}/base/{k}",
                np.asarray(mesh.vertices, dtype=np.float32),
                np.asarray(mesh.faces),
                color=NOT_JUDGED,
            )
        self._label = scene.add_label(
            f"{root}/label",
            name,
            position=np.array([0.0, 0.0, drawn.size]),
            anchor="bottom-center",
        )
        ring = trimesh.creation.torus(0.075 * drawn.size, 0.009 * drawn.size)
        ring.apply_transform(np.eye(4)[[2, 0, 1, 3]])  # z, its axis, becomes x
        self._ring = scene.add_mesh_simple(
            f"{root}/base/ring",
            np.asarray(ring.vertices),
            np.asarray(ring.faces),
            color=_RING,
            visible=False,
        )
        self._ringed: tuple[str, FloatArray] | None = None  # a link, and an axis in its frame
        self._last: dict[str, FloatArray] = {}

    def place(self, position: FloatArray, label_height: float) -> None:
        """Stand there, (3,) [m], with the label so high above."""
        self._root.position = position
        self._label.position = np.array([0.0, 0.0, label_height])

    def show(self, visible: bool) -> None:
        self._root.visible = visible

    def name(self, text: str) -> None:
        """Say something else above it."""
        if self._label.text != text:
            self._label.text = text

    def pose(self, q: FloatArray, base: FloatArray | None = None) -> None:
        """Move the links, (n,), and a base that floats, (7,) x y z qw qx qy qz."""
        poses = self._drawn.poses(q)
        if base is not None:
            self._base.position, self._base.wxyz = base[:3], base[3:]
        for link, T in poses.items():
            if np.array_equal(T, self._last.get(link, np.empty(0))):
                continue
            node = self._links[link]
            node.wxyz, node.position = wxyz_of(T[:3, :3]), T[:3, 3]
        self._last = poses
        self._pose_ring(q)

    def paint(self, colors: Mapping[int, Rgb], other: Rgb) -> None:
        """Colours by the number of the study's joint that moves a link."""
        for link, node in self._links.items():
            color = colors.get(self._drawn.mover.get(link, -1), other)
            if tuple(node.color) != color:
                node.color = color

    def ring(self, joint: str, q: FloatArray) -> None:
        """Put a ring about a joint's axis, if there is such a joint."""
        there = self._drawn.joints.get(joint)
        self._put_ring(None if there is None else (there.child, there.axis), q)

    def ring_link(self, link: str, q: FloatArray) -> None:
        """Put a ring about a link's origin, if there is such a link."""
        there = link in self._drawn.robot.link_names
        self._put_ring((link, np.array([0.0, 0.0, 1.0])) if there else None, q)

    def _put_ring(self, about: tuple[str, FloatArray] | None, q: FloatArray) -> None:
        self._ringed = about
        self._ring.visible = about is not None
        self._pose_ring(q)

    def _pose_ring(self, q: FloatArray) -> None:
        if self._ringed is None:
            return
        link, axis = self._ringed
        T = self._drawn.pose_of(link, q)
        turned = T[:3, :3] @ axis
        self._ring.position, self._ring.wxyz = T[:3, 3], turns_of_x(turned[None])[0]
