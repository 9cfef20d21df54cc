"""The place on a distance field's surface that is nearest to a point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik._distance_fields import distances_at

FloatArray = npt.NDArray[np.float64]

_STEPS, _ON_SURFACE, _LEVEL = 30, 1e-6, 1e-6  # of a search down a slope; [m]; slope squared
_SLIDES = 30  # along the surface
_INSIDE = 1e-6  # cells from the border of where values are: next to that border slopes are others
_SHORTEST = 1e-3  # slide that is worth another one, in cells


def field_distance(shape: pdoik.Shape) -> Callable[[FloatArray], float]:
    """What a distance field says of a point in its frame, (3,) [m]."""
    values, cell = shape.values, shape.cell
    assert cell is not None
    return lambda point: float(distances_at(values, cell, point[None])[0][0])


def field_surface(shape: pdoik.Shape) -> Callable[[FloatArray], tuple[float, FloatArray]]:
    """The same, and the place where the field is 0: down its slope, then along its surface.

    What is found is nearest among its neighbours. Of a field that is nowhere 0 it is where the
    slope ends.
    """
    field = _Field(shape)

    def to_field(point: FloatArray) -> tuple[float, FloatArray]:
        return field.at(point)[0], field.nearest(point)

    return to_field


class _Field:
    """A field in its own frame."""

    def __init__(self, shape: pdoik.Shape) -> None:
        assert shape.cell is not None
        self._values, self._cell = shape.values, shape.cell
        self._low = np.full(3, (0.5 + _INSIDE) * shape.cell)
        self._high = (np.array(shape.values.shape) - 0.5 - _INSIDE) * shape.cell

    def at(self, point: FloatArray) -> tuple[float, FloatArray]:
        (distance,), (slope,) = distances_at(self._values, self._cell, point[None])
        return float(distance), slope

    def nearest(self, point: FloatArray) -> FloatArray:
        place, slope = self._down(point)
        share = 1.0
        for _ in range(_SLIDES):
            square = float(slope @ slope)
            offset = point - place
            if square > _LEVEL:
                offset = offset - (offset @ slope) / square * slope
            if share * np.linalg.norm(offset) < _SHORTEST * self._cell:
                break
            other, its_slope = self._down(place + share * offset)
            if np.linalg.norm(other - point) < np.linalg.norm(place - point):
                place, slope = other, its_slope
            else:
                share /= 2
        return place

    def _down(self, point: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Where the slope leads to the surface, and the slope there."""
        place = np.clip(point, self._low, self._high)
        for _ in range(_STEPS):
            left, slope = self.at(place)
            square = float(slope @ slope)
            if abs(left) < _ON_SURFACE or square < _LEVEL:
                break
            place = np.clip(place - left / max(square, 1.0) * slope, self._low, self._high)
        return place, slope
