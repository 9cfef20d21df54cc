"""What a cause gains on rows from which its coefficients were not learnt, and how large it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.bodies import LinkInertials
from ..effects.drives import TorqueGain
from ..findings import HadBy, Support
from ..regression import TRUST, Fit, Term, Tolerance
from ..thresholds import DiagnosisThresholds
from .model import LEAST_OWN, unexplained
from .ordinary import OF_JOINTS, days_of

TRUSTED = (TRUST, Tolerance.id, TorqueGain.id)
"""What no cause is made up for by: how far it is off is in the cause's odds."""

_ACTS = 0.05  # numerics: of a column's mean square, from which a row counts as one where it acts


def held_out_support(
    fit: Fit,
    start: Fit,
    term: Term,
    log_odds: float,
    rivals: int = 0,
    anomalous: Sequence[Term] = (),
    had_by: HadBy = "all",
) -> Support:
    """Support of one of a fit's terms given all others, recordings or parts of them left out.

    Args:
        fit: of all that is in the model.
        start: of nothing, with the same noise.
        term: one of the fit's.
        log_odds: that it is there.
        rivals: names that do as well.
        anomalous: all causes that are not ordinary: smaller ones count as what nothing explains.
        had_by: machines that have its effect.
    """
    others = fit.without(term, *days_of(fit.terms, term))
    b = fit.balances
    if _folds_given(fit, term) > 1:
        before, after = others.held_out(), fit.held_out()
    else:  # what acts in one part alone is learnt where it acts, or nowhere
        before = {key: others.residual(key) for key in others.design}
        after = {key: fit.residual(key) for key in fit.design}
    count = int(b.block.max()) + 1
    gained, began, rows_acting, left = np.zeros(count), 0.0, 0, 0.0
    by_fold = np.zeros(fit.folds)
    seen = np.zeros(fit.folds, dtype=bool)
    first = own = 0.0
    for key, column in term.columns.items():
        if key not in fit.design or not len(fit.rows[key]):
            continue
        at = acting(column[fit.rows[key]])
        rows = fit.rows[key][at]
        gain = before[key][at] ** 2 - after[key][at] ** 2
        gained += np.bincount(b.block[rows], gain, minlength=count)
        by_fold += np.bincount(b.fold[rows], gain, minlength=fit.folds)
        seen |= np.bincount(b.fold[rows], minlength=fit.folds) > 0
        each = float(np.sum(before[key][at] ** 2))
        noise = len(rows) * (b.floor[key] / b.sigma[key]) ** 2
        began += max(each - noise, LEAST_OWN * each)
        first += float(np.sum(start.target[key] ** 2))
        own += float(np.sum(fit.part(term, key) ** 2)) / b.sigma[key] ** 2
        left += float(np.sum(after[key][at] ** 2))
        rows_acting += len(rows)
    used = gained[gained != 0.0]
    error = float(np.std(used) * np.sqrt(len(used))) if len(used) > 1 else np.inf
    total = float(gained.sum())
    return Support(
        log_odds=log_odds,
        had_by=had_by,
        weight=float(np.sqrt(own / max(first, 1e-12))),
        gain=min(total / max(began, 1e-12), 1.0),
        t=total / max(error, 1e-12),
        size=_size(fit, term, anomalous),
        agree=int(np.count_nonzero(by_fold[seen] > 0.0)),
        sessions=int(np.count_nonzero(seen)),
        blocks=len(used),
        left=float(np.sqrt(left / max(rows_acting, 1))),
        rivals=rivals,
        event=term.place.window is not None,
    )


def as_trusted(fit: Fit, anomalous: Sequence[Term]) -> Fit:
    """The fit with bodies and scales where they are: no anomalous cause is made up for by them.

    How far they may be off is in a cause's odds. Without it they would go as far as rows ask.
    """
    b, kept = fit.balances, []
    left = {key: b.residual[key].copy() for key in fit.design}
    for term, beta in fit.weighted:
        if term.effect not in TRUSTED or any(term is each for each in anomalous):
            kept.append(term)
            continue
        for key, column in term.columns.items():
            if key in left:
                left[key] -= column @ beta
    return Fit(b.with_residual(left), kept)


def _folds_given(fit: Fit, term: Term) -> int:
    """The number of folds in which a term acts."""
    energy = np.zeros(fit.folds)
    for key, column in term.columns.items():
        if key in fit.design:
            rows = fit.rows[key]
            each = np.sum((column[rows] / fit.balances.sigma[key]) ** 2, axis=1)
            energy += np.bincount(fit.balances.fold[rows], each, minlength=fit.folds)
    return int(np.count_nonzero(energy > _ACTS * energy.sum()))


def _size(fit: Fit, term: Term, anomalous: Sequence[Term]) -> float:
    """A term's part over what nothing explains: the largest of its balances.

    Sensors' noise does not count as that, and smaller anomalous causes do: many small ones may be a
    misfit of the law of something large. Of an event where it acts, of all else over all rows.
    """
    b, largest = fit.balances, 0.0
    for key in term.columns:
        if key not in fit.design or not len(fit.rows[key]):
            continue
        part = fit.part(term, key)
        rows = np.ones(len(part), dtype=np.bool_)
        if term.place.window is not None:
            rows = np.abs(part) > _ACTS * np.abs(part).max(initial=0.0)
        if not rows.any():
            continue
        own = float(np.mean(part[rows] ** 2))
        left = float(np.mean(fit.residual(key) ** 2)) * b.sigma[key] ** 2
        rest = unexplained(left, b.floor[key] ** 2)
        others = [
            float(np.mean(fit.part(each, key)[rows] ** 2))
            for each in anomalous
            if each is not term and key in each.columns
        ]
        rest += sum(each for each in others if each < own)
        largest = max(largest, float(np.sqrt(own / rest)))
    return largest


def acting(column: FloatArray) -> NDArray[np.bool_]:
    """Rows in which columns (N, k) act."""
    if not len(column):  # a joint at rest throughout
        return np.zeros(0, dtype=np.bool_)
    scale = np.sqrt(np.mean(column**2, axis=0)) + 1e-300
    energy = np.sum((column / scale) ** 2, axis=1)
    return np.asarray(energy > _ACTS * energy.mean())


def machines_with(term: Term, believed: DiagnosisThresholds) -> HadBy:
    """Whether few machines have a cause, many, or every one to some degree."""
    if term.place.gate is not None:
        return "few"
    if term.effect in (*OF_JOINTS, LinkInertials.id):
        return "all"
    return "many" if CATALOGUE[term.effect].odds >= believed.common else "few"
