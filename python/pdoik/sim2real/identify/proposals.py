"""Hypotheses that only what is left can suggest.

Harmonics, parts of time or of the positions, pushes, effects that begin in the middle of a
recording and stay, and torques without a name. They are compared like all others; how many of their
kind were looked at is in their odds. What differs between two recordings is another day's friction
before it is a fault, so an onset lies inside a recording, and says more there than at any border.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE, VARIABLES, Unknown
from ..motion import Balances, Gate, Key, Place, Shape, axis_of
from ..regression import Fit, Term, gains_alone, term_of
from .contacts import contact_term
from .gates import PARTS, likely_gates, plain_terms, terms_at, with_gate
from .harmonics import harmonic_terms
from .hypothesis import Hypothesis, anomalous

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


_OF_NORMAL = 0.6745  # median of the size of what is normal, over its standard deviation
_HARMONICS = 300.0  # of a joint that are looked at
_WINDOWS = 1000.0
_FREQUENCIES = 100.0


def harmonics(balances: Balances, fit: Fit) -> Iterator[Hypothesis]:
    """Harmonics of joints' angles, the strongest in what is left."""
    for term in harmonic_terms(fit):
        yield anomalous(balances, term, among=_HARMONICS)


def gated(
    balances: Balances, fit: Fit, joints: Sequence[int] | None = None
) -> Iterator[Hypothesis]:
    """Effects in a part of time or of the positions only."""
    for j in _unexplained(balances, fit, joints):
        options: dict[tuple[str, str], tuple[float, Term, Gate]] = {}
        for term in plain_terms(fit, j):
            for gain, gate in likely_gates(fit, term):
                kind = term.effect, gate.of
                if kind not in options or gain > options[kind][0]:
                    options[kind] = gain, term, gate
        best = sorted(options.values(), key=lambda each: -each[0])[:3]
        for _, plain, gate in best:
            term = with_gate(fit, plain, gate)
            if term.columns:
                yield anomalous(balances, term, among=PARTS)


def begun(
    balances: Balances, fit: Fit, joints: Sequence[int] | None = None
) -> Iterator[Hypothesis]:
    """Effects that begin at a moment and last."""
    for j in _unexplained(balances, fit, joints):
        pool = [term for term in terms_at(fit, j) if may_begin(term)]
        likely = [each for t in pool if (each := likely_onset(fit, t, j)) is not None]
        for each in sorted(likely, key=lambda each: -each.gain)[:2]:
            term = with_gate(fit, each.term, Gate(of="clock", low=each.since))
            if term.columns:
                yield anomalous(balances, term, among=MOMENTS)


def pushes(balances: Balances, fit: Fit) -> Iterator[Hypothesis]:
    """The clearest window in which something pushes.

    Compared with what is left at most times: a push that nobody has named is much of what is left.
    """
    usual = {key: _usual(fit, key) for key in fit.design}
    term = contact_term(Fit(balances.with_noise(usual), fit.terms))
    if term is not None:
        yield anomalous(balances, term, among=_WINDOWS)


def _usual(fit: Fit, key: Key) -> float:
    """What a balance is off by at most times, as a standard deviation; its noise at least."""
    b, off = fit.balances, np.abs(fit.residual(key))
    left = float(np.median(off)) * b.sigma[key] / _OF_NORMAL if len(off) else b.sigma[key]
    return max(left, b.floor.get(key, 0.0), 1e-12)


def nameless(
    balances: Balances, fit: Fit, joints: Sequence[int] | None = None
) -> Iterator[Hypothesis]:
    """Smooth functions of what a joint's torque may depend on."""
    effect = CATALOGUE[Unknown.id]
    for j in _unexplained(balances, fit, joints):
        places = [Place(joints=(j,))]
        places += [
            Place(joints=(j, i)) for i in range(balances.n) if i != j and balances.excited[i]
        ]
        found = [
            term_of(balances, effect, place, shape)
            for place in places
            for shape in effect.shapes(balances.motions, place)
        ]
        clocks = [term_of(balances, effect, places[0], shape) for shape in _clocks(fit, j)]
        for among, terms in ((1.0, found), (_FREQUENCIES, clocks)):
            for term in terms:
                if term is not None:
                    yield anomalous(balances, term, among=among * len(found))


def _clocks(fit: Fit, j: int) -> list[Shape]:
    """The strongest frequencies of the residual over time."""
    b = fit.balances
    key: Key = ("torque", j)
    left = np.zeros(b.count)
    left[fit.rows[key]] = fit.residual(key)
    longest = max(float(m.time[-1]) for m in b.motions)
    grid = np.arange(2.0 / longest, 0.8 * b.motions[0].cutoff, 0.25 / longest)
    power = np.zeros(len(grid))
    for i in range(len(b.motions)):
        span = slice(int(b.starts[i]), int(b.starts[i + 1]))
        step = float(b.time[span][1] - b.time[span][0])
        count = 8 * len(left[span])  # padded with zeros: fine enough in frequency
        spectrum = np.abs(np.fft.rfft(left[span], count)) ** 2
        power += np.interp(grid, np.fft.rfftfreq(count, step), spectrum)
    code = float(VARIABLES.index("clock"))
    return [(code, float(grid[i]), 1.0) for i in np.argsort(power)[::-1][:3]]


def _unexplained(balances: Balances, fit: Fit, joints: Sequence[int] | None) -> Iterator[int]:
    for j in range(balances.n) if joints is None else joints:
        key: Key = ("torque", j)
        if key not in fit.design or not balances.excited[j] or not len(fit.rows[key]):
            continue
        left = fit.residual(key) * fit.balances.sigma[key]
        if np.sqrt(np.mean(left**2)) > balances.thresholds.diagnosis.restless * balances.floor[key]:
            yield j
