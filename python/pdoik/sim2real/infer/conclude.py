"""From a finished search to the diagnosis: findings with intervals, confidence and evidence.

Figures and confidence are of the recordings to learn from. Those held out come last, and judge:
they say how much of what they show is explained, and change no finding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..channels.check_channels import ChannelCheck
from ..confirm.confidence import confidence_of
from ..controllers.check_controllers import ControllerCheck
from ..effects import CATALOGUE
from ..effects.inertial import Payload
from ..findings import Diagnosis, Equivalent, Evidence, Finding
from ..motion.prepare import Prepared
from ..regression.background import background
from ..regression.estimate import estimates
from ..regression.fit import Fit, Term
from ..regression.naming import Found, channel_of, finding_of, link_of, merged
from ..regression.prediction import Prediction
from ..regression.trial import Search
from ..select.rivals import equivalents_of
from .changing_friction import changing, with_changes
from .events import held_out_contacts, within
from .figures import Figures, figures_of
from .held_out_limits import held_out_limits
from .judged_by_simulation import SimulatedEvidence, judged_by_simulation
from .outstanding import with_outstanding
from .verdict import fitted_joints, joint_fits, notes_of, verdict_of

_NEVER = 1e-9  # share of the held-out residual that is none


@dataclass(frozen=True, kw_only=True, eq=False)
class Examination:
    """A diagnosis with all it rests on."""

    diagnosis: Diagnosis
    prepared: Prepared
    state: Search
    terms: tuple[tuple[Term, ...], ...]  # behind each finding of the diagnosis
    prediction: Prediction  # of the recordings that the diagnosis is judged by


def conclude(
    prepared: Prepared,
    state: Search,
    seed: int,
    check: ChannelCheck | None = None,
    doubtful: Sequence[Term] = (),
    control: ControllerCheck | None = None,
) -> Examination:
    """Findings, joints and verdict of a search.

    Args:
        prepared: the study.
        state: what was selected and confirmed.
        seed: of the bootstrap.
        check: what the channels were found to be.
        doubtful: terms that were left out for little confidence.
        control: what the controllers were found to be.
    """
    study = prepared.study
    suspected = _suspected(prepared, state, doubtful, seed)
    noisy, terms = background(prepared.fit)
    ordinary = Fit(noisy, terms) if terms else None
    figures = figures_of(prepared, state, seed, ordinary)
    state = figures.state

    prediction = Prediction(prepared.validate or prepared.fit)
    simulated = judged_by_simulation(prepared, state)
    found = [
        _found(prepared, figures, at, prediction, simulated, seed)
        for at in range(len(figures.terms))
    ]
    if prepared.validate is not None:
        found += held_out_limits(prepared, state.fit, prediction)
        maybe = [each for each in doubtful if state.support[each.key].gain > 0.0]
        found += held_out_contacts(prepared, state.fit, prediction, maybe)
    if check is not None:
        unsure = study.thresholds.confidence.unsupported
        found += [(replace(finding, confidence=unsure), ()) for finding in check.findings]
    if control is not None:
        found += [
            (replace(each, confidence=confidence_of(study.thresholds, each.support)), ())
            for each in control.findings
        ]
    found = merged(found, study.joints)
    found.sort(key=lambda each: -each[0].weight)
    least = study.thresholds.confidence.suspected
    suspected += tuple(finding for finding, _ in found if finding.confidence < least)
    found = [each for each in found if each[0].confidence >= least]
    joints = joint_fits(prepared, state, prediction, simulated.left)
    joints = with_outstanding(prepared, state, joints, ordinary)
    changes = changing(figures.spreads, study.thresholds.verdict)
    findings = tuple(with_changes(finding, study.joints, changes) for finding, _ in found)
    diagnosis = Diagnosis(
        verdict=verdict_of(
            findings,
            joints,
            fitted_joints(prepared, state, simulated.left),
            study.thresholds.verdict,
        ),
        findings=findings,
        joints=joints,
        notes=(
            *(control.notes if control else ()),
            *notes_of(prepared, state, joints),
            *(check.notes if check else ()),
            *figures.notes,
            *_as_judged(findings),
        ),
        suspected=suspected,
        thresholds=study.thresholds.values(),
        controllers=control.estimates if control else (),
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
    at: int,
    prediction: Prediction,
    simulated: SimulatedEvidence,
    seed: int,
) -> Found:
    """The finding of one of the terms that stand."""
    state, (term, values) = figures.state, figures.terms[at]
    channels = tuple(sorted({channel_of(prepared, key) for key in term.columns}))
    if term in state.contacts:
        evidence = within(state, term, channels)
    elif term.key in simulated.terms:
        evidence = replace(simulated.terms[term.key], channels=channels)
    else:
        evidence = prediction.evidence(state.fit, term, channels, seed)
    rivals = equivalents_of(state, term, prepared)
    if term.place in figures.loads and CATALOGUE[term.effect].is_body:
        rivals = (Equivalent(effect=Payload.id, links=link_of(prepared, term)), *rivals)[:3]
    support = state.support.get(term.key)
    finding = finding_of(prepared, term, values, rivals, evidence, support)
    weight = evidence.validation_gain if support is None else support.weight
    return replace(
        finding,
        weight=weight,
        confidence=confidence_of(
            prepared.study.thresholds, None if term.key in state.confirmed else support
        ),
    ), (term,)


def _as_judged(findings: Sequence[Finding]) -> list[str]:
    """What held-out recordings say nothing of, or contradict, in words: it stays all the same."""
    notes = []
    for each in findings:
        low, high = each.evidence.interval95
        where = ", ".join(each.links or each.joints) or "the base"
        said = f"{CATALOGUE[each.effect].words} at {where}"
        if high < 0.0:
            notes.append(
                f"{said}: contradicted by the held-out recordings, which only judge; something"
                " differs between them and the recordings to fit."
            )
        elif max(abs(low), abs(high)) < _NEVER:
            notes.append(
                f"{said}: never acts in the held-out recordings, and rests on the fit recordings"
                " alone."
            )
    return notes


def _suspected(
    prepared: Prepared, state: Search, doubtful: Sequence[Term], seed: int
) -> tuple[Finding, ...]:
    """What little speaks for, each fitted beside all that stands."""
    found = []
    for term in doubtful:
        support = state.support[term.key]
        if support.gain <= 0.0:
            continue
        values = estimates(state.fit.extended(term), (term,), seed)[0]
        none = Evidence(validation_gain=0.0, interval95=(0.0, 0.0))
        finding = finding_of(prepared, term, values, (), none, support)
        confidence = confidence_of(prepared.study.thresholds, support)
        found.append(replace(finding, weight=support.weight, confidence=confidence))
    return tuple(sorted(found, key=lambda each: -each.confidence))
