"""What a campaign came to, as Markdown."""

from __future__ import annotations

import pandas as pd

from bench.common.markdown import markdown_table
from bench.sim2real.legged.spec import HEALTHY

KEYS = {
    "named": "named",
    "and sized": "sized",
    "or listed": "listed",
    "or suspected": "suspected",
}
RATE = "false findings in a world"
SORT = ["robot", "background"]


def tables(rows: pd.DataFrame) -> str:
    """By sort of world, of healthy worlds, and by kind."""
    made = rows[rows.not_made == ""].infer_objects()
    hidden = made[made.kind != HEALTHY]
    took, crashed = made.seconds, int(made.crash.sum())
    parts = [
        _by_sort(hidden),
        _healthy(made[made.kind == HEALTHY]),
        _by_kind(hidden),
        f"A diagnosis takes {took.median():.0f} s, at most {took.max():.0f} s;"
        f" {crashed} of {len(made)} studies were not diagnosed.",
    ]
    fallen = rows[rows.not_made != ""]
    if len(fallen):
        parts.append(f"Not made, for the robot always fell: {', '.join(fallen.name)}.")
    return "\n\n".join(part.rstrip() for part in parts) + "\n"


def _by_sort(hidden: pd.DataFrame) -> str:
    lines = [(*sort, len(group), *_counts(group)) for sort, group in hidden.groupby(SORT)]
    return markdown_table(
        (*SORT, "worlds", *KEYS, RATE), [*lines, ("all", "", len(hidden), *_counts(hidden))]
    )


def _healthy(healthy: pd.DataFrame) -> str:
    lines = [
        (*sort, len(group), int(group.alarm.astype(bool).sum()), int(group["false"].sum()))
        for sort, group in healthy.groupby(SORT)
    ]
    return markdown_table((*SORT, "healthy worlds", "with a false alarm", "false findings"), lines)


def _by_kind(hidden: pd.DataFrame) -> str:
    lines = [(kind, len(group), *_counts(group)) for kind, group in hidden.groupby("kind")]
    return markdown_table(("kind", "worlds", *KEYS, RATE), lines)


def _counts(group: pd.DataFrame) -> tuple[str, ...]:
    """Of the columns of KEYS, and the rate of false findings."""
    rate = f"{group['false'].mean():.2f}" if len(group) else "-"
    return (*(str(int(group[key].sum())) for key in KEYS.values()), rate)
