"""What the pictures have in common: panels without a window, legends above, whole files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy.typing as npt

from bench.common.whole_files import write_whole

mpl.use("agg")
import matplotlib.pyplot as plt
from mpl_toolkits.mplot3d.art3d import Poly3DCollection


def save(figure: Any, path: Path, dpi: int = 110) -> None:
    """Write a picture, and forget it."""
    write_whole(path, lambda file: figure.savefig(file, dpi=dpi))
    plt.close(figure)


def title_and_legend(
    figure: Any, panel: Any, title: str, *, below: float, legend: float, **style: Any
) -> None:
    """A title over all panels, and one legend for what each of them shows.

    `legend` is where the legend's top is, and `below` where the panels' is, of the figure's height.
    """
    lines, names = panel.get_legend_handles_labels()
    figure.legend(lines, names, loc="upper center", ncol=4, bbox_to_anchor=(0.5, legend), **style)
    figure.suptitle(title, fontsize=10, y=0.997)
    figure.tight_layout(rect=(0, 0, 1, below))


def faces(ax: Any, corners: npt.NDArray[Any], **style: Any) -> None:
    """Polygons in space, (N, K, 3) [m]."""
    ax.add_collection3d(Poly3DCollection(corners, **style))


def cube(ax: Any, centre: Sequence[float], half: float, **aspect: float) -> None:
    """Show what is within `half` of a place [m], lengths alike in all directions."""
    for axis, value in zip("xyz", centre, strict=True):
        getattr(ax, f"set_{axis}lim")(value - half, value + half)
    ax.set_box_aspect((1, 1, 1), **aspect)
