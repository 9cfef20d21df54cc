"""A first set of points from the distances alone, as the public implementation starts by default.

Bounds that are not known follow from the triangle inequality; distances 9/10 of the way from lower
to upper are embedded by classical scaling, in as many dimensions as they need; and of these, the
three are kept along which the known distances extend most. Obstacles, which are no nodes here,
have no part in it.
"""

import numpy as np
import numpy.typing as npt

from bench.common.arrays import FloatArray

FRACTION = 0.9  # of the way from the lower bound to the upper one
NEGLIGIBLE = 1e-8  # eigenvalue of a Gram matrix that counts as none [m^2]


def smoothed(lower: FloatArray, upper: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Bounds of all distances by the triangle inequality, (N, N) each.

    They are symmetric, and 0 or inf where nothing is known [m].
    """
    lower, upper = lower.copy(), upper.copy()
    for k in range(len(upper)):  # Floyd and Warshall
        np.minimum(upper, upper[:, [k]] + upper[[k], :], out=upper)
    for k in range(len(upper)):
        detour = lower[:, [k]] - upper[[k], :]
        np.maximum(lower, np.maximum(detour, detour.T), out=lower)
    return lower, upper


def embedded(lower: FloatArray, upper: FloatArray, known: npt.NDArray[np.int_]) -> FloatArray:
    """Points in space whose distances are roughly within smoothed bounds, (N, 3) [m].

    The pairs whose distance is known are (m, 2).
    """
    squared = (lower + FRACTION * (upper - lower)) ** 2
    centered = squared - squared.mean(axis=0)
    gram = -0.5 * (centered - centered.mean(axis=1, keepdims=True))
    values, vectors = np.linalg.eigh(gram)
    kept = values > NEGLIGIBLE
    X = vectors[:, kept] * np.sqrt(values[kept])
    i, j = known.T
    edges = X[i] - X[j]
    _, directions = np.linalg.eigh(edges.T @ edges)  # ascending
    return np.asarray(X @ directions[:, :-4:-1])
