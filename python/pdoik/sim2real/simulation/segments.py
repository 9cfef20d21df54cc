"""What runs log, and recordings as their beginnings and grids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import savgol_filter

from pdoik.recordings import FloatArray, Recording


@dataclass(slots=True)
class Segment:
    """What one uninterrupted run logged, a row per step and one for its end."""

    start: float  # [s]
    position: FloatArray  # (steps + 1, nq)
    velocity: FloatArray
    command: FloatArray  # (steps, n)
    reported: FloatArray


def run_ends(duration: float, window: float | None, period: float) -> list[float]:
    """Where the runs end [s], on the recording's grid."""
    if window is None:
        return [duration]
    if not window > 0:
        raise ValueError(f"window must be positive, got {window} s")
    every = max(1, round(window / period))
    rows = np.arange(every, round(duration / period), every)
    return [*(rows * period).tolist(), duration]


def row_at(t: float, time: FloatArray, values: FloatArray) -> FloatArray:
    """Values (T, n) at a time between samples, (n,)."""
    return np.array([np.interp(t, time, column) for column in values.T])


def sampled(segments: list[Segment], field: str, dt: float, time: FloatArray) -> FloatArray:
    """A log at given times: states on straight lines between steps, torques held."""
    held = field in ("command", "reported")
    starts = np.array([segment.start for segment in segments])
    which = np.clip(np.searchsorted(starts, time - 1e-9, side="left") - 1, 0, None)
    parts = []
    for k, segment in enumerate(segments):
        log: FloatArray = getattr(segment, field)
        place = np.clip((time[which == k] - segment.start) / dt, 0.0, len(log) - 1.0)
        low = np.floor(place + 1e-6).astype(int)
        low = np.clip(low, 0, len(log) - 1 if held else max(len(log) - 2, 0))
        if held:
            parts.append(log[low])
        else:
            share = (place - low)[:, None]
            parts.append(log[low] * (1 - share) + log[low + 1] * share)
    return np.concatenate(parts)


def measured_state(
    commands: Recording, joints: tuple[str, ...], q0: FloatArray | None, dq0: FloatArray | None
) -> tuple[FloatArray, FloatArray]:
    """Recorded positions and speeds, (T, n) each, with other first ones where given."""
    q = commands.q.copy()
    if commands.dq is not None and np.isfinite(commands.dq).all():
        dq = commands.dq.copy()
    else:
        length = min(11, (len(q) - 1) // 2 * 2 + 1)
        order = min(3, length - 1)
        dq = savgol_filter(q, length, order, deriv=1, delta=commands.period, axis=0)
    for name, given, values in (("q0", q0, q), ("dq0", dq0, dq)):
        if given is not None:
            if np.shape(given) != (len(joints),):
                raise ValueError(f"{name} has shape {np.shape(given)}, expected ({len(joints)},)")
            values[0] = given
    return q, np.asarray(dq)
