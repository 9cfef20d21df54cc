"""A picture of a whole path: joints and their limits, clearance, pieces, and where it breaks."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from pdoik._core import PathResult
from pdoik._files import write_whole
from pdoik.solver import Solver

__all__ = ["draw_path"]

FloatArray = npt.NDArray[np.float64]

_INK, _LIMIT, _OBSTACLE, _SELF, _BREAK = "#2b2f36", "#d3151b", "#d77a12", "#4c78a8", "#d3151b"
_PIECES = ("#2b5f9e", "#3a8f5c", "#8a5fa8", "#a8703a")
_NEAR = 1.0  # limits that are no farther off, or half of what is moved, are shown [rad] or [m]
_LEAST_SPAN = 0.2  # of an axis [rad] or [m]
_MOST_JUDGED = 600  # rows
_FAR = 0.6  # clearances beyond it look alike [m]


def draw_path(
    path: str | Path,
    solver: Solver,
    result: PathResult,
    obstacles: Any = None,
    *,
    title: str = "",
    dpi: int = 110,
) -> None:
    """Draw what `Solver.solve_path` gave into a PNG file.

    Args:
        path: Where to; an old file there is replaced once the new one is whole.
        solver: That gave it.
        result: Of pieces all are drawn; without rows only where it breaks.
        obstacles: That it was asked with.
        title: Above it.
        dpi: Of the picture.
    """
    robot = solver.robot
    figure = Figure(figsize=(9.0, 1.2 + 0.95 * robot.dof + 1.7), layout="constrained")
    ratios = [1.0] * robot.dof + [1.5]
    panels = figure.subplots(robot.dof + 1, 1, sharex=True, height_ratios=ratios, squeeze=False)
    for j, axes in enumerate(panels[:-1, 0]):
        _joint(axes, solver, result, j)
    _clearance(panels[-1, 0], solver, result, obstacles)
    for axes in panels[:, 0]:
        for end in result.ends:
            axes.axvline(end.at, color=_BREAK, linestyle=":", linewidth=1.2)
    for first, _ in result.pieces[1:]:
        for axes in panels[:, 0]:
            axes.axvline(result.at[first], color=_INK, linestyle="--", linewidth=0.8)
    panels[-1, 0].set_xlabel("place on the path [stations]")
    figure.suptitle("\n".join(_words(result, title)), fontsize=9, x=0.01, ha="left")
    buffer = io.BytesIO()
    FigureCanvasAgg(figure)
    figure.savefig(buffer, format="png", dpi=dpi, facecolor="white", metadata={"Software": None})
    write_whole(path, buffer.getvalue())


def _words(result: PathResult, title: str) -> list[str]:
    status = result.status.replace("_", " ")
    lines = [f"{title}: {status}" if title else status]
    lines += [f"breaks at {end.at:.2f}: {end.reason}" for end in result.ends[:3]]
    return [line if len(line) < 120 else line[:117] + "..." for line in lines]


def _joint(axes: Axes, solver: Solver, result: PathResult, j: int) -> None:
    robot = solver.robot
    lower, upper = float(robot.lower[j]), float(robot.upper[j])
    values = result.q[:, j] if len(result.q) else np.array([0.0])
    low, high = float(values.min()), float(values.max())
    margin = max(0.12 * (high - low), 0.5 * (_LEAST_SPAN - (high - low)), 0.02)
    bottom, top = low - margin, high + margin
    near = max(_NEAR, 0.5 * (high - low))
    if lower > low - near:
        bottom = min(bottom, lower - 0.7 * margin)
    if upper < high + near:
        top = max(top, upper + 0.7 * margin)
    for edge, beyond in ((lower, bottom), (upper, top)):
        if np.isfinite(edge):
            axes.axhspan(edge, beyond if bottom < edge < top else edge, color=_LIMIT, alpha=0.18)
            axes.axhline(edge, color=_LIMIT, linewidth=0.8)
    for k, (first, end) in enumerate(result.pieces):
        color = _PIECES[k % len(_PIECES)]
        axes.plot(result.at[first:end], result.q[first:end, j], color=color, linewidth=1.3)
    axes.set_ylim(bottom, top)
    unit = "m" if robot.joint_types[j] == "prismatic" else "rad"
    axes.set_ylabel(f"{robot.joint_names[j]}\n[{unit}]", fontsize=6.5)
    axes.tick_params(labelsize=7)


def _clearance(axes: Axes, solver: Solver, result: PathResult, obstacles: Any) -> None:
    robot = solver.robot
    tip = robot.tip_links[0]
    is_drawn = False
    for first, end in result.pieces:
        count = min(end - first, max(_MOST_JUDGED // len(result.pieces), 2))
        rows = np.unique(np.linspace(first, end - 1, count).astype(int))
        verdicts = []
        for q in result.q[rows]:
            target = {tip: robot.fk(q, tip)} if len(robot.tip_links) > 1 else robot.fk(q)
            verdicts.append(solver.judge(target, q, obstacles, T_tip_tool=np.eye(4)))
        for name, label, color in (
            ("clearance", "to obstacles", _OBSTACLE),
            ("self_distance", "between links", _SELF),
        ):
            values = np.array([getattr(each, name) for each in verdicts])
            if np.isfinite(values).any():
                shown = np.minimum(values, _FAR)
                axes.plot(
                    result.at[rows], shown, color=color, label=None if is_drawn else label, lw=1.3
                )
        is_drawn = True
    wanted = solver.options.clearance
    axes.axhline(wanted, color=_LIMIT, linewidth=0.8)
    axes.set_ylabel("clearance\n[m]", fontsize=7)
    axes.tick_params(labelsize=7)
    axes.set_ylim(bottom=min(0.0, wanted) - 0.005)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=7, loc="best", frameon=False)
    else:
        axes.text(0.5, 0.5, "nothing to keep clear of", transform=axes.transAxes, ha="center")
