"""Coefficients learnt anew from each session alone, with errors by the jackknife.

Over its blocks; and where sessions have several recordings, over these: a law that is not quite
right fits each motion with figures of its own, which is no change from day to day. What a session
does not show is left to priors and ridge, which know nothing of it: there its error is as large as
theirs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..study.recording import FloatArray
from .fit import Fit

_MATTERS = 0.05  # of a coefficient's error


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SessionFit:
    """What one session alone says."""

    beta: FloatArray  # (k,) of the session
    without_block: FloatArray  # (blocks, k) without one of its blocks after the other
    without_recording: FloatArray  # (recordings, k) the same of its recordings; (0, k) of one alone
    unseen: FloatArray  # (k,) standard deviation of what the session does not show


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BySession:
    """One figure as each session has it."""

    values: FloatArray  # (S,)
    variances: FloatArray  # (S,) of their errors
    freedom: int  # degrees of freedom of the variances together


def by_session(fit: Fit) -> tuple[SessionFit, ...]:
    """One for each session that the study tells of; none where it tells of fewer than two."""
    b = fit.balances
    if b.told is None:
        return ()
    grams, moments = fit.block_sums(as_measured=True)
    recording = np.empty(len(grams), dtype=np.intp)
    recording[b.block] = b.recording
    session = b.told[recording]
    return tuple(
        _alone(fit, grams[session == k], moments[session == k], recording[session == k])
        for k in range(int(b.told.max()) + 1)
    )


def figure_by_session(
    sessions: Sequence[SessionFit], figure: Callable[[FloatArray], float]
) -> BySession:
    """A figure of all coefficients, (k,), as each session has it.

    Where recordings of one session differ by more than their blocks tell, all errors are larger
    by as much.
    """
    values = np.array([figure(each.beta) for each in sessions])
    own = np.array([_jackknife(each.without_block, figure) for each in sessions])
    freedom = sum(len(each.without_block) - 1 for each in sessions)
    several = [k for k, each in enumerate(sessions) if len(each.without_recording)]
    if several:
        apart = [_jackknife(sessions[k].without_recording, figure) for k in several]
        larger = float(np.sum(apart)) / max(float(np.sum(own[several])), 1e-300)
        if larger > 1.0:
            own = own * larger
            freedom = sum(len(sessions[k].without_recording) - 1 for k in several)
    hidden = np.array([_hidden(each, figure) for each in sessions])
    return BySession(values=values, variances=own + hidden, freedom=freedom)


def _alone(
    fit: Fit, grams: FloatArray, moments: FloatArray, recording: NDArray[np.intp]
) -> SessionFit:
    gram, moment = grams.sum(axis=0), moments.sum(axis=0)

    def without(groups: NDArray[np.intp]) -> FloatArray:
        names = np.unique(groups)
        if len(names) < 2:
            return np.zeros((0, fit.size))
        kept = [groups != name for name in names]
        return np.stack([fit.solve(grams[k].sum(axis=0), moments[k].sum(axis=0)) for k in kept])

    return SessionFit(
        beta=fit.solve(gram, moment),
        without_block=without(np.arange(len(grams))),
        without_recording=without(recording),
        unseen=_unseen(fit, gram),
    )


def _jackknife(without: FloatArray, figure: Callable[[FloatArray], float]) -> float:
    """Variance of a figure, from what it is without one part after the other; of one: infinite."""
    if not len(without):
        return np.inf
    return (len(without) - 1) * float(np.var([figure(beta) for beta in without]))


def _hidden(session: SessionFit, figure: Callable[[FloatArray], float]) -> float:
    """Variance of a figure by what the session does not show."""
    value, variance = figure(session.beta), 0.0
    if not len(session.without_block):
        return np.inf
    errors = np.std(session.without_block, axis=0) * np.sqrt(len(session.without_block))
    for k in np.flatnonzero(session.unseen > _MATTERS * errors):
        moved = session.beta.copy()
        moved[k] += session.unseen[k]
        variance += (figure(moved) - value) ** 2
    return variance


def _unseen(fit: Fit, gram: FloatArray) -> FloatArray:
    """Standard deviation that priors and ridge, which are no data, hide of each coefficient."""
    regular = fit.regular(gram)
    scale = 1.0 / np.sqrt(np.diag(regular))
    inverse = np.linalg.pinv(regular * np.outer(scale, scale), rcond=1e-12, hermitian=True)
    inverse = inverse * np.outer(scale, scale)
    hidden = inverse @ (regular - gram) @ inverse
    return np.asarray(np.sqrt(np.maximum(np.diag(hidden), 0.0)))
