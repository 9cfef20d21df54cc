"""Every accepted term learnt anew without one session after the other, and held against that.

Sessions are those that the study tells of, where there are three or more; else recordings, or
parts of one that is alone. The search tunes nonlinear parameters and gates on all rows and only its
coefficients by folds, and it looks at hundreds of candidates. Here shapes and gates are tuned
without the session too: what is gained is gained where the whole of the term was never seen (nested
cross-validation; Varma and Simon, BMC Bioinformatics 7:91, 2006).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..effects import CATALOGUE
from ..findings import Support
from ..regression.fit import Fit, Term
from ..regression.one_more import OneMore
from ..regression.refine import refined
from ..regression.trial import Search
from ..select.gates import sharpened
from ..study.recording import FloatArray
from .confidence import confidence_of
from .event_support import event_support
from .ordinary_looks import Ordinary

_TOLD = 0.5  # of a session's rows that the others tell of, for it to be judged as a whole
_PARTS = 4  # of one that is not


def borne_out(state: Search) -> tuple[Search, tuple[Term, ...]]:
    """The search without terms that left-out sessions or the background do not bear out, and these.

    What simulations confirmed stays.
    """
    doubtful: list[Term] = []
    ordinary = Ordinary(of=state.balances)
    while True:
        judged = state.accepted
        new = {t.key: _best_support(state, t) for t in judged if t.key not in state.support}
        state = replace(state, support={**state.support, **new})
        failing = [(t, state.support[t.key].t) for t in judged if not _stands(state, t)]
        failing = failing or ordinary.without_need(state)
        if not failing:
            return state, tuple(doubtful)
        worst = min(failing, key=lambda each: each[1])[0]
        doubtful.append(worst)
        beside = {
            t.key
            for t in judged
            if t is not worst and not worst.columns.keys().isdisjoint(t.columns)
        }
        kept = {key: each for key, each in state.support.items() if key not in beside}
        contacts = tuple(t for t in state.contacts if t is not worst)
        state = replace(state.without(worst), support=kept, contacts=contacts)


def _best_support(state: Search, term: Term) -> Support:
    """What a term gains beside the others, or beside the background if that says more.

    The others' figures are free; what few sessions make of them may hide what is peculiar.
    """
    own, beside = support_of(state, term), state.peculiar
    found = [] if beside is None else [t for t in beside.accepted if t.key == term.key]
    if beside is None or not found:
        return own
    other = support_of(beside, found[0])
    thresholds = state.balances.thresholds
    surer = confidence_of(thresholds, other) > confidence_of(thresholds, own)
    return replace(other, weight=max(own.weight, other.weight)) if surer else own


def support_of(state: Search, term: Term) -> Support:
    """What a term gains in sessions that it was not learnt from, beside the others.

    Of what one session alone tells, in parts of it; of an event, on quarters of its own rows.
    """
    b = state.balances
    others, judged = state.without(term).fit, []
    if term not in state.contacts:
        judged = _judged(others, term)
    if not judged:
        return event_support(others, term, {key: state.start.residual(key) for key in term.columns})
    gained = np.sum([each.gain for each in judged], axis=0)
    began, rows = sum(each.before for each in judged), sum(each.rows for each in judged)
    acting = gained[gained != 0.0]
    error = float(np.std(acting) * np.sqrt(len(acting))) if len(acting) > 1 else np.inf
    total = float(gained.sum())
    first = sum(
        float(np.sum((b.residual[key][others.rows[key]] / b.sigma[key]) ** 2))
        for key in term.columns
    )
    return Support(
        weight=total / max(first, 1e-12),
        gain=total / max(began, 1e-12),
        t=total / max(error, 1e-12),
        size=float(np.sign(total) * np.sqrt(abs(total) / max(rows, 1))),
        agree=sum(bool(each.gain.sum() > 0.0) for each in judged),
        sessions=len(judged),
        blocks=len(acting),
        left=_left(state.fit, term),
        rivals=len(state.level.get(term.key, ())),
    )


def _left(fit: Fit, term: Term) -> float:
    """Root mean square of what nothing explains at the term's balances, in sigmas."""
    squares = [fit.residual(key) ** 2 for key in term.columns]
    return float(np.sqrt(np.mean(np.concatenate(squares))))


def _shares(fit: Fit, term: Term) -> FloatArray:
    """Of a term's squared column, of each session, (sessions,)."""
    count = int(fit.balances.session.max()) + 1
    energy = np.zeros(count)
    for key, column in term.columns.items():
        rows = fit.rows[key]
        scaled = np.sum((column[rows] / fit.balances.sigma[key]) ** 2, axis=1)
        energy += np.bincount(fit.balances.session[rows], scaled, minlength=count)
    return np.asarray(energy / max(float(energy.sum()), 1e-300))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Judged:
    """How a term that was learnt elsewhere does in a session."""

    gain: FloatArray  # of each block
    before: float  # sum of squares without it
    rows: float  # by how much the others say of what is there
    told: float  # their share of all rows


def _judged(others: Fit, term: Term) -> list[_Judged]:
    """Sessions that can judge a term beside others: what they show can be learnt without them.

    A session of which the others hardly say what is there is judged in parts. Two knees that
    bend together in all others are told from one another by none of them.
    """
    found: list[_Judged | None] = []
    least = others.balances.thresholds.support.least_elsewhere
    for session, share in enumerate(_shares(others, term)):
        if share < least:
            continue
        whole = _left_out(others, term, session) if 1.0 - share >= least else None
        if whole is not None and whole.told >= _TOLD:
            found.append(whole)
            continue
        parts, which = others.balances.with_parts_of(session, _PARTS)
        inside = others.on(parts)
        of_parts = _shares(inside, term)
        found += [
            _left_out(inside, term, part) for part in which if least <= of_parts[part] < 1.0 - least
        ]
    return [each for each in found if each is not None]


def _left_out(others: Fit, term: Term, session: int) -> _Judged | None:
    """A session's judgement; None where the others say too little of what it shows.

    A body that only swings in one session may move there as it never does in others: what these
    make of it is their noise, many times enlarged, and judges nothing. Rows count the less, the
    less the others say of what else is there.
    """
    b = others.balances
    base = others.on(b.without_session(session))
    learnt = relearnt(base, term)
    beside = OneMore(base)
    beta = beside.beta(learnt)
    own = np.zeros((learnt.width, learnt.width))
    gained, began, count, whole = np.zeros(int(b.block.max()) + 1), 0.0, 0.0, 0
    for key, column in learnt.columns.items():
        rows = others.rows[key]
        part = column[rows]
        acts = np.sum(part**2, axis=1) if len(part) else np.zeros(0)
        at = (b.session[rows] == session) & (acts > 0.05 * (acts.mean() if len(acts) else 0.0))
        index, design = others.index[key], others.design[key].at(at)
        beneath = design @ np.eye(len(index))
        sure = 1.0 / np.sqrt(1.0 + beside.doubt(index, beneath))
        there = _Rows(
            fit=others,
            index=index,
            design=beneath * sure[:, None],
            target=others.target[key][at] * sure,
        )
        before = there.left(base.beta) ** 2
        shown = part[at] / b.sigma[key] * sure[:, None]
        after = there.left(beta, learnt, shown) ** 2
        own += shown.T @ shown
        gained += np.bincount(b.block[rows[at]], before - after, minlength=len(gained))
        began += float(before.sum())
        count += float(np.sum(sure**2))
        whole += len(sure)
    least = b.thresholds.support.least_elsewhere
    if beside.leverage(learnt, own) > (1.0 - least) / least:
        return None
    return _Judged(gain=gained, before=began, rows=count, told=count / max(whole, 1))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Rows:
    """Some rows of a session at a balance, and what a fit has there."""

    fit: Fit
    index: NDArray[np.intp]  # of the design's columns among the coefficients
    design: FloatArray  # (N, w)
    target: FloatArray

    def left(
        self, beta: FloatArray, more: Term | None = None, column: FloatArray | None = None
    ) -> FloatArray:
        """What coefficients that were learnt elsewhere leave, in sigmas.

        Friction as a whole is whatever it was that day, a usual share of what was learnt or more.

        Args:
            beta: of the fit's terms, then of one term more.
            more: that term.
            column: its column on the rows, (N, k) in sigmas.
        """
        fit, index = self.fit, self.index
        left = self.target - self.design @ beta[index]
        friction = self.design @ _rubbing(fit, beta)[index]
        if more is not None and column is not None:
            part = column[:, 0] if more.fixed else column @ beta[fit.size :]
            left = left - part
            if _rubs(more):
                friction = friction + part
        power = float(friction @ friction)
        if power <= 0.0:
            return left
        least = 1.0 - fit.balances.thresholds.figures.usual_spread
        share = 1.0 + float(left @ friction) / power
        return np.asarray(left - (float(np.clip(share, least, 1.0 / least)) - 1.0) * friction)


def _rubs(term: Term) -> bool:
    return term.effect in CATALOGUE and CATALOGUE[term.effect].family == "friction"


def _rubbing(fit: Fit, beta: FloatArray) -> FloatArray:
    """The coefficients of friction alone."""
    rubbing = np.zeros(fit.size)
    for term, offset in zip(fit.terms, fit.offsets, strict=False):
        if _rubs(term) and not term.fixed:
            rubbing[offset : offset + term.width] = beta[offset : offset + term.width]
    return rubbing


def relearnt(base: Fit, term: Term) -> Term:
    """The term with gate and nonlinear parameters tuned on the rows of a fit."""
    if CATALOGUE[term.effect].costly:  # shown by simulations, where it is to be believed
        return term
    if term.place.gate is not None:
        return sharpened(base, term)
    return refined(base, term, closely=False)


def _stands(state: Search, term: Term) -> bool:
    """Whether a term is sure enough to be claimed."""
    if term.key in state.confirmed:
        return True
    thresholds = state.balances.thresholds
    return confidence_of(thresholds, state.support[term.key]) >= thresholds.confidence.suspected
