"""Effects that act in a part of time or of a joint's positions only: a gate put before a term."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import Gate, Place, axis_of
from ..regression import Fit, OneMore, Term, gains_alone, refined, term_of
from .candidates import candidates
from .harmonics import harmonic_terms

_SLOW = (4.0, 5.0, 6.0, 7.0, 8.0)
"""Harmonics of the joint's angle that a part of the positions shows no whole wave of."""

_GRID = 25  # numerics: quantiles between which a gate's ends are looked for first
PARTS = _GRID * (_GRID - 1) / 2  # pairs of ends
_EDGES = (0.0, 0.02, 0.05, 0.1, 0.2)  # tried [s], [rad], [m]


def plain_terms(base: Fit, j: int) -> list[Term]:
    """Candidates of the joint that may act in a part only, without a gate."""
    return [t for t in terms_at(base, j) if CATALOGUE[t.effect].gated]


def terms_at(base: Fit, j: int) -> list[Term]:
    """All of a joint, harmonics as they are in what is left."""
    b = base.balances
    harmonic = [each for each in CATALOGUE.values() if each.sought == "harmonics"]
    slow = [term_of(b, each, Place(joints=(j,)), (h,)) for each in harmonic for h in _SLOW]
    pool = [
        *candidates(b),
        *harmonic_terms(base, (j,)),
        *(term for term in slow if term is not None),
    ]
    return [t for t in pool if t.place.joints == (j,)]


def likely_gates(base: Fit, term: Term) -> Iterator[tuple[float, Gate]]:
    """The best gate in time and in position, by the gain of the gated column alone."""
    j = term.place.joints[0]
    for of in ("time", "position"):
        x = _axis(base, of, j)
        ends = np.quantile(x, np.linspace(0.0, 1.0, _GRID))
        moment, gram = _sums(base, term, x, ends)
        best, (first, last) = _best_span(term, moment, gram)
        if best > 0.0:
            # What begins lasts; where no position was, nothing is known.
            beyond = np.inf if of == "time" else 0.02 * float(np.ptp(x))
            low = float(ends[first] - (beyond if first == 0 else 0.0))
            high = float(ends[last] + (beyond if last == _GRID - 1 else 0.0))
            yield best, Gate(of=of, low=low, high=high)


def _sums(base: Fit, term: Term, x: FloatArray, ends: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Moments (G, k) and Gram matrices (G, k, k) of all rows below each end."""
    k = term.width
    moment, gram = np.zeros((len(ends), k)), np.zeros((len(ends), k, k))
    for key, column in term.columns.items():
        rows = base.rows[key]
        part = column[rows] / base.balances.sigma[key]
        cell = np.searchsorted(ends, x[rows], side="right").clip(1, len(ends) - 1)
        left = base.residual(key)
        for a in range(k):
            moment[:, a] += np.bincount(cell, part[:, a] * left, minlength=len(ends))
            for c in range(k):
                gram[:, a, c] += np.bincount(cell, part[:, a] * part[:, c], minlength=len(ends))
    return np.cumsum(moment, axis=0), np.cumsum(gram, axis=0)


def _best_span(term: Term, moment: FloatArray, gram: FloatArray) -> tuple[float, tuple[int, int]]:
    """Largest gain of the column between two of the ends, though not all, and which these are."""
    first, last = np.triu_indices(_GRID, 1)
    part = (first > 0) | (last < _GRID - 1)
    first, last = first[part], last[part]
    betas, gains = gains_alone(moment[last] - moment[first], gram[last] - gram[first])
    effect = CATALOGUE[term.effect]
    for k in np.argsort(-gains):
        if gains[k] <= 0.0:
            break
        if effect.admissible(betas[k]):
            return float(gains[k]), (int(first[k]), int(last[k]))
    return 0.0, (0, 0)


def with_gate(base: Fit, plain: Term, gate: Gate) -> Term:
    """The term behind the gate."""
    b, effect = base.balances, CATALOGUE[plain.effect]
    place = replace(plain.place, gate=gate)
    columns = b.compute(effect, place, plain.shape)
    return replace(plain, place=place, columns=columns)


def sharpened(base: Fit, term: Term) -> Term:
    """Ends, edges and shape moved to where the training cost is lowest."""
    gate = term.place.gate
    assert gate is not None
    reach = float(np.ptp(_axis(base, gate.of, term.place.joints[0])))
    one_more = OneMore(base)
    best, gain = term, one_more.gain(term)
    for step in (reach / _GRID * 0.5**halving for halving in range(6)):
        improved = True
        while improved:
            improved = False
            for moved in _moved(best, step):
                tried = with_gate(base, best, moved)
                there = one_more.gain(tried) if tried.columns else -np.inf
                if there > gain + 1e-6:
                    best, gain, improved = tried, there, True
    return refined(base, best)


def _moved(term: Term, step: float) -> Iterator[Gate]:
    """The gate with one end a step away, or other edges."""
    gate = term.place.gate
    assert gate is not None
    for low, high in ((-step, 0.0), (step, 0.0), (0.0, -step), (0.0, step)):
        moved = replace(gate, low=gate.low + low, high=gate.high + high)
        if moved != gate and moved.low < moved.high:
            yield moved
    for edge in _EDGES:
        if edge != gate.edge and edge < gate.high - gate.low:
            yield replace(gate, edge=edge)


def _axis(base: Fit, of: str, j: int) -> FloatArray:
    """Times, or joint j's positions, of all rows."""
    b = base.balances
    return b.sampled([axis_of(m, of, j) for m in b.motions])
