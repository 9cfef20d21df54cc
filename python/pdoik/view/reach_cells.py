"""The places of a reachability map as cubes: how large, of what colour, which of them can be seen.

Most of a map lies inside it. A cube whose six neighbours are there hides behind them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib import colormaps
from scipy.spatial import cKDTree

import pdoik

FloatArray = npt.NDArray[np.float64]
ByteArray = npt.NDArray[np.uint8]
BoolArray = npt.NDArray[np.bool_]

COLORS = colormaps["viridis"]  # even to the eye, and in print and to the colour-blind
_EDGE_ALONE = 0.05  # of a cube that has no neighbour [m]
_WIDEST = 1 << 20  # a lattice along an axis
_NEIGHBOURS = np.concatenate([np.eye(3, dtype=np.int64), -np.eye(3, dtype=np.int64)])


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """A plane that takes away what is on one side of it."""

    axis: int  # of x, y, z: the plane's normal
    at: float  # [m]
    keep_above: bool = True

    def keeps(self, centers: FloatArray) -> BoolArray:
        """Which of some cubes stay, shape (K,), those whose middle lies on the plane among them."""
        beyond = centers[:, self.axis] - self.at
        kept: BoolArray = (beyond if self.keep_above else -beyond) >= -1e-6
        return kept


class ReachCells:
    """A cube for each place where an orientation is reached.

    Attributes:
        centers: Shape (K, 3), base frame [m].
        shares: Of the orientations there, how many are reached, shape (K,).
        edge: Of a cube: the distance of neighbouring places [m].
    """

    def __init__(self, result: pdoik.Reachability) -> None:
        share = result.share
        self.centers = result.grid.positions[share > 0]
        self.shares = share[share > 0]
        self.edge = _spacing(result.grid.positions)
        self._lattice = _lattice(self.centers, self.edge)

    def visible(self, cut: Cut | None) -> npt.NDArray[np.intp]:
        """Which cubes stay after a cut and have a face that no other covers."""
        kept = np.ones(len(self.centers), dtype=bool) if cut is None else cut.keeps(self.centers)
        if self._lattice is None:
            return np.flatnonzero(kept)
        there = np.flatnonzero(kept)
        keys = np.unique(_key(self._lattice[there]))
        covered = np.ones(len(there), dtype=bool)
        for way in _NEIGHBOURS:
            covered &= np.isin(_key(self._lattice[there] + way), keys)
        return there[~covered]


def share_colors(shares: npt.ArrayLike) -> ByteArray:
    """Colours of shares from 0 to 1, (K, 3)."""
    colors: ByteArray = COLORS(np.asarray(shares, dtype=np.float64), bytes=True)[..., :3]
    return colors


def _spacing(positions: FloatArray) -> float:
    """The usual distance between neighbours [m]."""
    if len(positions) == 1:
        return _EDGE_ALONE
    nearest = np.asarray(cKDTree(positions).query(positions, k=[2])[0])
    apart = nearest[nearest > 0]
    return float(np.median(apart)) if len(apart) else _EDGE_ALONE


def _lattice(centers: FloatArray, edge: float) -> npt.NDArray[np.int64] | None:
    """Whole numbers, from 1, that count edges along each axis, (K, 3); None if some lie between."""
    if not len(centers):
        return None
    count = (centers - centers.min(axis=0)) / edge
    if count.max() >= _WIDEST - 2 or np.abs(count - count.round()).max() > 0.01:
        return None
    return np.asarray(count.round(), dtype=np.int64) + 1


def _key(lattice: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """One number for each, (K,)."""
    key: npt.NDArray[np.int64] = lattice @ np.array([_WIDEST * _WIDEST, _WIDEST, 1])
    return key
