"""Coefficients learnt anew from each session alone, with errors by the jackknife over its blocks.

What a session does not show is left to priors and ridge, which know nothing of it: there its error
is as large as theirs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..study.recording import FloatArray
from .fit import Fit

_MATTERS = 0.05  # of a coefficient's error

Figures = Callable[[FloatArray], dict[str, float]]
"""Figures by name from all coefficients of a fit."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SessionFit:
    """What one session alone says."""

    beta: FloatArray  # (k,) of the session
    without: FloatArray  # (blocks, k) without one of its blocks after the other
    unseen: FloatArray  # (k,) standard deviation of what the session does not show

    def coefficient(self, k: int) -> tuple[float, float]:
        """A coefficient and the variance of its error."""
        count = len(self.without)
        return float(self.beta[k]), float((count - 1) * np.var(self.without[:, k])) + float(
            self.unseen[k] ** 2
        )

    def figure(self, figures: Figures, name: str) -> tuple[float, float]:
        """A figure and the variance of its error."""
        value = figures(self.beta)[name]
        parts = np.array([figures(beta)[name] for beta in self.without])
        count = len(parts)
        variance = (count - 1) / count * float(np.sum((parts - parts.mean()) ** 2))
        errors = np.std(self.without, axis=0) * np.sqrt(count)
        for k in np.flatnonzero(self.unseen > _MATTERS * errors):
            moved = self.beta.copy()
            moved[k] += self.unseen[k]
            variance += (figures(moved)[name] - value) ** 2
        return value, variance


def by_session(fit: Fit) -> tuple[SessionFit, ...]:
    """One for each session that the study tells of; none where it tells of fewer than two."""
    b = fit.balances
    if b.told is None:
        return ()
    grams, moments = fit.block_sums(as_measured=True)
    session = np.empty(len(grams), dtype=np.intp)
    session[b.block] = b.told[b.recording]
    return tuple(
        _alone(fit, grams[session == k], moments[session == k])
        for k in range(int(b.told.max()) + 1)
    )


def _alone(fit: Fit, grams: FloatArray, moments: FloatArray) -> SessionFit:
    gram, moment = grams.sum(axis=0), moments.sum(axis=0)
    without = [fit.solve(gram - g, moment - m) for g, m in zip(grams, moments, strict=True)]
    return SessionFit(
        beta=fit.solve(gram, moment), without=np.stack(without), unseen=_unseen(fit, gram)
    )


def _unseen(fit: Fit, gram: FloatArray) -> FloatArray:
    """Standard deviation that priors and ridge, which are no data, hide of each coefficient."""
    regular = fit.regular(gram)
    scale = 1.0 / np.sqrt(np.diag(regular))
    inverse = np.linalg.pinv(regular * np.outer(scale, scale), rcond=1e-12, hermitian=True)
    inverse = inverse * np.outer(scale, scale)
    hidden = inverse @ (regular - gram) @ inverse
    return np.asarray(np.sqrt(np.maximum(np.diag(hidden), 0.0)))
