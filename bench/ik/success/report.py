"""Tables and the figure of the paper's first experiment, from its trials."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd

from bench.common.intervals import duration, share, wilson
from bench.common.markdown import markdown_table
from bench.common.whole_files import write_whole

mpl.use("agg")
import matplotlib.pyplot as plt

# Sec. exp1, by number of obstacles from 1 to 9.
PAPER_POINTS = (24, 47, 68, 87, 101, 110, 122, 130, 136)
RATES = {
    "success": "success",
    "fails_limits": "P_joint",
    "fails_collision": "P_col",
    "fails_pose": "P_ee",
}


def summary_table(trials: pd.DataFrame) -> str:
    """One row per arm and method, over all numbers of obstacles that it took part in.

    P_self is the share of answers whose links meet, "off itself" of successes whose do not.
    """
    header = ["arm", "method", "n", "success [95%]", "P_joint", "P_col", "P_ee", "P_self"]
    header += [
        "off itself",
        "median",
        "p95",
        "mean log10 T",
        "evaluations",
        "claims not confirmed",
        "language",
    ]
    rows = []
    for (robot, method), some in _grouped(trials, ["robot", "method"]):
        claims = some[some.claimed]
        rows.append(
            [
                robot,
                method,
                len(some),
                share(some.success),
                *(f"{some[rate].mean():.3f}" for rate in (*list(RATES)[1:], "meets_itself")),
                f"{(some.success & ~some.meets_itself).mean():.3f}",
                duration(some.time.median()),
                duration(some.time.quantile(0.95)),
                f"{np.log10(some.time).mean():.2f}",
                f"{some.evaluations.mean():.0f}",
                f"{(~claims.success).sum()} of {len(claims)}",
                some.language.iloc[0],
            ]
        )
    return markdown_table(header, rows)


def success_table(trials: pd.DataFrame) -> str:
    """Success by number of obstacles: one row per arm and method."""
    counts = sorted(trials.n_objects.unique())
    header = ["arm", "method", *(str(count) for count in counts)]
    rows = []
    for (robot, method), some in _grouped(trials, ["robot", "method"]):
        by_count = some.groupby("n_objects").success.mean()
        rows.append([robot, method, *(f"{by_count.get(n, np.nan):.3f}" for n in counts)])
    return markdown_table(header, rows)


def full_table(trials: pd.DataFrame) -> str:
    """Everything by arm, number of obstacles and method."""
    header = ["arm", "obstacles", "method", "n", "success [95%]", "P_joint", "P_col", "P_ee"]
    header += ["median", "p95", "mean log10 T"]
    rows = []
    for (robot, count, method), some in _grouped(trials, ["robot", "n_objects", "method"]):
        rates = (f"{some[rate].mean():.3f}" for rate in list(RATES)[1:])
        times = (duration(some.time.median()), duration(some.time.quantile(0.95)))
        logarithm = f"{np.log10(some.time).mean():.2f}"
        rows.append(
            [robot, count, method, len(some), share(some.success), *rates, *times, logarithm]
        )
    return markdown_table(header, rows)


def points_table(trials: pd.DataFrame) -> str:
    """Mean number of points in the cloud, ours and the paper's."""
    scenes = trials.drop_duplicates(["robot", "n_objects", "index"])
    means = scenes.groupby("n_objects").n_points.mean()
    header = ["obstacles", *(str(count) for count in means.index)]
    paper = [str(PAPER_POINTS[count - 1]) for count in means.index]
    return markdown_table(
        header, [["points here", *(f"{mean:.0f}" for mean in means)], ["the paper's", *paper]]
    )


def speed_ratios(trials: pd.DataFrame, faster: str, slower: Sequence[str]) -> str:
    """How many times longer others take, paired by scenario: median and the middle half."""
    key = ["robot", "n_objects", "index"]
    times = trials.set_index([*key, "method"]).time.unstack("method")
    header = ["arm", *(f"{method} / {faster}" for method in slower)]
    rows = []
    for robot, some in times.groupby("robot"):
        cells = []
        for method in slower:
            ratio = (some[method] / some[faster]).dropna()
            q25, q50, q75 = ratio.quantile([0.25, 0.5, 0.75])
            cells.append(f"{q50:.0f} ({q25:.0f} to {q75:.0f}, n = {len(ratio)})")
        rows.append([robot, *cells])
    return markdown_table(header, rows)


def draw(trials: pd.DataFrame, path: Path, title: str) -> None:
    """The paper's figure: five rows of panels, one column per arm, 95% intervals shaded."""
    robots = list(dict.fromkeys(trials.robot))
    methods = list(dict.fromkeys(trials.method))
    panels = ["success", "time", "fails_limits", "fails_collision", "fails_pose"]
    labels = ["$P_{scs}$", "$\\log_{10} T$ [s]", "$P_{joint}$", "$P_{col}$", "$P_{ee}$"]
    colours = dict(zip(methods, plt.get_cmap("tab10").colors, strict=False))
    figure, axes = plt.subplots(
        len(panels), len(robots), figsize=(4 * len(robots), 11), sharex=True, squeeze=False
    )
    for column, robot in enumerate(robots):
        axes[0][column].set_title(robot)
        axes[-1][column].set_xlabel("obstacles")
        for row, (panel, label) in enumerate(zip(panels, labels, strict=True)):
            ax = axes[row][column]
            for method in methods:
                some = trials[(trials.robot == robot) & (trials.method == method)]
                x, middle, low, high = _curve(some, panel)
                ax.plot(x, middle, marker=".", color=colours[method], label=method)
                ax.fill_between(x, low, high, color=colours[method], alpha=0.12, linewidth=0)
            ax.set_ylabel(label if column == 0 else "")
            if panel != "time":
                ax.set_ylim(-0.03, 1.03)
            ax.grid(alpha=0.3)
    handles, names = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, names, loc="upper center", ncol=4, bbox_to_anchor=(0.5, 0.985))
    figure.suptitle(title, y=0.997, fontsize=10)
    figure.tight_layout(rect=(0, 0, 1, 0.95))
    write_whole(path, lambda file: figure.savefig(file, dpi=110))
    plt.close(figure)


def _curve(some: pd.DataFrame, panel: str) -> tuple[list[int], list[float], ...]:  # type: ignore[misc]
    x, middle, low, high = [], [], [], []
    for count, trials in some.groupby("n_objects"):
        x.append(int(count))
        if panel == "time":
            values = np.log10(trials.time)
            error = 1.96 * values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else 0.0
            middle.append(float(values.mean()))
            low.append(float(values.mean() - error))
            high.append(float(values.mean() + error))
        else:
            ends = wilson(int(trials[panel].sum()), len(trials))
            middle.append(float(trials[panel].mean()))
            low.append(ends[0])
            high.append(ends[1])
    return x, middle, low, high


def _grouped(trials: pd.DataFrame, keys: list[str]) -> Iterable[tuple[tuple, pd.DataFrame]]:
    """Groups in the order in which their keys first appear."""
    return trials.groupby(keys, sort=False)  # type: ignore[return-value]
