"""Capsules that hold a link's collision geometry tightly: the second, closer level of hulls."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..errors import OverhangWarning
from .hulls import FloatArray, Point, tidy_point
from .overhang import Overhang, each_overhang, overhang_of
from .segments import Capsules, free, surface, to_segments
from .settle import Proof
from .solid import Solid
from .wrap import ShrinkWrap, greedy_cover

_LANDMARKS = 1500
_POINTS = 6000  # of the surface where overhangs are measured in between
_INNER = 300  # points inside that are asked for while capsules move
_FIRST_SWELL = 0.85  # how far the first set sticks out, over the most that is allowed
_MOST_ROUNDS, _MOST_PROOFS = 30, 6
_FIRST_STEPS, _NEXT_STEPS, _DROP_STEPS = 240, 120, 120
_GROWTH = 0.15  # share of capsules that are split in a round
_SPARE = 1.015  # of the aims, for what another look than ours may find
_MOST = 120  # capsules of a link, where nothing else is asked
_SWELLING = 0.15  # by a proof, of the aims, until one has shown it
_CLOSE = 0.95  # of the aims, from where no more is left out after a proof
_HASTE = 1.0  # share of the capsules that is left out at once, over the aims' share to spare
_PATIENCE = 3  # capsules whose loss is tried in vain before a leap
_LEAP = 0.06  # share of the capsules that it leaves out


AIM = Overhang(mean=0.004, worst=0.015)


class Capsule(NamedTuple):
    """A ball swept along a segment, fixed to a link; a ball where the ends coincide."""

    link: str
    a: Point  # one end of the segment, in the link's frame [m]
    b: Point  # the other end [m]
    radius: float  # [m]
    overhang: float = 0.0  # of its surface beyond the link at most, 0 where nobody knows [m]


def fit_capsules(
    triangles: FloatArray,
    *,
    max_overhang: float = AIM.worst,
    mean_overhang: float = AIM.mean,
    most: int | None = None,
) -> list[tuple[Point, Point, float]]:
    """Few capsules that together hold a surface and what it encloses, and stick out little.

    Where concave, geometry is followed as it is. What is held, and how that is proven: `Proof`.
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
    aim = Overhang(mean_overhang, max_overhang)
    found, _ = _fitted(Solid.of(triangles), aim, most)
    return _rows(found)


def fit_link(
    link: str, triangles: FloatArray, *, most: int | None = None
) -> tuple[list[Capsule], Overhang]:
    """The capsules of `fit_capsules` fixed to a link, and how far their union sticks out.

    Warns:
        OverhangWarning: It is farther than `AIM`.
    """
    solid = Solid.of(triangles)
    found, out = _fitted(solid, AIM, most)
    warn_of_overhang(link, len(found.radius), out)
    each = np.round(each_overhang(solid, found), 6)
    rows = zip(_rows(found), each, strict=True)
    return [Capsule(link, *row, float(overhang)) for row, overhang in rows], out


def warn_of_overhang(link: str, count: int, out: Overhang) -> None:
    """Warn if a link's capsules stick out farther than the aim."""
    if not out.meets(AIM):
        message = f"{link}: {count} capsules stick out {out}, the aims are {AIM}"
        warnings.warn(message, OverhangWarning, stacklevel=3)


@np.errstate(invalid="ignore")  # products that write to fresh memory: some BLAS read it, times 0
def _fitted(solid: Solid, aim: Overhang, most: int | None) -> tuple[Capsules, Overhang]:
    return _Fit(solid, aim, most or _MOST).run()


def _rows(capsules: Capsules) -> list[tuple[Point, Point, float]]:
    return [
        (tidy_point(a), tidy_point(b), float(radius))
        for a, b, radius in zip(*capsules, strict=True)
    ]


@dataclass(frozen=True, slots=True)
class _Set:
    """Capsules that hold many points of the link."""

    capsules: Capsules
    overhang: Overhang
    score: float  # at most 1 where both aims hold

    @property
    def count(self) -> int:
        return len(self.capsules.radius)


class _Fit:
    """The search for one link: split what sticks out, until the aims hold; then leave out.

    It asks only that many points be held. What it ends with is proven; if that swells the capsules
    beyond the aims, the search goes on with room left for so much.
    """

    def __init__(self, solid: Solid, aim: Overhang, most: int) -> None:
        self.solid, self.aim, self.most = solid, aim, most
        inner, _ = solid.inner_points()
        landmarks = [solid.landmarks(_LANDMARKS), inner[:: max(len(inner) // _INNER, 1)]]
        self.points = np.concatenate([*landmarks, solid.samples.data])
        self.wrap = ShrinkWrap(solid, self.points, aim.worst)
        self.first = greedy_cover(solid, np.concatenate(landmarks), _FIRST_SWELL * aim.worst)
        self.proof = Proof(solid)
        self.swelling = Overhang(_SWELLING * aim.mean, _SWELLING * aim.worst)  # by the proof

    def run(self) -> tuple[Capsules, Overhang]:
        """Where no set meets the aims, the one that comes nearest."""
        now = self._moved(self.first.take(slice(self.most)), _FIRST_STEPS)
        proofs: list[_Set] = []
        for _ in range(_MOST_PROOFS):
            before = now.count
            now = self._fewer(self._more(now))
            proofs.append(self._proven(now))
            score = proofs[-1].score
            if now.count == (self.most if score > 1 else before) or _CLOSE < score <= 1:
                break
            now = _Set(now.capsules, proofs[-1].overhang, score)
        holding = [entry for entry in proofs if entry.score <= 1]
        if holding:
            best = min(holding, key=lambda entry: entry.count)
        else:
            best = min(proofs, key=lambda entry: entry.score)
        return best.capsules, best.overhang

    def _moved(self, capsules: Capsules, steps: int) -> _Set:
        moved = self.proof.approximate(self.wrap.move(capsules, steps))
        got = overhang_of(self.solid, moved, _POINTS)
        out = Overhang(got.mean + self.swelling.mean, got.worst + self.swelling.worst)
        return _Set(moved, out, self._score(out))

    def _proven(self, now: _Set) -> _Set:
        """Proven; what the proof added to the overhang is expected of the next sets too."""
        proven = self.proof.settle(now.capsules)
        out, before, added = overhang_of(self.solid, proven), now.overhang, self.swelling
        self.swelling = Overhang(
            added.mean + out.mean - before.mean, added.worst + out.worst - before.worst
        )
        return _Set(proven, out, self._score(out))

    def _score(self, out: Overhang) -> float:
        return _SPARE * max(out.mean / self.aim.mean, out.worst / self.aim.worst)

    def _more(self, now: _Set) -> _Set:
        """Ever more capsules, those that stick out most being split, until the aims hold."""
        best = now
        for _ in range(_MOST_ROUNDS):
            if best.score <= 1 or now.count >= self.most:
                break
            now = self._moved(self._split(now.capsules, now.score), _NEXT_STEPS)
            best = min(best, now, key=lambda entry: entry.score)
        return best

    def _fewer(self, best: _Set) -> _Set:
        """Ever fewer capsules as long as the aims hold; while they are far, several at a time.

        Where no one capsule can be spared, the worst place standing a little too far out, a leap
        often gets past: some are left out at once, and the others move longer.
        """
        in_vain: set[int] = set()
        haste = _HASTE
        while best.score <= 1 and best.count > 1:
            order = [int(k) for k in np.argsort(self._losses(best.capsules))]
            leaps = len(in_vain) >= min(_PATIENCE, best.count)
            if leaps:
                count, steps, haste = max(1, int(_LEAP * best.count)), _FIRST_STEPS, _HASTE
            else:
                count, steps = max(1, int(haste * (1 - best.score) * best.count)), _DROP_STEPS
                order = [k for k in order if k not in in_vain]
            left = np.delete(np.arange(best.count), order[:count])
            fewer = self._moved(best.capsules.take(left), steps)
            if fewer.score > 1 and count == 1 and not leaps:
                fewer = self._moved(fewer.capsules, steps)
            if fewer.score <= 1:
                best, in_vain = fewer, set()
            elif leaps:
                break
            elif count > 1:
                haste /= 2
            else:
                in_vain.add(order[0])
        return best

    def _split(self, capsules: Capsules, score: float) -> Capsules:
        """Halves in place of the capsules that stick out most; of a short one, side by side."""
        a, b, radius = capsules
        count = max(1, round(min(_GROWTH, score - 1) * len(radius)))
        count = min(count, self.most - len(radius))
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

    def _losses(self, capsules: Capsules) -> FloatArray:
        """How much would be bare without each capsule, (K,)."""
        gap = to_segments(self.points.astype(np.float32), capsules.a, capsules.b) - capsules.radius
        own = gap.argmin(axis=1)
        nearest = np.partition(gap, 1, axis=1)[:, 1]  # of the others
        bare = np.maximum(nearest, 0) ** 2
        return np.bincount(own, bare, minlength=len(gap[0])).astype(np.float64)
