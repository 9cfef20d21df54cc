"""The robot on the page: hulls, meshes, skeleton, and where its tips are."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
import viser

import pdoik
from pdoik._hulls import placed_hulls, way_to
from pdoik.solids import binding

from ..humanoid import first_posture
from ..model import Model
from ..shown import Shown
from .hull_scene import HullScene
from .instances import add_instances
from .shapes import segments, turns_of_x, wxyz_of

FloatArray = npt.NDArray[np.float64]

_BONE, _JOINT = (43, 47, 54), (242, 142, 43)


class RobotScene:
    """The nodes below /robot, which follow the posture.

    Args:
        server: Where to draw.
        model: What to draw.
        size: About how far the robot stretches [m].
    """

    def __init__(self, server: viser.ViserServer, model: Model, size: float) -> None:
        self._server = server
        self._robot = model.robot
        self._last_poses: dict[str, FloatArray] = {}
        scene = server.scene
        scene.add_frame("/robot", show_axes=False)
        self._meshes = scene.add_frame("/robot/meshes", show_axes=False)
        self._links: dict[str, Any] = {
            link: scene.add_glb(f"/robot/meshes/{_node(link)}", glb)
            for link, glb in model.visuals.items()
        }
        self._chains = [
            way_to(model.robot, model.robot.mid_configuration(), tip)
            for tip in model.robot.tip_links
        ]
        axes = 0.1 if len(model.robot.tip_links) == 1 else 0.05
        self._axes = {
            tip: scene.add_frame(
                f"/robot/tips/{_node(tip)}",
                axes_length=axes * size,
                axes_radius=0.035 * axes * size,
            )
            for tip in model.robot.tip_links
        }
        self._hulls = HullScene(server, model.robot, solid=not model.visuals)
        self._bones, self._joints = self._add_skeleton(0.011 * size)

    def remove(self) -> None:
        self._server.scene.remove_by_name("/robot")

    def show_parts(self, *, hulls: bool, wide_hulls: bool, meshes: bool, skeleton: bool) -> None:
        """Show or hide kinds of things."""
        self._hulls.show_parts(hulls=hulls, wide_hulls=wide_hulls)
        self._meshes.visible = meshes
        self._bones.visible = self._joints.visible = skeleton

    def show(self, shown: Shown) -> None:
        """Pose everything; hulls of the binding constraint turn orange, or red if it fails."""
        poses = {link: self._robot.fk(shown.q, link) for link in self._drawn_links()}
        for link, node in [*self._links.items(), *self._axes.items()]:
            if np.array_equal(poses[link], self._last_poses.get(link, np.empty(0))):
                continue
            node.wxyz, node.position = wxyz_of(poses[link][:3, :3]), poses[link][:3, 3]
        self._last_poses = poses
        self._pose_skeleton(poses)
        shapes = [shape.name for shape in shown.cloud.shapes]
        tight = binding(shown.result, self._robot, shapes).hulls
        self._hulls.show(shown.q, tight, fails=not shown.met_to_tolerance)

    def _drawn_links(self) -> set[str]:
        return {*self._links, *self._axes, *(link for chain in self._chains for link in chain)}

    def _add_skeleton(self, radius: float) -> tuple[Any, Any]:
        n_bones = sum(len(chain) - 1 for chain in self._chains)
        n_joints = sum(len(chain) for chain in self._chains)
        bone = trimesh.creation.cylinder(radius=radius, height=1.0, sections=20)
        bone.apply_transform(np.eye(4)[[2, 0, 1, 3]])  # z, its axis, becomes x
        joint = trimesh.creation.icosphere(subdivisions=2, radius=1.9 * radius)
        nodes = [
            add_instances(self._server, f"/robot/{name}", mesh, n, color)
            for name, mesh, n, color in (
                ("bones", bone, n_bones, _BONE),
                ("joints", joint, n_joints, _JOINT),
            )
        ]
        return nodes[0], nodes[1]

    def _pose_skeleton(self, poses: dict[str, FloatArray]) -> None:
        places = [[poses[link][:3, 3] for link in chain] for chain in self._chains]
        lines = np.concatenate([segments(each) for each in places])  # (B, 2, 3)
        vectors = lines[:, 1] - lines[:, 0]
        lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
        ones = np.ones_like(lengths)
        self._bones.batched_wxyzs = turns_of_x(vectors / np.maximum(lengths, 1e-12))
        self._bones.batched_positions = lines.mean(axis=1)
        self._bones.batched_scales = np.concatenate([lengths, ones, ones], axis=1)
        self._joints.batched_positions = np.concatenate(places)


def robot_size(model: Model) -> float:
    """About how far the robot stretches: the length of its way to a tip, or of its half [m]."""
    robot = model.robot
    if len(robot.tip_links) > 1:
        return float(0.7 * np.linalg.norm(np.ptp(_ends(robot, first_posture(robot)), axis=0)))
    q = robot.mid_configuration()
    (tip,) = robot.tip_links
    origins = np.array([robot.fk(q, link)[:3, 3] for link in way_to(robot, q, tip)])
    return max(float(np.linalg.norm(np.diff(origins, axis=0), axis=1).sum()), 0.1)


def camera_of(model: Model, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where a camera that sees the robot next to the panel looks and stands, (3,) each [m]."""
    size = robot_size(model)
    if len(model.robot.tip_links) == 1:
        return np.array([0.31, 0.09, 0.3]) * size, np.array([1.05, -1.15, 0.78]) * size
    ends = _ends(model.robot, q)
    look_at = (ends.min(axis=0) + ends.max(axis=0)) / 2 + np.array([0.12, 0.22, 0.0]) * size
    return look_at, look_at + np.array([1.9, -1.25, 0.4]) * size


def _ends(robot: pdoik.Robot, q: FloatArray) -> FloatArray:
    """Origins of the links and centres of the hulls, (N, 3) [m]."""
    links = [robot.fk(q, link)[:3, 3] for link in robot.link_names]
    hulls = [hull.ends.mean(axis=0) for hull in placed_hulls(robot, q)]
    return np.array(links + hulls)


def _node(link: str) -> str:
    """A link's name as one level of the scene tree."""
    return link.replace("/", "_")
