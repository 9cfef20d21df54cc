"""Tables of the comparison with peers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

TITLES = {
    "validate": "held out",
    "faster": "faster",
    "poses": "other poses",
    "load": "other load",
}
LEVEL = 1.05  # times the lowest error is level with it
BLUR = 0.1  # of the noise: errors nearer than this cannot be told apart in use


def levels(rows: pd.DataFrame, blur: float) -> pd.Series:
    """Whether each row's method is lowest of its study and column, or level with it."""
    lowest = rows.groupby(["seed", "column"]).floors.transform("min")
    return (rows.floors <= LEVEL * lowest) | (rows.floors <= lowest + blur)


def method_table(rows: pd.DataFrame, value: str) -> tuple[list[str], list[list[str]]]:
    """Median with quartiles of `ratio` or `floors`, per method and column."""
    header = ["method", *TITLES.values()]
    table = []
    for method, some in rows.groupby("method", sort=False):
        cells = [quartiles(some[some.column == column][value]) for column in TITLES]
        table.append([str(method), *cells])
    return header, table


def level_table(rows: pd.DataFrame) -> tuple[list[str], list[list[str]]]:
    """Share of studies in which a method is lowest or level; and median seconds of its fit."""
    header = ["method"]
    for title in TITLES.values():
        header += [title, f"{title}, or within {BLUR:g} of the noise"]
    table = []
    rivals = rows[rows.method != "nothing"]
    for method, some in rivals.groupby("method", sort=False):
        cells = [str(method)]
        for column in TITLES:
            here = some[some.column == column]
            for blur in (0.0, BLUR):
                won = levels(rivals, blur)[here.index]
                cells.append(f"{100.0 * float(np.mean(won)):.0f} %")
        table.append([*cells, f"{some.seconds.median():.1f}"])
    return [*header, "seconds"], table


def effect_table(rows: pd.DataFrame, column: str | None) -> tuple[list[str], list[list[str]]]:
    """Median error over the noise by effect and method; of no column: the worst beyond the fit.

    The lowest and those level with it are bold.
    """
    some = rows[rows.column != "validate"] if column is None else rows[rows.column == column]
    keys = ["seed", "effect", "method"]
    worst = some.groupby(keys, sort=False).floors.max().reset_index()
    wide = worst.pivot_table(
        index="effect", columns="method", values="floors", aggfunc="median", sort=False
    )
    table = []
    for effect, values in wide.iterrows():
        lowest = np.nanmin(values)
        level = (values <= LEVEL * lowest) | (values <= lowest + BLUR)
        cells = [
            f"**{short(value)}**" if best else short(value)
            for value, best in zip(values, level, strict=True)
        ]
        table.append([str(effect), *cells])
    return ["effect", *map(str, wide.columns)], table


def not_lowest(rows: pd.DataFrame) -> list[str]:
    """Where ours is neither lowest nor level, a line each, the widest gap first."""
    rivals = rows[rows.method != "nothing"]
    level = levels(rivals, BLUR)
    lost = rivals[(rivals.method == "ours") & ~level]
    lines: list[tuple[float, str]] = []
    for row in lost.itertuples():
        others = rivals[(rivals.seed == row.seed) & (rivals.column == row.column)]
        best = others.loc[others.floors.idxmin()]
        lines.append((row.floors - best.floors, lost_line(row, best)))
    return [line for _, line in sorted(lines, reverse=True)]


def lost_line(row: Any, best: Any) -> str:
    """One place where a peer was lower."""
    return (
        f"- {row.effect}, {row.robot}, seed {row.seed}, {TITLES[row.column]}: ours"
        f" {row.floors:.2f} of the noise, {best.method} {best.floors:.2f};"
        f" ours said: {row.said}"
    )


def quartiles(values: Sequence[float]) -> str:
    """Median [lower quartile, upper quartile]."""
    low, middle, high = np.quantile(values, [0.25, 0.5, 0.75])
    return f"{short(middle)} [{short(low)}, {short(high)}]"


def short(value: float) -> str:
    """Two decimals, or fewer where it is large."""
    return f"{value:.2f}" if value < 10.0 else f"{value:.0f}"
