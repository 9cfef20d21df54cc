"""Effects that begin in the middle of a recording and stay: a seal that fails, a clamp that slips.

What differs between two recordings is another day's friction before it is a fault, so an onset has
to lie inside a recording, and to say more there than at any border between two.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..effects import CATALOGUE
from ..motion.balances import Balances, axis_of
from ..motion.place import Gate, Key
from ..regression.fit import Fit, Term
from ..regression.trial import Search, cross_validated, held_out_squares
from ..study.recording import FloatArray
from .candidates import candidates
from .gates import sharpened

_GRID = 60  # moments of the study at which an onset is looked for first
_TRIED = 3  # effects of a joint that are cross-validated
_MOST = 3  # onsets of a study


def with_onsets(state: Search) -> Search:
    """With effects that begin at a moment, the clearest first."""
    for _ in range(_MOST):
        found = [best for j in range(state.balances.n) if (best := _at_joint(state, j)) is not None]
        if not found:
            break
        term = max(found, key=lambda each: each[0])[1]
        state = replace(state, fit=state.fit.extended(term))
    return state


@dataclass(frozen=True, slots=True)
class _Onset:
    gain: float  # of the training cost, by the gated column alone
    since: float
    term: Term


def _at_joint(state: Search, j: int) -> tuple[float, Term] | None:
    """The joint's best onset and what it gains on held-out rows."""
    b, key = state.balances, _key(j)
    least = b.thresholds.gates
    if not b.excited[j] or key not in state.fit.design or not len(state.fit.rows[key]):
        return None
    if any(t.place.gate is not None and t.place.joints == (j,) for t in state.accepted):
        return None
    left = float(np.sum(state.fit.residual(key) ** 2))
    pool = [t for t in candidates(b) if t.place.joints == (j,) and _may_begin(t)]
    likely = [each for t in pool if (each := _onset(state.fit, t, j)) is not None]
    likely = [each for each in likely if each.gain > least.onset_explains * left]
    likely.sort(key=lambda each: -each.gain)
    held = held_out_squares(state.fit)
    best: tuple[float, Term] | None = None
    for each in likely[:_TRIED]:
        gate = Gate(of="clock", low=each.since)
        place = replace(each.term.place, gate=gate)
        columns = b.compute(CATALOGUE[each.term.effect], place, each.term.shape)
        if not columns:
            continue
        term = sharpened(state.fit, replace(each.term, place=place, columns=columns))
        trial = cross_validated(state, term, held)
        always = cross_validated(state, each.term, held)
        sure = trial.significant and trial.t > least.onset_t
        if sure and trial.gain > 2.0 * always.gain and (best is None or trial.gain > best[0]):
            best = trial.gain, term
    return best


def _key(j: int) -> Key:
    return ("torque", j)


def _may_begin(term: Term) -> bool:
    effect = CATALOGUE[term.effect]
    return effect.gated and not effect.fixed and not effect.costly


def _onset(fit: Fit, term: Term, j: int) -> _Onset | None:
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
    if at[best] <= (1.0 + b.thresholds.gates.onset_better) * between:
        return None
    return _Onset(at[best], float(inside[best]), term)


def _moments(balances: Balances, clock: FloatArray, borders: FloatArray) -> FloatArray:
    """Moments of the study away from the recordings' borders."""
    away = balances.thresholds.gates.onset_away
    moments = np.quantile(clock, np.linspace(0.02, 0.98, _GRID))
    ends = [m.clock + float(m.time[-1]) for m in balances.motions]
    near = np.min(np.abs(moments[:, None] - np.concatenate([borders, ends])[None, :]), axis=1)
    return np.asarray(moments[near > away])


def _gain(term: Term, column: FloatArray, residual: FloatArray, since: FloatArray) -> float:
    part = column[since]
    if len(part) < 2 * part.shape[1] + 10:
        return 0.0
    gram = part.T @ part
    scale = float(np.trace(gram))
    if scale <= 0.0:
        return 0.0
    moment = part.T @ residual[since]
    beta = np.asarray(np.linalg.solve(gram + 1e-9 * scale * np.eye(len(gram)), moment))
    return float(beta @ moment) if CATALOGUE[term.effect].admissible(beta) else 0.0
