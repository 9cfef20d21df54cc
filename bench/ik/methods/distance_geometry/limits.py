"""Joint limits as ranges of distances between points two axes apart.

After Maric et al. 2021. While joint k turns, a point of axis k + 1 moves on a circle about
axis k, so its squared distance to a point of axis k - 1 is
    d^2(theta) = c_0 + c_1 cos(theta - phi),  c_1 >= 0.
The public implementation bounds a distance only where zero is an extreme of d, and takes limits as
symmetric about it; here, each distance keeps to its range over the limits, which is the same in
that case and otherwise says all that this distance can say.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.common.arrays import FloatArray

TURN = 2 * np.pi
SAME = 1e-9  # squared distances that differ less are one [m^2]
NEARLY = 1e-3  # an angle closer to its limits than this is not called outside them [rad]


@dataclass(frozen=True, slots=True, kw_only=True)
class SquaredDistance:
    """d^2 between two points over the angle of the joint between them."""

    mean: float  # c_0 [m^2]
    amplitude: float  # c_1 [m^2]
    phase: float  # phi [rad]

    @classmethod
    def through(cls, samples: FloatArray) -> SquaredDistance:
        """Fit to values at 0, 1/3 and 2/3 of a turn, (3,) [m^2]."""
        angles = TURN / 3 * np.arange(3)
        a, b = 2 / 3 * samples @ np.cos(angles), 2 / 3 * samples @ np.sin(angles)
        return cls(
            mean=float(np.mean(samples)),
            amplitude=float(np.hypot(a, b)),
            phase=float(np.arctan2(b, a)),
        )

    def __call__(self, theta: FloatArray) -> FloatArray:
        return np.asarray(self.mean + self.amplitude * np.cos(theta - self.phase))

    @property
    def is_constant(self) -> bool:
        return self.amplitude < SAME

    def range(self, lower: float, upper: float) -> tuple[float, float]:
        """Least and greatest value over an interval; -inf and inf where the limits take nothing."""
        ends = self(np.array([lower, upper])) if np.isfinite(upper - lower) else np.zeros(2)
        low = -np.inf if _holds(lower, upper, self.phase + np.pi) else float(ends.min())
        high = np.inf if _holds(lower, upper, self.phase) else float(ends.max())
        return low, high


def expresses(distances: list[SquaredDistance], lower: float, upper: float) -> bool:
    """Whether the distances' ranges together leave no angle outside the limits."""
    if upper - lower >= TURN - 2 * NEARLY:
        return False
    theta = np.linspace(upper + NEARLY, lower + TURN - NEARLY, 2000)
    left = np.ones(len(theta), dtype=bool)
    for distance in distances:
        low, high = distance.range(lower, upper)
        value = distance(theta)
        left &= (value >= low - SAME) & (value <= high + SAME)
    return not left.any()


def _holds(lower: float, upper: float, angle: float) -> bool:
    """Whether the angle or one some turns further is strictly between the two."""
    return upper - lower >= TURN or bool((angle - lower) % TURN < upper - lower)
