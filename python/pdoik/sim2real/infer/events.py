"""What happens once: contacts and limits of held-out recordings, and what speaks for them.

An event cannot repeat, so no session can be left out. It is learnt on one half of its rows, every
other quarter, and scored on the other half, in turn; and it is compared with what the same joints
show at other times, which nothing explains either: a misfit that is common is no event.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.drives import OF_COMMAND, TorqueSaturation, kinds, top_of
from ..findings import Estimate, Evidence, Finding, Support
from ..identify import (
    Identified,
    acting,
    confidence_of,
    contact_term,
    event_estimates,
    pauses,
    stands,
)
from ..motion import Balances, FlatTop, Key, Place, Prepared
from ..regression import (
    Fit,
    Found,
    Index,
    Prediction,
    Term,
    channel_of,
    effect_of,
    finding_of,
    refined,
    term_of,
    wald,
)
from ..thresholds import Thresholds

_SEEN = 1e-4  # of the strongest direction of a force: what motors feel less of is left at zero


def event_support(others: Fit, term: Term, start: Fit) -> Support:
    """Support of an event, which is not in the fit.

    Args:
        others: the fit without it.
        term: the event.
        start: of nothing, which leaves all.
    """
    felt = others.balances.thresholds.diagnosis.little
    at = {
        key: np.flatnonzero(acting(column[others.rows[key]], felt))
        for key, column in term.columns.items()
    }
    rows = np.concatenate([others.rows[key][where] for key, where in at.items()])
    ends = np.quantile(rows, (0.25, 0.5, 0.75))
    halves = []
    for odd in (0, 1):  # the first and third quarter, then the others
        half = {
            key: where[np.searchsorted(ends, others.rows[key][where]) % 2 == odd]
            for key, where in at.items()
        }
        rest = {key: np.setdiff1d(where, half[key]) for key, where in at.items()}
        force = np.ones(1) if term.fixed else _force(others, term, rest)
        halves.append(sum(_gained(others, term, force, key, each) for key, each in half.items()))
    total, count = float(sum(halves)), len(rows)
    began = sum(float(np.sum(start.target[key][where] ** 2)) for key, where in at.items())
    usual = _usual(others, at)
    size = total / max(count, 1)
    return Support(
        weight=float(np.clip(total / max(began, 1e-12), 0.0, 1.0)),
        gain=size / (size + usual) if size > 0.0 else size / usual,
        t=wald(others.extended(term), term),
        size=float(np.sign(size) * np.sqrt(abs(size))),
        agree=sum(gain > 0.0 for gain in halves),
        sessions=2,
        blocks=2,
        left=float(np.sqrt(usual)),
        rivals=0,
        event=True,
    )


def _gained(others: Fit, term: Term, force: FloatArray, key: Key, at: Index) -> float:
    """Decrease of the squared residual of a balance on some rows."""
    before = others.residual(key)[at]
    part = term.columns[key][others.rows[key][at]] @ force / others.balances.sigma[key]
    return float(np.sum(before**2 - (before - part) ** 2))


def _usual(others: Fit, at: Mapping[Key, Index]) -> float:
    """Mean square that nothing explains at the same balances at other times; noise at least."""
    squares = [np.delete(others.residual(key), where) ** 2 for key, where in at.items()]
    elsewhere = np.concatenate(squares)
    return max(float(elsewhere.mean()) if len(elsewhere) else 1.0, 1.0)


def _force(others: Fit, term: Term, at: Mapping[Key, Index]) -> FloatArray:
    """Coefficients of an event on some of its rows."""
    gram, moment = np.diag(term.prior + 1e-9), np.zeros(term.width)
    for key, where in at.items():
        part = term.columns[key][others.rows[key][where]] / others.balances.sigma[key]
        gram += part.T @ part
        moment += part.T @ others.residual(key)[where]
    return np.asarray(np.linalg.lstsq(gram, moment, rcond=_SEEN)[0])


_LIMIT = TorqueSaturation.id


def held_out_limits(prepared: Prepared, fit: Fit, prediction: Prediction) -> list[Found]:
    """Flat tops of joints that the fit recordings never drove to their limit.

    Held-out recordings choose nothing that could be learnt elsewhere; what only happens there can
    only be seen there, as a contact can. It is taken out of their residual.
    """
    found: list[Found] = []
    b = prepared.validate
    if b is None:
        return found
    of_level = b.thresholds.priors.discretisation
    limited = {t.place.joints for t in fit.terms if t.effect == _LIMIT}
    for j in range(b.n):
        if (j,) in limited:
            continue
        for kind in kinds(b.motions[0], j):
            top = top_of(b.motions, j, kind)
            if top is None:
                continue
            place = Place(joints=(j,))
            term = term_of(b, CATALOGUE[_LIMIT], place, (kind, top.level))
            if term is None:
                continue
            rest = prediction.rest(fit)
            term = refined(rest, term)
            share = _share(rest, term)
            if share < CATALOGUE[_LIMIT].least_of_rest:
                continue
            evidence = Evidence.once(share, "tau_cmd" if kind == OF_COMMAND else "q_des")
            level = term.shape[1]
            std = float(np.hypot(top.std, of_level * level))
            figures = {"level": Estimate.normal(level, std, "N m")}
            support = event_support(rest, term, Fit(b, ()))
            finding = finding_of(prepared, term, figures, (), evidence, support)
            finding = _where(finding, b, top)
            found.append((finding, (term,)))
            if finding.confidence >= b.thresholds.diagnosis.suspected:
                prediction.events.append((term, np.ones(1)))
            break
    return found


def _share(rest: Fit, term: Term) -> float:
    """Share of the mean square that was left on the rows in which the term acts."""
    gained = began = 0.0
    for key, column in term.columns.items():
        part = column[rest.rows[key], 0] / rest.balances.sigma[key]
        at = part != 0.0
        before = rest.target[key][at]
        gained += float(np.sum(before**2 - (before - part[at]) ** 2))
        began += float(np.sum(before**2))
    return float(np.clip(gained / max(began, 1e-12), 0.0, 1.0))


def _where(finding: Finding, b: Balances, top: FlatTop) -> Finding:
    """The finding with the recordings in which it happened: nothing else speaks for it."""
    names = tuple(m.recording.name for m, rows in zip(b.motions, top.rows, strict=True) if rows)
    return only_held_out(replace(finding, recordings=names), b.thresholds)


_MOST = 3  # of held-out recordings


def within(state: Identified, term: Term, channels: tuple[str, ...]) -> Evidence:
    """Evidence of an event in recordings to fit, compared with its own window."""
    return Evidence.once(
        event_support(state.without(term).fit, term, state.start).weight, *channels
    )


def held_out_contacts(
    prepared: Prepared, fit: Fit, prediction: Prediction, suspected: Sequence[Term] = ()
) -> list[Found]:
    """Contacts in recordings that were held out; an event is found where it happened.

    They are taken out of the residual of these recordings. None are looked for where a torque
    without a name was found: what its function misses where it was not learnt looks like events.
    So does what is only suspected, and a model that fails from a recording's first row to its last.

    Args:
        prepared: the study.
        fit: of what stands.
        prediction: of the recordings held out.
        suspected: what is not claimed, but may be there.
    """
    found: list[Found] = []
    b = prepared.validate
    if b is None or any(effect_of(term).sought == "last" for term in fit.terms):
        return found
    least, start, rest = b.thresholds.diagnosis, Fit(b, ()), prediction.rest(fit)
    left = prediction.rest(fit.extended(*suspected))
    for _ in range(_MOST):
        term = contact_term(left)
        if term is None:
            break
        left, with_it = left.extended(term), rest.extended(term)
        if not pauses(left, term):
            break
        if not stands(with_it, term):
            continue
        support = event_support(rest, term, start)
        rest = with_it
        if support.weight < least.push_share:
            break
        channels = sorted({channel_of(prepared, key) for key in term.columns})
        evidence = Evidence.once(support.weight, *channels)
        finding = finding_of(prepared, term, event_estimates(rest, term), (), evidence, support)
        finding = only_held_out(finding, b.thresholds)
        found.append((finding, (term,)))
        if finding.confidence >= b.thresholds.diagnosis.suspected:
            prediction.events.append((term, rest.beta[-term.width :].copy()))
    return found


def only_held_out(finding: Finding, thresholds: Thresholds) -> Finding:
    """Marked as seen in held-out recordings alone."""
    names = ", ".join(finding.recordings)
    said = f"Seen only in {names}, held out: no other recording speaks for it."
    return replace(
        finding,
        statement=f"{finding.statement} {said}",
        weight=finding.evidence.validation_gain,
        confidence=confidence_of(thresholds, finding.support),
        held_out_only=True,
    )
