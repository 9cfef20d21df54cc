"""The places of a reachability map as cubes, and which of their faces can be seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib import colormaps
from scipy.spatial import cKDTree

import pdoik

FloatArray = npt.NDArray[np.float64]
ByteArray = npt.NDArray[np.uint8]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]

COLORS = colormaps["viridis"]  # even to the eye, and in print and to the colour-blind
_EDGE_ALONE = 0.05  # of a cube that has no neighbour [m]
_WIDEST = 1 << 20  # a lattice along an axis
_WAYS = np.concatenate([np.eye(3, dtype=np.int64), -np.eye(3, dtype=np.int64)])  # out of a cube
_AXES = np.abs(_WAYS).argmax(axis=1)
_ROUND = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
_CORNERS = np.array(  # of the faces of a cube from -1 to 1, (6, 4, 3)
    [
        way + np.outer(u, np.roll(way, 1)) + np.outer(v, np.abs(np.roll(way, 2)))
        for way in _WAYS
        for u, v in [_ROUND.T]
    ]
)


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Squares:
    """Faces of cubes that can be seen.

    Attributes:
        corners: Counterclockwise from outside, base frame, shape (F, 4, 3) [m].
        shares: Of the cubes they belong to, shape (F,).
        axes: Of x, y, z, the one that each is normal to, shape (F,).
    """

    corners: FloatArray
    shares: FloatArray
    axes: IntArray


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

    def visible(self, cut: Cut | None) -> Squares:
        """The faces of the cubes that a cut leaves, without those that a neighbour covers."""
        there = np.arange(len(self.centers))
        if cut is not None:
            there = there[cut.keeps(self.centers)]
        cubes, sides = [], []
        for way in range(len(_WAYS)):
            bare = there[~self._covered(there, way)]
            cubes.append(bare)
            sides.append(np.full(len(bare), way))
        cube, of = np.concatenate(cubes), np.concatenate(sides)
        return Squares(
            corners=self.centers[cube][:, None] + self.edge / 2 * _CORNERS[of],
            shares=self.shares[cube],
            axes=np.asarray(_AXES[of]),
        )

    def _covered(self, there: IntArray, way: int) -> BoolArray:
        """Which of some cubes have one of them next to them that way, (K,)."""
        if self._lattice is None:
            return np.zeros(len(there), dtype=bool)
        at = self._lattice[there]
        return np.isin(_key(at + _WAYS[way]), _key(at))


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


def _lattice(centers: FloatArray, edge: float) -> IntArray | None:
    """Whole numbers, from 1, that count edges along each axis, (K, 3); None if some lie between."""
    if not len(centers):
        return None
    count = (centers - centers.min(axis=0)) / edge
    if count.max() >= _WIDEST - 2 or np.abs(count - count.round()).max() > 0.01:
        return None
    return np.asarray(count.round(), dtype=np.int64) + 1


def _key(lattice: IntArray) -> IntArray:
    """One number for each, (K,)."""
    key: IntArray = lattice @ np.array([_WIDEST * _WIDEST, _WIDEST, 1])
    return key
