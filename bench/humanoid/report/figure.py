"""A figure after the paper's Fig. exp-h1: key frames, solver speed, CoM, distance."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from bench.common.whole_files import write_whole
from bench.humanoid.dodge.follow import Steps
from bench.humanoid.report.pictures import Picture, strip
from bench.humanoid.trials.predict import Trial
from bench.humanoid.world.simulate import DISTANCE_CUTOFF, Run
from bench.humanoid.world.standing import COM_LOWER, COM_UPPER

PAPER_RATES = (10.0, 1500.0)  # of its Fig. exp-h1b [Hz]
_BLUE, _RED, _GREY = "#2f6fb5", "#c0392b", "#555555"


def write_figure(trial: Trial, path: Path, title: str, more: Mapping[str, Picture]) -> None:
    """Write the figure; the suffix (.png, .pdf, .svg) says how.

    Args:
        trial: What is drawn.
        path: Of the file; it appears whole or not at all.
        title: Over the key frames.
        more: Key frames of other runs, by title.
    """
    run = trial.run
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        rows = [1.0, 1.0, *([0.8] if more else [])]
        figure = Figure(figsize=(11, 3.15 * sum(rows)), dpi=110, layout="constrained")
        panels: Any = figure.subfigures(len(rows), 1, height_ratios=rows)
        _draw_frames(panels[0], strip(trial.world, run), f"(a) {title}")
        left, middle, right = panels[1].subfigures(1, 3, width_ratios=[1.0, 1.1, 1.0])
        _draw_speed(left.subplots(), trial.steps, run)
        _draw_com(middle.subplots(3, 1, sharex=True), run)
        _draw_distance(right.subplots(), run)
        if more:
            parts = np.atleast_1d(panels[2].subfigures(1, len(more)))
            for part, letter, (name, frames) in zip(parts, "efgh", more.items(), strict=False):
                _draw_frames(part, frames, f"({letter}) {name}")
        write_whole(path, figure.savefig)


def _draw_frames(panel: Any, picture: Picture, title: str) -> None:
    axes = panel.subplots()
    axes.imshow(picture)
    axes.set_axis_off()
    axes.set_title(title, loc="left")


def _draw_speed(axes: Any, speed: Steps, run: Run) -> None:
    axes.set_xlabel("time [s]")
    axes.set_ylabel("solves per second [Hz]")
    axes.set_xlim(0, run.time[-1])
    axes.axhspan(*PAPER_RATES, color=_GREY, alpha=0.12, lw=0)
    axes.text(
        0.02, np.sqrt(np.prod(PAPER_RATES)), " paper: 10 to 1500 Hz", color=_GREY, va="center"
    )
    rate = speed.rate
    axes.semilogy(speed.time, rate, "-", color=_BLUE, lw=0.6)
    axes.set_ylim(PAPER_RATES[0] / 2, 2 * rate.max())
    axes.grid(which="major", axis="y", alpha=0.3)
    median = float(np.median(rate))
    axes.set_title(f"(b) solver speed, median {1e-3 * median:.1f} kHz", loc="left")


def _draw_com(panels: Any, run: Run) -> None:
    panels[0].set_title("(c) CoM and its box (Eq. com)", loc="left")
    for k, (axes, name) in enumerate(zip(panels, "xyz", strict=True)):
        low, high = COM_LOWER[k], COM_UPPER[k]
        axes.axhspan(low, high, color=_BLUE, alpha=0.10, lw=0)
        for bound in (low, high):
            axes.axhline(bound, color=_BLUE, lw=0.8)
        axes.plot(run.time, run.com[:, k], color=_RED, lw=1.2)
        margin = 0.15 * (high - low)
        values = run.com[:, k]
        axes.set_ylim(min(low, values.min()) - margin, max(high, values.max()) + margin)
        axes.set_ylabel(f"{name} [m]")
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(0, run.time[-1])


def _draw_distance(axes: Any, run: Run) -> None:
    axes.set_title("(d) least distance, object to robot", loc="left")
    seen = run.distance < DISTANCE_CUTOFF
    axes.plot(run.distance_time[seen], run.distance[seen], color=_RED, lw=1.2)
    axes.axhline(0, color=_GREY, lw=0.8)
    axes.set_xlim(0, run.time[-1])
    axes.set_xlabel("time [s]")
    axes.set_ylabel("distance [m]")
    if seen.any():
        k = int(np.argmin(run.distance))
        least = run.distance[k]
        axes.plot(run.distance_time[k], least, "o", color=_RED, ms=4)
        word = "touched" if run.contact else f"least {1e3 * least:.0f} mm"
        axes.annotate(
            word, (run.distance_time[k], least), xytext=(12, 14), textcoords="offset points",
            ha="left", color=_RED, bbox={"fc": "white", "ec": "none", "pad": 1},
        )  # fmt: skip
