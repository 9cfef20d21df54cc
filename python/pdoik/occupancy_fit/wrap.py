"""Wrap a solid in capsules: a first set by greedy cover, then moved until little sticks out."""

from __future__ import annotations

import numpy as np

from .hulls import FloatArray
from .segments import Capsules, free, surface, to_segments
from .solid import Solid

_SEEDS_INSIDE, _SEEDS_ON = 110, 40  # ends of the segments that the greedy cover chooses from
_ACTIVE, _REFRESH = 2500, 8  # points that pull, and after how many steps they are chosen anew
_STATIONS = 9  # along a segment, where its depth is asked


def farthest_points(points: FloatArray, count: int) -> np.ndarray:
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


def greedy_cover(
    solid: Solid, points: FloatArray, weights: FloatArray, swell: float, share: float = 0.995
) -> Capsules:
    """Candidates that cover most weight of points (P, 3) each in turn, up to a share of it."""
    pool = candidates(solid, points, swell)
    holds = np.concatenate(
        [
            (to_segments(points, *part[:2]) < part.radius).T
            for part in (
                pool.take(np.arange(k, min(k + 2000, len(pool.radius))))
                for k in range(0, len(pool.radius), 2000)
            )
        ]
    ).astype(np.float32)
    left = weights.astype(np.float32)
    chosen: list[int] = []
    while left.sum() > (1 - share) * weights.sum():
        gain = holds @ left
        best = int(gain.argmax())
        if gain[best] <= 0:
            break
        chosen.append(best)
        left = left * (1 - holds[best])
    return pool.take(chosen)


def shrink_wrap(
    solid: Solid,
    points: FloatArray,
    weights: FloatArray,
    capsules: Capsules,
    *,
    steps: int,
    step: float = 1.5e-3,
    samples: int = 96,
    worst: float = 0.015,
    stiff: float = 3e4,
    margin: float = 0.0,
    low: float = 0.1,
    rate: float = 0.5,
    end: float = 0.01,
) -> Capsules:
    """Move capsules so that they hold the points (P, 3) and what sticks out is least.

    Descends by Adam on
        integral over the union outside the solid of f(distance)  +  rho sum_p w_p (gap_p)_+^2
    where gap_p is how far point p is outside the union. The integral's derivative is exact and
    cheap (Reynolds): where the union's free surface moves outwards by dn, it grows by f dn dA.
    f = 1 + (distance / worst)^6 punishes what sticks out farthest.
    """
    K = len(capsules.radius)
    x = np.concatenate([capsules.a, capsules.b, capsules.radius[:, None]], axis=1)  # (K, 7)
    first, second = np.zeros_like(x), np.zeros_like(x)
    everything, everyone = points, weights / weights.sum()
    pull_of = np.zeros(len(points))
    area = float(surface(capsules, 8).areas.sum() * 8) * 0.3
    for n in range(1, steps + 1):
        progress = n / steps
        now = Capsules(x[:, :3], x[:, 3:6], x[:, 6])
        rho = 2 * (low + (1 - low) * progress) * stiff * area
        if n % _REFRESH == 1:  # look only at points that may come out before the next look
            gap = (to_segments(everything, now.a, now.b) - now.radius).min(axis=1) + margin
            pull_of = np.maximum(pull_of + rate * rho * gap, 0)
            active = np.argsort(-(pull_of + rho * gap))[:_ACTIVE]
            points, weights, pulls = everything[active], everyone[active], pull_of[active]
        on = surface(now, samples, turn=(0.618 * n) % 1)
        outer = free(now, on)
        depth = solid.depth_at(on.points.reshape(-1, 3)).reshape(outer.shape)
        out = np.maximum(-depth, 0)
        f = (1 + (out / worst) ** 6) * (depth < 0) * outer * on.areas[:, None]  # (K, N)
        gradient = np.zeros_like(x)
        gradient[:, 6] = f.sum(axis=1)
        pull = f[:, :, None] * on.normals
        gradient[:, :3] = (pull * (1 - on.at)[:, :, None]).sum(axis=1)
        gradient[:, 3:6] = (pull * on.at[:, :, None]).sum(axis=1)

        gap = to_segments(points, now.a, now.b) - now.radius + margin
        own = gap.argmin(axis=1)
        gap = gap[np.arange(len(points)), own]
        force = weights * np.maximum(pulls + rho * gap, 0)
        bad = force > 0
        own, force, p = own[bad], force[bad], points[bad]
        t = nearest_one(p, now.a[own], now.b[own])
        q = now.a[own] + t[:, None] * (now.b - now.a)[own]
        away = (p - q) / np.maximum(np.linalg.norm(p - q, axis=1), 1e-9)[:, None]
        np.add.at(gradient[:, 6], own, -force)
        np.add.at(gradient[:, :3], own, -(force * (1 - t))[:, None] * away)
        np.add.at(gradient[:, 3:6], own, -(force * t)[:, None] * away)

        first = 0.8 * first + 0.2 * gradient
        second = 0.95 * second + 0.05 * gradient**2
        # One scale per capsule, so that a step keeps the gradient's direction.
        size = np.sqrt(second.sum(axis=1, keepdims=True) / (1 - 0.95**n)) + 1e-12
        x = x - step * (1 - progress + end) * first / (1 - 0.8**n) / size
        x[:, 6] = np.maximum(x[:, 6], 1e-3)
    return Capsules(x[:, :3], x[:, 3:6], x[:, 6])


def nearest_one(points: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Where on its own segment, 0 at a and 1 at b, the nearest place to each point is, (P,)."""
    along = b - a
    length2 = np.maximum((along * along).sum(axis=1), 1e-18)
    return np.asarray(np.clip(((points - a) * along).sum(axis=1) / length2, 0, 1))
