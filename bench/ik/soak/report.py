"""The tables of a soak test."""

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from bench.common.grouped import grouped_table
from bench.common.intervals import duration, wilson
from bench.ik.soak import solves, tracking
from bench.ik.soak.scenes import SIZES
from bench.ik.soak.trees import FAMILIES

EXCESS = ("position", "rotation", "clearance", "self", "balance")
STEP_FAULTS = {name: f"fault {name}" for name in tracking.FAULTS}
Cell = Callable[[pd.DataFrame], object]


def report(solved: pd.DataFrame, tracked: pd.DataFrame, seed: int) -> str:
    """Markdown."""
    parts = [f"Seed {seed}."]
    if len(solved):
        own = solved.self_collision.map({True: "self-collision", False: ""})
        both = own + np.where((own != "") & solved.balance, " and ", "")
        asked = both + solved.balance.map({True: "balance", False: ""})
        solved = solved.assign(ask=asked.where(asked != "", solved.goal))
        parts += [
            f"**{solved.n.sum():,} solves**: {solved.wrong.sum():,} wrong, "
            f"{faults_of(solved, solves.FAULTS) - solved.wrong.sum():,} other faults.",
            solve_table(solved, "family", FAMILIES),
            solve_table(solved, "cloud", [size[0] for size in SIZES]),
            solve_table(solved, "ask", sorted(set(solved.ask))),
            worst_table(solved),
            deadline_lines(solved),
        ]
    if len(tracked):
        parts += [
            f"**{tracked.n.sum():,} tracker steps**: "
            f"{faults_of(tracked, [*STEP_FAULTS.values()]):,} faults.",
            step_table(tracked, "speeds"),
            step_table(tracked, "family"),
            by_speeds(tracked, {name: total(column) for name, column in STEP_FAULTS.items()}),
            by_speeds(
                tracked,
                {
                    "late": total("late"),
                    "of these preempted": total("preempted"),
                    "worst overrun, wall": lambda some: _time(some.overrun.max()),
                    "processor time": lambda some: _time(some.overrun_cpu.max()),
                    "evaluations after the strike": lambda some: some.late_evaluations.max(),
                },
            ),
        ]
    return "\n\n".join(parts) + "\n\n" + LEGEND


LEGEND = """\
*wrong*: claimed, but by the judge goal, clearance, distance from itself, balance or limits do \
not hold. *broken*: `lower <= q <= upper` (exactly), `max_step`, half a turn of a joint without \
limits, or a number that is not finite, of any answer. *misreported*: a figure of the result \
that differs from the judge's by more than 1e-9, or a status that contradicts `success`. *none \
found*: some goals cannot be met. *missed*: of a random sample, those answered only with twenty \
times the budget, another seed or L-BFGS, with Wilson's 95 % interval. *beyond tolerance*: the \
worst of all claims; negative is inside. *deeper*: a step, whatever it says, that is deeper in \
anything than standing still would be, and than contact. *passed through*: a step that says \
`tracking` and on whose straight way, looked at every few millimetres, a hull is 5 mm deeper in \
an obstacle than at either end and than allowed. *left of clearance*: above what was wanted less \
its tolerance, while it says `tracking`. Overruns are of the deadline, on the wall's clock and \
of the thread's processor time; *preempted*: late steps during which the thread did not have the \
processor for 0.1 ms or more.
"""


def faults_of(table: pd.DataFrame, names: Sequence[str]) -> int:
    """How many in all."""
    return int(table[list(names)].to_numpy().sum())


def total(*columns: str) -> Cell:
    """A count."""
    return lambda some: f"{faults_of(some, columns)}"


def thousands(*columns: str) -> Cell:
    """A count that may be large."""
    return lambda some: f"{faults_of(some, columns):,}"


def of_all(column: str) -> Cell:
    """A share of the answers."""
    return lambda some: f"{some[column].sum() / some.n.sum():.4f}"


def solve_table(table: pd.DataFrame, by: str, order: Sequence[str]) -> str:
    """The four rates, and what must not be."""

    def missed(some: pd.DataFrame) -> str:
        sampled, missed = int(some.sampled.sum()), int(some.missed.sum())
        low, high = wilson(missed, sampled)
        return f"{missed} of {sampled} [{low:.3f}, {high:.3f}]" if sampled else "0 of 0"

    twice = pd.concat([table, table.assign(**{by: "all"})])
    return grouped_table(
        twice,
        {by: by},
        {
            "n": thousands("n"),
            "solved": of_all("solved"),
            "wrong": thousands("wrong"),
            "broken": thousands("limits", "step", "turn", "not finite"),
            "misreported": thousands("misreported", "status"),
            "none found": of_all("none_found"),
            "missed [95%]": missed,
        },
        order={by: [*order, "all"]},
    )


def worst_table(table: pd.DataFrame) -> str:
    """Table of the largest excess over tolerances among what was claimed."""
    columns = {
        f"{name}, beyond tolerance": lambda some, name=name: _figure(some[f"excess_{name}"].max())
        for name in EXCESS
    }
    return grouped_table(table, {"family": "family"}, columns)


def deadline_lines(table: pd.DataFrame) -> str:
    """Lines of the solves whose deadlines strike."""
    some = table[table.struck]
    if not len(some):
        return "No deadline was short enough to strike."
    alone = some[some.single]
    return (
        f"Deadlines of 0.1 and 1 ms, {some.n.sum():,} solves: late by {_time(some.overrun.max())} "
        f"at worst on the wall's clock, by {_time(alone.overrun_cpu.max())} of processor time "
        f"(the call from Python and the cloud's intake included, where the core does not tell it), "
        f"{some.late_evaluations.max()} evaluations after the strike."
    )


def step_table(table: pd.DataFrame, by: str) -> str:
    """What became of the steps, and the worst of what must hold."""
    return grouped_table(
        table,
        {by: by},
        {
            "steps": thousands("n"),
            **{status: of_all(status) for status in tracking.STATUSES},
            "faults": total(*STEP_FAULTS.values()),
            "left of clearance [m]": lambda some: _figure(some.least_clearance_left.min()),
            "step over its bound": lambda some: _figure(some.step_over.max()),
            "long steps, looked at": lambda some: f"{some.long.sum():,}, {some.looked_at.sum():,}",
            "depth on the way [m]": lambda some: _figure(some.path_depth.max()),
            "where it does not say tracking [m]": lambda some: _figure(some.path_depth_else.max()),
        },
    )


def by_speeds(table: pd.DataFrame, columns: dict[str, Cell]) -> str:
    """Some columns for each kind of speed limits."""
    return grouped_table(table, {"speeds": "speeds"}, columns)


def _figure(value: float) -> str:
    return f"{value:.2g}" if np.isfinite(value) else "none"


def _time(seconds: float) -> str:
    return duration(seconds) if seconds > 0.0 else "0 us"
