"""Capsules that hold a link's collision geometry tightly: the second, closer level of hulls."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .hulls import FloatArray, Point, tidy_point
from .overhang import Overhang, overhang
from .segments import Capsules, free, surface, to_segments
from .settle import settle
from .solid import Solid
from .wrap import greedy_cover, shrink_wrap

_LANDMARKS = 1500
_INNER = 300  # points inside that are asked for while capsules move
_FIRST_SWELL = 0.85  # how far the first set sticks out, over the most that is allowed
_MOST_ROUNDS = 30
_FIRST_STEPS, _NEXT_STEPS, _DROP_STEPS = 240, 120, 90
_GROWTH = 0.15  # share of capsules that are split in a round
_SPARE = 1.015  # of the aims, for what another look than ours may find
_MOST = 120  # capsules of a link, where nothing else is asked
_HASTE = 1.0  # share of the capsules that is left out at once, over the aims' share to spare
_STEPS_BACK = 4  # of the last sets: one that meets the aims with the inside proven is taken
_PATIENCE = 3  # capsules whose loss is tried in vain before the rest stay


class Capsule(NamedTuple):
    """A ball swept along a segment, fixed to a link; a ball where the ends coincide."""

    link: str
    a: Point  # one end of the segment, in the link's frame [m]
    b: Point  # the other end [m]
    radius: float  # [m]


def fit_capsules(
    triangles: FloatArray,
    *,
    max_overhang: float = 0.015,
    mean_overhang: float = 0.004,
    most: int | None = None,
) -> list[tuple[Point, Point, float]]:
    """Few capsules that together hold a surface and what it encloses, and stick out little.

    Where concave, geometry is followed as it is. What is held, and how that is proven: `settle`.
    The two bounds on what sticks out (`overhang`) are aims: with `most` they may be missed.

    Args:
        triangles: The link's collision geometry, (T, 3, 3) [m]; open, touching and crossing
            surfaces are welcome.
        max_overhang: Aim for the farthest that the union sticks out [m].
        mean_overhang: Aim for the mean over the union's surface [m].
        most: Most capsules; None for as many as it takes up to 120. Thin open shells want many.

    Returns:
        Ends a and b and radius of each capsule [m]; none for no triangles.

    Raises:
        ValueError: An argument is out of range or a coordinate is not finite.
    """
    triangles = np.asarray(triangles, dtype=np.float64)
    if triangles.ndim != 3 or triangles.shape[1:] != (3, 3):
        raise ValueError(f"triangles has shape {triangles.shape}, expected (T, 3, 3)")
    if not np.isfinite(triangles).all():
        raise ValueError("triangles has coordinates that are not finite")
    for name, value in (("max_overhang", max_overhang), ("mean_overhang", mean_overhang)):
        if not value > 0:
            raise ValueError(f"{name} must be positive, got {value}")
    if most is not None and most < 1:
        raise ValueError(f"most must be at least 1, got {most}")
    if not len(triangles):
        return []
    fit = _Fit(Solid.of(triangles), Overhang(mean_overhang, max_overhang), most or _MOST)
    found = fit.run()
    return [
        (tidy_point(a), tidy_point(b), float(radius)) for a, b, radius in zip(*found, strict=True)
    ]


class _Fit:
    """The search for one link: split what sticks out, until the aims hold; then leave out."""

    def __init__(self, solid: Solid, aim: Overhang, most: int) -> None:
        self.solid, self.aim, self.most = solid, aim, most
        landmarks = solid.landmarks(_LANDMARKS)
        inner, _ = solid.inner_points()
        thin = inner[:: max(len(inner) // _INNER, 1)]
        self.landmarks = np.concatenate([landmarks, thin])
        self.points = np.concatenate([self.landmarks, solid.samples.data[::2]])

    def run(self) -> Capsules:
        moving = greedy_cover(self.solid, self.landmarks, _FIRST_SWELL * self.aim.worst)
        moving = moving.take(np.arange(min(self.most, len(moving.radius))))
        moving = self._wrap(moving, _FIRST_STEPS)
        best, score = self._settle(moving, with_inside=False)
        moving = best
        for _ in range(_MOST_ROUNDS):
            if score <= 1 or len(moving.radius) >= self.most:
                break
            moving = self._wrap(self._split(moving), _NEXT_STEPS)
            moving, new_score = self._settle(moving, with_inside=False)
            if new_score < score:
                best, score = moving, new_score
        for fewest in reversed(self._drop(best, score)):
            settled, new_score = self._settle(fewest, with_inside=True)
            if new_score <= 1:
                break
        return settled

    def _wrap(self, capsules: Capsules, steps: int) -> Capsules:
        return shrink_wrap(self.solid, self.points, capsules, steps=steps, worst=self.aim.worst)

    def _settle(self, capsules: Capsules, *, with_inside: bool) -> tuple[Capsules, float]:
        settled = settle(self.solid, capsules, with_inside=with_inside)
        return settled, self._score(settled)

    def _score(self, capsules: Capsules) -> float:
        """At most 1 where both aims hold."""
        got = overhang(self.solid, capsules)
        return _SPARE * max(got.mean / self.aim.mean, got.worst / self.aim.worst)

    def _split(self, capsules: Capsules) -> Capsules:
        """Halves in place of the capsules that stick out most; of a short one, side by side."""
        a, b, radius = capsules
        count = min(max(1, round(_GROWTH * len(radius))), self.most - len(radius))
        chosen = np.argsort(-self._costs(capsules))[:count]
        quarter = (b - a)[chosen] / 4
        aside = np.eye(3)[np.arange(count) % 3] * radius[chosen, None]
        short = np.linalg.norm(4 * quarter, axis=1, keepdims=True) < radius[chosen, None]
        shift, half = np.where(short, 0.3 * aside, quarter), np.where(short, 0.1 * aside, quarter)
        middle = (a + b)[chosen] / 2
        others = np.delete(np.arange(len(radius)), chosen)
        return Capsules(
            np.concatenate([a[others], middle - shift - half, middle + shift - half]),
            np.concatenate([b[others], middle - shift + half, middle + shift + half]),
            np.concatenate([radius[others], radius[chosen], radius[chosen]]),
        )

    def _costs(self, capsules: Capsules) -> FloatArray:
        """What each capsule adds to the integral of the overhang, or more for the worst, (K,)."""
        on = surface(capsules, 200)
        outer = free(capsules, on)
        out = np.zeros(outer.shape)
        out[outer] = self.solid.outside(on.points[outer])
        excess = np.maximum(out - self.aim.mean, 0) / self.aim.mean
        return np.asarray((excess + (out / self.aim.worst) ** 6).sum(axis=1) * on.areas)

    def _drop(self, best: Capsules, score: float) -> list[Capsules]:
        """Ever fewer capsules, several left out at a time while the aims are far, as they hold."""
        kept = [best]
        in_vain: set[int] = set()
        haste = _HASTE
        while score <= 1 and len(best.radius) > 1 and len(in_vain) < _PATIENCE:
            loss = self._losses(best)
            order = [int(k) for k in np.argsort(loss) if k not in in_vain]
            if not order:
                break
            count = max(1, int(haste * (1 - score) * len(loss)))
            fewer = best.take(np.delete(np.arange(len(loss)), order[:count]))
            fewer = self._wrap(fewer, _DROP_STEPS)
            settled, new_score = self._settle(fewer, with_inside=False)
            if new_score <= 1:
                best, score, in_vain = settled, new_score, set()
                kept.append(best)
            elif count > 1:
                haste /= 2
            else:
                in_vain.add(order[0])
        return kept[-_STEPS_BACK:]

    def _losses(self, capsules: Capsules) -> FloatArray:
        """How much would be bare without each capsule, (K,)."""
        gap = to_segments(self.points, capsules.a, capsules.b) - capsules.radius
        own = gap.argmin(axis=1)
        nearest = np.partition(gap, 1, axis=1)[:, 1]  # of the others
        bare = np.maximum(nearest, 0) ** 2
        return np.bincount(own, bare, minlength=len(gap[0])).astype(np.float64)
