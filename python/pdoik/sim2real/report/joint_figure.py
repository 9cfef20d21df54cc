"""All about one joint's residual: in time, close up, by speed, position, load and clock."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.typing import LineStyleType
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from .curves import BINS, binned, busiest, envelope, reach, sample
from .data import ReportData, Traces
from .style import AFTER, BEFORE, INK, MEASURED, MUTED, NOISE, Picture, picture, quiet_legend, short
from .words import slug

CLOSE_UP = 6.0  # [s]
SHOWN = 4  # recordings laid head to tail; the rest is in the binned panels


def joint_picture(data: ReportData, joint: int, points: int = 2500) -> Picture:
    """The joint's figure; `points` is how many samples a cloud may hold."""
    name, unit = data.joints[joint], data.units[joint]
    figure = Figure(figsize=(10.6, 8.1))
    grid = figure.add_gridspec(
        3, 13, left=0.078, right=0.992, top=0.968, bottom=0.06, hspace=0.42, wspace=0.8,
        height_ratios=(1.0, 1.0, 1.1),
    )  # fmt: skip
    held_out = data.held_out
    limit = reach(*(traces.before[:, joint] for traces in held_out))
    _in_time(figure.add_subplot(grid[0, :]), data, joint, limit)
    _close_up(figure.add_subplot(grid[1, :]), data, joint)
    q, dq, load, before, after = (
        np.concatenate([getattr(traces, field)[:, joint] for traces in held_out])
        for field in ("q", "dq", "load", "before", "after")
    )
    position = data.position_unit(joint)
    panels = (
        (dq, f"speed [{position}/s]"),
        (q, f"position [{position}]"),
        (load, f"load [{data.load_unit(joint)}]"),
    )
    for k, (x, label) in enumerate(panels):
        axes = figure.add_subplot(grid[2, 3 * k : 3 * k + 3])
        against(axes, x, before, after, points, dq if k else None)
        if not np.isfinite(x).any():
            axes.text(0.5, 0.5, "not known", transform=axes.transAxes, ha="center", color=MUTED)
            axes.set_xticks([])
        axes.set(ylim=limit, xlabel=label, title=f"by {label.split(' [')[0]}")
        if k:
            axes.tick_params(labelleft=False)
        else:
            axes.set_ylabel(f"residual [{unit}]")
    _by_clock(figure.add_subplot(grid[2, 10:]), data, joint, points)
    caption = (
        f"{name}: residual before and after the findings. Lines in the lower panels are medians"
        " (by position and load dashed for backward motion; by time of day root mean squares),"
        " bands hold the middle half."
    )
    return picture(figure, f"joint{joint + 1}_{slug(name)}", caption)


def against(
    axes: Axes,
    x: FloatArray,
    before: FloatArray,
    after: FloatArray,
    points: int,
    direction: FloatArray | None = None,
) -> None:
    """Clouds of both residuals over x, with medians and quartiles by bins.

    With `direction` there are medians of each: what friction does both ways is no average.
    """
    parts: list[tuple[NDArray[np.bool_], LineStyleType]] = [(np.isfinite(x), "-")]
    if direction is not None:
        parts = [(direction > 0, "-"), (direction < 0, (0, (3, 1.2)))]
    chosen = sample(len(x), points)
    for y, color in ((before, BEFORE), (after, AFTER)):
        axes.plot(
            x[chosen], y[chosen], ".", ms=1.6, mew=0, alpha=0.35, color=color, rasterized=True
        )
    axes.axhline(0, color=MUTED, lw=0.8)
    for y, color in ((before, BEFORE), (after, AFTER)):
        for inside, dashes in parts:
            bins = binned(x[inside], y[inside], BINS if direction is None else 12)
            axes.fill_between(bins.x, bins.low, bins.high, color=color, alpha=0.22, lw=0)
            axes.plot(bins.x, bins.median, color=color, lw=1.8, ls=dashes)


def residual_lines(axes: Axes, time: FloatArray, before: FloatArray, after: FloatArray) -> None:
    """Both residuals over time."""
    axes.plot(*envelope(time, before), color=BEFORE, lw=0.7, alpha=0.9)
    axes.plot(*envelope(time, after), color=AFTER, lw=0.7, alpha=0.95)


def _in_time(axes: Axes, data: ReportData, joint: int, limit: tuple[float, float]) -> None:
    shown = sorted(data.held_out, key=lambda traces: -len(traces.time))[:SHOWN]
    shown = [traces for traces in data.held_out if traces in shown]
    floor = data.noise_floor[joint]
    start = 0.0
    total = sum(float(np.ptp(traces.time)) for traces in shown)
    ticks: list[tuple[float, str]] = []
    for k, traces in enumerate(shown):
        length = float(np.ptp(traces.time))
        time = start + traces.time - traces.time[0]
        residual_lines(axes, time, traces.before[:, joint], traces.after[:, joint])
        axes.text(
            start, 1.0, f" {short(traces.name, 34)}", transform=axes.get_xaxis_transform(),
            va="top", fontsize=7.5, color=MUTED,
        )  # fmt: skip
        if k:
            axes.axvline(start - 0.01 * total, color=MUTED, lw=0.8)
        ticks += [(start + tick, f"{tick:g}") for tick in _ticks(length, total)]
        start += length + 0.02 * total
    if np.isfinite(floor):
        axes.axhspan(-2 * floor, 2 * floor, color=NOISE, alpha=0.3, lw=0, zorder=0)
    axes.plot([], [], color=BEFORE, label="before")
    axes.plot([], [], color=AFTER, label="after")
    axes.fill_between([], [], [], color=NOISE, alpha=0.3, lw=0, label="noise, ±2 std")
    axes.set_xticks([tick for tick, _ in ticks], [label for _, label in ticks])
    kind = "held-out recordings" if shown and shown[0].role == "validate" else "recordings"
    axes.set(
        xlim=(0, start - 0.02 * total), ylim=limit, xlabel="time [s]",
        ylabel=f"residual [{data.units[joint]}]", title=f"{short(data.joints[joint])}: {kind}",
    )  # fmt: skip
    quiet_legend(axes)


def _ticks(length: float, total: float) -> FloatArray:
    steps = np.array([0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000])
    step = steps[np.argmin(np.abs(steps - max(total, 1e-3) / 12))]
    return np.arange(0, max(length - 0.3 * step, step / 2), step)


def _close_up(axes: Axes, data: ReportData, joint: int) -> None:
    """The stretch where the user's model is furthest off: what was measured, and predicted."""
    unit = data.units[joint]
    traces = worst_recording(data, joint)
    part = busiest(traces.time, traces.before[:, joint], CLOSE_UP)
    time = traces.time[part]
    if traces.measured is None:
        residual_lines(axes, time, traces.before[part, joint], traces.after[part, joint])
        label, title = f"residual [{unit}]", "close up"
    else:
        lines = (
            (traces.predicted_before, BEFORE, "model before", 1.4),
            (traces.predicted_after, AFTER, "model after", 1.4),
        )
        axes.plot(*envelope(time, traces.measured[part, joint]), color=MEASURED, lw=2.2, alpha=0.35,
                  label="measured")  # fmt: skip
        for values, color, what, width in lines:
            if values is not None:
                axes.plot(*envelope(time, values[part, joint]), color=color, lw=width, label=what)
        label, title = f"{data.residual_of} [{unit}]", "where the model was furthest off"
    if len(time):
        axes.set_xlim(float(time[0]), float(time[-1]))
    axes.set(xlabel="time [s]", ylabel=label, title=f"{title}: {short(traces.name, 40)}")
    quiet_legend(axes)


def worst_recording(data: ReportData, joint: int) -> Traces:
    """The one with the stretch where the user's model is furthest off."""

    def badness(traces: Traces) -> float:
        part = busiest(traces.time, traces.before[:, joint], CLOSE_UP)
        return float(np.nansum(traces.before[part, joint] ** 2))

    return max(data.telling, key=badness)


def _by_clock(axes: Axes, data: ReportData, joint: int, points: int) -> None:
    """Size of the residual over all recordings as they were taken, pauses cut short."""
    some = sorted(data.recordings, key=lambda traces: float(traces.clock[0]))
    total = sum(float(np.ptp(traces.clock)) for traces in some) or 1.0
    budget = max(60, points // max(len(some), 1))
    origin = float(some[0].clock[0])
    start, starts, top = 0.0, [], 0.0
    for traces in some:
        x = start + traces.clock - traces.clock[0]
        for y, color in ((traces.before[:, joint], BEFORE), (traces.after[:, joint], AFTER)):
            size = np.abs(y)
            chosen = sample(len(x), budget)
            axes.plot(
                x[chosen], size[chosen], ".", ms=1.6, mew=0, alpha=0.3, color=color, rasterized=True
            )
            bins = binned(x, size, bins=max(3, round(12 * float(np.ptp(x)) / total)))
            axes.fill_between(bins.x, bins.low, bins.high, color=color, alpha=0.22, lw=0)
            axes.plot(bins.x, bins.rms, color=color, lw=1.8, marker="o", ms=2.6)
            top = max(top, reach(size, share=0.99)[1])
        starts.append((start, float(traces.clock[0]) - origin))
        start += float(np.ptp(traces.clock)) + 0.04 * total
    for x0, _ in starts[1:]:
        axes.axvline(x0 - 0.02 * total, color=MUTED, lw=0.8)
    every = -(-len(starts) // 4)
    axes.set_xticks([x0 for x0, _ in starts][::every], [_clock_text(t) for _, t in starts][::every])
    axes.set(ylim=(0, top), xlabel="recordings from", title="|residual| by time of day")
    axes.tick_params(axis="x", colors=INK)


def _clock_text(seconds: float) -> str:
    if abs(seconds) < 120:
        return f"{seconds:.0f} s"
    if abs(seconds) < 7200:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h" if abs(seconds) < 172800 else f"{seconds / 86400:.1f} d"
