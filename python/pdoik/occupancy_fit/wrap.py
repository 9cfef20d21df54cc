"""Wrap a solid in capsules: a first set by greedy cover, then moved until little sticks out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .hulls import FloatArray
from .segments import AnyFloats, Capsules, free, surface, to_segments
from .solid import Solid

_SEEDS_INSIDE, _SEEDS_ON = 110, 40  # ends of the segments that the greedy cover chooses from
_ACTIVE, _REFRESH = 2500, 4  # points that pull, and after how many steps they are chosen anew
_SAMPLES = 64  # points on each capsule's surface
_STEP, _LEAST_RADIUS = 2e-3, 1e-3  # the first step and the thinnest capsule [m]
_STIFFNESS = 2e4  # of the points' pull against the surface's, [1/m]
_FREE_SHARE = 0.3  # of the capsules' surface that is free, about
_CHUNK = 2000  # candidates at a time
_STATIONS = 9  # along a segment, where its depth is asked


def farthest_points(points: FloatArray, count: int) -> NDArray[np.intp]:
    """Indices of points chosen one by one, each farthest from those before it."""
    chosen = [int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    gap = np.linalg.norm(points - points[chosen[0]], axis=1)
    while len(chosen) < min(count, len(points)):
        chosen.append(int(gap.argmax()))
        gap = np.minimum(gap, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


def candidates(solid: Solid, points: FloatArray, swell: float) -> Capsules:
    """Segments between seeds; radii such that nothing sticks out farther than `swell` [m].

    A ball of the radius of its center's depth is inside, so a capsule sticks out by no more than
    its radius less the least depth along its segment.
    """
    inner, _ = solid.inner_points()
    ends = points[farthest_points(points, _SEEDS_ON)]
    if len(inner):
        ends = np.concatenate([inner[farthest_points(inner, _SEEDS_INSIDE)], ends])
    i, j = np.triu_indices(len(ends))
    a, b = ends[i], ends[j]
    shares = np.linspace(0, 1, _STATIONS)
    stations = a[:, None] + shares[:, None] * (b - a)[:, None]
    depth = solid.depth_at(stations.reshape(-1, 3)).reshape(len(a), -1).min(axis=1)
    keep = depth > -0.5 * swell
    return Capsules(a[keep], b[keep], depth[keep] + swell)


def greedy_cover(solid: Solid, points: FloatArray, swell: float, share: float = 0.995) -> Capsules:
    """Candidates that each in turn hold most of what is left of points (P, 3), up to a share."""
    pool = candidates(solid, points, swell)
    count = len(pool.radius)
    parts = [pool.take(np.arange(n, min(n + _CHUNK, count))) for n in range(0, count, _CHUNK)]
    holds = np.concatenate([(to_segments(points, p.a, p.b) < p.radius).T for p in parts])
    holds = holds.astype(np.float32)
    left = np.ones(len(points), dtype=np.float32)
    chosen: list[int] = []
    while left.sum() > (1 - share) * len(points):
        gain = holds @ left
        best = int(gain.argmax())
        if gain[best] <= 0:
            break
        chosen.append(best)
        left = left * (1 - holds[best])
    return pool.take(chosen)


class ShrinkWrap:
    """Moves capsules so that they hold points and what sticks out is least.

    Descends by Adam on an augmented Lagrangian of
        min  integral over the union, outside the solid, of f(distance)
        such that no point is outside the union,
    f = 1 + (distance / worst)^6, which punishes what sticks out farthest. The integral's
    derivative is exact and cheap (Reynolds): where the union's free surface moves outwards by dn
    it grows by f dn dA.
    """

    def __init__(self, solid: Solid, points: FloatArray, worst: float) -> None:
        self._solid, self._worst = solid, worst
        self._points = points.astype(np.float32)  # (P, 3)

    def move(self, capsules: Capsules, steps: int) -> Capsules:
        """What comes back leaves points outside by some tenths of a millimetre."""
        x = np.concatenate([capsules.a, capsules.b, capsules.radius[:, None]], axis=1)  # (K, 7)
        first, second = np.zeros_like(x), np.zeros_like(x)
        area = _FREE_SHARE * float(surface(capsules, 1).areas.sum())
        multipliers = np.zeros(len(self._points))
        for n in range(1, steps + 1):
            progress = n / steps
            now = Capsules(x[:, :3], x[:, 3:6], x[:, 6])
            rho = 2 * (0.1 + 0.9 * progress) * _STIFFNESS * area
            if n % _REFRESH == 1:  # look only at points that may come out before the next look
                gap = to_segments(self._points, now.a, now.b) - now.radius.astype(np.float32)
                gap = gap.min(axis=1)
                multipliers = np.maximum(multipliers + rho * gap / 4, 0)
                push = multipliers + rho * gap
                active = np.argpartition(-push, min(_ACTIVE, len(push)) - 1)[:_ACTIVE]
            gradient = self._outside_gradient(now, turn=(0.618 * n) % 1)
            gradient -= _pull(self._points[active], multipliers[active], rho, now) / len(gap)
            first = 0.8 * first + 0.2 * gradient
            second = 0.95 * second + 0.05 * gradient**2
            # One scale per capsule, so that a step keeps the gradient's direction.
            size = np.sqrt(second.sum(axis=1, keepdims=True) / (1 - 0.95**n)) + 1e-12
            x = x - _STEP * (1.01 - progress) * first / (1 - 0.8**n) / size
            x[:, 6] = np.maximum(x[:, 6], _LEAST_RADIUS)
        return Capsules(x[:, :3], x[:, 3:6], x[:, 6])

    def _outside_gradient(self, capsules: Capsules, *, turn: float) -> FloatArray:
        """The integral's derivative by each capsule's (a, b, radius), (K, 7) [m^2]."""
        on = surface(capsules, _SAMPLES, turn)
        depth = self._solid.depth_at(on.points.reshape(-1, 3)).reshape(on.at.shape)
        f = 1 + (np.minimum(depth, 0) / self._worst) ** 6
        f = f * free(capsules, on, among=depth < 0) * on.areas[:, None]  # (K, N)
        push = f[:, :, None] * on.normals
        by_a = (push * (1 - on.at)[:, :, None]).sum(axis=1)
        by_b = (push * on.at[:, :, None]).sum(axis=1)
        return np.concatenate([by_a, by_b, f.sum(axis=1)[:, None]], axis=1)


def _pull(points: AnyFloats, multipliers: FloatArray, rho: float, capsules: Capsules) -> FloatArray:
    """How points that are outside, or were, draw the capsule nearest to each, (K, 7)."""
    a, b, radius = capsules
    gap = to_segments(points, a, b) - radius.astype(points.dtype)
    own = gap.argmin(axis=1)
    force = np.maximum(multipliers + rho * gap[np.arange(len(points)), own], 0)
    own, p, force = own[force > 0], points[force > 0], force[force > 0]
    along = b[own] - a[own]
    length2 = np.maximum((along * along).sum(axis=1), 1e-18)
    t = np.clip(((p - a[own]) * along).sum(axis=1) / length2, 0, 1)[:, None]
    away = p - (a[own] + t * along)
    away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-9)
    pull = force[:, None] * np.concatenate([(1 - t) * away, t * away, np.ones_like(t)], axis=1)
    columns = [np.bincount(own, column, minlength=len(radius)) for column in pull.T]
    return np.stack(columns, axis=1)
