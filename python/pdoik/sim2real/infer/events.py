"""Events: pushes and limits, which happen once and can only be judged where they happened.

What an event explains is learnt on one half of its rows, every other quarter, and scored on the
other half, in turn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..findings import Evidence, Finding
from ..motion.place import Key
from ..motion.prepare import Prepared
from ..regression.estimate import event_estimates
from ..regression.fit import Fit, Index, Term
from ..regression.naming import Found, channel_of, finding_of
from ..regression.prediction import Prediction
from ..regression.trial import Search
from ..regression.trusted_bodies import effect_of
from ..select.contacts import contact_term, stands
from ..study.recording import FloatArray

_SEEN = 1e-4  # of the strongest direction of a force: what motors feel less of is left at zero


def without_needless_contacts(state: Search) -> Search:
    """Without contacts that later findings have made needless."""
    least = state.balances.thresholds.contacts.least_weight
    for term in state.contacts:
        others = state.without(term)
        share = within(state, term, ()).validation_gain
        if share < least or not stands(others.fit.extended(term), term):
            state = others
    kept = tuple(term for term in state.contacts if term in state.fit.terms)
    return replace(state, contacts=kept)


def within(state: Search, term: Term, channels: tuple[str, ...]) -> Evidence:
    """Evidence of an event in recordings to fit, held against its own window."""
    others = state.without(term).fit
    began = {key: state.start.residual(key) for key in term.columns}
    share = share_of_halves(others, term, began)
    return Evidence(validation_gain=share, interval95=(share, share), channels=channels)


def held_out_contacts(prepared: Prepared, fit: Fit, prediction: Prediction) -> list[Found]:
    """Contacts in recordings that were held out; an event is found where it happened.

    They are taken out of the residual of these recordings. None are looked for beside a torque
    without a name: what its function misses where it was not learnt looks like events.
    """
    found: list[Found] = []
    b = prepared.validate
    if b is None or any(effect_of(term).sought == "last" for term in fit.terms):
        return found
    left = prediction.residual(fit)
    least, rest = b.thresholds.contacts, Fit(b, ())
    for key in rest.target:
        rest.target[key] = left[key][rest.rows[key]] / b.sigma[key]
    for _ in range(least.most_held_out):
        term = contact_term(rest)
        if term is None:
            break
        began = {key: b.residual[key][rest.rows[key]] / b.sigma[key] for key in term.columns}
        share = share_of_halves(rest, term, began)
        rest = rest.extended(term)
        if share < least.least_weight:
            break
        prediction.events.append((term, rest.beta[-term.width :].copy()))
        evidence = Evidence(
            validation_gain=share,
            interval95=(share, share),
            channels=tuple(sorted({channel_of(prepared, key) for key in term.columns})),
        )
        finding = finding_of(prepared, term, event_estimates(rest, term), (), evidence)
        found.append((only_held_out(finding, share), (term,)))
    return found


def only_held_out(finding: Finding, share: float) -> Finding:
    """Marked as seen in held-out recordings alone."""
    names = ", ".join(finding.recordings)
    said = f"Seen only in {names}, held out: no other recording speaks for it."
    statement = f"{finding.statement} {said}"
    return replace(finding, statement=statement, weight=share, held_out_only=True)


def share_of_halves(others: Fit, term: Term, began: Mapping[Key, FloatArray]) -> float:
    """Share of the first residual in an event's rows that it explains where it was not learnt.

    Args:
        others: the fit without it.
        term: the event.
        began: residual without any finding on the rows that count, in sigmas.
    """
    felt = others.balances.thresholds.contacts.felt
    at = {key: _acting(column[others.rows[key]], felt) for key, column in term.columns.items()}
    rows = np.concatenate([others.rows[key][where] for key, where in at.items()])
    ends = np.quantile(rows, (0.25, 0.5, 0.75))
    gained = first = 0.0
    for odd in (0, 1):  # the first and third quarter, then the others
        half = {
            key: where[np.searchsorted(ends, others.rows[key][where]) % 2 == odd]
            for key, where in at.items()
        }
        rest = {key: np.setdiff1d(where, half[key]) for key, where in at.items()}
        force = _force(others, term, rest)
        for key, where in half.items():
            before = others.residual(key)[where]
            part = term.columns[key][others.rows[key][where]] @ force / others.balances.sigma[key]
            gained += float(np.sum(before**2 - (before - part) ** 2))
            first += float(np.sum(began[key][where] ** 2))
    return float(np.clip(gained / max(first, 1e-12), 0.0, 1.0))


def _acting(column: FloatArray, felt: float) -> Index:
    """Rows in which more than a filter's ringing is felt."""
    size = np.abs(column).max(axis=1, initial=0.0)
    return np.flatnonzero(size > felt * size.max(initial=0.0))


def _force(others: Fit, term: Term, at: Mapping[Key, Index]) -> FloatArray:
    """Coefficients of an event on some of its rows."""
    gram, moment = np.diag(term.prior + 1e-9), np.zeros(term.width)
    for key, where in at.items():
        part = term.columns[key][others.rows[key][where]] / others.balances.sigma[key]
        gram += part.T @ part
        moment += part.T @ others.residual(key)[where]
    return np.asarray(np.linalg.lstsq(gram, moment, rcond=_SEEN)[0])
