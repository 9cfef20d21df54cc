"""What stands around a picture of a solution: the verdict above, the meaning of colours below."""

from __future__ import annotations

import textwrap

from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import pdoik

from .contents import Contents
from .marks import Mark
from .style import (
    BONE,
    FAILS,
    FAR,
    GAP_COLORS,
    HELD,
    HULL,
    JOINT,
    MET,
    NEAR,
    NOT_MET,
    SHAPE,
    SURFACE,
)

_WIDTH = 112  # characters of a line


def headline(figure: Figure, contents: Contents, result: pdoik.Result, title: str | None) -> None:
    """Title or status, errors, and why it failed."""
    status = result.status.replace("_", " ")
    color = MET if result.success else NOT_MET
    if not result.success and result.status != "nearest":
        status = f"not solved ({status})"
    first = title or f"{contents.robot.name}: {status}"
    figure.text(0.03, 0.972, first, fontsize=16, weight="bold", color=color, va="center")
    numbers = [
        f"position error {_small(1e3 * result.position_error, 'mm')}",
        f"rotation error {_small(1e3 * result.rotation_error, 'mrad')}",
    ]
    if len(contents.points) or contents.shapes:
        numbers.append(f"clearance {1e3 * result.clearance:.1f} mm")
    numbers.append(f"{1e3 * result.time:.2f} ms")
    figure.text(0.03, 0.943, "    ".join(numbers), fontsize=10.5, color="#333333", va="center")
    if not result.success:
        why = textwrap.shorten(result.message or result.worst_constraint, 2 * _WIDTH)
        text = textwrap.fill(why, _WIDTH)
        figure.text(0.03, 0.928, text, fontsize=9.5, color=NOT_MET, va="top")


def _small(value: float, unit: str) -> str:
    return f"{value:.3f} {unit}" if value >= 5e-4 else f"below 0.001 {unit}"


def legend(figure: Figure, contents: Contents, mark: Mark | None) -> None:
    """What is what, and what colours of points mean."""

    def dot(color: str, size: float, label: str, alpha: float = 1.0) -> Line2D:
        return Line2D([], [], marker="o", ls="", color=color, ms=size, label=label, alpha=alpha)

    def line(color: str, width: float, label: str, style: str = "-") -> Line2D:
        return Line2D([], [], color=color, lw=width, ls=style, label=label)

    hulls, points = contents.hulls, contents.points
    bone = Line2D([], [], color=BONE, lw=4, marker="o", mfc=JOINT, mew=0, ms=9)
    bone.set_label("links and joints")
    handles: list[Line2D | Patch] = [bone]
    filled = sum(hull.fills for hull in hulls)
    if hulls:
        handles.append(dot(HULL, 14, f"{filled} hulls", 0.6))
    if contents.held:
        handles.append(Patch(color=HELD, label=_count(contents.held, "held")))
    handles.append(line("#1f5fd0", 4, f"{contents.tip} (x red, y green, z blue)"))
    if contents.target is not None:
        handles.append(line("#1f5fd0", 1.6, "its target"))
    if contents.shapes:
        handles.append(Patch(color=SHAPE, label=_count(contents.shapes, "obstacle")))
    if len(points):
        handles.append(dot("#f59a23", 7, f"{len(points)} obstacle points"))
    if len(contents.surface):
        handles.append(dot(SURFACE, 2.5, f"the {len(contents.surface)} points they stand for"))
    if mark is not None and mark.fails:
        handles.append(line(FAILS, 2.2, "too near"))
    elif mark is not None and mark.line is not None:
        handles.append(line(NEAR, 2.2, "nearest"))
    figure.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.01, 0.005), ncols=3, frameon=False,
        fontsize=9, handlelength=1.6, columnspacing=1.4,
    )  # fmt: skip
    if len(points) and hulls:
        bar_axes = figure.add_axes((0.715, 0.072, 0.26, 0.013))
        mappable = ScalarMappable(Normalize(0, FAR), GAP_COLORS)
        bar = figure.colorbar(mappable, cax=bar_axes, orientation="horizontal", extend="max")
        bar.ax.set_title("gap to the nearest hull [m]", fontsize=9, loc="left", pad=4)
        bar.ax.tick_params(labelsize=8, length=2)


def _count(shapes: list[pdoik.Shape], what: str) -> str:
    """'obstacle: table', or '3 obstacles'; 'held: mug', or 'held: 2 shapes'."""
    if len(shapes) == 1:
        return f"{what}: {shapes[0].name}"
    return f"held: {len(shapes)} shapes" if what == "held" else f"{len(shapes)} {what}s"
