"""The picture of bench.ik.clouds: intake, questions and solves over the number of points."""

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.axes import Axes

from bench.common.whole_files import write_whole
from bench.ik.clouds.capt import CAPT, FILTERED
from bench.ik.clouds.structures import COAL, NANOFLANN, OURS, OURS_SINGLE, OURS_THINNED, SCIPY
from bench.ik.clouds.tables import questions
from bench.ik.experiment import ARMS

COLOURS = {
    OURS: "#0b6e4f",
    OURS_SINGLE: "#5fb49c",
    OURS_THINNED: "#9bc53d",
    COAL: "#c8553d",
    SCIPY: "#3d5a98",
    NANOFLANN: "#8d6a9f",
    CAPT: "#b07d12",
    FILTERED: "#d9b44a",
}
ARM_COLOURS = dict(zip(ARMS, ("#0b6e4f", "#b07d12", "#3d5a98"), strict=True))
OTHER = "#666666"


def draw(rows: pd.DataFrame, path: Path) -> None:
    """Three panels, logarithmic both ways but for the solves' ratio."""
    figure, axes = plt.subplots(1, 3, figsize=(14, 5.6), layout="constrained")
    _intake(axes[0], rows)
    _questions(axes[1], rows)
    _solves(axes[2], rows)
    for panel in axes:
        panel.set_xscale("log")
        panel.set_xlabel("points")
        panel.legend(fontsize=8, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.13))
        panel.grid(alpha=0.3, which="major")
    write_whole(path, lambda temporary: figure.savefig(temporary, dpi=110))
    plt.close(figure)


def _intake(panel: Axes, rows: pd.DataFrame) -> None:
    for name, group in rows[rows.kind == "intake"].groupby("name", sort=False):
        medians = 1e3 * group.groupby("points").time.median()
        panel.plot(medians, "o-", color=COLOURS.get(name, OTHER), label=name)
    updates = 1e3 * rows[rows.kind == "update"].groupby("points").time.median()
    panel.plot(updates, "o:", color=COLOURS[OURS], label=f"{OURS}, update of 1 %")
    panel.set_yscale("log")
    panel.set_ylabel("median [ms]")
    panel.set_title("Intake")


def _questions(panel: Axes, rows: pd.DataFrame) -> None:
    some = questions(rows)
    for method, group in some[some.our_free].groupby("method", sort=False):
        medians = 1e6 * group.groupby("points")[["free_time", "clearance_time"]].median()
        colour = COLOURS.get(method, OTHER)
        label = "both" if method == OURS else "is it free?"
        panel.plot(medians.free_time, "o-", color=colour, label=f"{method}: {label}")
        if method != OURS and medians.clearance_time.notna().any():
            panel.plot(medians.clearance_time, "o--", color=colour, label=f"{method}: clearance")
    vamp = rows[(rows.kind == "capt") & (rows.method == "one") & (rows.free == True)]  # noqa: E712
    for name, group in vamp.groupby("name", sort=False):
        medians = 1e6 * group.groupby("points").free_time.median()
        panel.plot(medians, "s-", color=COLOURS[name], label=f"{name}: is it free? (Panda)")
    panel.set_yscale("log")
    panel.set_ylabel("median of free configurations [us]")
    panel.set_title("One configuration's questions, three arms")


def _solves(panel: Axes, rows: pd.DataFrame) -> None:
    some = rows[rows.kind == "solve"]
    for arm, group in some.groupby("robot", sort=False):
        medians = group.groupby("points").time.median()
        first = medians.iloc[0]
        panel.plot(
            medians / first,
            "o-",
            color=ARM_COLOURS[arm],
            label=f"{arm}, {1e6 * first:.0f} us at first",
        )
    panel.set_ylim(bottom=0)
    panel.set_ylabel(f"median time over that among {some.points.min()} points")
    panel.set_title("A solve")
