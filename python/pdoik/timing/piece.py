"""A path's piece from one rest to the next: its curve, and the fastest motion along it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PPoly

from pdoik.timing.curve import Curve, rounded
from pdoik.timing.jerk import within_jerk
from pdoik.timing.limits import Bounds, Limits, Tool
from pdoik.timing.profile import fastest

FloatArray = npt.NDArray[np.float64]

_MOMENTS = np.array([0.01, 0.25, 0.5, 0.75, 0.99])  # of each step at which the outcome is measured
_POWERS = {"tool": 1, "turn": 1, "speed": 1, "acceleration": 2, "jerk": 3}  # of slowness
_TRIES = 10  # with limits inside that are smaller by what was measured
_EXCESS = 1e-4  # of time, which is left to slowing all of it
_REGIONS = 100  # besides the curve's polynomials: where limits inside are smaller, each its own


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Use:
    """How much of each limit a motion uses, at several moments of each step of it."""

    time: FloatArray  # (k,) [s]
    s: FloatArray  # (k,), place on the curve
    at: FloatArray  # (k,), place on the path
    ratios: dict[str, FloatArray]  # (k, n) of joints' limits, (k, 1) of the tool's

    @property
    def slowness(self) -> float:
        """Factor of the time that would bring it within all limits, at least 1."""
        wanted = (float(r.max() ** (1 / _POWERS[name])) for name, r in self.ratios.items())
        return max(1.0, *wanted)

    def excess(self, name: str, edges: FloatArray) -> FloatArray:
        """The largest use of a limit between edges of regions, at least 1, shape (m - 1,)."""
        largest = np.ones(len(edges) - 1)
        if name in self.ratios:
            region = np.clip(np.searchsorted(edges, self.s, "right") - 1, 0, len(largest) - 1)
            np.maximum.at(largest, region, self.ratios[name].max(axis=1))
        return largest


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Piece:
    """The motion from one rest to the next."""

    curve: Curve
    motion: PPoly  # s by time
    s: FloatArray  # (m,) of each row
    at: FloatArray  # (m,), place of each row on the path

    @property
    def nodes(self) -> FloatArray:
        """Times between which the motion is one polynomial [s]."""
        times: FloatArray = self.motion.x
        return times

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.motion.x[-1])

    @property
    def end(self) -> FloatArray:
        """Where it comes to rest, shape (n,)."""
        last: FloatArray = self.curve(self.curve.breaks[-1:])[0]
        return last

    def place(self, t: FloatArray) -> FloatArray:
        """Place on the curve, shape (k,)."""
        s: FloatArray = np.clip(self.motion(t), 0.0, self.curve.breaks[-1])
        return s

    def states(self, t: FloatArray) -> tuple[FloatArray, ...]:
        """Place on the path (k,), then q and its three derivatives by time (k, n)."""
        t = np.clip(t, 0.0, self.duration)
        s = self.place(t)
        v, a, j = (self.motion(t, order)[:, None] for order in (1, 2, 3))
        q, q1, q2, q3 = (self.curve(s, order) for order in range(4))
        jerk = q3 * v**3 + 3 * q2 * v * a + q1 * j
        return np.interp(s, self.s, self.at), q, q1 * v, q2 * v**2 + q1 * a, jerk

    def use(self, limits: Limits, tool: Tool | None) -> Use:
        """Measured, whatever it was made by."""
        time = (self.nodes[:-1, None] + np.diff(self.nodes)[:, None] * _MOMENTS).ravel()
        at, q, dq, ddq, dddq = self.states(time)
        ratios = {
            "speed": np.abs(dq) / limits.speed,
            "acceleration": np.abs(ddq) / limits.acceleration,
            "jerk": np.abs(dddq) / limits.jerk,
        }
        if tool is not None:
            rates = tool.rates(q, dq) / (tool.speed, tool.turn)
            ratios |= {"tool": rates[:, :1], "turn": rates[:, 1:]}
        return Use(time=time, s=self.place(time), at=at, ratios=ratios)

    def slowed(self, factor: float) -> Piece:
        """The same in so many times the time."""
        orders = np.arange(len(self.motion.c))[::-1, None]
        slow = PPoly(self.motion.c / factor**orders, self.motion.x * factor)
        return replace(self, motion=slow)


def time_piece(
    rows: FloatArray,
    s: FloatArray,
    at: FloatArray,
    limits: Limits,
    tool: Tool | None,
    deviation: float,
) -> tuple[Piece, Use]:
    """The fastest motion along rows (m, n), from rest to rest, and how much of limits it uses.

    What is between the points at which limits were taken into account may be beyond them by a
    little. That is measured, and limits inside are made smaller there by as much. What is left then
    is made up for by slowing all of it.
    """
    s = s - s[0]
    curve = rounded(rows, s, deviation)
    edges = np.union1d(curve.breaks, np.linspace(0.0, curve.breaks[-1], _REGIONS + 1))
    inside = {name: np.ones(len(edges) - 1) for name in _POWERS}
    for _ in range(_TRIES):
        motion = _motion(Bounds(curve, limits, tool, edges, inside))
        piece = Piece(curve=curve, motion=motion, s=s, at=at)
        use = piece.use(limits, tool)
        if use.slowness <= 1 + _EXCESS:
            break
        for name, share in inside.items():
            share /= use.excess(name, edges)
    piece = piece.slowed(use.slowness)
    return piece, piece.use(limits, tool)


def _motion(bounds: Bounds) -> PPoly:
    """The place s by time within these limits."""
    limits = bounds.limits
    moved = np.abs(np.diff(bounds.curve.splines[0].c, axis=0)).sum(axis=0)  # (n,), at most
    if np.isinf(limits.jerk[moved > 0.0]).all():
        return fastest(bounds)
    # From rest to rest over what a joint goes, jerk lets it come to no more than this.
    reached = np.cbrt(np.where(moved > 0.0, moved, np.inf) * limits.jerk**2 / 2)
    usable = replace(limits, acceleration=np.minimum(limits.acceleration, reached))
    ramp = float((usable.acceleration / limits.jerk)[moved > 0.0].max())
    return within_jerk(bounds, fastest(replace(bounds, limits=usable)), ramp)
