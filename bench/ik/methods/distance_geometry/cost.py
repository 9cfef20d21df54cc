"""How far a set of points is from its distances: the cost, its gradient and its Hessian.

After Maric et al. 2021. With a row A_e of weights for each edge, d_e = A_e Y and
    r_e = d_e.d_e - clip(d_e.d_e, lower_e, upper_e)
the cost is sum r_e^2, half the squared Frobenius norm over the symmetric matrix of all pairs. It
depends on Y Y^T only. Edges between two nodes have weights 1 and -1; an obstacle's have more.
"""

import numpy as np

from bench.common.arrays import FloatArray


class DistanceCost:
    """Cost [m^4] of a factor Y, (N, 3) [m]; keeps what the last Y gave, which must not change."""

    def __init__(self, incidence: FloatArray, lower: FloatArray, upper: FloatArray) -> None:
        self._A = incidence  # (m, N)
        self._lower, self._upper = lower, upper  # (m,) [m^2]
        self._known = lower == upper
        self.evaluations = 0
        self._Y: FloatArray | None = None
        self._hessian_Y: FloatArray | None = None

    def __call__(self, Y: FloatArray) -> float:
        self._update(Y)
        return float(self._r @ self._r)

    def gradient(self, Y: FloatArray) -> FloatArray:
        """4 A^T diag(r) A Y, (N, 3)."""
        self._update(Y)
        rows = np.flatnonzero(self._r)  # most obstacles are far away
        return np.asarray(4.0 * (self._A[rows].T @ (self._r[rows, None] * self._d[rows])))

    def hessian(self, Y: FloatArray, Z: FloatArray) -> FloatArray:
        """Derivative of the gradient along Z, (N, 3).

        4 A^T diag(r) A Z + 8 sum_e A_e^T (d_e.A_e Z) d_e over the edges not strictly inside their
        range, as one matrix that all products at the same Y share.
        """
        self._assemble(Y)
        return np.asarray(self._H @ Z.ravel()).reshape(Z.shape)

    def _assemble(self, Y: FloatArray) -> None:
        if self._hessian_Y is not Y:
            self._update(Y)
            active = np.flatnonzero((self._r != 0) | self._known)
            A, d, r = self._A[active], self._d[active], self._r[active]
            N = A.shape[1]
            B = (A[:, :, None] * d[:, None, :]).reshape(len(active), 3 * N)
            H = 8.0 * (B.T @ B)
            laplacian = 4.0 * (A.T @ (r[:, None] * A))
            for axis in range(3):
                H[axis::3, axis::3] += laplacian
            self._H, self._hessian_Y = H, Y

    def _update(self, Y: FloatArray) -> None:
        if self._Y is Y:
            return
        self.evaluations += 1
        self._d = self._A @ Y  # (m, 3)
        squared = np.einsum("ij,ij->i", self._d, self._d)
        self._r = squared - np.minimum(np.maximum(squared, self._lower), self._upper)
        self._Y = Y
