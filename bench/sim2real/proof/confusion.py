"""What was said of what was hidden, as a picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from bench.common.whole_files import write_whole
from bench.sim2real.concealed.catalogue import EFFECTS

SAID = ("unknown", "nothing", "cannot tell", "error")
DECOYS = {
    "clean": "nothing wrong",
    "outside": "outside the catalogue",
    "lying": "lying channel",
    "still": "joint at rest",
}
LIGHT = 0.55  # share above which figures are written in white


def counts(studies: pd.DataFrame) -> pd.DataFrame:
    """Rows: what was hidden; columns: what was said first. Poor motion is left out."""
    return _table(studies).fillna(0).astype(int)


def draw(studies: pd.DataFrame, path: Path) -> None:
    """A cell's shade is its share of the row, its figure the count; blue is right, red wrong."""
    table = counts(studies)
    good = studies.named.where(studies.group == "effect", studies.right).astype(float)
    right = _table(studies, good).to_numpy(float) >= 0.5  # nothing said there: False
    shares = table.to_numpy(float) / np.maximum(table.sum(axis=1).to_numpy(float)[:, None], 1.0)
    height, width = table.shape
    figure = Figure(figsize=(3.2 + 0.31 * width, 2.6 + 0.31 * height), dpi=120)
    axes = figure.subplots()
    for cells, colours in ((right, "Blues"), (~right & (shares > 0.0), "Reds")):
        shade = np.where(cells, 0.12 + 0.8 * shares, np.nan)
        axes.imshow(shade, cmap=colours, vmin=0.0, vmax=1.0, aspect="auto")
    for row, column in np.argwhere(table.to_numpy() > 0):
        axes.text(
            column,
            row,
            str(table.iat[row, column]),
            ha="center",
            va="center",
            fontsize=10,
            color="white" if shares[row, column] > LIGHT else "black",
        )
    axes.set_xticks(range(width), [_words(name) for name in table.columns], rotation=90)
    axes.set_yticks(range(height), [_words(name) for name in table.index])
    axes.set_xticks(np.arange(-0.5, width), minor=True)
    axes.set_yticks(np.arange(-0.5, height), minor=True)
    axes.grid(which="minor", color="#dddddd", linewidth=0.6)
    axes.tick_params(which="both", length=0, labelsize=10)
    axes.axvline(len(EFFECTS) - 0.5, color="#666666", linewidth=1.2)
    first = sum(name in EFFECTS for name in table.index)
    axes.axhline(first - 0.5, color="#666666", linewidth=1.2)
    axes.set_xlabel("said first", fontsize=11)
    axes.set_ylabel("hidden", fontsize=11)
    total = int(table.to_numpy().sum())
    title = f"{total} studies: counts, shaded by share of the row; blue right, red wrong"
    axes.set_title(title, fontsize=11)
    figure.tight_layout()
    write_whole(path, lambda temporary: figure.savefig(temporary, format="png"))


def _table(studies: pd.DataFrame, values: pd.Series[float] | None = None) -> pd.DataFrame:
    """Counts, or means of values, NaN where there are none."""
    kept = (studies.group != "effect") | (studies.hide != "poor")
    some = studies[kept]
    rows = some.effect.where(some.group == "effect", some.group.map(DECOYS))
    more = {} if values is None else {"values": values[kept], "aggfunc": "mean"}
    table = pd.crosstab(rows, some["first"], **more)
    columns = [*EFFECTS, *SAID]
    columns += [name for name in table.columns if name not in columns]
    order = [name for name in (*EFFECTS, *DECOYS.values()) if name in table.index]
    return table.reindex(index=order, columns=columns)


def _words(name: str) -> str:
    return name.replace("_", " ")
