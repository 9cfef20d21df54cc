"""The tables of a soak test."""

import numpy as np
import pandas as pd

from bench.common.intervals import duration, wilson
from bench.common.markdown import markdown_table
from bench.ik.soak import solves, tracking
from bench.ik.soak.scenes import SIZES
from bench.ik.soak.trees import FAMILIES

EXCESS = ("position", "rotation", "clearance", "self", "balance")


def report(solved: pd.DataFrame, tracked: pd.DataFrame, seed: int) -> str:
    """Markdown."""
    parts = [f"Seed {seed}."]
    if len(solved):
        parts += [
            f"**{solved.n.sum():,} solves**: {solved.wrong.sum():,} wrong, "
            f"{faults_of(solved, solves.FAULTS) - solved.wrong.sum():,} other faults.",
            solve_table(solved, "family", FAMILIES),
            solve_table(solved, "cloud", tuple(size[0] for size in SIZES)),
            solve_table(solved.assign(ask=asked_for(solved)), "ask"),
            worst_table(solved, "family"),
            deadline_lines(solved),
        ]
    if len(tracked):
        broken = faults_of(tracked, [f"fault {name}" for name in tracking.FAULTS])
        parts += [
            f"**{tracked.n.sum():,} tracker steps**: {broken:,} faults.",
            step_table(tracked, "speeds"),
            step_table(tracked, "family"),
            fault_table(tracked),
            late_table(tracked),
        ]
    return "\n\n".join(parts) + "\n\n" + LEGEND


LEGEND = """\
*wrong*: claimed, but by the judge goal, clearance, distance from itself, balance or limits do \
not hold. *broken*: `lower <= q <= upper` (exactly), `max_step`, half a turn of a joint without \
limits, or a number that is not finite, of any answer. *misreported*: a figure of the result \
that differs from the judge's by more than 1e-9, or a status that contradicts `success`. *none \
found*: some goals cannot be met. *missed*: of a random sample, those answered only with twenty \
times the budget, another seed or L-BFGS, with Wilson's 95 % interval. *beyond tolerance*: the \
worst of all claims; negative is inside. *passed through*: a step that says `tracking` and on \
whose straight way, looked at every few millimetres, a hull is 5 mm deeper in an obstacle than \
at either end and than allowed. *left of clearance*: above what was wanted less its tolerance, \
while it says `tracking`. Overruns are of the deadline, on the wall's clock and of the thread's \
processor time; *preempted*: late steps during which the thread did not have the processor for \
0.1 ms or more.
"""


def faults_of(table: pd.DataFrame, names: tuple[str, ...] | list[str]) -> int:
    """How many in all."""
    return int(table[list(names)].to_numpy().sum())


def asked_for(table: pd.DataFrame) -> pd.Series:
    """Goal type, or what was asked for beside it."""
    beside = np.select(
        [table.self_collision & table.balance, table.self_collision, table.balance],
        ["self-collision and balance", "self-collision", "balance"],
        "",
    )
    return pd.Series(np.where(beside == "", table.goal, beside), index=table.index)


def solve_table(table: pd.DataFrame, by: str, order: tuple[str, ...] = ()) -> str:
    """The four rates, and what must not be."""
    header = [by, "n", "solved", "wrong", "broken", "misreported", "none found", "missed [95%]"]
    groups = dict(list(table.groupby(by, sort=False)))
    names = [*(each for each in order if each in groups), *sorted(set(groups) - {*order})]
    rows = [[name, *_rates(groups[name])] for name in names] + [["all", *_rates(table)]]
    return markdown_table(header, rows)


def _rates(some: pd.DataFrame) -> list[str]:
    n, sampled, missed = int(some.n.sum()), int(some.sampled.sum()), int(some.missed.sum())
    low, high = wilson(missed, sampled)
    share = f"{missed} of {sampled} [{low:.3f}, {high:.3f}]" if sampled else "0 of 0"
    return [
        f"{n:,}",
        f"{some.solved.sum() / n:.4f}",
        f"{some.wrong.sum():,}",
        f"{faults_of(some, ['limits', 'step', 'turn', 'not finite']):,}",
        f"{faults_of(some, ['misreported', 'status']):,}",
        f"{some.none_found.sum() / n:.4f}",
        share,
    ]


def worst_table(table: pd.DataFrame, by: str) -> str:
    """Of what was claimed, by how much the worst is beyond its tolerance."""
    header = [by, *(f"{name}, beyond tolerance" for name in EXCESS)]
    rows = [
        [name, *(_figure(some[f"excess_{each}"].max()) for each in EXCESS)]
        for name, some in table.groupby(by, sort=False)
    ]
    return markdown_table(header, rows)


def deadline_lines(table: pd.DataFrame) -> str:
    """Of the solves whose deadlines strike."""
    some = table[table.struck]
    if not len(some):
        return "No deadline was short enough to strike."
    alone = some[some.single]
    return (
        f"Deadlines of 0.1 and 1 ms, {some.n.sum():,} solves: late by {_time(some.overrun.max())} "
        f"at worst on the wall's clock, by {_time(alone.overrun_cpu.max())} of processor time "
        f"(the call from Python and the cloud's intake included, where the core does not tell it), "
        f"{_late(some)} evaluations after the strike."
    )


def step_table(table: pd.DataFrame, by: str) -> str:
    """What became of the steps, and the worst of what must hold."""
    header = [by, "steps", *tracking.STATUSES, "faults", "left of clearance [m]"]
    header += ["step over its bound", "long steps, looked at", "depth on the way [m]"]
    header += ["where it does not say tracking [m]"]
    rows = []
    for name, some in table.groupby(by, sort=False):
        n = int(some.n.sum())
        rows.append(
            [
                name,
                f"{n:,}",
                *(f"{some[status].sum() / n:.4f}" for status in tracking.STATUSES),
                faults_of(some, [f"fault {fault}" for fault in tracking.FAULTS]),
                _figure(some.least_clearance_left.min()),
                _figure(some.step_over.max()),
                f"{some.long.sum():,}, {some.looked_at.sum():,}",
                _figure(some.path_depth.max()),
                _figure(some.path_depth_else.max()),
            ]
        )
    return markdown_table(header, rows)


def fault_table(table: pd.DataFrame) -> str:
    """What is wrong with how many steps."""
    header = ["speeds", *tracking.FAULTS]
    rows = [
        [name, *(int(some[f"fault {fault}"].sum()) for fault in tracking.FAULTS)]
        for name, some in table.groupby("speeds", sort=False)
    ]
    return markdown_table(header, rows)


def late_table(table: pd.DataFrame) -> str:
    """Steps that missed their deadline, and by how much."""
    header = ["speeds", "late", "of these preempted", "worst overrun, wall", "processor time"]
    header += ["evaluations after the strike"]
    rows = [
        [
            name,
            int(some.late.sum()),
            int(some.preempted.sum()),
            _time(some.overrun.max()),
            _time(some.overrun_cpu.max()),
            _late(some),
        ]
        for name, some in table.groupby("speeds", sort=False)
    ]
    return markdown_table(header, rows)


def _late(some: pd.DataFrame) -> str:
    """Evaluations begun after a deadline, the most of one call, where the core counts them."""
    most = int(some.late_evaluations.max())
    return "not told how many" if most == solves.UNTOLD else str(most)


def _figure(value: float) -> str:
    return f"{value:.2g}" if np.isfinite(value) else "none"


def _time(seconds: float) -> str:
    return duration(seconds) if seconds > 0.0 else "0 us"
