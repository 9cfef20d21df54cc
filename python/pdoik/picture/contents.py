"""What there is to draw of a solution: where the robot is, what it holds, and what is around it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik._hulls import PlacedHull, gaps, placed_hulls, skeleton
from pdoik.solids import placed, shape_mesh

from .cube import Cube

FloatArray = npt.NDArray[np.float64]

_CUT = 0.35  # of the arm's extent: how near what is larger than the arm is shown
_ROOM = 1.02  # of the cube, over what is in it


@dataclass(frozen=True, slots=True, kw_only=True)
class Contents:
    """A posture and its surroundings, in the base frame.

    Attributes:
        robot: Whose posture.
        q: (n,).
        tip: The first of its tip links.
        T_base_tool: Of what is to meet a target, (4, 4).
        bones: The way to the tip, (B, 3) [m].
        hulls: Of the robot, where they are.
        held: What is attached to links, where it is.
        points: Of obstacles and their radii, (K, 4) [m].
        surface: What the points stand for, (N, 3) [m].
        scene: The shapes, the points and what may touch, for a solver.
        target: For the tool, (4, 4); None where there is no single one.
    """

    robot: pdoik.Robot
    q: FloatArray
    tip: str
    T_base_tool: FloatArray
    bones: FloatArray
    hulls: list[PlacedHull]
    held: list[pdoik.Shape]
    points: FloatArray
    surface: FloatArray
    scene: pdoik.Scene
    target: FloatArray | None

    @property
    def shapes(self) -> list[pdoik.Shape]:
        return self.scene.shapes

    def gap(self) -> FloatArray:
        """Gap of each point to the nearest hull, (K,) [m]."""
        return gaps(self.hulls, self.points[:, :3]) - self.points[:, 3]

    def cube(self) -> Cube:
        """Around the arm, what it holds, its target, and what is near by."""
        inner = [self.bones, *(_corners(shape) for shape in self.held)]
        if self.target is not None:
            inner.append(self.target[None, :3, 3])
        for hull in self.hulls:
            middle = hull.ends.mean(axis=0)
            inner += [middle[None] - hull.extent, middle[None] + hull.extent]
        arm = np.concatenate(inner)
        extent = float(np.ptp(arm, axis=0).max())
        middle = (arm.min(axis=0) + arm.max(axis=0)) / 2
        near = [arm, self.points[:, :3][self._gaps(self.points[:, :3]) < extent]]
        reach = (0.5 + _CUT) * extent
        small = [np.empty((0, 8, 3))]
        for shape in self.shapes:
            if shape.kind == "half_space":
                T = np.asarray(shape.T_base_shape)
                foot = middle - (T[:3, 2] @ (middle - T[:3, 3])) * T[:3, 2]
                if np.linalg.norm(foot - middle) < reach:
                    near.append(foot[None])
                continue
            corners = _corners(shape)
            if np.ptp(corners, axis=0).max() <= extent:
                small.append(corners[None])
            else:  # it may be a room: what is far of it is cut off
                near.append(np.clip(corners, middle - reach, middle + reach))
        corners = np.concatenate(small)
        gap = self._gaps(corners.reshape(-1, 3)).reshape(-1, 8).min(axis=1, initial=np.inf)
        near.append(corners[gap < extent].reshape(-1, 3))
        all_near = np.concatenate(near)
        low, high = all_near.min(axis=0), all_near.max(axis=0)
        return Cube((low + high) / 2, float((high - low).max()) / 2 * _ROOM)

    def _gaps(self, points: FloatArray) -> FloatArray:
        return gaps(self.hulls, points) if self.hulls else np.zeros(len(points))


def contents_of(
    solver: pdoik.Solver,
    result: pdoik.Result,
    target: npt.ArrayLike | None,
    obstacles: Any,
    surface: npt.ArrayLike | None,
) -> Contents:
    """See `draw_solution`."""
    robot, q = solver.robot, np.asarray(result.q, dtype=np.float64)
    tip = robot.tip_links[0]
    scene = _scene_of(obstacles)
    points = np.empty((0, 4)) if scene.cloud is None else np.asarray(scene.cloud.points)
    if target is not None:
        target = np.asarray(target, dtype=np.float64)
        if target.shape != (4, 4):
            raise ValueError(f"T_base_tip has shape {target.shape}, expected (4, 4)")
    return Contents(
        robot=robot,
        q=q,
        tip=tip,
        T_base_tool=robot.fk(q, tip) @ np.asarray(solver.options.T_tip_tool),
        bones=skeleton(robot, q, tip),
        hulls=placed_hulls(robot, q),
        held=[
            placed(shape, robot.fk(q, each.links[0]))
            for each in solver.carried
            for shape in each.shapes
        ],
        points=points,
        surface=_surface(surface),
        scene=pdoik.Scene(
            scene.shapes, cloud=points if len(points) else None, contacts=scene.contacts
        ),
        target=target,
    )


def _scene_of(obstacles: Any) -> pdoik.Scene:
    """Whatever a solve takes as obstacles."""
    if obstacles is None:
        return pdoik.Scene()
    if isinstance(obstacles, pdoik.Scene):
        return obstacles
    is_list = isinstance(obstacles, Sequence) and not isinstance(obstacles, np.ndarray)
    if is_list and all(isinstance(each, pdoik.Shape) for each in obstacles):
        return pdoik.Scene(list(obstacles))
    return pdoik.Scene(cloud=obstacles)


def _surface(points: npt.ArrayLike | None) -> FloatArray:
    array = np.empty((0, 3)) if points is None else np.asarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"surface has shape {array.shape}, expected (N, 3)")
    return array


def _corners(shape: pdoik.Shape) -> FloatArray:
    """Corners of the box along the base's axes around a shape, (8, 3) [m]."""
    mesh, T = shape_mesh(shape)
    vertices = np.asarray(mesh.vertices) @ T[:3, :3].T + T[:3, 3]
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    ends = low, high
    return np.array([[x[0], y[1], z[2]] for x in ends for y in ends for z in ends])
