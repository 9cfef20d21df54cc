"""What a campaign came to, as Markdown."""

from __future__ import annotations

import pandas as pd
from bench.legged.spec import HEALTHY

from markdown import markdown_table

COLUMNS = ("named", "and sized", "or listed", "or suspected")
KEYS = ("named", "sized", "listed", "suspected")


def tables(rows: pd.DataFrame) -> str:
    """By sort of world, and by kind."""
    failed, rows = rows[rows.not_made != ""], rows[rows.not_made == ""].infer_objects()
    hidden, healthy = rows[rows.kind != HEALTHY], rows[rows.kind == HEALTHY]
    text = []
    by_sort = [
        (robot, background, len(group), *_shares(group), _rate(group))
        for (robot, background), group in hidden.groupby(["robot", "background"])
    ]
    head = ("robot", "background", "worlds", *COLUMNS, "false findings in a world")
    text.append(
        markdown_table(head, [*by_sort, ("all", "", len(hidden), *_shares(hidden), _rate(hidden))])
    )
    alarms = [
        (
            robot,
            background,
            len(group),
            int(group.alarm.astype(bool).sum()),
            int(group["false"].sum()),
        )
        for (robot, background), group in healthy.groupby(["robot", "background"])
    ]
    head = ("robot", "background", "healthy worlds", "with a false alarm", "false findings")
    text.append(markdown_table(head, alarms))
    kinds = [
        (kind, len(group), *_shares(group), _rate(group)) for kind, group in hidden.groupby("kind")
    ]
    text.append(markdown_table(("kind", "worlds", *COLUMNS, "false findings in a world"), kinds))
    took = rows.seconds
    text.append(f"A diagnosis takes {took.median():.0f} s, at most {took.max():.0f} s;")
    text.append(f"{int(rows.crash.sum())} of {len(rows)} studies were not diagnosed.")
    text[-2:] = [" ".join(text[-2:])]
    if len(failed):
        text.append(f"Not made, as the robot fell whatever was drawn: {', '.join(failed.name)}.")
    return "\n\n".join(part.rstrip() for part in text) + "\n"


def _shares(group: pd.DataFrame) -> tuple[str, ...]:
    return tuple(f"{int(group[key].sum())}" for key in KEYS)


def _rate(group: pd.DataFrame) -> str:
    return f"{group['false'].mean():.2f}" if len(group) else "-"
