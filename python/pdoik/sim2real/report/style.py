"""Colours and output of the figures: PNG files, and SVG that follows the page's theme."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

INK, MUTED, GRID, PAPER = "#1c2127", "#5f6b7a", "#e2e6eb", "#fffffe"
BEFORE, AFTER, MEASURED, NOISE = "#c9542c", "#1a6fb5", "#2b3139", "#9aa4b0"
DPI = 110
_VARIABLES = {
    INK: "--ink",
    MUTED: "--muted",
    GRID: "--grid",
    PAPER: "--card",
    BEFORE: "--before",
    AFTER: "--after",
    MEASURED: "--measured",
    NOISE: "--noise",
}
_SETTINGS: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9.0,
    "text.color": INK,
    "text.parse_math": False,  # a joint may be called $1
    "svg.fonttype": "none",
    "axes.edgecolor": MUTED,
    "axes.facecolor": "none",
    "axes.formatter.use_mathtext": False,
    "axes.formatter.useoffset": False,
    "axes.grid": True,
    "axes.labelcolor": MUTED,
    "axes.linewidth": 0.8,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlecolor": INK,
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # found without measuring, which takes a fifth of the time
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "path.simplify_threshold": 0.3,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """A figure as the page and as a file."""

    name: str  # of the file, without its ending
    caption: str  # also the text for those who cannot see it
    svg: str
    png: bytes


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the report's style, whatever the user's matplotlibrc says."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        with mpl.rc_context():
            mpl.rcdefaults()
            mpl.rcParams.update(_SETTINGS)
            yield


def picture(figure: Figure, name: str, caption: str) -> Picture:
    """Both outputs of a figure."""
    return Picture(name=name, caption=caption, svg=svg_of(figure, name), png=png_of(figure))


def png_of(figure: Figure, dpi: float = DPI) -> bytes:
    """PNG on white, to stand anywhere."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, facecolor="white", metadata={"Software": None})
    return buffer.getvalue()


def svg_of(figure: Figure, name: str) -> str:
    """SVG to stand within a page: without header, ids of its own, the theme's colours.

    Numbers are rounded to a hundredth of a point.
    """
    buffer = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": name}):
        figure.savefig(buffer, format="svg", dpi=DPI, transparent=True, metadata={"Date": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"\s*<metadata>.*?</metadata>", "", text, count=1, flags=re.DOTALL)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", text, count=1)
    text = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text, count=1)
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'(href="|url\()#', rf"\1#{name}-", text)
    text = re.sub(r' d="[^"]*"', lambda path: _rounded(path[0]), text)
    for color, variable in _VARIABLES.items():
        text = text.replace(color, f"var({variable})")
    return text


def _rounded(path: str) -> str:
    path = re.sub(r"(-?\d+\.\d\d)\d+", r"\1", path)
    return re.sub(r"\s+", " ", path)


def quiet_legend(axes: Axes, **options: Any) -> None:
    """A legend over the axes, in a row."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        axes.legend(
            handles,
            labels,
            ncols=len(handles),
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            borderaxespad=0.1,
            handlelength=1.6,
            columnspacing=1.4,
            **options,
        )


def short(text: str, length: int = 28) -> str:
    """Text no longer than fits next to a figure."""
    return text if len(text) <= length else f"{text[: length - 1]}…"
