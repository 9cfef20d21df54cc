"""How residuals before and after change with the filter's cut-off."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import Balances, Prepared, prepare
from ..regression import Fit, Prediction, Term, term_of, trusted
from ..report import CutoffInfluence
from .traces import shown_key

if TYPE_CHECKING:
    from ..infer import Examination

FACTORS = (0.5, 0.7, 1.4)  # of the chosen cut-off


def cutoff_influence(examination: Examination) -> CutoffInfluence:
    """The findings fitted anew with other cut-offs, at the same places and shapes."""
    prepared = examination.prepared
    rows = [(prepared.cutoff, *_residuals(examination.prediction, examination.state.fit))]
    for factor in FACTORS:
        other = prepare(prepared.study, prepared.body, factor * prepared.cutoff)
        rows.append((other.cutoff, *_refitted(examination, other)))
    rows.sort(key=lambda row: row[0])
    return CutoffInfluence(
        frequency=np.array([row[0] for row in rows]),
        before=np.stack([row[1] for row in rows]),
        after=np.stack([row[2] for row in rows]),
        chosen=prepared.cutoff,
    )


def _refitted(examination: Examination, other: Prepared) -> tuple[FloatArray, FloatArray]:
    nuisance = trusted(other.fit, other.study.trust.rigid_body)
    fit = Fit(other.fit, [*nuisance, *_moved(other.fit, examination.state.accepted)])
    prediction = Prediction(other.validate or other.fit)
    for event, beta in examination.prediction.events:
        prediction.events += [(term, beta) for term in _moved(prediction.balances, (event,))]
    return _residuals(prediction, fit)


def _moved(balances: Balances, terms: tuple[Term, ...]) -> list[Term]:
    """The same terms on other balances."""
    moved = [term_of(balances, CATALOGUE[t.effect], t.place, t.shape) for t in terms]
    return [term for term in moved if term is not None]


def _residuals(prediction: Prediction, fit: Fit) -> tuple[FloatArray, FloatArray]:
    """Root mean squares before and after, (n,) each; NaN where a joint has no balance."""
    b = prediction.balances
    left = prediction.residual(fit)
    before, after = np.full(b.n, np.nan), np.full(b.n, np.nan)
    for j in range(b.n):
        key = shown_key(b, j)
        if key is not None and b.mask[key].any():
            before[j], after[j] = b.rms(key), b.rms(key, left[key])
    return before, after
