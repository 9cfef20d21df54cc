"""The picture of bench.ik.clouds: intake, questions and solves over the number of points."""

from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes

from bench.ik.clouds.capt import CAPT, FILTERED
from bench.ik.clouds.structures import COAL, NANOFLANN, OURS, OURS_SINGLE, OURS_THINNED, SCIPY
from bench.ik.clouds.tables import questions
from bench.ik.experiment import ARMS
from bench.ik.pictures import plt, save

COLOURS = {
    OURS: "#0b6e4f",
    OURS_SINGLE: "#5fb49c",
    OURS_THINNED: "#9bc53d",
    COAL: "#c8553d",
    SCIPY: "#3d5a98",
    NANOFLANN: "#8d6a9f",
    CAPT: "#b07d12",
    FILTERED: "#d9b44a",
    **dict(zip(ARMS, ("#0b6e4f", "#b07d12", "#3d5a98"), strict=True)),
}


def draw(rows: pd.DataFrame, path: Path) -> None:
    """Three panels, logarithmic both ways but for the solves' ratio."""
    figure, axes = plt.subplots(1, 3, figsize=(14, 5.6), layout="constrained")
    for panel, draw_on in zip(axes, (_intake, _questions, _solves), strict=True):
        draw_on(panel, rows)
        panel.set_xscale("log")
        panel.set_xlabel("points")
        panel.legend(fontsize=8, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.13))
        panel.grid(alpha=0.3, which="major")
    save(figure, path)


def _line(panel: Axes, medians: pd.Series, style: str, name: str, label: str) -> None:
    panel.plot(medians, style, color=COLOURS[name], label=label)


def _intake(panel: Axes, rows: pd.DataFrame) -> None:
    for name, group in rows[rows.kind == "intake"].groupby("name", sort=False):
        _line(panel, 1e3 * group.groupby("points").time.median(), "o-", name, name)
    updates = 1e3 * rows[rows.kind == "update"].groupby("points").time.median()
    _line(panel, updates, "o:", OURS, f"{OURS}, update of 1 %")
    panel.set(yscale="log", ylabel="median [ms]", title="Intake")


def _questions(panel: Axes, rows: pd.DataFrame) -> None:
    some = questions(rows)
    for method, group in some[some.our_free].groupby("method", sort=False):
        medians = 1e6 * group.groupby("points")[["free_time", "clearance_time"]].median()
        label = "both" if method == OURS else "is it free?"
        _line(panel, medians.free_time, "o-", method, f"{method}: {label}")
        if method != OURS and medians.clearance_time.notna().any():
            _line(panel, medians.clearance_time, "o--", method, f"{method}: clearance")
    vamp = rows[(rows.kind == "capt") & (rows.method == "one")]
    for name, group in vamp[vamp.free.astype(bool)].groupby("name", sort=False):
        medians = 1e6 * group.groupby("points").free_time.median()
        _line(panel, medians, "s-", name, f"{name}: is it free? (Panda)")
    panel.set(yscale="log", ylabel="median of free configurations [us]")
    panel.set_title("One configuration's questions, three arms")


def _solves(panel: Axes, rows: pd.DataFrame) -> None:
    some = rows[rows.kind == "solve"]
    for arm, group in some.groupby("robot", sort=False):
        medians = group.groupby("points").time.median()
        first = medians.iloc[0]
        _line(panel, medians / first, "o-", arm, f"{arm}, {1e6 * first:.0f} us at first")
    panel.set_ylim(bottom=0)
    panel.set_ylabel(f"median time over that among {some.points.min()} points")
    panel.set_title("A solve")
