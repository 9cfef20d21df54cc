"""What speaks for an event: a push, or a limit that one session alone reaches.

It cannot repeat, so no session can be left out. It is learnt on one half of its rows, every other
quarter, and scored on the other half, in turn; and it is compared with what the same joints show at
other times, which nothing explains either: a misfit that is common is no event.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pdoik.recordings import FloatArray

from ..findings import Support
from ..identify import acting
from ..motion import Key
from ..regression import Fit, Index, Term, wald

_SEEN = 1e-4  # of the strongest direction of a force: what motors feel less of is left at zero


def event_support(others: Fit, term: Term, start: Fit) -> Support:
    """Support of an event, which is not in the fit.

    Args:
        others: the fit without it.
        term: the event.
        start: of nothing, which leaves all.
    """
    felt = others.balances.thresholds.diagnosis.little
    at = {
        key: np.flatnonzero(acting(column[others.rows[key]], felt))
        for key, column in term.columns.items()
    }
    rows = np.concatenate([others.rows[key][where] for key, where in at.items()])
    ends = np.quantile(rows, (0.25, 0.5, 0.75))
    halves = []
    for odd in (0, 1):  # the first and third quarter, then the others
        half = {
            key: where[np.searchsorted(ends, others.rows[key][where]) % 2 == odd]
            for key, where in at.items()
        }
        rest = {key: np.setdiff1d(where, half[key]) for key, where in at.items()}
        force = np.ones(1) if term.fixed else _force(others, term, rest)
        halves.append(sum(_gained(others, term, force, key, each) for key, each in half.items()))
    total, count = float(sum(halves)), len(rows)
    began = sum(float(np.sum(start.target[key][where] ** 2)) for key, where in at.items())
    usual = _usual(others, at)
    size = total / max(count, 1)
    return Support(
        weight=float(np.clip(total / max(began, 1e-12), 0.0, 1.0)),
        gain=size / (size + usual) if size > 0.0 else size / usual,
        t=wald(others.extended(term), term),
        size=float(np.sign(size) * np.sqrt(abs(size))),
        agree=sum(gain > 0.0 for gain in halves),
        sessions=2,
        blocks=2,
        left=float(np.sqrt(usual)),
        rivals=0,
        event=True,
    )


def _gained(others: Fit, term: Term, force: FloatArray, key: Key, at: Index) -> float:
    """Decrease of the squared residual of a balance on some rows."""
    before = others.residual(key)[at]
    part = term.columns[key][others.rows[key][at]] @ force / others.balances.sigma[key]
    return float(np.sum(before**2 - (before - part) ** 2))


def _usual(others: Fit, at: Mapping[Key, Index]) -> float:
    """Mean square that nothing explains at the same balances at other times; noise at least."""
    squares = [np.delete(others.residual(key), where) ** 2 for key, where in at.items()]
    elsewhere = np.concatenate(squares)
    return max(float(elsewhere.mean()) if len(elsewhere) else 1.0, 1.0)


def _force(others: Fit, term: Term, at: Mapping[Key, Index]) -> FloatArray:
    """Coefficients of an event on some of its rows."""
    gram, moment = np.diag(term.prior + 1e-9), np.zeros(term.width)
    for key, where in at.items():
        part = term.columns[key][others.rows[key][where]] / others.balances.sigma[key]
        gram += part.T @ part
        moment += part.T @ others.residual(key)[where]
    return np.asarray(np.linalg.lstsq(gram, moment, rcond=_SEEN)[0])
