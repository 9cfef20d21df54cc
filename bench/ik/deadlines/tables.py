"""The tables of bench/ik/deadlines/__main__.py."""

from collections.abc import Callable

import numpy as np
import pandas as pd

from bench.common.grouped import grouped_table

SIDES = {0: "idle", 1: "beside one", 2: "beside two"}
KEYS = {"count": "points", "cloud": "cloud"}
FIGURES = {"n": len, "ended by it": lambda some: f"{some.struck.mean():.2f}"}

INTRODUCTION = (
    "Times in ms, median / p99.9 / max, of calls that the deadline ended or that lasted longer; of"
    " less than 1,000 calls p99.9 is next to the max. The cloud's intake is not in them. *wall* is"
    " what a caller waits, *CPU* what the thread worked: their difference is other programs'."
    " *late*: evaluations begun after the deadline, at most, where results say so."
)


def all_tables(calls: pd.DataFrame, seed: int) -> str:
    """Every robot's and call's table, then the methods and the kinds of goals at one budget."""
    calls = calls.assign(
        count=lambda rows: [f"{points:,}" for points in rows.points],
        cloud=lambda rows: rows.cloud.where(rows.points > 0, ""),
        over=lambda rows: rows.cpu - rows.budget,
    )
    sections = [f"{INTRODUCTION} Seed {seed}."]
    for (robot, call), some in calls.groupby(["robot", "call"], sort=False):
        if some.load.nunique() > 1:  # with other programs running, too
            sections.append(f"**{robot}, {call}**\n\n{main_table(some)}")
    idle = calls[calls.load == 0]
    usual = idle[idle.budget == 0.001].sort_values(["robot", "points", "cloud", "call"])
    methods = {
        **FIGURES,
        "wall": lambda some: spread(some, "wall"),
        "CPU": lambda some: spread(some, "cpu"),
        "late": late,
    }
    table = grouped_table(usual, {"robot": "robot", "call": "call", **KEYS}, methods)
    sections.append(f"**Methods, 1 ms, idle**\n\n{table}")
    alike = idle[idle.case != "random"].sort_values(["points", "case"], kind="stable")
    goals = {**FIGURES, "CPU beyond the budget": lambda some: spread(some, "over")}
    table = grouped_table(alike, {"count": "points", "case": "goal"}, goals)
    sections.append(f"**Kinds of goals, idle**\n\n{table}")
    return "\n\n".join(section.rstrip() for section in sections) + "\n"


def main_table(calls: pd.DataFrame) -> str:
    """A row for each budget and cloud, over all kinds of goals."""
    loads = sorted(calls.load.unique())

    def at_load(load: int, figure: Callable[..., object], *more: str) -> Callable[..., object]:
        return lambda some: figure(some[some.load == load], *more)

    columns = {"intake": at_load(loads[0], lambda some: ms(some.intake.median()))}
    columns |= {name: at_load(loads[0], figure) for name, figure in FIGURES.items()}
    for load in loads:
        columns[f"wall, {SIDES[load]}"] = at_load(load, spread, "wall")
        columns[f"CPU, {SIDES[load]}"] = at_load(load, spread, "cpu")
    calls = calls.sort_values(["budget", "points", "cloud"], kind="stable")
    calls = calls.assign(allowed=[ms(budget) for budget in calls.budget])
    return grouped_table(calls, {"allowed": "budget", **KEYS}, {**columns, "late": late})


def spread(calls: pd.DataFrame, column: str) -> str:
    """Median / p99.9 / max [ms] of those that were struck; empty where there are none."""
    times = calls[column][calls.struck]
    return " / ".join(map(ms, np.quantile(times, [0.5, 0.999, 1.0]))) if len(times) else ""


def late(calls: pd.DataFrame) -> int:
    """The most evaluations begun after the deadline."""
    return int(calls.late.max())


def ms(seconds: float) -> str:
    """Milliseconds with three figures, no finer than a microsecond."""
    value = 1e3 * seconds
    return f"{value:.0f}" if abs(value) >= 99.5 else f"{value:.3f}"[:5].rstrip(".")
