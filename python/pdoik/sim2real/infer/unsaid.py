"""What is in the model and not stated, in the figures of what is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..effects import CATALOGUE
from ..identify import Identified
from ..motion import Prepared
from ..regression import Found, Term, TermKey, finding_of


def with_unsaid(prepared: Prepared, state: Identified, found: Sequence[Found]) -> list[Found]:
    """Findings whose figures take in what a reader would take for them.

    A joint's friction is a level and a slope. Where one of them is too little, or too unsure, to be
    stated, the other is read as all of its friction: it is given as much more as the unstated one
    comes to along the motion, as far as that looks like it. Its interval stays as wide: the two are
    known worse apart than together.
    """
    said = {term.key for _, terms in found for term in terms}
    result = []
    for finding, terms in found:
        more = _unsaid(state, terms[0], said) if len(terms) == 1 else 0.0
        if more:
            name = next(iter(finding.parameters))
            own = finding.parameters[name]
            values = {**finding.parameters, name: own.moved(own.value + more)}
            again = finding_of(
                prepared, terms[0], values, finding.equivalents, finding.evidence, finding.support
            )
            finding = replace(again, weight=finding.weight, confidence=finding.confidence)
        result.append((finding, terms))
    return result


def _unsaid(state: Identified, term: Term, said: set[TermKey]) -> float:
    """What a term includes and nobody states, as its own coefficient."""
    carries, fit, more = CATALOGUE[term.effect].carries, state.fit, 0.0
    for other in fit.terms:
        if other.effect not in carries or other.place != term.place or other.key in said:
            continue
        square = alike = 0.0
        for key in other.columns.keys() & term.columns.keys():
            weight = 1.0 / fit.balances.sigma[key]
            mine = term.columns[key][fit.rows[key], 0] * weight
            square += float(mine @ mine)
            alike += float(mine @ other.columns[key][fit.rows[key], 0]) * weight
        if square > 0.0:
            more += alike / square * float(fit.bounded()[fit.span(other)][0])
    return more
