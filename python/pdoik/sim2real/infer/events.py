"""Contacts that held-out recordings alone show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..findings import Evidence, Finding
from ..identify import Identified, confidence_of, contact_term, event_estimates, pauses, stands
from ..motion import Prepared
from ..regression import Fit, Found, Prediction, Term, channel_of, effect_of, finding_of
from ..thresholds import Thresholds
from .event_support import event_support

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
