"""How users would ask whether a configuration is free of a cloud, and how near it comes.

What `prepare` does, with the poses of all links, (4, 4), is not timed.
"""

from collections.abc import Mapping
from typing import Any

import coal
import numpy as np

import pdoik
from bench.common.arrays import FloatArray, moved
from bench.ik.clouds.hulls import Capsule, moving_hulls
from bench.ik.clouds.structures import COAL, OURS, SCIPY, octree, scipy_tree

Placed = Mapping[str, FloatArray]


class Judge:
    """Ours: one call answers both, forward kinematics included."""

    name = OURS

    def __init__(self, robot: pdoik.Robot, points: FloatArray) -> None:
        self._cloud, self._robot = pdoik.Cloud(points), robot
        self._solver = pdoik.Solver(robot, pdoik.Options(base_collision=False))

    def prepare(self, q: FloatArray, placed: Placed) -> Any:
        return self._robot.fk(q), q

    def free(self, ready: Any) -> bool:
        return self.clearance(ready) >= 0.0

    def clearance(self, ready: Any) -> float:
        T, q = ready
        return self._solver.judge(T, q, self._cloud).clearance


class Octree:
    """coal: each hull's capsule against the octree. The kinematics are there already."""

    name = COAL

    def __init__(self, robot: pdoik.Robot, points: FloatArray) -> None:
        self._capsules = [Capsule.about(hull) for hull in moving_hulls(robot)]
        self._tree, self._still = octree(points), coal.Transform3s.Identity()
        self._touch, self._distance = coal.CollisionRequest(), coal.DistanceRequest()
        self._touches, self._nearest = coal.CollisionResult(), coal.DistanceResult()

    def prepare(self, q: FloatArray, placed: Placed) -> Any:
        return [(each.shape, each.place(placed[each.hull.link])) for each in self._capsules]

    def free(self, ready: Any) -> bool:
        for shape, place in ready:
            self._touches.clear()
            if coal.collide(shape, place, self._tree, self._still, self._touch, self._touches):
                return False
        return True

    def clearance(self, ready: Any) -> float:
        tree, still, request, nearest = self._tree, self._still, self._distance, self._nearest
        least = np.inf
        for shape, place in ready:
            nearest.clear()
            least = min(least, coal.distance(shape, place, tree, still, request, nearest))
        return float(least)


class Tree:
    """SciPy: the points in each hull's ball, then the hull's own inequality."""

    name = SCIPY
    clearance = None

    def __init__(self, robot: pdoik.Robot, points: FloatArray) -> None:
        self._hulls = moving_hulls(robot)
        self._points, self._tree = points, scipy_tree(points)

    def prepare(self, q: FloatArray, placed: Placed) -> Any:
        ready = []
        for hull in self._hulls:
            T = placed[hull.link]
            focal = np.sqrt(max(0.0, hull.semi_major**2 - hull.semi_minor**2))
            center, reach = moved(hull.center, T), focal * (T[:3, :3] @ hull.axis)
            ready.append((center, center - reach, center + reach, hull.semi_major))
        return ready

    def free(self, ready: Any) -> bool:
        for center, focus_a, focus_b, semi_major in ready:
            near = self._points[self._tree.query_ball_point(center, semi_major)]
            to_a = np.linalg.norm(near - focus_a, axis=1)
            if (to_a + np.linalg.norm(near - focus_b, axis=1) < 2 * semi_major).any():
                return False
        return True


METHODS = (Judge, Octree, Tree)
