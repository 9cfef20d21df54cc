"""Tables and the figure of the paper's first experiment, from its trials."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bench.common.grouped import grouped_table, mean, time_at
from bench.common.intervals import share, wilson
from bench.common.markdown import markdown_table
from bench.ik.pictures import plt, save, title_and_legend

# Sec. exp1, by number of obstacles from 1 to 9.
PAPER_POINTS = (24, 47, 68, 87, 101, 110, 122, 130, 136)
BY_METHOD = {"robot": "arm", "method": "method"}
FAILURES = {"fails_limits": "P_joint", "fails_collision": "P_col", "fails_pose": "P_ee"}
SUCCESS = {"n": len, "success [95%]": lambda some: share(some.success)}
RATES = {name: mean(rate) for rate, name in FAILURES.items()}
TIMES = {
    "median": time_at(0.5),
    "p95": time_at(0.95),
    "mean log10 T": lambda some: f"{np.log10(some.time).mean():.2f}",
}


def summary_table(trials: pd.DataFrame) -> str:
    """One row per arm and method, over all numbers of obstacles that it took part in.

    P_self is the share of answers whose links meet, "off itself" of successes whose do not.
    """
    return grouped_table(
        trials,
        BY_METHOD,
        {
            **SUCCESS,
            **RATES,
            "P_self": mean("meets_itself"),
            "off itself": lambda some: f"{(some.success & ~some.meets_itself).mean():.3f}",
            **TIMES,
            "evaluations": mean("evaluations", 0),
            "claims not confirmed": lambda some: (
                f"{(some.claimed & ~some.success).sum()} of {some.claimed.sum()}"
            ),
            "language": lambda some: some.language.iloc[0],
        },
    )


def success_table(trials: pd.DataFrame) -> str:
    """Success by number of obstacles: one row per arm and method."""
    counts = {
        str(n): lambda some, n=n: f"{some.success[some.n_objects == n].mean():.3f}"
        for n in sorted(trials.n_objects.unique())
    }
    return grouped_table(trials, BY_METHOD, counts)


def full_table(trials: pd.DataFrame) -> str:
    """Everything by arm, number of obstacles and method."""
    keys = {"robot": "arm", "n_objects": "obstacles", "method": "method"}
    return grouped_table(trials, keys, {**SUCCESS, **RATES, **TIMES})


def points_table(trials: pd.DataFrame) -> str:
    """Mean number of points in the cloud, ours and the paper's."""
    scenes = trials.drop_duplicates(["robot", "n_objects", "index"])
    means = scenes.groupby("n_objects").n_points.mean()
    ours = ["points here", *(f"{mean:.0f}" for mean in means)]
    paper = ["the paper's", *(PAPER_POINTS[count - 1] for count in means.index)]
    return markdown_table(["obstacles", *means.index], [ours, paper])


def speed_ratios(trials: pd.DataFrame, faster: str, slower: Sequence[str]) -> str:
    """How many times longer others take, paired by scenario: median and the middle half."""
    key = ["robot", "n_objects", "index"]
    times = trials.set_index([*key, "method"]).time.unstack("method")
    rows = []
    for robot, some in times.groupby("robot"):
        cells = []
        for method in slower:
            ratio = (some[method] / some[faster]).dropna()
            q25, q50, q75 = ratio.quantile([0.25, 0.5, 0.75])
            cells.append(f"{q50:.0f} ({q25:.0f} to {q75:.0f}, n = {len(ratio)})")
        rows.append([robot, *cells])
    return markdown_table(["arm", *(f"{method} / {faster}" for method in slower)], rows)


def draw(trials: pd.DataFrame, path: Path, title: str) -> None:
    """The paper's figure: five rows of panels, one column per arm, 95% intervals shaded."""
    robots, methods = trials.robot.unique(), trials.method.unique()
    panels = {
        "success": "$P_{scs}$",
        "time": "$\\log_{10} T$ [s]",
        "fails_limits": "$P_{joint}$",
        "fails_collision": "$P_{col}$",
        "fails_pose": "$P_{ee}$",
    }
    figure, axes = plt.subplots(
        len(panels), len(robots), figsize=(4 * len(robots), 11), sharex=True, squeeze=False
    )
    for column, robot in enumerate(robots):
        axes[0][column].set_title(robot)
        axes[-1][column].set_xlabel("obstacles")
        for ax, (panel, label) in zip(axes[:, column], panels.items(), strict=True):
            for method, colour in zip(methods, plt.get_cmap("tab10").colors, strict=False):
                some = trials[(trials.robot == robot) & (trials.method == method)]
                curve = np.array([(n, *_middle(g, panel)) for n, g in some.groupby("n_objects")])
                x, middle, low, high = curve.T
                ax.plot(x, middle, marker=".", color=colour, label=method)
                ax.fill_between(x, low, high, color=colour, alpha=0.12, linewidth=0)
            ax.set_ylabel(label if column == 0 else "")
            if panel != "time":
                ax.set_ylim(-0.03, 1.03)
            ax.grid(alpha=0.3)
    title_and_legend(figure, axes[0][0], title, below=0.95, legend=0.985)
    save(figure, path)


def _middle(trials: pd.DataFrame, panel: str) -> tuple[float, float, float]:
    """The mean with the ends of its interval."""
    if panel != "time":
        return trials[panel].mean(), *wilson(int(trials[panel].sum()), len(trials))
    values = np.log10(trials.time)
    error = 1.96 * values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else 0.0
    return values.mean(), values.mean() - error, values.mean() + error
