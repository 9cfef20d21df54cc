"""Words and lines over a picture, next to one another."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.transforms import Bbox, IdentityTransform

FloatArray = npt.NDArray[np.float64]

_STEP = 4.0  # by which a text moves up until it covers no other [point]
_MOST_STEPS = 60
_AWAY = (50.0, 80.0, 120.0)  # how far a note may be from what it is about [point]
_WAYS = 12  # around it
_ROOM = 5.0  # around its words [point]
_TEXT: dict[str, Any] = {"va": "bottom", "ha": "center", "transform": IdentityTransform()}


class Labels:
    """A transparent figure as large as the picture, its pixels counted from the upper left corner.

    Args:
        width: Of the picture [pixel].
        height: Of the picture [pixel].
        dpi: Pixels per inch.
        covered: Where something is drawn, (H, W).
    """

    def __init__(self, width: int, height: int, dpi: float, covered: npt.NDArray[np.bool_]) -> None:
        size = width / dpi, height / dpi
        self.figure = Figure(figsize=size, dpi=dpi, facecolor="none")
        self._height, self._point = height, dpi / 72
        self._covered = covered
        self._taken: list[Bbox] = []

    def line(self, pixels: FloatArray, color: str, width: float, style: str = "-") -> None:
        """Draw a line through pixels, (N, 2)."""
        self._add_line(pixels, color=color, lw=width, ls=style)

    def dots(self, pixels: FloatArray, color: str, size: float) -> None:
        """Draw dots at pixels, (N, 2)."""
        self._add_line(pixels, color=color, ls="", marker="o", ms=size, mew=0)

    def text(self, pixel: FloatArray, words: str, color: str, size: float) -> None:
        """Above a pixel, higher where there are words already."""
        text = Text(
            float(pixel[0]), self._height - float(pixel[1]) + 3 * self._point, words,
            color=color, size=size, **_TEXT,
        )  # fmt: skip
        self.figure.add_artist(text)
        for _ in range(_MOST_STEPS):
            extent = text.get_window_extent()
            if not any(extent.overlaps(each) for each in self._taken):
                break
            text.set_y(text.get_position()[1] + _STEP * self._point)
        self._taken.append(text.get_window_extent())

    def note(self, pixel: FloatArray, words: str, color: str, size: float) -> None:
        """Strong words on white, with a thin line to a pixel, where they cover least."""
        x, y = float(pixel[0]), self._height - float(pixel[1])
        box = {"facecolor": "white", "alpha": 0.85, "edgecolor": color, "lw": 0.6, "pad": 2.5}
        text = Text(x, y, words, color=color, size=size, weight="bold", bbox=box, **_TEXT)
        self.figure.add_artist(text)
        extent = text.get_window_extent()
        half = np.array([extent.width, extent.height]) / 2 + _ROOM * self._point
        angles = 2 * np.pi * np.arange(_WAYS) / _WAYS
        places = [
            np.array([x, y]) + (away * self._point + half) * [np.cos(angle), np.sin(angle)]
            for away in _AWAY
            for angle in angles
        ]
        best = min(places, key=lambda place: self._cost(place - half, place + half))
        text.set_position((best[0], best[1] - extent.height / 2))
        self._taken.append(text.get_window_extent())
        ends = np.array([[x, y], np.clip([x, y], best - half, best + half)])
        ends[:, 1] = self._height - ends[:, 1]
        self.line(ends, color, 0.8)

    def _cost(self, low: FloatArray, high: FloatArray) -> float:
        """How much of what is drawn words would cover; more outside of the picture."""
        height, width = self._covered.shape
        if low.min() < 0 or high[0] > width or high[1] > height:
            return np.inf
        (x0, y0), (x1, y1) = low.astype(int), high.astype(int)
        cost = float(self._covered[height - y1 : height - y0, x0:x1].mean())
        box = Bbox([low, high])
        return cost + sum(box.overlaps(each) for each in self._taken)

    def _add_line(self, pixels: FloatArray, **style: Any) -> None:
        x, y = pixels[:, 0], self._height - pixels[:, 1]
        self.figure.add_artist(Line2D(x, y, transform=IdentityTransform(), **style))
