"""A recording as the page plays it: postures and residuals at any time."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import numpy.typing as npt

from pdoik.sim2real.evidence import Motion

from .colors import moving_rms

FloatArray = npt.NDArray[np.float64]

COPIES = ("recorded", "before", "after")
_QUANTILE = 0.98  # of the residuals before, where the colours end


class Timeline:
    """Timeline of one recording; times are seconds after its first sample."""

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self.time = motion.time - motion.time[0]

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.time[-1])

    @property
    def simulated(self) -> bool:
        return self.motion.replay is not None

    @cached_property
    def size(self) -> dict[str, FloatArray]:
        """Root mean square residuals about each moment, (T, n), before and after."""
        return {
            "before": moving_rms(self.time, self.motion.before),
            "after": moving_rms(self.time, self.motion.after),
        }

    def q(self, copy: str, t: float, times: float = 1.0) -> FloatArray:
        """The posture of a copy, (n,); differences to the recording are drawn `times` as large.

        Where nothing was simulated, or not so long, it is the recorded one.
        """
        recorded = _at(t, self.time, self.motion.q)
        replay = self.motion.replay
        if copy == "recorded" or replay is None or not self.is_simulated(t):
            return recorded
        time = replay.time - replay.time[0]
        off = (replay.before if copy == "before" else replay.after) - replay.recorded
        return recorded + times * _at(t, time, off)

    def is_simulated(self, t: float) -> bool:
        """Whether a simulation reaches so far."""
        replay = self.motion.replay
        return replay is not None and t <= float(replay.time[-1] - replay.time[0]) + 1e-6

    @cached_property
    def departures(self) -> dict[str, FloatArray]:
        """How far a simulation goes off, (n,) before and after; empty if there is none.

        Where it is put back to the recording again and again, the largest between two times of
        that, median of all; otherwise the root mean square over the recording.
        """
        replay = self.motion.replay
        if replay is None:
            return {}
        off = {w: np.abs(getattr(replay, w) - replay.recorded) for w in ("before", "after")}
        if replay.horizon is None:
            return {which: np.sqrt((each**2).mean(axis=0)) for which, each in off.items()}
        run = np.ceil((replay.time - replay.time[0]) / replay.horizon - 1e-6).astype(int)
        begins = np.flatnonzero(np.diff(run, prepend=-1))
        return {
            which: np.median(np.maximum.reduceat(each, begins, axis=0)[1:], axis=0)
            for which, each in off.items()
        }

    @property
    def horizon(self) -> float | None:
        """Every so long the simulation is put back to the recording [s]; None: never."""
        return None if self.motion.replay is None else self.motion.replay.horizon

    def base(self, t: float) -> FloatArray | None:
        """The pose of a base that floats, (7,)."""
        if self.motion.base is None:
            return None
        pose = _at(t, self.time, self.motion.base)
        pose[3:] /= max(float(np.linalg.norm(pose[3:])), 1e-12)
        return pose

    def residual(self, which: str, t: float) -> FloatArray:
        """Root mean square about that moment, (n,); NaN where it is not known."""
        row = min(int(np.searchsorted(self.time, t)), len(self.time) - 1)
        return np.asarray(self.size[which][row])

    def most(self, joints: list[int]) -> float:
        """Where the colours of these joints end."""
        values = self.size["before"][:, joints]
        known = values[np.isfinite(values)]
        return float(np.quantile(known, _QUANTILE)) if known.size else 1.0


def _at(t: float, time: FloatArray, values: FloatArray) -> FloatArray:
    return np.array([np.interp(t, time, column) for column in values.T])
