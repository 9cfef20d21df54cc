"""Effects that act in a part of time or of a joint's positions only: a gate put before a term.

A search without gates finds such an effect weakly, or several others in its place. Here one gated
effect is held against all that was accepted of its kind at the joint.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..effects import CATALOGUE
from ..motion.balances import axis_of
from ..motion.place import Gate, Key, Place
from ..regression.fit import Fit, Term, term_of
from ..regression.one_more import OneMore
from ..regression.refine import refined
from ..regression.trial import Search, Trial, cross_validated, held_out_squares
from ..study.recording import FloatArray
from .candidates import candidates
from .harmonics import harmonic_terms

_SLOW = (4.0, 5.0, 6.0, 7.0, 8.0)
"""Harmonics of the joint's angle that a part of the positions shows no whole wave of."""

_GRID = 25  # quantiles between which a gate's ends are looked for first
_TRIED = 5  # gated terms of a joint that are cross-validated
_EDGES = (0.0, 0.02, 0.05, 0.1, 0.2)  # tried [s], [rad], [m]


def gated_term(state: Search) -> Term | None:
    """The clearest gated effect that explains a joint better than what was accepted there."""
    found = [best for j in range(state.balances.n) if (best := _at_joint(state, j)) is not None]
    return max(found, key=lambda each: each[0])[1] if found else None


def _at_joint(state: Search, j: int) -> tuple[float, Term] | None:
    """The joint's best, and what it gains on held-out rows beyond what it would replace."""
    b, least = state.balances, state.balances.thresholds.gates
    if not b.excited[j] or any(t.place.gate and t.place.joints == (j,) for t in state.accepted):
        return None
    instead = [
        t
        for t in state.accepted
        if CATALOGUE[t.effect].of_joint_torque and t.place.joints[:1] == (j,)
    ]
    base = state.without(*instead).fit
    key: Key = ("torque", j)
    if key not in base.design or not len(base.rows[key]):
        return None
    if np.sqrt(np.mean(base.residual(key) ** 2)) < least.least_left:
        return None
    above = _above_noise(base, key)
    if _above_noise(state.fit, key) < least.better * above:
        return None  # what was accepted leaves no gate anything to be better by
    options: dict[tuple[str, str], tuple[float, Term, Gate]] = {}
    for term in _plain(base, j):
        for gain, gate in _gates(base, term):
            kind = term.effect, gate.of
            if kind not in options or gain > options[kind][0]:
                options[kind] = gain, term, gate
    likely = [each for each in options.values() if each[0] > least.promising * above]
    likely.sort(key=lambda each: -each[0])
    held = held_out_squares(base)
    now = base.by_block(_difference(held, held_out_squares(state.fit)))
    best: tuple[float, Term] | None = None
    for _, plain, gate in likely[:_TRIED]:
        term = sharpened(base, _with_gate(base, plain, gate))
        trial = cross_validated(state, term, held, base)
        gain = float(trial.blocks.sum() - now.sum())
        if _stands(base, trial, now) and (best is None or gain > best[0]):
            best = gain, term
    return best


def _above_noise(fit: Fit, key: Key) -> float:
    """Squared residual beyond that of noise alone."""
    return float(np.sum(fit.residual(key) ** 2)) - len(fit.rows[key])


def _plain(base: Fit, j: int) -> list[Term]:
    """Candidates of the joint without a gate."""
    b = base.balances
    harmonic = [each for each in CATALOGUE.values() if each.sought == "harmonics"]
    slow = [term_of(b, each, Place(joints=(j,)), (h,)) for each in harmonic for h in _SLOW]
    pool = [*candidates(b), *harmonic_terms(base), *(term for term in slow if term is not None)]
    return [t for t in pool if CATALOGUE[t.effect].gated and t.place.joints == (j,)]


def _gates(base: Fit, term: Term) -> Iterator[tuple[float, Gate]]:
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
    moments, grams = moment[last] - moment[first], gram[last] - gram[first]
    scale = np.trace(grams, axis1=1, axis2=2)
    ridge = np.maximum(1e-9 * scale, 1e-300)[:, None, None] * np.eye(term.width)
    betas = np.linalg.solve(grams + ridge, moments[:, :, None])[:, :, 0]
    gains = np.where(scale > 0.0, np.sum(betas * moments, axis=1), 0.0)
    effect = CATALOGUE[term.effect]
    for k in np.argsort(-gains):
        if gains[k] <= 0.0:
            break
        if effect.admissible(betas[k]):
            return float(gains[k]), (int(first[k]), int(last[k]))
    return 0.0, (0, 0)


def _with_gate(base: Fit, plain: Term, gate: Gate) -> Term:
    """The term behind the gate."""
    b, effect = base.balances, CATALOGUE[plain.effect]
    place = Place(joints=plain.place.joints, gate=gate)
    columns = b.compute(effect, place, plain.shape)
    return replace(plain, place=place, columns=columns)


def sharpened(base: Fit, term: Term) -> Term:
    """Ends, edges and shape moved to where the training cost is lowest."""
    gate = term.place.gate
    assert gate is not None
    reach = float(np.ptp(_axis(base, gate.of, term.place.joints[0])))
    beside = OneMore(base)
    best, gain = term, beside.gain(term)
    for step in (reach / _GRID * 0.5**halving for halving in range(6)):
        improved = True
        while improved:
            improved = False
            for moved in _moved(best, step):
                tried = _with_gate(base, best, moved)
                there = beside.gain(tried) if tried.columns else -np.inf
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


def _difference(
    before: dict[Key, FloatArray], after: dict[Key, FloatArray]
) -> dict[Key, FloatArray]:
    return {key: before[key] - after[key] for key in before}


def _stands(base: Fit, trial: Trial, now: FloatArray) -> bool:
    """Whether the gate is a part of the data, in several recordings, and clearly better."""
    if not trial.significant or not _is_part(base, trial.term):
        return False
    least = base.balances.thresholds.gates
    keys = [key for key in trial.term.columns if key[0] == "torque"] or list(trial.term.columns)
    above = sum(_above_noise(base, key) for key in keys)
    better = trial.blocks - now
    used = better[(trial.blocks != 0.0) | (now != 0.0)]
    error = float(np.std(used) * np.sqrt(len(used))) if len(used) > 1 else np.inf
    return (
        trial.gain > least.explains * above
        and float(better.sum()) > least.better * above
        and float(better.sum()) > least.better_t * error
    )


def _is_part(base: Fit, term: Term) -> bool:
    """Whether some of the effect lies inside and some outside, in two recordings at least."""
    b = base.balances
    plain = b.columns(CATALOGUE[term.effect], replace(term.place, gate=None), term.shape)
    inside = whole = 0.0
    seen = set()
    for key, column in term.columns.items():
        rows = base.rows[key]
        inside += float(np.sum(column[rows] ** 2))
        whole += float(np.sum(plain[key][rows] ** 2))
        acting = np.any(column[rows] != 0.0, axis=1)
        seen |= set(np.unique(b.recording[rows[acting]]).tolist())
    share, of = inside / max(whole, 1e-300), b.thresholds.gates
    return of.least_inside < share < of.most_inside and len(seen) >= min(2, len(b.motions))
