"""OctoMaps as obstacles: what their leaves take, put together to few boxes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik._core import Shape
from pdoik._octree import IntArray, Octree, OctreeError, read_octree
from pdoik.errors import LoadError

FloatArray = npt.NDArray[np.float64]
Boxes = tuple[FloatArray, FloatArray]
"""The lowest and the highest corner of each, (N, 3) [m]."""

_BLOCK = 128  # cells along an edge, put together at once; a power of two, as leaves are
_MOST_BLOCKS = 4096  # that are looked through for what is unknown


def boxes_of_file(
    path: Path, *, unknown: bool = False, region: npt.ArrayLike | None = None
) -> Boxes:
    """What a .bt or .ot file takes; see `boxes_of`.

    Raises:
        LoadError: The file cannot be read, or nothing in it is taken.
    """
    try:
        return boxes_of(read_octree(path.read_bytes()), unknown=unknown, region=region)
    except OSError as error:
        raise LoadError(f"{path}: cannot be read: {error.strerror or error}") from error
    except OctreeError as error:
        raise LoadError(f"{path}: {error}") from error


def boxes_of(tree: Octree, *, unknown: bool = False, region: npt.ArrayLike | None = None) -> Boxes:
    """What is taken, as boxes that do not overlap.

    Args:
        tree: With what is known.
        unknown: Whether what is not known is taken, too: in the region, or without one in the
            smallest box that holds what is known.
        region: The lowest and the highest x, y, z of what counts, (2, 3) [m]; None for all.

    Raises:
        OctreeError: Nothing is taken; the region is none, or holds too much that is not known.
    """
    low, high = _counting(tree, region)
    inside = ((tree.low < high) & (tree.low + tree.size[:, None] > low)).all(axis=1)
    leaves = Octree(tree.resolution, tree.low[inside], tree.size[inside], tree.taken[inside])
    found = list(_not_free(leaves, low, high)) if unknown else list(_taken(leaves))
    if not found:
        where = "in the region " if region is not None else ""
        raise OctreeError(f"nothing {where}is taken")
    lowest = tree.resolution * np.concatenate([corners for corners, _ in found])
    highest = tree.resolution * np.concatenate([corners for _, corners in found])
    if region is not None:
        bounds = np.asarray(region, dtype=np.float64)
        lowest, highest = np.maximum(lowest, bounds[0]), np.minimum(highest, bounds[1])
        thick = (lowest < highest).all(axis=1)
        lowest, highest = lowest[thick], highest[thick]
    return lowest, highest


def _counting(tree: Octree, region: npt.ArrayLike | None) -> tuple[IntArray, IntArray]:
    """The cells that count: the lowest, and those behind the highest, (3,)."""
    if region is None:
        if not len(tree.size):
            raise OctreeError("it holds nothing")
        return tree.low.min(axis=0), (tree.low + tree.size[:, None]).max(axis=0)
    bounds = np.asarray(region, dtype=np.float64)
    if bounds.shape != (2, 3) or not np.isfinite(bounds).all() or (bounds[0] >= bounds[1]).any():
        raise OctreeError(
            f"expected a region of the lowest and the highest x, y, z, shape (2, 3), got {region!r}"
        )
    cells = np.clip(bounds / tree.resolution, -(2**20), 2**20)
    return np.floor(cells[0]).astype(np.int64), np.ceil(cells[1]).astype(np.int64)


def _taken(leaves: Octree) -> Iterator[tuple[IntArray, IntArray]]:
    """Boxes of what is known to be taken, in cells."""
    low, size = leaves.low[leaves.taken], leaves.size[leaves.taken]
    large = size >= _BLOCK
    if large.any():
        yield low[large], low[large] + size[large, None]
    for block, mine in _blocks(low[~large]):
        cells = np.zeros((_BLOCK,) * 3, dtype=bool)
        _fill(cells, low[~large][mine] - block, size[~large][mine], True)
        yield from _merged(cells, block)


def _not_free(leaves: Octree, low: IntArray, high: IntArray) -> Iterator[tuple[IntArray, IntArray]]:
    """Boxes of what is not known to be free between two corners, in cells."""
    free_low, free_size = leaves.low[~leaves.taken], leaves.size[~leaves.taken]
    first, last = low // _BLOCK, -(-high // _BLOCK)
    if np.prod(last - first, dtype=np.float64) > _MOST_BLOCKS:
        raise OctreeError("what is unknown is too much to be taken: give a region that is smaller")
    small = free_size < _BLOCK
    mine_of = {tuple(block): mine for block, mine in _blocks(free_low[small])}
    for place in np.ndindex(*(last - first)):
        block = (first + place) * _BLOCK
        cells = np.zeros((_BLOCK,) * 3, dtype=bool)
        begin, end = np.maximum(low - block, 0), np.minimum(high - block, _BLOCK)
        cells[tuple(map(slice, begin, end))] = True
        for k in np.flatnonzero(~small):
            if ((block >= free_low[k]) & (block < free_low[k] + free_size[k])).all():
                cells[:] = False
        mine = mine_of.get(tuple(block))
        if mine is not None:
            _fill(cells, free_low[small][mine] - block, free_size[small][mine], False)
        yield from _merged(cells, block)


def _blocks(low: IntArray) -> Iterator[tuple[IntArray, IntArray]]:
    """The lowest corner of each block that has some of these cubes, and which."""
    if not len(low):
        return
    corners, of = np.unique(low // _BLOCK * _BLOCK, axis=0, return_inverse=True)
    order = np.argsort(of.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(of.ravel()))
    yield from zip(corners, np.split(order, ends[:-1]), strict=True)


def _fill(cells: npt.NDArray[np.bool_], low: IntArray, size: IntArray, value: bool) -> None:
    single = size == 1
    cells[tuple(low[single].T)] = value
    for (x, y, z), edge in zip(low[~single].tolist(), size[~single].tolist(), strict=True):
        cells[x : x + edge, y : y + edge, z : z + edge] = value


def _merged(cells: npt.NDArray[np.bool_], block: IntArray) -> Iterator[tuple[IntArray, IntArray]]:
    if cells.any():
        corners = np.rint(Shape.grid("block", cells, 1.0).vertices).astype(np.int64) + block
        yield corners[0::2], corners[1::2]
