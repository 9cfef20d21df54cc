"""Contacts that held-out recordings alone show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..confirm.event_support import event_support
from ..findings import Evidence, Finding
from ..identify.confidence import confidence_of
from ..identify.contacts import contact_term, pauses, stands
from ..identify.figures import event_estimates
from ..identify.identified import Identified
from ..motion.balances import Balances
from ..motion.prepare import Prepared
from ..regression.fit import Fit, Term
from ..regression.naming import Found, channel_of, finding_of
from ..regression.prediction import Prediction
from ..regression.trusted_bodies import effect_of
from ..thresholds import Thresholds


def within(state: Identified, term: Term, channels: tuple[str, ...]) -> Evidence:
    """Evidence of an event in recordings to fit, held against its own window."""
    first = {key: state.start.residual(key) for key in term.columns}
    share = event_support(state.without(term).fit, term, first).weight
    return Evidence(validation_gain=share, interval95=(share, share), channels=channels)


def held_out_contacts(
    prepared: Prepared, fit: Fit, prediction: Prediction, suspected: Sequence[Term] = ()
) -> list[Found]:
    """Contacts in recordings that were held out; an event is found where it happened.

    They are taken out of the residual of these recordings. None are looked for beside a torque
    without a name: what its function misses where it was not learnt looks like events. So does
    what is only suspected, and a model that fails from a recording's first row to its last.

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
    least, rest = b.thresholds.contacts, _left(b, prediction, fit)
    beside = _left(b, prediction, fit.extended(*suspected))
    for _ in range(least.most_held_out):
        term = contact_term(beside)
        if term is None:
            break
        beside, with_it = beside.extended(term), rest.extended(term)
        if not pauses(beside, term):
            break
        if not stands(with_it, term):
            continue
        first = {key: b.residual[key][rest.rows[key]] / b.sigma[key] for key in term.columns}
        support = event_support(rest, term, first)
        rest = with_it
        if support.weight < least.least_weight:
            break
        evidence = Evidence(
            validation_gain=support.weight,
            interval95=(support.weight, support.weight),
            channels=tuple(sorted({channel_of(prepared, key) for key in term.columns})),
        )
        finding = finding_of(prepared, term, event_estimates(rest, term), (), evidence, support)
        finding = only_held_out(finding, b.thresholds)
        found.append((finding, (term,)))
        if finding.confidence >= b.thresholds.confidence.suspected:
            prediction.events.append((term, rest.beta[-term.width :].copy()))
    return found


def _left(balances: Balances, prediction: Prediction, fit: Fit) -> Fit:
    """A fit of nothing yet to what another leaves of other recordings."""
    found, left = Fit(balances, ()), prediction.residual(fit)
    for key in found.target:
        found.target[key] = left[key][found.rows[key]] / balances.sigma[key]
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
