"""One finding where several joints show the same delay, lag or skew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..findings import Estimate
from ..regression import Found


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
