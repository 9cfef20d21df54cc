"""The columns of many terms at one balance, in the blocks they came in."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..study.recording import FloatArray

_MOST = 8  # blocks, before they are made one

Rows = NDArray[np.intp] | NDArray[np.bool_] | slice


class Design:
    """A matrix (N, w) that grows by blocks of columns, which nobody copies."""

    def __init__(self, rows: int, blocks: tuple[FloatArray, ...] = ()) -> None:
        self._rows, self._made = rows, blocks
        self._of: tuple[Design, Rows] | None = None  # whose rows these are, until they are asked

    @property
    def _blocks(self) -> tuple[FloatArray, ...]:
        if self._of is not None:
            whole, rows = self._of
            self._made, self._of = tuple(each[rows] for each in whole._blocks), None
        return self._made

    @property
    def width(self) -> int:
        """Number of columns."""
        return sum(each.shape[1] for each in self._blocks)

    def __matmul__(self, factors: FloatArray) -> FloatArray:
        """The product with factors (w,) or (w, k)."""
        product = np.zeros((self._rows, *factors.shape[1:]))
        first = 0
        for block in self._blocks:
            last = first + block.shape[1]
            product += block @ factors[first:last]
            first = last
        return product

    def against(self, values: FloatArray) -> FloatArray:
        """The transposed matrix times values (N,) or (N, k)."""
        if not self._blocks:
            return np.zeros((0, *values.shape[1:]))
        return np.concatenate([block.T @ values for block in self._blocks])

    def at(self, rows: Rows) -> Design:
        """Some of the rows."""
        some = Design(len(np.arange(self._rows)[rows]))
        some._of = self, rows
        return some

    def kept(self, columns: NDArray[np.bool_]) -> Design:
        """Some of the columns."""
        blocks, first = [], 0
        for block in self._blocks:
            here = columns[first : first + block.shape[1]]
            first += block.shape[1]
            if here.any():
                blocks.append(block if here.all() else block[:, here])
        return Design(self._rows, tuple(blocks))

    def beside(self, block: FloatArray) -> Design:
        """With one block more; where blocks are many, they are first made one."""
        if len(self._blocks) >= _MOST:
            self._made = (np.hstack(self._blocks),)
        return Design(self._rows, (*self._blocks, block))

    def gram(self) -> FloatArray:
        """The transposed matrix times the matrix, (w, w)."""
        whole: Any = np.hstack(self._blocks) if self._blocks else np.zeros((self._rows, 0))
        return np.asarray(whole.T @ whole)
