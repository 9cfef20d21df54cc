"""Least squares of many columns by blocks of time: normal equations of each, then small algebra."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..study.recording import FloatArray
from .experiment import Experiment
from .sensitivities import Sensitivities

Indices = NDArray[np.intp]
_RIDGE = 1e-3  # of a step, against errors: only keeps columns that show nothing at zero
_FOLDS = 6


@dataclass(frozen=True, kw_only=True, eq=False)
class Blocks:
    """What blocks of time say of x: loss_b(x) = c_b - 2 g_b x + x G_b x, in squared errors.

    x is the change from the user's model in steps, of P knobs; errors are over the channels'
    present size, so that a channel counts by how well it is explained and not by its unit.
    """

    G: FloatArray  # (B, P, P)
    g: FloatArray  # (B, P)
    c: FloatArray  # (B,)
    lowest: FloatArray  # (P,)
    rows: FloatArray  # (B,) numbers in each
    folds: Indices  # (B,) stretches of neighbours

    @classmethod
    def of(cls, experiment: Experiment, about: Sensitivities, sigma: FloatArray) -> Blocks:
        """From sensitivities about a candidate, errors over sigma (C,)."""
        from_base = experiment.measured - about.shown
        from_base = from_base + np.einsum("prc,p->rc", about.J, about.at)
        r, J = from_base / sigma, about.J / sigma
        count = int(experiment.block.max()) + 1
        G, g = np.empty((count, len(J), len(J))), np.empty((count, len(J)))
        c, rows = np.empty(count), np.empty(count)
        for b in range(count):
            at = experiment.block == b
            mine, left = J[:, at].reshape(len(J), -1), r[at].reshape(-1)
            G[b], g[b], c[b] = mine @ mine.T, mine @ left, float(left @ left)
            rows[b] = left.size
        folds = np.minimum(np.arange(count) * _FOLDS // count, _FOLDS - 1)
        return cls(G=G, g=g, c=c, lowest=about.lowest, rows=rows, folds=folds)

    def solve(self, chosen: Sequence[int]) -> FloatArray:
        """The best x (P,), zero but at the chosen knobs, within bounds."""
        x = np.zeros(self.g.shape[1])
        x[list(chosen)] = self._solved(self._sums[-1], list(chosen))
        return x

    def foreseen(self, chosen: Sequence[int]) -> FloatArray:
        """Loss of each block by an x that was learnt from the other folds, (B,)."""
        k = list(chosen)
        out = self.c.copy()
        if not k:
            return out
        for fold, rest in enumerate(self._sums[:-1]):
            x = self._solved(rest, k)
            mine = self._blocks[fold]
            G = self.G[mine][:, k][:, :, k]
            out[mine] += (G @ x) @ x - 2.0 * self.g[mine][:, k] @ x
        return out

    @cached_property
    def _blocks(self) -> list[slice]:
        """Of each fold."""
        ends = np.searchsorted(self.folds, np.arange(int(self.folds.max()) + 2))
        return [slice(int(a), int(b)) for a, b in pairwise(ends)]

    @cached_property
    def _sums(self) -> list[tuple[FloatArray, FloatArray]]:
        """G and g of all blocks but those of a fold, for each; of all at the end."""
        G, g = self.G.sum(axis=0), self.g.sum(axis=0)
        rest = [(G - self.G[m].sum(axis=0), g - self.g[m].sum(axis=0)) for m in self._blocks]
        return [*rest, (G, g)]

    def _solved(self, sums: tuple[FloatArray, FloatArray], chosen: list[int]) -> FloatArray:
        """The chosen knobs' x, (K,); one that would leave its bounds is held there."""
        k = np.array(chosen, dtype=np.intp)
        G, g = sums[0][np.ix_(k, k)], sums[1][k]
        x, free = np.zeros(len(k)), np.ones(len(k), dtype=bool)
        while free.any():
            A = G[np.ix_(free, free)]
            A[np.diag_indices_from(A)] += _RIDGE
            x[free] = np.linalg.solve(A, g[free] - G[np.ix_(free, ~free)] @ x[~free])
            under = free & (x < self.lowest[k])
            if not under.any():
                break
            x[under] = self.lowest[k][under]
            free &= ~under
        return x

    def covariance(self, chosen: Sequence[int], x: FloatArray) -> FloatArray:
        """Of the chosen knobs' x by how blocks pull at it, (K, K): no matter how errors go on."""
        k = list(chosen)
        H = np.linalg.inv(self.G.sum(axis=0)[np.ix_(k, k)] + _RIDGE * np.eye(len(k)))
        pulls = self.g[:, k] - np.einsum("bpq,q->bp", self.G[:, k, :], x)
        count = len(pulls)
        spread = pulls.T @ pulls * count / max(count - 1, 1)
        return np.asarray(H @ spread @ H)


def t_of(gains: FloatArray) -> float:
    """Mean of the blocks' gains over its standard error."""
    error = float(np.std(gains, ddof=1)) / np.sqrt(len(gains)) if len(gains) > 1 else np.inf
    return float(np.mean(gains)) / max(error, 1e-300)
