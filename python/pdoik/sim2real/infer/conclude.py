"""The diagnosis of what was identified: findings with intervals, confidence and evidence.

Figures and confidence are of the recordings to learn from. Those held out come last, and judge:
they say how much of what they show is explained, and change no finding.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..channels import ChannelCheck
from ..controllers import ControllerCheck
from ..effects import CATALOGUE
from ..effects.bodies import Payload
from ..findings import (
    MOST_EQUIVALENTS,
    Diagnosis,
    Equivalent,
    Estimate,
    Evidence,
    Finding,
    OrdinaryPart,
)
from ..identify import Identified, Part, confidence_of, estimates
from ..motion import Prepared
from ..regression import (
    Fit,
    Found,
    Prediction,
    Term,
    background,
    channel_of,
    effect_of,
    finding_of,
    link_of,
)
from .events import held_out_contacts, held_out_limits, within
from .figures import Figures, figures_of, with_torque_scale
from .standing_out import changing, spreads_of, with_changes, with_outstanding
from .stated import merged, with_unsaid
from .verdict import (
    SimulatedEvidence,
    fitted_joints,
    joint_fits,
    judged_by_simulation,
    notes_of,
    verdict_of,
)

_NEVER = 1e-9  # numerics: share of the held-out residual that is none


@dataclass(frozen=True, kw_only=True, eq=False)
class Examination:
    """A diagnosis with all it rests on."""

    diagnosis: Diagnosis
    prepared: Prepared
    state: Identified
    terms: tuple[tuple[Term, ...], ...]  # behind each finding of the diagnosis
    prediction: Prediction  # of the recordings that the diagnosis is judged by


def conclude(
    prepared: Prepared,
    state: Identified,
    seed: int,
    check: ChannelCheck,
    control: ControllerCheck,
) -> Examination:
    """Findings, joints and verdict.

    Args:
        prepared: the study.
        state: what was identified and confirmed.
        seed: of the bootstrap.
        check: what the channels were found to be.
        control: what the controllers were found to be.
    """
    study = prepared.study
    suspected, whole = _suspected(prepared, state, seed), state
    ordinary = Fit(*background(prepared.fit))
    prediction = Prediction(prepared.validate or prepared.fit)
    figures = figures_of(prepared, state, seed)
    simulated = judged_by_simulation(prepared, figures.state)
    found: list[Found] = []
    against: list[Term] = []
    changes = changing(spreads_of(ordinary), study.thresholds)
    for term, values in figures.terms:
        each = _found(prepared, figures, term, values, prediction, simulated, seed)
        # Of friction that is another one in every recording, one more is no contradiction.
        known = _is_ordinary(state, term)
        changed = known and _changes(term, changes)
        if not changed and _is_contradicted(prepared, each, ordinary=known):
            against.append(term)
            suspected += (_suspect(prepared, each),)
        else:
            found.append((each, (term,)))
    # The rest was learnt with them, and stays as it is; nothing is predicted with them.
    prediction.apart |= {term.key for term in against}
    state = figures.state
    if prepared.validate is not None:
        found += held_out_limits(prepared, state.fit, prediction)
        maybe = [each for each in state.doubtful if state.support[each.key].gain > 0.0]
        found += held_out_contacts(prepared, state.fit, prediction, maybe)
    unsure = study.thresholds.confidence.unsupported
    found += [(replace(finding, confidence=unsure), ()) for finding in check.findings]
    found += [
        (replace(each, confidence=confidence_of(study.thresholds, each.support)), ())
        for each in control.findings
    ]
    found = merged(found, study.joints)
    found.sort(key=lambda each: -each[0].weight)
    least = study.thresholds.diagnosis.suspected
    found = [(_if_sized(each, least), terms) for each, terms in found]
    suspected += tuple(finding for finding, _ in found if finding.confidence < least)
    found = with_unsaid(prepared, whole, [each for each in found if each[0].confidence >= least])
    joints = joint_fits(prepared, state, prediction, simulated.left)
    joints = with_outstanding(prepared, state, joints, ordinary)
    findings = tuple(with_changes(finding, study.joints, changes) for finding, _ in found)
    diagnosis = Diagnosis(
        verdict=verdict_of(
            findings,
            joints,
            fitted_joints(prepared, state, simulated.left),
            study.thresholds.diagnosis,
        ),
        findings=findings,
        joints=joints,
        notes=(
            *control.notes,
            *notes_of(prepared, state, joints),
            *check.notes,
            *figures.notes,
            *_as_judged(findings),
        ),
        suspected=suspected,
        thresholds=study.thresholds.values(),
        controllers=control.estimates,
        ordinary=tuple(_ordinary_part(prepared, part) for part in state.ordinary),
    )
    return Examination(
        diagnosis=diagnosis,
        prepared=prepared,
        state=state,
        terms=tuple(terms for _, terms in found),
        prediction=prediction,
    )


def _found(
    prepared: Prepared,
    figures: Figures,
    term: Term,
    values: dict[str, Estimate],
    prediction: Prediction,
    simulated: SimulatedEvidence,
    seed: int,
) -> Finding:
    """The finding of one of the terms that stand."""
    state = figures.state
    channels = tuple(sorted({channel_of(prepared, key) for key in term.columns}))
    if term in state.contacts:
        evidence = within(state, term, channels)
    elif term.key in simulated.terms:
        evidence = replace(simulated.terms[term.key], channels=channels)
    else:
        evidence = prediction.evidence(state.fit, term, channels, seed)
    rivals = _equivalents(state, term, prepared)
    if term.place in figures.loads and CATALOGUE[term.effect].is_body:
        rivals = (Equivalent(effect=Payload.id, links=link_of(prepared, term)), *rivals)[
            :MOST_EQUIVALENTS
        ]
    support = state.support.get(term.key)
    finding = finding_of(prepared, term, values, rivals, evidence, support)
    weight = evidence.validation_gain if support is None else support.weight
    return replace(
        finding,
        weight=weight,
        confidence=confidence_of(
            prepared.study.thresholds, None if term.key in state.confirmed else support
        ),
    )


def _equivalents(state: Identified, term: Term, prepared: Prepared) -> tuple[Equivalent, ...]:
    """The other names that are nearly as likely, at most three, the likeliest first."""
    found = [
        Equivalent(
            effect=rival.term.effect,
            joints=tuple(prepared.study.joints[j] for j in rival.term.place.joints),
            links=link_of(prepared, rival.term),
        )
        for rival in state.rivals.get(term.key, ())
    ]
    return tuple(dict.fromkeys(found))[:MOST_EQUIVALENTS]


def _ordinary_part(prepared: Prepared, part: Part) -> OrdinaryPart:
    """A part of what every machine has, in the words of its effect."""
    effect, place = effect_of(part.term), part.term.place
    first = effect.parameters[0]
    nothing = np.zeros(part.term.width)
    none = effect.values(part.term.shape, nothing)[first.name] if not effect.is_body else 0.0
    estimate = Estimate.normal(none + part.value, part.std, first.unit)
    torque = with_torque_scale(prepared.study, {first.name: estimate})[first.name]
    return OrdinaryPart(
        effect=effect.id,
        joints=tuple(prepared.study.joints[j] for j in place.joints),
        links=link_of(prepared, part.term),
        parameter=first.name,
        estimate=torque,
        negligible=part.negligible,
    )


def _is_contradicted(prepared: Prepared, finding: Finding, *, ordinary: bool) -> bool:
    """Whether recordings that only judge are better with it by next to nothing.

    Given everything else that was found, as share of what they leave without it. What acts in a
    part only, or is not separated from the rest, must be sure by itself too, unless it is much: of
    few stretches in which it acts there is none in some that are drawn.
    What every machine has is there in any case: it is only not to make them worse.
    """
    if prepared.validate is None:
        return False
    seen, believed = finding.evidence, prepared.study.thresholds.diagnosis
    if ordinary:
        return _acts(seen) and seen.validation_gain < 0.0
    little = seen.with_others is not None and seen.with_others < believed.judged
    unsure = seen.interval95[0] < 0.0 and seen.validation_gain < believed.judged
    by_itself = seen.with_others is None or finding.gate is not None
    return _acts(seen) and (little or (by_itself and unsure))


def _changes(term: Term, joints: Collection[int]) -> bool:
    """Whether it is friction of one of these joints."""
    return CATALOGUE[term.effect].family == "friction" and set(term.place.joints) <= set(joints)


def _acts(seen: Evidence) -> bool:
    """Whether recordings that only judge say anything of a cause."""
    return max(map(abs, seen.interval95)) >= _NEVER


def _if_sized(finding: Finding, suspected: float) -> Finding:
    """A finding whose size may as well be nothing, by its own interval, is only suspected.

    Its size is its first figure, or all of them. A function's values have been judged together.
    That another day's friction may be nothing, of few that were seen, is no doubt of these days'.
    """
    effect = CATALOGUE[finding.effect]
    named = [each.name for each in effect.parameters if not each.chosen]
    sizes = [name for name in named if name in finding.parameters]
    nothing = (effect.example and effect.example.nothing) or {}
    if effect.size_first:
        sizes, nothing = sizes[:1], {}
    if not sizes or not all(
        _may_be(finding.parameters[name], nothing.get(name, 0.0)) for name in sizes
    ):
        return finding
    return replace(finding, confidence=min(finding.confidence, suspected - 1e-3))


def _may_be(figure: Estimate, value: float) -> bool:
    """Whether a value lies within an interval of these days' figure."""
    if figure.spread is not None:
        figure = Estimate.normal(figure.value, figure.std, figure.unit)
    low, high = figure.interval95
    return low <= value <= high


def _is_ordinary(state: Identified, term: Term) -> bool:
    """Whether it is a part of what every machine has, which is sized and not selected."""
    parts = {part.term.key for part in state.ordinary}
    return term.key in parts and CATALOGUE[term.effect].ordinary


def _suspect(prepared: Prepared, finding: Finding) -> Finding:
    """What was found and then contradicted is not claimed."""
    most = prepared.study.thresholds.diagnosis.suspected
    worse = finding.evidence.interval95[1] < 0.0
    how = "contradict it" if worse else "show next to nothing of it"
    said = f"{finding.statement} The held-out recordings, which only judge, {how}."
    return replace(finding, statement=said, confidence=min(finding.confidence, most))


def _as_judged(findings: Sequence[Finding]) -> list[str]:
    """What held-out recordings say nothing of, in words: it stays all the same."""
    notes = []
    for each in findings:
        where = ", ".join(each.links or each.joints) or "the base"
        said = f"{CATALOGUE[each.effect].words} at {where}"
        if not _acts(each.evidence):
            notes.append(
                f"{said}: never acts in the held-out recordings, and rests on the fit recordings"
                " alone."
            )
    return notes


def _suspected(prepared: Prepared, state: Identified, seed: int) -> tuple[Finding, ...]:
    """Findings that are likely and not claimed, given all that is claimed."""
    found = []
    for term in state.doubtful:
        support = state.support[term.key]
        values = estimates(state.fit, (term,), seed)[0]
        finding = finding_of(prepared, term, values, (), Evidence.once(0.0), support)
        most = prepared.study.thresholds.diagnosis.suspected
        confidence = min(confidence_of(prepared.study.thresholds, support), most)
        found.append(replace(finding, weight=support.weight, confidence=confidence))
    return tuple(sorted(found, key=lambda each: -each.confidence))
