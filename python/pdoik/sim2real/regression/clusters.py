"""Errors of least squares whose rows are not independent: sums over blocks count, not rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray


def clustered(
    inverse: FloatArray, rows: FloatArray, left: FloatArray, block: NDArray[np.intp]
) -> tuple[FloatArray, int]:
    """Covariance of the figures, and how many blocks say anything.

    Args:
        inverse: (p, p) of the rows' gram.
        rows: (N, p).
        left: (N,) what the figures leave.
        block: (N,) numbers from 0.
    """
    scores = np.zeros((int(block.max(initial=-1)) + 1, rows.shape[1]))
    np.add.at(scores, block, rows * left[:, None])
    scores = scores[np.abs(scores).sum(axis=1) > 0.0]
    return inverse @ (scores.T @ scores) @ inverse, len(scores)
