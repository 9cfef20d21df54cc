"""The manifold of Gram matrices of rank 3, quicker than pymanopt's own at this one size."""

import numpy as np
from pymanopt.manifolds import PSDFixedRank

from bench.common.arrays import FloatArray


class GramRank3(PSDFixedRank):
    """Y, (n, 3), up to turns and reflections: pymanopt's quotient, its steps in closed form.

    A tangent vector is horizontal if it does not turn Y. Turning it about axis k gives the
    direction Y [e_k]_x; horizontal is what is orthogonal to all three.
    """

    def __init__(self, n: int) -> None:
        super().__init__(n, 3)
        self._last: FloatArray | None = None
        self._basis = np.empty((3 * n, 3))

    def projection(self, point: FloatArray, vector: FloatArray) -> FloatArray:
        """The horizontal part of a vector, (n, 3)."""
        Q, v = self.turns(point), vector.ravel()
        return np.asarray(v - Q @ (v @ Q)).reshape(vector.shape)

    def turns(self, point: FloatArray) -> FloatArray:
        """An orthonormal basis of the directions that turn a point, (3 n, 3); kept for the last."""
        if self._last is not point:
            Y = point
            directions = np.zeros((*Y.shape, 3))
            directions[:, 1, 0], directions[:, 2, 0] = Y[:, 2], -Y[:, 1]
            directions[:, 2, 1], directions[:, 0, 1] = Y[:, 0], -Y[:, 2]
            directions[:, 0, 2], directions[:, 1, 2] = Y[:, 1], -Y[:, 0]
            self._basis = np.linalg.qr(directions.reshape(-1, 3))[0]
            self._last = point
        return self._basis

    to_tangent_space = projection

    def inner_product(self, point: FloatArray, a: FloatArray, b: FloatArray) -> float:
        """Euclidean."""
        return float(np.vdot(a, b))

    def norm(self, point: FloatArray, tangent_vector: FloatArray) -> float:
        """Euclidean [m]."""
        return float(np.sqrt(np.vdot(tangent_vector, tangent_vector)))

    def transport(self, a: FloatArray, b: FloatArray, tangent_vector: FloatArray) -> FloatArray:
        """Transport by projection."""
        return self.projection(b, tangent_vector)
