"""The distance graph of an arm: which distances are known, and which are bounded.

After Maric et al. 2021. Nodes are the points of points.py. Edges carry `lower` and
`upper`, squared distances [m^2] that are equal where the distance is known:
    base    among x, y, p_0, q_0
    link    among the points of consecutive axes, which a link holds
    limit   between axes two apart, from the joint between them
    goal    from the last axis to the base; the values are a problem's
"""

from collections.abc import Iterable
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
        last = points.n_joints - 1
        self._add_known("base", combinations(BASE, 2))
        for joint in range(1, points.n_joints):
            pair = points.pair(joint)
            self._add_known("link", [pair, *product(points.pair(joint - 1), pair)])
        # Joints whose limits the distances do not tell; the last one moves no point.
        self.relaxed = [
            joint
            for joint in range(last)
            if not self._add_limits(joint, float(lower[joint]), float(upper[joint]))
        ] + [last]
        self._add_known("goal", product(BASE, points.pair(last)))
        self._ends = np.array(self.graph.edges)
        edges = [edge for *_, edge in self.graph.edges(data=True)]
        rows = np.arange(len(edges))
        self.incidence = np.zeros((len(edges), len(points.names)))  # (m, N), 1 and -1
        self.incidence[rows, self._ends[:, 0]], self.incidence[rows, self._ends[:, 1]] = 1, -1
        self._lower, self._upper = (np.array([e[end] for e in edges]) for end in ("lower", "upper"))
        self._goal_rows = np.flatnonzero([edge["kind"] == "goal" for edge in edges])

    def ranges(self, goal: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lower and upper squared distances of all edges, (m,) each.

        The goal is where the last axis's two points shall be, (2, 3) [m].
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

    def _add_known(self, kind: str, edges: Iterable[tuple[int, int]]) -> None:
        """Edges of known length, as in the zero configuration."""
        zero = self._points.zero
        for i, j in edges:
            squared = float(np.sum((zero[i] - zero[j]) ** 2))
            self.graph.add_edge(i, j, kind=kind, lower=squared, upper=squared)

    def _add_limits(self, joint: int, lower: float, upper: float) -> bool:
        """Whether the distances between the axes about a joint tell its limits."""
        pairs = list(product(self._points.pair(joint - 1), self._points.pair(joint + 1)))
        turned = np.zeros((3, self._points.n_joints))
        turned[:, joint] = 2 * np.pi / 3 * np.arange(3)
        positions = np.stack([self._points.positions(q) for q in turned])  # (3, N, 3)
        distances = [
            SquaredDistance.through(np.sum((positions[:, i] - positions[:, j]) ** 2, axis=1))
            for i, j in pairs
        ]
        for (i, j), distance in zip(pairs, distances, strict=True):
            low, high = distance.range(lower, upper)
            if distance.is_constant:
                self._add_known("link", [(i, j)])
            elif np.isfinite(low) or np.isfinite(high):
                self.graph.add_edge(i, j, kind="limit", lower=low, upper=high)
        return expresses(distances, lower, upper)
