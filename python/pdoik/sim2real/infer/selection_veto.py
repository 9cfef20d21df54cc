"""What held-out recordings do not bear out is not claimed."""

from __future__ import annotations

import numpy as np

from ..effects import CATALOGUE
from ..motion.prepare import Prepared
from ..regression.fit import Fit, Term
from ..regression.naming import described
from ..regression.prediction import Prediction
from ..regression.trial import LEAST_OF_REST, Search, without

_VERY_CLEAR, _VERY_LARGE = 8.0, 3.0
"""Wald statistic and size in sigmas of what acts in so few rows that they decide little."""

_ACTS = 0.5  # sigmas from which a row says something of a term
_BARELY = 1e-9


def selection_veto(prepared: Prepared, state: Search) -> tuple[str, ...]:
    """Leave out what recordings that nothing was fitted to do not confirm; says so in words.

    Held-out recordings choose nothing, but what they do not bear out is not claimed. What acts in
    few of their rows is judged on these. What never acts in them (a limit that is not reached) is
    neither confirmed nor contradicted: it stays, and is said to rest on the fit recordings alone.
    """
    if prepared.validate is None:
        return ()
    notes = []
    prediction = Prediction(prepared.validate)
    for term in state.accepted:
        if term in state.contacts or term.key in state.confirmed:
            continue
        evidence = prediction.evidence(state.fit, term, (), 0)
        low, high = evidence.interval95
        if low > 0.0:
            continue
        if low > -_BARELY:  # it acts in few blocks or none, and some draws have none of them
            rows, share = where_it_acts(prediction, state.fit, term)
            trial = without(state, term)
            if not rows and trial.significant:
                notes.append(
                    f"{described(prepared, term)}: never acts in the held-out recordings, and rests"
                    " on the fit recordings alone."
                )
                continue
            clear = trial.t >= _VERY_CLEAR and trial.size >= _VERY_LARGE
            if clear or (trial.significant and share >= _least(term)):
                continue
        state.fit = Fit(state.balances, [t for t in state.fit.terms if t is not term])
        said = "contradicted" if high < 0.0 else "not confirmed"
        notes.append(
            f"{described(prepared, term)}: suggested by the fit recordings, {said} by the held-out"
            " ones, and left out."
        )
    return tuple(notes)


def where_it_acts(prediction: Prediction, fit: Fit, term: Term) -> tuple[int, float]:
    """Held-out rows in which a term acts, and its share of the mean square that is left there."""
    b = prediction.balances
    others = Fit(fit.balances, [t for t in fit.terms if t is not term])
    before, after = prediction.residual(others), prediction.residual(fit)
    count, gained, began = 0, 0.0, 0.0
    for key in term.columns:
        if key not in before:
            continue
        rows, scale = b.mask[key], 1.0 / b.sigma[key]
        x, y = before[key][rows] * scale, after[key][rows] * scale
        at = np.abs(x - y) > _ACTS
        count += int(at.sum())
        gained += float(np.sum(x[at] ** 2 - y[at] ** 2))
        began += float(np.sum(x[at] ** 2))
    return count, gained / max(began, 1e-12)


def _least(term: Term) -> float:
    return max(LEAST_OF_REST, CATALOGUE[term.effect].least_of_rest)
