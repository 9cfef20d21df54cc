"""How clearly a fit's last term differs from nothing, by clusters of rows that err alike.

Errors of neighbouring rows are alike, and count as fewer.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..motion import Balances
from .fit import Fit, Index, Term


def repeats(parts: Iterable[FloatArray]) -> float:
    """One and twice the sum of the autocorrelation of stretches of a residual.

    Sums end where the correlation first is no longer positive (Geyer, Statistical Science 7(4),
    1992).
    """
    total = np.zeros(0)
    for each in parts:
        if not len(each):
            continue
        spectrum = np.abs(np.fft.rfft(each, 2 * len(each))) ** 2
        own = np.fft.irfft(spectrum)[: len(each)]
        size = max(len(total), len(own))
        total = np.pad(total, (0, size - len(total))) + np.pad(own, (0, size - len(own)))
    if not len(total) or total[0] <= 0.0:
        return 1.0
    correlation = total / total[0]
    below = np.flatnonzero(correlation <= 0.0)
    last = int(below[0]) if len(below) else len(correlation)
    return float(1.0 + 2.0 * np.sum(correlation[1:last]))


def repeats_of(balances: Balances, rows: NDArray[np.intp], left: FloatArray) -> float:
    """The same of what is left on some rows, nothing on the others."""
    series = np.zeros(balances.count)
    series[rows] = left
    return repeats(np.split(series, balances.starts[1:-1]))


def wald(fit: Fit, term: Term) -> float:
    """How clearly the last term's coefficients differ from zero.

    The square root of beta' V^-1 beta / k, with V of `robust`. For a fixed term the coefficient
    is fitted with the others, around its 1.
    """
    free = fit if not term.fixed else fit.extended(_freed(term))
    beta = free.beta[-term.width :].copy()
    if term.fixed:
        beta += 1.0
    values, vectors = np.linalg.eigh(robust(free, term))
    keep = values > 1e-10 * values.max()
    along = vectors[:, keep].T @ beta
    rank = max(int(keep.sum()), 1)
    return float(np.sqrt(np.sum(along**2 / values[keep]) / rank))


def robust(fit: Fit, term: Term) -> FloatArray:
    """Cluster-robust covariance of the last term's coefficients, (k, k).

    Residuals count by clusters of neighbouring rows: the blocks, or parts of them where the
    term acts in few (Cameron and Miller, J. Human Resources 50(2), 2015).
    """
    clusters, count = clusters_of(fit, term)
    scale, even = fit.even(fit.gram)
    inverse = (np.linalg.inv(even) * np.outer(scale, scale))[-term.width :]
    scores = np.zeros((term.width, count))
    for key, design in fit.design.items():
        index = fit.index[key]
        if not len(index):
            continue
        each, of = design @ inverse[:, index].T, clusters[fit.rows[key]]
        left = fit.residual(key)
        for k in range(term.width):
            scores[k] += np.bincount(of, each[:, k] * left, minlength=count)
    return np.asarray(scores @ scores.T * count / max(count - fit.size, 1))


def _freed(term: Term) -> Term:
    """A fixed term's column with a free coefficient."""
    return Term(
        effect="free",
        place=term.place,
        shape=term.shape,
        columns=term.columns,
        prior=np.zeros(1),
    )


def clusters_of(fit: Fit, term: Term) -> tuple[Index, int]:
    """Cluster of every row: the blocks, or parts of them where the term acts in few."""
    b, least = fit.balances, fit.balances.thresholds.diagnosis
    parts = 1
    while True:
        length = max(1, int(np.median(np.bincount(b.block)) / parts))
        order = np.arange(b.count)
        within = order - np.concatenate([[0], np.flatnonzero(np.diff(b.block)) + 1])[b.block]
        number = b.block * (parts + 1) + np.minimum(within // length, parts)
        active = set()
        for key, column in term.columns.items():
            rows = fit.rows[key]
            energy = np.sum(column[rows] ** 2, axis=1)
            if len(energy):
                active |= set(number[rows[energy > least.nothing * energy.max()]].tolist())
        step = 1.0 / (3.0 * b.motions[0].cutoff)
        if len(active) >= least.fewest_stretches or length * step <= least.shortest:
            return number.astype(np.intp), int(number.max()) + 1
        parts *= 2
