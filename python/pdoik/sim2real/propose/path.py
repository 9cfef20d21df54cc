"""A motion of all joints, on a uniform grid of time, with the curve through it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from pdoik.recordings import FloatArray

STEP = 0.01  # of the grid [s]
REST = 0.25  # at either end [s]
_ROUNDING = 0.04  # of corners: half the width of the window that they are rounded with [s]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Path:
    """A motion from rest to rest. Arrays are (T, n), T rows STEP apart."""

    q: FloatArray
    dq: FloatArray
    ddq: FloatArray

    @property
    def time(self) -> FloatArray:
        """Times of the rows, (T,), from 0 [s]."""
        return np.asarray(STEP * np.arange(len(self.q)), dtype=np.float64)

    @property
    def duration(self) -> float:
        """[s]."""
        return STEP * (len(self.q) - 1)

    @property
    def curve(self) -> CubicSpline:
        """Spline through the rows, at rest at both ends."""
        return CubicSpline(self.time, self.q, bc_type="clamped")

    def toward(self, start: FloatArray, share: float) -> Path:
        """The same shrunk towards one configuration: all of it at 1, nothing but that at 0."""
        return Path(q=start + share * (self.q - start), dq=share * self.dq, ddq=share * self.ddq)


def path_of(q: FloatArray) -> Path:
    """A path through rows STEP apart, with corners rounded, and at rest at both ends.

    Args:
        q: (T, n), whose first and last 0.25 s are overwritten by rest.
    """
    held = q.copy()
    rest = round(REST / STEP)
    held[:rest], held[-rest:] = q[0], q[-1]
    smooth = _rounded(held)
    dq = np.gradient(smooth, STEP, axis=0)
    return Path(q=smooth, dq=dq, ddq=np.gradient(dq, STEP, axis=0))


def _rounded(q: FloatArray) -> FloatArray:
    """Rows passed through a Hann window twice, so that accelerations are continuous; ends stay."""
    half = max(1, round(_ROUNDING / STEP))
    window = np.hanning(2 * half + 3)[1:-1]
    window /= window.sum()
    padded = np.pad(q, ((2 * half, 2 * half), (0, 0)), mode="edge")
    columns = [
        np.convolve(np.convolve(column, window, mode="same"), window, mode="same")
        for column in padded.T
    ]
    return np.ascontiguousarray(np.stack(columns, axis=1)[2 * half : -2 * half])
