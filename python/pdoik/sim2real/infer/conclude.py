"""From a finished search to the diagnosis: findings with intervals and evidence."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..channels.check_channels import ChannelCheck
from ..confirm.simulated_estimates import simulated_estimates
from ..effects import CATALOGUE
from ..effects.inertial import Payload
from ..findings import Diagnosis, Equivalent, Estimate, Evidence
from ..motion.prepare import Prepared
from ..regression.estimate import estimates, event_estimates
from ..regression.fit import Fit, Term
from ..regression.naming import Found, channel_of, described, finding_of, link_of, merged
from ..regression.prediction import Prediction
from ..regression.second_order import to_second_order
from ..regression.trial import Search
from ..regression.trusted_bodies import effect_of
from ..select.contacts import contact_term
from ..select.rivals import equivalents_of
from .bodies import by_moments
from .held_out_limits import held_out_limits
from .sampling import widened, without_sampling
from .verdict import fitted_joints, joint_fits, notes_of, verdict_of

LEAST_CONTACT = 0.01
"""Share of the first residual within its window that a contact must explain."""

_CLEAR_TOGETHER = 100.0
"""Wald statistic of all figures of a body, above which they are not nothing together."""


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
    vetoed: tuple[str, ...] = (),
) -> Examination:
    """Findings, joints and verdict of a search."""
    study = prepared.study
    held_out = prepared.validate or prepared.fit
    prediction = Prediction(held_out)
    motions = prepared.fit.motions
    accepted = tuple(
        term
        for term in state.accepted
        if not CATALOGUE[term.effect].negligible(motions, term.shape)
    )
    accepted, unsure = without_sampling(prepared, state.fit, accepted)
    values = estimates(state.fit, accepted, seed)
    accepted, values, loads = by_moments(state, accepted, values, seed)
    values = {i: to_second_order(state.fit, t, values[i]) for i, t in enumerate(accepted)}
    values, simulated = simulated_estimates(prepared, state, accepted, values)
    found: list[Found] = []
    lost: list[Term] = []
    for number, term in enumerate(accepted):
        values[number] = widened(motions, term, values[number])
        plain = {name: each.value for name, each in values[number].items()}
        if CATALOGUE[term.effect].trifling(plain):
            continue
        if term not in state.contacts and _is_lost_in_its_error(state.fit, term, values[number]):
            unsure.append(f"{described(prepared, term)}: suggested, but not larger than its error.")
            lost.append(term)
            continue
        if said := at_bound(state.fit, term, values[number]):
            unsure.append(f"{described(prepared, term)}: {said}, so it explains nothing.")
            lost.append(term)
            continue
        channels = tuple(sorted({channel_of(prepared, key) for key in term.columns}))
        evidence = prediction.evidence(state.fit, term, channels, seed)
        if term in state.contacts:
            evidence = within(state, term, channels)
            others = Fit(state.balances, [t for t in state.fit.terms if t is not term])
            values[number] = event_estimates(others.extended(term), term)
        if term.key in state.confirmed:
            evidence = replace(state.confirmed[term.key], channels=channels)
        rivals = equivalents_of(state, term, study.joints, prepared.body)
        if term.place in loads and CATALOGUE[term.effect].is_body:
            rivals = (Equivalent(effect=Payload.id, links=link_of(prepared, term)), *rivals)[:3]
        finding = finding_of(prepared, term, values[number], rivals, evidence)
        found.append((finding, (term,)))
    if lost:
        state.fit = Fit(state.balances, [t for t in state.fit.terms if t not in lost])
    if prepared.validate is not None:
        found += held_out_limits(prepared, state.fit, prediction)
        found += held_out_contacts(prepared, state.fit, prediction)
    if check is not None:
        found += [(finding, ()) for finding in check.findings]
    found = merged(found, study.joints)
    found.sort(key=lambda each: -each[0].evidence.validation_gain)
    joints = joint_fits(prepared, state, prediction)
    findings = tuple(finding for finding, _ in found)
    diagnosis = Diagnosis(
        verdict=verdict_of(findings, joints, fitted_joints(prepared, state)),
        findings=findings,
        joints=joints,
        notes=(
            *notes_of(prepared, state, joints),
            *(check.notes if check else ()),
            *vetoed,
            *([simulated] if simulated else []),
            *unsure,
        ),
    )
    return Examination(
        diagnosis=diagnosis,
        prepared=prepared,
        state=state,
        terms=tuple(terms for _, terms in found),
        prediction=prediction,
    )


def _is_lost_in_its_error(fit: Fit, term: Term, values: dict[str, Estimate]) -> bool:
    """Whether the size of what was found, or of a body all its figures, may as well be zero.

    Of a body each figure may be nothing while their combinations, which are what motors feel, are
    not: then it stays.
    """
    sizes = list(values.values())
    effect = CATALOGUE[term.effect]
    body = effect.is_body
    if effect.size_first:
        sizes = sizes[:1]
    elif not body:
        return False
    if any(abs(each.value) >= 2.0 * each.std for each in sizes):
        return False
    if not body:
        return True
    others = Fit(fit.balances, [each for each in fit.terms if each is not term])
    return others.extended(term).wald(term)[0] < _CLEAR_TOGETHER


_ON_IT = 1e-3  # relative: how near to a bound a figure lies on it


def at_bound(fit: Fit, term: Term, values: dict[str, Estimate]) -> str:
    """Which figure of a term lies on a bound of its effect, in words; "" where none does.

    A figure that would go on beyond what it may be is pulled by something else.
    """
    effect = CATALOGUE[term.effect]
    for each in effect.parameters:
        if each.name not in values or each.chosen:
            continue
        value = values[each.name].value
        for bound, beyond in ((each.lower, each.lower - value), (each.upper, value - each.upper)):
            if bound and np.isfinite(bound) and beyond >= -_ON_IT * abs(bound):
                return f"its {each.name.replace('_', ' ')} lies on its bound, {bound:g} {each.unit}"
    if term.fixed or term.width != 1 or effect.shown_poorly:  # the last are told by simulations
        return ""
    beta = fit.bounded()[int(fit.offsets[fit.terms.index(term)])]
    for bound in (float(limit[0]) for limit in effect.bounds):
        if bound and np.isfinite(bound) and abs(beta - bound) <= _ON_IT * abs(bound):
            figures = ", ".join(f"{name} {each.value:.3g}" for name, each in values.items())
            return f"it lies on a bound of what it may be ({figures})"
    return ""


def held_out_contacts(prepared: Prepared, fit: Fit, prediction: Prediction) -> list[Found]:
    """Contacts in recordings that were held out; an event is found where it happened.

    They are taken out of the residual of these recordings. None are looked for beside a torque
    without a name: what its function misses where it was not learnt looks like events.
    """
    found: list[Found] = []
    if prepared.validate is None or any(effect_of(term).sought == "last" for term in fit.terms):
        return found
    b = prepared.validate
    left = prediction.residual(fit)
    rest = Fit(b, ())
    for key in rest.target:
        rest.target[key] = left[key][rest.rows[key]] / b.sigma[key]
    for _ in range(3):
        term = contact_term(rest)
        if term is None:
            break
        rest = rest.extended(term)
        share = prediction.share(rest, term)
        if share < LEAST_CONTACT:
            break
        prediction.events.append((term, rest.beta[-term.width :].copy()))
        evidence = Evidence(
            validation_gain=share,
            interval95=(share, share),
            channels=tuple(sorted({channel_of(prepared, key) for key in term.columns})),
        )
        values = event_estimates(rest, term)
        found.append((finding_of(prepared, term, values, (), evidence), (term,)))
    return found


def within(state: Search, term: Term, channels: tuple[str, ...]) -> Evidence:
    """Evidence of an event: it cannot repeat, so it is held against its own window."""
    others = Fit(state.balances, [t for t in state.fit.terms if t is not term])
    fit = others.extended(term)
    gained = began = 0.0
    for key, column in term.columns.items():
        at = np.any(column[fit.rows[key]] != 0.0, axis=1)
        gained += float(np.sum(others.residual(key)[at] ** 2 - fit.residual(key)[at] ** 2))
        began += float(np.sum(state.start.residual(key)[at] ** 2))
    share = float(np.clip(gained / max(began, 1e-12), 0.0, 1.0))
    return Evidence(validation_gain=share, interval95=(share, share), channels=channels)
