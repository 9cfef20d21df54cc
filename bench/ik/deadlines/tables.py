"""The tables of bench/ik/deadlines/__main__.py."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.common.markdown import markdown_table

SIDES = {0: "idle", 1: "beside one", 2: "beside two"}

INTRODUCTION = (
    "Times in ms, median / p99.9 / max, of calls that the deadline ended or that lasted longer; of"
    " less than 1,000 calls p99.9 is next to the max. The cloud's intake is not in them. *wall* is"
    " what a caller waits, *CPU* what the thread worked: their difference is other programs'."
    " *late*: evaluations begun after the deadline, at most, where results say so."
)


def all_tables(calls: pd.DataFrame, seed: int) -> str:
    """Every robot's and call's table, then the methods and the kinds of goals at one budget."""
    sections = [f"{INTRODUCTION} Seed {seed}."]
    for (robot, call), some in calls.groupby(["robot", "call"], sort=False):
        if some.load.nunique() > 1:  # beside other programs, too
            sections.append(f"**{robot}, {call}**\n\n{main_table(some)}")
    usual = calls[(calls.load == 0) & (calls.budget == 0.001)]
    sections.append(f"**Methods, 1 ms, idle**\n\n{method_table(usual)}")
    alike = calls[(calls.load == 0) & (calls.case != "random")]
    sections.append(f"**Kinds of goals, idle**\n\n{case_table(alike)}")
    return "\n\n".join(section.rstrip() for section in sections) + "\n"


def main_table(calls: pd.DataFrame) -> str:
    """A row for each budget and cloud, over all kinds of goals."""
    loads = sorted(calls.load.unique())
    header = ["budget", "points", "cloud", "intake", "n", "ended by it"]
    header += [f"{clock}, {SIDES[load]}" for load in loads for clock in ("wall", "CPU")] + ["late"]
    rows = []
    for (budget, points, cloud), some in calls.groupby(["budget", "points", "cloud"]):
        idle = some[some.load == loads[0]]
        row = [ms(budget), f"{points:,}", cloud if points else "", ms(idle.intake.median())]
        row += [str(len(idle)), f"{idle.struck.mean():.2f}"]
        for load in loads:
            struck = some[(some.load == load) & some.struck]
            row += [spread(struck.wall), spread(struck.cpu)]
        rows.append([*row, late(some)])
    return markdown_table(header, rows)


def method_table(calls: pd.DataFrame) -> str:
    """A row for each robot, method and cloud."""
    header = ["robot", "call", "points", "cloud", "n", "ended by it", "wall", "CPU", "late"]
    rows = []
    keys = ["robot", "points", "cloud", "call"]
    for (robot, points, cloud, call), some in calls.groupby(keys):
        struck = some[some.struck]
        row = [robot, call, f"{points:,}", cloud if points else "", str(len(some))]
        row += [f"{some.struck.mean():.2f}", spread(struck.wall), spread(struck.cpu), late(some)]
        rows.append(row)
    return markdown_table(header, rows)


def case_table(calls: pd.DataFrame) -> str:
    """Time beyond the budget by kind of goal: the median and the worst over everything else."""
    header = ["points", "goal", "n", "ended by it", "CPU beyond the budget"]
    rows = []
    for (points, case), some in calls.groupby(["points", "case"]):
        struck = some[some.struck]
        row = [f"{points:,}", case, str(len(some)), f"{some.struck.mean():.2f}"]
        rows.append([*row, spread(struck.cpu - struck.budget)])
    return markdown_table(header, rows)


def spread(times: pd.Series[float]) -> str:
    """Median / p99.9 / max [ms]; empty where there are none."""
    if len(times) == 0:
        return ""
    return " / ".join(ms(value) for value in np.quantile(times, [0.5, 0.999, 1.0]))


def late(calls: pd.DataFrame) -> str:
    """The most evaluations begun after the deadline; ? where results do not say."""
    worst = int(calls.late.max())
    return "?" if worst < 0 else str(worst)


def ms(seconds: float) -> str:
    """Milliseconds with three figures, no finer than a microsecond."""
    value = 1e3 * seconds
    return f"{value:.0f}" if abs(value) >= 99.5 else f"{value:.3f}"[:5].rstrip(".")
