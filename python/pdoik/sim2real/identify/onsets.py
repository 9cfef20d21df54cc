"""Effects that begin in the middle of a recording and stay: a seal that fails, a clamp that slips.

What differs between two recordings is another day's friction before it is a fault, so an onset has
to lie inside a recording, and to say more there than at any border between two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import Balances, Key, axis_of
from ..regression import Fit, Term, gains_alone

_FEWEST = 10  # numerics: rows beyond a fit's own
MOMENTS = 60  # moments of the study at which an onset is looked for first


@dataclass(frozen=True, slots=True)
class Onset:
    gain: float  # of the training cost, by the gated column alone
    since: float
    term: Term


def _key(j: int) -> Key:
    return ("torque", j)


def may_begin(term: Term) -> bool:
    """Whether a machine may have it since a moment: whatever breaks, sticks or comes loose."""
    effect = CATALOGUE[term.effect]
    return not (effect.fixed or effect.costly or effect.shown_poorly)


def likely_onset(fit: Fit, term: Term, j: int) -> Onset | None:
    """The moment since when the term explains most; None where a border between recordings does."""
    b, key = fit.balances, _key(j)
    if key not in term.columns:
        return None
    rows = fit.rows[key]
    clock = b.sampled([axis_of(m, "clock", j) for m in b.motions])[rows]
    column = term.columns[key][rows] / b.sigma[key]
    residual = fit.residual(key)
    borders = np.array([m.clock for m in b.motions])
    inside = _moments(b, clock, borders)
    at = [_gain(term, column, residual, clock >= since) for since in inside]
    if not at:
        return None
    best = int(np.argmax(at))
    between = max(_gain(term, column, residual, clock >= since) for since in borders)
    if at[best] <= (1.0 + b.thresholds.diagnosis.moment_better) * between:
        return None
    return Onset(at[best], float(inside[best]), term)


def _moments(balances: Balances, clock: FloatArray, borders: FloatArray) -> FloatArray:
    """Moments of the study away from the recordings' borders."""
    away = balances.thresholds.noise.block
    moments = np.quantile(clock, np.linspace(0.02, 0.98, MOMENTS))
    ends = [m.clock + float(m.time[-1]) for m in balances.motions]
    near = np.min(np.abs(moments[:, None] - np.concatenate([borders, ends])[None, :]), axis=1)
    return np.asarray(moments[near > away])


def _gain(term: Term, column: FloatArray, residual: FloatArray, since: FloatArray) -> float:
    part = column[since]
    if len(part) < 2 * part.shape[1] + _FEWEST:
        return 0.0
    betas, gains = gains_alone((part.T @ residual[since])[None], (part.T @ part)[None])
    return float(gains[0]) if CATALOGUE[term.effect].admissible(betas[0]) else 0.0
