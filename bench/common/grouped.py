"""Tables with a row for each group of trials."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pandas as pd

from bench.common.intervals import duration
from bench.common.markdown import markdown_table

Cell = Callable[[pd.DataFrame], object]


def grouped_table(
    trials: pd.DataFrame,
    keys: Mapping[str, str],
    columns: Mapping[str, Cell],
    order: Mapping[str, Sequence[Any]] | None = None,
) -> str:
    """A row per group, in the order in which the groups first appear.

    Args:
        trials: A row each.
        keys: What groups them, and the heading of each.
        columns: By heading what a group has there.
        order: Of keys that have another: their values as they are to come.
    """
    groups = list(trials.groupby([*keys], sort=False))
    if order:
        places = [([*keys].index(key), list(values)) for key, values in order.items()]
        groups.sort(key=lambda each: [values.index(each[0][at]) for at, values in places])
    rows = [[*key, *(cell(some) for cell in columns.values())] for key, some in groups]
    return markdown_table([*keys.values(), *columns], rows)


def time_at(quantile: float, column: str = "time") -> Cell:
    """A quantile of times, with the unit that suits it."""
    return lambda some: duration(some[column].quantile(quantile))


def mean(column: str, digits: int = 3) -> Cell:
    """Cell with a column's mean, or the share of trials where it is true."""
    return lambda some: f"{some[column].mean():.{digits}f}"
