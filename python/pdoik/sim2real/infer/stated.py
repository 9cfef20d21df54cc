"""What findings say: figures that take in what nobody states, one finding of what joints share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..findings import Estimate
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


def merged(found: list[Found], joints: tuple[str, ...]) -> list[Found]:
    """The findings, those of the same cause joined."""
    result: list[Found] = []
    groups: dict[str, list[Found]] = {}
    for finding, terms in found:
        if CATALOGUE[finding.effect].shared:
            groups.setdefault(finding.effect, []).append((finding, terms))
        else:
            result.append((finding, terms))
    for group in groups.values():
        result += _joined(group, joints)
    return result


def _near_the_median(times: FloatArray) -> list[int]:
    """Which of several joints' times are one cause's."""
    middle = float(np.median(times))
    return [i for i, t in enumerate(times) if abs(t - middle) < max(0.3 * abs(middle), 2e-3)]


def _joined(group: list[Found], joints: tuple[str, ...]) -> list[Found]:
    name = next(iter(group[0][0].parameters))
    times = np.array([finding.parameters[name].value for finding, _ in group])
    near = _near_the_median(times)
    if len(near) < 2:
        return group
    best = max((group[i] for i in near), key=lambda each: each[0].weight)
    inside = [group[i][0] for i in near]
    weight = np.array([1.0 / max(f.parameters[name].std, 1e-6) ** 2 for f in inside])
    value = float(np.sum(weight * times[near]) / weight.sum())
    # What sampling leaves open is common to the joints: their number does not make it less.
    std = float(
        max(np.std(times[near]) / np.sqrt(len(near)), min(f.parameters[name].std for f in inside))
    )
    own = best[0].parameters[name]
    joint = Estimate.normal(value, std, own.unit)
    estimate = replace(joint, spread=own.spread, spread_p=own.spread_p)
    names = tuple(j for j in joints if any(j in f.joints for f in inside))
    effect = CATALOGUE[best[0].effect]
    where = "all joints" if len(names) == len(joints) else ", ".join(names)
    others = {k: e for k, e in best[0].parameters.items() if k != name}
    one = replace(
        best[0],
        joints=names,
        parameters={name: estimate} | others,
        statement=effect.statement(where, {name: value} | {k: e.value for k, e in others.items()}),
        regime=effect.regime(where),
        confidence=max(finding.confidence for finding in inside),
    )
    terms = tuple(term for i in near for term in group[i][1])
    return [(one, terms)] + [group[i] for i in range(len(group)) if i not in near]
