"""What no named effect explains: on what it depends, without a name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..effects import CATALOGUE
from ..effects.unknown import VARIABLES, Unknown
from ..motion.place import Key, Place
from ..regression.fit import Fit, Term, term_of
from ..regression.screen import screen
from ..regression.trial import Search, Trial, cross_validated, held_out_squares

_NAMELESS = CATALOGUE[Unknown.id]


def with_unknown(state: Search) -> Search:
    """With unnamed functions where named effects leave something that generalises."""
    for _ in range(state.balances.n):
        best = _best(state)
        if best is None:
            break
        wider = replace(state, fit=state.fit.extended(best.term), tried=(*state.tried, best))
        state = _names_given_up(wider, state.fit, best.term)
    return state


def _best(state: Search) -> Trial | None:
    b, effect = state.balances, _NAMELESS
    least, held = b.thresholds.unnamed, held_out_squares(state.fit)
    taken = {t.place.joints[0] for t in state.accepted if t.effect == effect.id}
    trials = []
    for j in range(b.n):
        key = ("torque", j)
        if key not in state.fit.design or not b.excited[j] or j in taken:
            continue
        if not len(held[key]) or np.sqrt(np.mean(held[key])) < least.least_left:
            continue
        places = [Place(joints=(j,))]
        places += [Place(joints=(j, i)) for i in range(b.n) if i != j and b.excited[i]]
        terms = [
            term_of(b, effect, place, shape)
            for place in places
            for shape in effect.shapes(b.motions, place)
        ]
        terms += [term_of(b, effect, Place(joints=(j,)), s) for s in _clocks(state.fit, j)]
        found: list[tuple[Term, float]] = []
        for term in terms:  # one at a time: screen keeps the best shape of each place only
            if term is not None:
                found += screen(state.fit, [term])
        found.sort(key=lambda each: -each[1])
        trials += [cross_validated(state, term, held) for term, _ in found[:4]]
    good = [
        t
        for t in trials
        if t.significant and (t.share >= least.least_share or _completes(state.fit, t.term))
    ]
    plain = [t for t in good if not _is_wide(t.term)]
    best = max(good, key=lambda t: t.gain, default=None)
    simple = max(plain, key=lambda t: t.gain, default=None)
    if best is not None and simple is not None and simple.gain > least.simple * best.gain:
        return simple
    return best


def _completes(fit: Fit, term: Term) -> bool:
    """Whether a joint that names leave far from its floor reaches it with the function."""
    least = fit.balances.thresholds.unnamed
    return _rms(fit, term) > least.far and _rms(fit.extended(term), term) < least.near


def _rms(fit: Fit, term: Term) -> float:
    """Root mean square in sigmas of what is left at the term's joint."""
    return float(np.sqrt(np.mean(fit.residual(("torque", term.place.joints[0])) ** 2)))


def _is_wide(term: Term) -> bool:
    """Whether it has many coefficients, so that a simpler one nearly as good is to be preferred."""
    name = VARIABLES[int(term.shape[0])]
    return name.endswith("and speed") or name.startswith("fine")


def _clocks(fit: Fit, j: int) -> list[tuple[float, float, float]]:
    """The strongest frequencies of the residual over time."""
    b = fit.balances
    key: Key = ("torque", j)
    left = np.zeros(b.count)
    left[fit.rows[key]] = fit.residual(key)
    cutoff = b.motions[0].cutoff
    longest = max(float(m.time[-1]) for m in b.motions)
    grid = np.arange(2.0 / longest, 0.8 * cutoff, 0.25 / longest)
    power = np.zeros(len(grid))
    for i in range(len(b.motions)):
        span = slice(int(b.starts[i]), int(b.starts[i + 1]))
        step = float(b.time[span][1] - b.time[span][0])
        count = 8 * len(left[span])  # padded with zeros: fine enough in frequency
        spectrum = np.abs(np.fft.rfft(left[span], count)) ** 2
        power += np.interp(grid, np.fft.rfftfreq(count, step), spectrum)
    code = float(VARIABLES.index("clock"))
    top = np.argsort(power)[::-1][:3]
    return [(code, float(grid[i]), 1.0) for i in top]


def _names_given_up(state: Search, named: Fit, unknown: Term) -> Search:
    """Without names of the same joint and variable where these explain clearly less."""
    name = VARIABLES[int(unknown.shape[0])]
    j = unknown.place.joints[0]
    names = [
        term
        for term in state.accepted
        if _shows_by(CATALOGUE[term.effect].depends_on, name) and term.place.joints == (j,)
    ]
    if not names:
        return state
    without = state.without(*names)
    alone = without.fit
    start, by_names, by_unknown, both = (
        _left(fit, j) for fit in (state.start, named, alone, state.fit)
    )
    explained = (start - by_names) / max(start - by_unknown, 1e-12)
    least = state.balances.thresholds.unnamed
    enough = by_unknown < least.alone * both + least.alone_share * start
    before, after = _rms(named, unknown), _rms(alone, unknown)
    if enough and (explained < least.names_explain or before > least.far > least.near > after):
        return without
    return state


def _shows_by(variables: tuple[str, ...], name: str) -> bool:
    """Whether what depends on these variables may be what the unnamed function of `name` is."""
    if name.endswith("position and speed"):
        return "speed" in variables or "position and speed" in variables
    return name.removeprefix("fine ") in variables


def _left(fit: Fit, j: int) -> float:
    return float(np.sum(fit.residual(("torque", j)) ** 2))
