"""The picture: tip errors before and after, by effect, and over time for some."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from bench.common.whole_files import write_whole
from bench.sim2real.loop.report import per_world

COLORS = {"pd": "0.6", "given": "tab:red", "diagnosed": "tab:blue", "floor": "black"}
WORDS = {
    "pd": "PD and gravity compensation alone",
    "given": "given model fed forward",
    "diagnosed": "diagnosed model fed forward",
    "floor": "nothing concealed, true model",
}
SHOWN = ("coulomb_friction", "command_delay", "kinematic_error", "several_at_once")
STEP = 0.02  # of the stored errors [s]


def write_picture(rows: pd.DataFrame, path: Path) -> None:
    """Left all effects, right the error over time of a path in the first world of some."""
    effects = list(dict.fromkeys(rows.effect))
    shown = [name for name in SHOWN if name in effects] or effects[:4]
    height = max(4.2, 0.42 * len(effects) + 1.6)
    figure = plt.figure(figsize=(12.5, height), layout="constrained")
    grid = figure.add_gridspec(len(shown), 2, width_ratios=[1.15, 1.0])
    left = figure.add_subplot(grid[:, 0])
    _by_effect(left, per_world(rows), effects)
    figure.legend(loc="outside upper center", ncols=4, fontsize=9, frameon=False)
    axes: list[Axes] = []
    for k, effect in enumerate(shown):
        axes.append(figure.add_subplot(grid[k, 1], sharex=axes[0] if axes else None))
        _over_time(axes[-1], rows[rows.effect == effect], effect)
        axes[-1].tick_params(labelbottom=k == len(shown) - 1)
    axes[-1].set_xlabel("time since the arm set out on a path the diagnosis never saw [s]")
    write_whole(path, lambda temporary: figure.savefig(temporary, dpi=110, format="png"))
    plt.close(figure)


def _by_effect(axes: Axes, worlds: pd.DataFrame, effects: list[str]) -> None:
    """A dot per world, a bar at the median."""
    for row, effect in enumerate(effects):
        some = worlds[worlds.effect == effect]
        for shift, (way, color) in zip((-0.24, -0.08, 0.08, 0.24), COLORS.items(), strict=True):
            values = some[f"rms_{way}"].to_numpy()
            label = WORDS[way] if row == 0 else None
            at = np.full(len(values), row + shift)
            axes.plot(values, at, "o", color=color, ms=4, alpha=0.75, label=label)
            axes.plot(
                2 * [np.median(values)], [row + shift - 0.09, row + shift + 0.09], color=color
            )
    axes.set_xscale("log")
    axes.set_yticks(range(len(effects)), [name.replace("_", " ") for name in effects])
    axes.set_ylim(len(effects) - 0.5, -0.5)
    axes.grid(axis="x", which="major", color="0.88")
    axes.set_axisbelow(True)
    axes.set_xlabel("tip error, root mean square over new paths [mm]; a dot is a machine")


def _over_time(axes: Axes, rows: pd.DataFrame, effect: str) -> None:
    """All ways along one path."""
    seed = rows.seed.iloc[0]
    for run in rows[(rows.seed == seed) & (rows.path == 0)].itertuples():
        error = 1e3 * np.asarray(run.error)
        axes.plot(STEP * np.arange(len(error)), error, color=COLORS[run.way], lw=1.0)
    axes.set_yscale("log")
    axes.set_ylim(1e-3, 60.0)
    axes.set_ylabel("[mm]")
    axes.set_title(f"tip error: {effect.replace('_', ' ')}", fontsize=9, loc="left")
    axes.grid(axis="y", color="0.9")
