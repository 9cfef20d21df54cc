"""How deep an arm's capsules are in solids, in points and in one another."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial import cKDTree

from bench.common.arrays import BoolArray, FloatArray
from bench.ik.judges.distances import to_segment
from bench.ik.paths.solids import World
from bench.ik.soak.hulls import segment_distance
from bench.ik.soak.judge import Judge

AT_ONCE = 64  # configurations, whose capsules a cache holds


class Contacts:
    """Contacts of one arm in one world.

    Every capsule is in a ball, and only of those that meet something the distance is taken: figures
    of what is apart are not needed.
    """

    def __init__(self, judge: Judge, world: World) -> None:
        self._judge, self._world = judge, world
        self._tree = cKDTree(world.points) if len(world.points) else None
        count = len(judge.A)
        self._may_meet: BoolArray = np.zeros((count, count), dtype=bool)
        if len(judge.pairs):
            self._may_meet[tuple(judge.pairs.T)] = True

    def depths(self, Q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """In the world and in itself, 0 where it is clear, in configurations (B, n), (B,) [m]."""
        parts = [self._depths(some) for some in _blocks(Q)]
        world, own = (np.concatenate(each) for each in zip(*parts, strict=True))
        return world, own

    def _depths(self, Q: FloatArray) -> tuple[FloatArray, FloatArray]:
        judge = self._judge
        p, q = judge.hulls(judge.kinematics.place(Q))
        centres = 0.5 * (p + q)
        reach = judge.A + 0.5 * np.linalg.norm(q - p, axis=-1)  # (B, H)
        deep = np.zeros(len(Q))
        for solid in self._world.solids:
            row, hull = np.nonzero(solid.distance(centres) < reach)
            gap = solid.to_segment(p[row, hull], q[row, hull]) - judge.A[hull]
            np.maximum.at(deep, row, -gap)
        if self._tree is not None:
            self._among_points(p, q, centres, reach, deep)
        return deep, self._own(p, q, centres, reach)

    def _among_points(
        self, p: FloatArray, q: FloatArray, centres: FloatArray, reach: FloatArray, deep: FloatArray
    ) -> None:
        assert self._tree is not None
        nearest, _ = self._tree.query(centres, distance_upper_bound=float(reach.max()))
        for row, hull in zip(*np.nonzero(nearest < reach), strict=True):
            near = self._tree.query_ball_point(centres[row, hull], reach[row, hull])
            points = self._world.points[near]
            gap = to_segment(points, p[row, hull], q[row, hull]) - self._judge.A[hull]
            deep[row] = max(deep[row], -gap.min())

    def _own(
        self, p: FloatArray, q: FloatArray, centres: FloatArray, reach: FloatArray
    ) -> FloatArray:
        squares = np.einsum("bhi,bhi->bh", centres, centres)
        apart = squares[:, :, None] + squares[:, None] - 2 * centres @ centres.swapaxes(1, 2)
        near = apart < (reach[:, :, None] + reach[:, None]) ** 2 + 1e-12
        row, i, j = np.nonzero(near & self._may_meet)
        between = segment_distance(p[row, i], q[row, i], p[row, j], q[row, j])
        deep = np.zeros(len(p))
        np.maximum.at(deep, row, self._judge.A[i] + self._judge.A[j] - between)
        return deep


def _blocks(Q: FloatArray) -> Iterator[FloatArray]:
    for first in range(0, len(Q), AT_ONCE):
        yield Q[first : first + AT_ONCE]
