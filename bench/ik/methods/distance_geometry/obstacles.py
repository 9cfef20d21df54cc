"""Obstacles as spheres about their points that the joints' points stay out of.

Maric et al. 2021: an obstacle is a node whose distances to the base are known, and
its distance to a joint's p_k has a lower bound, its radius. Departs from it in two ways:
    - A node with known distances to the base is a fixed weighted sum of the base's points,
      o = sum_b c_b y_b with sum_b c_b = 1. That sum stands for the node, so that obstacles add
      bounds but no unknowns; where the base's distances hold, it is the same.
    - The radius depends on the joint: how deep its p_k lies inside what the arm fills, plus the
      obstacle point's own radius.
Links between the joints stay uncovered. This is the method's known gap, not a slip: distances
between points say nothing of a link's side.
"""

from collections.abc import Sequence

import numpy as np

import pdoik
from bench.common.arrays import FloatArray, moved
from bench.ik.methods.distance_geometry.points import BASE, ArmPoints

N_SAMPLES = 32  # configurations that a depth is the least of


class JointSpheres:
    """A sphere about the p_k of each moving joint that the arm fills in all configurations."""

    def __init__(self, robot: pdoik.Robot, points: ArmPoints) -> None:
        rng = np.random.default_rng(0)
        lower = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
        upper = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
        qs = rng.uniform(lower, upper, (N_SAMPLES, robot.dof))
        rows = [points.p(joint) for joint in range(1, robot.dof)]
        depths = np.stack([_depths(robot, q, points.positions(q)[rows]) for q in qs])
        radii = depths.min(axis=0).max(axis=-1, initial=0.0)  # (n - 1,)
        self.rows = np.array(rows)[radii > 0]  # of the point matrix
        self.radii = radii[radii > 0]  # [m]
        base = points.zero[list(BASE)]
        self._to_weights = np.linalg.inv(np.vstack([base.T, np.ones(4)]))
        self._n_points = len(points.names)

    def bounds(self, cloud: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What the cost takes: weights (m, N) and least squared distances (m,) [m^2]."""
        K = len(cloud)
        weights = self._to_weights @ np.vstack([cloud[:, :3].T, np.ones(K)])  # (4, K)
        incidence = np.zeros((len(self.rows), K, self._n_points))
        incidence[:, :, list(BASE)] = -weights.T
        incidence[np.arange(len(self.rows)), :, self.rows] += 1
        reach = self._reach(cloud)
        return incidence.reshape(-1, self._n_points), (reach**2).ravel()

    def clearance(self, positions: FloatArray, cloud: FloatArray) -> float:
        """Least gap between a sphere and an obstacle [m]; inf if there is none."""
        gaps = np.linalg.norm(positions[self.rows][:, None] - cloud[:, :3], axis=-1)
        return float(np.min(gaps - self._reach(cloud), initial=np.inf))

    def _reach(self, cloud: FloatArray) -> FloatArray:
        """Sums of the joints' and the points' radii, (joints, K) [m]."""
        return np.asarray(
            self.radii[:, None] + (cloud[:, 3] if cloud.shape[1] == 4 else np.zeros(len(cloud)))
        )


def _depths(robot: pdoik.Robot, q: FloatArray, positions: FloatArray) -> FloatArray:
    """How deep points are inside each hull, negative outside, (points, hulls) [m]."""
    poses = {link: robot.fk(q, link) for link in robot.link_names}

    def away(link: str, xyz: Sequence[float]) -> FloatArray:
        return np.linalg.norm(positions - moved(np.array(xyz), poses[link]), axis=1)

    occupancy = robot.occupancy
    depths = [radius - away(link, xyz) for link, xyz, radius in occupancy.spheres]
    depths += [A - (away(la, a) + away(lb, b)) / 2 for la, a, lb, b, A in occupancy.spheroids]
    return np.stack(depths, axis=1) if depths else np.empty((len(positions), 0))
