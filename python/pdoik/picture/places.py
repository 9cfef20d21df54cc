"""A map of places for a base or a part: how much room paths have from each."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PatchCollection
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pdoik._files import write_whole
from pdoik.base_places import BasePlaces

__all__ = ["place_map"]

FloatArray = npt.NDArray[np.float64]

_COLORS = LinearSegmentedColormap.from_list(
    "room", ["#5b5e66", "#d9dbe0", "#fff7e0", "#8fcf8a", "#1b7837"]
)
_LEAST_CELL = 1e-6  # [m]


def place_map(places: BasePlaces, path: str | Path | None = None, title: str = "") -> Figure:
    """Each cell has the colour of the best score of all heights and yaws there: green is whole.

    Args:
        places: To be shown.
        path: Of a .png file to write, if any; an old file is replaced once the new one is whole.
        title: Above it.

    Raises:
        ValueError: The name ends in something else.
    """
    if path is not None and Path(path).suffix.lower() != ".png":
        raise ValueError(f"expected a name that ends in .png, got {Path(path).name!r}")
    figure = Figure(figsize=(7.6, 6.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    score = places.score
    order = places.order
    _, first = np.unique(places.places[order, :2].round(9), axis=0, return_index=True)
    shown = order[first]  # the best of each x and y
    shown = shown[np.isfinite(score[shown])]
    xy, values = places.places[shown, :2], score[shown]
    top = max(float(values.max(initial=0.0)), 0.1)
    norm = TwoSlopeNorm(0.0, -2.0, top)
    size = _cell(places.places[:, 0]), _cell(places.places[:, 1])
    cells = _cells(axes, xy, values, size, norm)
    bar = figure.colorbar(cells, ax=axes, shrink=0.8)
    bar.set_label("room: above 0 all paths are whole, 1 is far from everything", fontsize=8)
    whole = places.whole[shown]
    if len(np.unique(places.places[:, 3])) > 1 and whole.any():
        yaw = places.places[shown[whole], 3]
        axes.quiver(
            *xy[whole].T, np.cos(yaw), np.sin(yaw), angles="xy", color="#2b2f36", alpha=0.6,
            pivot="mid", scale=1.6 / min(size), scale_units="xy", width=0.003,
        )  # fmt: skip
    if places.move == "base":
        for k, way in enumerate(places.ways):
            label = "path" if k == 0 else None
            axes.plot(way[:, 0], way[:, 1], color="#d3151b", linewidth=1.6, label=label)
    best = places.best
    if best is not None:
        label = f"best: x {best.x:.3g}, y {best.y:.3g}, z {best.z:.3g}, yaw {best.yaw:.3g}"
        axes.plot(best.x, best.y, "*", color="#d77a12", markersize=15, label=label)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8, loc="upper left")
    axes.set_aspect("equal")
    axes.set(xlabel=f"x of the {places.move} [m]", ylabel=f"y of the {places.move} [m]")
    count = f"whole from {int(places.whole.sum())} of {len(places)} places"
    axes.set_title(f"{title}: {count}" if title else count, fontsize=10)
    if path is not None:
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=120, metadata={"Software": None})
        write_whole(path, buffer.getvalue())
    return figure


def _cell(values: FloatArray) -> float:
    """How far places are apart."""
    steps = np.diff(np.unique(values.round(9)))
    return float(steps.min()) if len(steps) and steps.min() > _LEAST_CELL else 0.1


def _cells(
    axes: Axes,
    xy: FloatArray,
    values: FloatArray,
    size: tuple[float, float],
    norm: TwoSlopeNorm,
) -> PatchCollection:
    width, height = size
    corners = xy - np.array(size) / 2
    patches = [Rectangle((x, y), width, height) for x, y in corners.tolist()]
    cells = PatchCollection(patches, cmap=_COLORS, norm=norm, edgecolor="white", linewidth=0.4)
    cells.set_array(values)
    axes.add_collection(cells)
    axes.autoscale_view()
    return cells
