"""Coefficients of bodies moved, at the least cost, to where some distribution of mass has them.

Least squares know nothing of mass: what little a motion shows of a link may come out as no body's
figures. The 4x4 matrix of second moments of a body is positive semidefinite (Wensing, Kim and
Slotine, IEEE RA-L 3(1), 2018), so it is a factor times its transpose. Nothing is asked of a factor,
and a flat body, where the least cost often lies, is a plain point among them (Burer and Monteiro,
Math. Program. 95, 2003).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import linalg, optimize

from pdoik.recordings import FloatArray

from ..simulation import Inertial

_ROUNDS = 20  # of bodies in turn
_STILL = 1e-6  # numerics: of a body's own size, that a round moves it
_EVEN = 1e-12  # added to the diagonal of a matrix of unit diagonal
_LEAST = 1e-5  # of the largest second moment: what a start is kept from being flat by


def with_real_bodies(
    beta: FloatArray, normal: FloatArray, bodies: Sequence[tuple[slice, FloatArray]]
) -> FloatArray:
    """Coefficients near `beta` with which every body is one.

    Args:
        beta: (k,) the coefficients of least cost.
        normal: (k, k) the cost's: (b - beta)' normal (b - beta) is what others cost more.
        bodies: the ten coefficients of each body, and what they are added to, (10,).

    Returns:
        (k,) `beta` itself where all are bodies already.
    """
    wrong = [
        (span, base) for span, base in bodies if not Inertial.from_ten(base + beta[span]).is_body
    ]
    if not wrong:
        return beta
    kept = np.zeros(len(beta), dtype=bool)
    for span, _ in wrong:
        kept[span] = True
    free = np.flatnonzero(~kept)
    among = np.flatnonzero(kept)
    inside = normal[np.ix_(among, among)]
    if len(free):
        cross = normal[np.ix_(free, among)]
        size = np.sqrt(np.maximum(np.diag(normal)[free], 1e-300))  # units differ by far
        even = normal[np.ix_(free, free)] / np.outer(size, size) + _EVEN * np.eye(len(free))
        follow = linalg.solve(even, cross / size[:, None], assume_a="pos") / size[:, None]
        inside = inside - cross.T @ follow
    place = {int(index): i for i, index in enumerate(among)}
    spans = [slice(place[span.start], place[span.start] + 10) for span, _ in wrong]
    x = beta[among].copy()
    for span, (_, base) in zip(spans, wrong, strict=True):
        x[span] = Inertial.from_ten(base + x[span]).nearest_body().ten() - base
    for _ in range(_ROUNDS):  # one after the other, each with the rest as it is
        before = x.copy()
        for span, (_, base) in zip(spans, wrong, strict=True):
            own = inside[span, span]
            pull = inside[span] @ (x - beta[among]) - own @ (x[span] - beta[among][span])
            wanted = beta[among][span] - linalg.lstsq(own, pull)[0]
            x[span] = nearest(wanted + base, own, x[span] + base) - base
        if np.abs(x - before).max() <= _STILL * np.abs(x).max():
            break
    result = beta.copy()
    result[among] = x
    if len(free):
        result[free] -= follow @ (x - beta[among])
    return result


def nearest(wanted: FloatArray, metric: FloatArray, start: FloatArray) -> FloatArray:
    """The body's ten parameters (10,) nearest to `wanted` by a metric (10, 10), from a body."""
    values, vectors = np.linalg.eigh(metric)
    root = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T

    def left(theta: FloatArray) -> FloatArray:
        return np.asarray(root @ (_ten(theta) - wanted))

    return _ten(optimize.least_squares(left, _theta(start), max_nfev=500, xtol=1e-10).x)


def _ten(theta: FloatArray) -> FloatArray:
    """The ten parameters of a factor's sixteen numbers."""
    L = theta.reshape(4, 4)
    whole = L @ L.T
    S = whole[:3, :3]
    body = Inertial(
        mass=float(whole[3, 3]), first_moment=whole[:3, 3], inertia=np.trace(S) * np.eye(3) - S
    )
    return body.ten()


def _theta(ten: FloatArray) -> FloatArray:
    """The factor of a body; of a flat one that of one that is not quite flat."""
    body = Inertial.from_ten(ten)
    S = 0.5 * np.trace(body.inertia) * np.eye(3) - body.inertia
    whole = np.block([[S, body.first_moment[:, None]], [body.first_moment[None], body.mass]])
    size = np.sqrt(np.maximum(np.diag(whole), _LEAST * max(float(np.diag(whole).max()), 1e-9)))
    values, vectors = np.linalg.eigh(whole / np.outer(size, size))
    whole = (vectors * np.maximum(values, _LEAST)) @ vectors.T * np.outer(size, size)
    return np.linalg.cholesky(whole).ravel()
