"""The improved simulation together with the recording."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pdoik.recordings import FloatArray

from .curves import busiest, envelope, reach, rms
from .data import Replay, ReportData
from .style import AFTER, BEFORE, MEASURED, MUTED, Picture, picture, quiet_legend, short
from .words import number, slug

CLOSE_UP = 5.0  # [s]


def replay_picture(data: ReportData, replay: Replay, index: int) -> Picture:
    """How far the replay is from the recording, per joint, and the worst stretch close up."""
    n = len(data.joints)
    columns = min(n, 2)
    lines = -(-n // columns)
    height = 2.9 + 1.35 * lines
    figure = Figure(figsize=(10.6, height))
    grid = figure.add_gridspec(
        lines + 1, columns, left=0.07, right=0.99, top=1 - 0.36 / height, bottom=0.45 / height,
        height_ratios=(1.6, *(1.0,) * lines), hspace=0.62, wspace=0.18,
    )  # fmt: skip
    joint = worst_joint(replay)
    _close_up(figure.add_subplot(grid[0, :]), data, replay, joint)
    for k in range(n):
        axes = figure.add_subplot(grid[1 + k // columns, k % columns])
        _error(axes, data, replay, k)
        if k // columns == lines - 1:
            axes.set_xlabel("time [s]")
    caption = (
        f"{replay.recording}: {replay.how}. Above the stretch of {data.joints[joint]} where it was"
        " furthest off; below simulated minus recorded."
    )
    return picture(figure, f"replay{index + 1}_{slug(replay.recording)}", caption)


def worst_joint(replay: Replay) -> int:
    """The joint whose replay before the findings was furthest off, relative to how far it moves."""
    errors = replay.before - replay.recorded
    scores = [
        rms(errors[:, k]) / (float(np.nanstd(replay.recorded[:, k])) + 1e-3)
        for k in range(errors.shape[1])
    ]
    return int(np.argmax(np.nan_to_num(scores)))


def _close_up(axes: Axes, data: ReportData, replay: Replay, joint: int) -> None:
    part = busiest(replay.time, (replay.before - replay.recorded)[:, joint], CLOSE_UP)
    time = replay.time[part]
    lines: tuple[tuple[FloatArray, str, str, float, float], ...] = (
        (replay.recorded, MEASURED, "recorded", 2.4, 0.35),
        (replay.before, BEFORE, "simulated before", 1.4, 1.0),
        (replay.after, AFTER, "simulated after", 1.4, 1.0),
    )
    for values, color, label, width, alpha in lines:
        axes.plot(
            *envelope(time, values[part, joint]), color=color, lw=width, alpha=alpha, label=label
        )
    unit = data.position_unit(joint)
    title = f"{short(data.joints[joint])}, close up: {short(replay.recording, 30)}"
    axes.set(ylabel=f"position [{unit}]", title=title)
    if len(time):
        axes.set_xlim(float(time[0]), float(time[-1]))
    quiet_legend(axes)


def _error(axes: Axes, data: ReportData, replay: Replay, joint: int) -> None:
    scale, unit = (1e3, "mrad") if data.position_unit(joint) == "rad" else (1e3, "mm")
    before, after = (
        scale * (values - replay.recorded)[:, joint] for values in (replay.before, replay.after)
    )
    axes.axhline(0, color=MUTED, lw=0.8)
    axes.plot(*envelope(replay.time, before, 400), color=BEFORE, lw=0.9)
    axes.plot(*envelope(replay.time, after, 400), color=AFTER, lw=0.9)
    axes.set(ylim=reach(before, after), xlim=(float(replay.time[0]), float(replay.time[-1])))
    gain = f"{number(rms(before))} → {number(rms(after))} {unit} rms"
    axes.set_title(f"{short(data.joints[joint], 20)}: {gain}")
    axes.set_ylabel(f"[{unit}]")
