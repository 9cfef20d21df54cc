"""The distance graph of an arm: which distances are known, and which are bounded.

After Maric et al. 2021. Nodes are the points of points.py. Edges carry `lower` and
`upper`, squared distances [m^2] that are equal where the distance is known:
    base    among x, y, p_0, q_0
    link    among the points of consecutive axes, which a link holds
    limit   between axes two apart, from the joint between them
    goal    from the last axis to the base; the values are a problem's
"""

from itertools import combinations, product

import networkx as nx
import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.methods.distance_geometry.limits import SquaredDistance, expresses
from bench.ik.methods.distance_geometry.points import BASE, ArmPoints
from bench.ik.methods.distance_geometry.start import embedded, smoothed


class DistanceGraph:
    """An arm's graph, and the same as rows for the cost."""

    def __init__(self, points: ArmPoints, lower: FloatArray, upper: FloatArray) -> None:
        self._points = points
        self.graph = nx.Graph()
        self.graph.add_nodes_from((i, {"name": name}) for i, name in enumerate(points.names))
        self.relaxed: list[int] = []  # joints whose limits the distances do not tell
        self._add_known()
        for joint in range(points.n_joints - 1):
            self._add_limits(joint, float(lower[joint]), float(upper[joint]))
        self.relaxed.append(points.n_joints - 1)  # it moves no point
        self._add_goal()
        edges = list(self.graph.edges(data=True))
        self.incidence = np.zeros((len(edges), len(points.names)))  # (m, N), 1 and -1
        for row, (i, j, _) in enumerate(edges):
            self.incidence[row, i], self.incidence[row, j] = 1, -1
        self._lower = np.array([edge["lower"] for _, _, edge in edges])
        self._upper = np.array([edge["upper"] for _, _, edge in edges])
        self._ends = np.array([(i, j) for i, j, _ in edges])
        self._goal_rows = np.array(
            [row for row, (_, _, edge) in enumerate(edges) if edge["kind"] == "goal"]
        )

    def ranges(self, goal: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lower and upper squared distances of all edges, (m,) each, for a place of the last axis.

        Args:
            goal: Positions of its two points, (2, 3) [m].
        """
        zero = self._points.zero.copy()
        zero[-2:] = goal
        squared = np.sum((self.incidence[self._goal_rows] @ zero) ** 2, axis=1)
        lower, upper = self._lower.copy(), self._upper.copy()
        lower[self._goal_rows] = upper[self._goal_rows] = squared
        return lower, upper

    def start(self, goal: FloatArray) -> FloatArray:
        """Points from the bounds alone for a place of the last axis, (N, 3) [m]."""
        least, greatest = self.ranges(goal)
        i, j = self._ends.T
        N = len(self._points.names)
        lower, upper = np.zeros((N, N)), np.full((N, N), np.inf)
        np.fill_diagonal(upper, 0.0)
        lower[i, j] = lower[j, i] = np.sqrt(np.maximum(least, 0.0))
        upper[i, j] = upper[j, i] = np.sqrt(greatest)
        return embedded(*smoothed(lower, upper), known=self._ends[least == greatest])

    def _add_known(self) -> None:
        for i, j in combinations(BASE, 2):
            self._add(i, j, "base")
        for joint in range(1, self._points.n_joints):
            pair = self._points.pair(joint)
            self._add(*pair, "link")
            for i, j in product(self._points.pair(joint - 1), pair):
                self._add(i, j, "link")

    def _add_limits(self, joint: int, lower: float, upper: float) -> None:
        pairs = list(product(self._points.pair(joint - 1), self._points.pair(joint + 1)))
        turned = np.zeros((3, self._points.n_joints))
        turned[:, joint] = 2 * np.pi / 3 * np.arange(3)
        positions = np.stack([self._points.positions(q) for q in turned])  # (3, N, 3)
        distances = [
            SquaredDistance.through(np.sum((positions[:, i] - positions[:, j]) ** 2, axis=1))
            for i, j in pairs
        ]
        for (i, j), distance in zip(pairs, distances, strict=True):
            if distance.is_constant:
                self._add(i, j, "link")
                continue
            low, high = distance.range(lower, upper)
            if np.isfinite(low) or np.isfinite(high):
                self.graph.add_edge(i, j, kind="limit", lower=low, upper=high)
        if not expresses(distances, lower, upper):
            self.relaxed.append(joint)

    def _add_goal(self) -> None:
        for i, j in product(BASE, self._points.pair(self._points.n_joints - 1)):
            self._add(i, j, "goal")

    def _add(self, i: int, j: int, kind: str) -> None:
        """An edge of known length, as in the zero configuration."""
        squared = float(np.sum((self._points.zero[i] - self._points.zero[j]) ** 2))
        self.graph.add_edge(i, j, kind=kind, lower=squared, upper=squared)
