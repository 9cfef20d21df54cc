"""Machine, simulator and patched simulator in one picture, joint by joint."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pdoik.recordings import FloatArray

from ..report import AFTER, BEFORE, MEASURED, Picture, number, picture, short
from .compare import Trace
from .differences import BANDS, in_bands

_WINDOW = 2.0  # numerics: shown about the largest error [s]


def overlay(trace: Trace, joints: tuple[str, ...], name: str) -> Picture:
    """A row for each joint: where the error is largest, and the error by frequency."""
    n = len(joints)
    figure = Figure(figsize=(9.0, 1.0 + 1.45 * n), layout="constrained")
    grid = figure.subplots(n, 2, squeeze=False, width_ratios=(2.2, 1.0))
    for k, joint in enumerate(joints):
        _motion(grid[k, 0], trace, k, joint)
        _bands(grid[k, 1], trace, k)
    grid[0, 0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.12), ncols=3, borderaxespad=0.1)
    grid[0, 1].set_title("error by frequency [rad rms]")
    grid[-1, 0].set_xlabel("time [s]")
    grid[-1, 1].set_xlabel("[Hz]")
    after = "" if trace.patched is None else ", and the simulator with the patch (blue)"
    caption = (
        f"{trace.recording.name}: positions of the machine (dark), the simulator as it is (red)"
        f"{after}, {_WINDOW:g} s about the largest error of each joint."
    )
    return picture(figure, name, caption)


def _motion(axes: Axes, trace: Trace, k: int, joint: str) -> None:
    time, q = trace.recording.time, trace.recording.q[:, k]
    error = np.abs(q - trace.simulator[:, k])
    middle = float(time[int(np.nanargmax(error))]) if np.isfinite(error).any() else 0.0
    first = float(np.clip(middle - 0.5 * _WINDOW, 0.0, max(time[-1] - _WINDOW, 0.0)))
    at = (time >= first) & (time <= first + _WINDOW)
    axes.plot(time[at], q[at], color=MEASURED, lw=1.6, label="machine")
    axes.plot(time[at], trace.simulator[at, k], color=BEFORE, lw=1.0, label="simulator")
    said = number(_rms(q - trace.simulator[:, k]))
    if trace.patched is not None:
        axes.plot(time[at], trace.patched[at, k], color=AFTER, lw=1.0, label="patched")
        said += f" → {number(_rms(q - trace.patched[:, k]))}"
    axes.set_title(f"{short(joint, 24)}: {said} rad rms")
    axes.set_ylabel("[rad]")
    axes.set_xlim(first, first + _WINDOW)


def _bands(axes: Axes, trace: Trace, k: int) -> None:
    place = np.arange(len(BANDS))
    sides = [(trace.simulator, BEFORE, -0.2)]
    if trace.patched is not None:
        sides.append((trace.patched, AFTER, 0.2))
    for values, color, aside in sides:
        error = trace.recording.q[:, k] - values[:, k]
        there = np.isfinite(error)
        axes.bar(
            place + aside, in_bands(error[there], trace.recording.period), width=0.38, color=color
        )
    names = [f"<{high:g}" if np.isfinite(high) else f">{low:g}" for low, high in BANDS]
    axes.set_xticks(place, names)


def _rms(error: FloatArray) -> float:
    return float(np.sqrt(np.nanmean(error**2)))
