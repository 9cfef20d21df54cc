"""From a study to what is wrong with its model: the stages, one after the other."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .channels import ChannelCheck, check_channels
from .contact import contact_term, stands
from .effects import CATALOGUE, Key
from .equivalents import equivalents_of, swapped
from .estimate import estimates, event_estimates
from .findings import Diagnosis, Evidence, Finding, JointFit, Verdict
from .naming import Found, described, finding_of, merged
from .nuisance import trusted
from .prepare import Prepared, prepare
from .read_study import load_study
from .recording import FloatArray
from .regression import Fit, Term
from .search import Search, search
from .study import Study
from .unexplained import add_unknown
from .validation import Prediction

Tell = Callable[[str, str, float], None]

_LEAST_CONTACT = 0.01  # share of the first residual within its window
_NEAR_FLOOR = 1.6
"""A residual within this factor of the noise floor counts as explained."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Examination:
    """A diagnosis with all it rests on."""

    diagnosis: Diagnosis
    prepared: Prepared
    state: Search
    terms: tuple[tuple[Term, ...], ...]  # behind each finding of the diagnosis
    prediction: Prediction  # of the recordings that the diagnosis is judged by


def diagnose(
    study: Study | str | os.PathLike[str], *, seed: int = 0, tell: Tell | None = None
) -> Diagnosis:
    """Where and why recordings and model disagree.

    Args:
        study: a study, or its YAML file.
        seed: of the bootstrap.
        tell: called with a stage's name, what it found in words, and the share of the work done.

    Raises:
        LoadError, ValueError: the study cannot be used; the message says what was expected.
    """
    return examine(study, seed=seed, tell=tell).diagnosis


def examine(
    study: Study | str | os.PathLike[str], *, seed: int = 0, tell: Tell | None = None
) -> Examination:
    """`diagnose`, with all it rests on."""
    say = tell or (lambda stage, text, share: None)
    study = load_study(study)
    say("read", f"{len(study.recordings)} recordings of {len(study.joints)} joints", 0.02)
    prepared = prepare(study)
    say("residual", f"cut-off {prepared.cutoff:.3g} Hz, torque {_source(prepared)}", 0.15)
    check = check_channels(prepared)
    for note in check.notes:
        say("channels", note, 0.16)
    if check.mended:
        prepared = prepare(check.study, prepared.body)
    state = run_search(prepared, say)
    add_unknown(state)
    say("name", "looking for what else would explain the same", 0.75)
    swapped(state)
    forget_contacts(state)
    vetoed = veto(prepared, state)
    say("estimate", "intervals by the block bootstrap", 0.85)
    return conclude(prepared, state, seed, check, vetoed)


def run_search(prepared: Prepared, say: Tell) -> Search:
    """Accept effects, then contacts, then effects again beside these."""
    nuisance = trusted(prepared.fit, prepared.study.trust.rigid_body)
    state = search(
        prepared.fit,
        nuisance,
        lambda term, share: say("name", described(prepared, term), 0.15 + 0.5 * share),
    )
    for _ in range(4):
        term = contact_term(state.fit)
        if term is None:
            break
        say("name", described(prepared, term), 0.6)
        state = search(prepared.fit, nuisance, contacts=(*state.contacts, term))
    return state


def forget_contacts(state: Search) -> None:
    """Leave out contacts that later findings have made needless."""
    for term in state.contacts:
        others = Fit(state.balances, [t for t in state.fit.terms if t is not term])
        share = _within(state, term, ()).validation_gain
        if share < _LEAST_CONTACT or not stands(others.extended(term), term):
            state.fit = others
    state.contacts = tuple(term for term in state.contacts if term in state.fit.terms)


def veto(prepared: Prepared, state: Search) -> tuple[str, ...]:
    """Leave out what makes recordings worse that nothing was fitted to; says so in words.

    Held-out recordings choose nothing, but what they contradict is not claimed.
    """
    if prepared.validate is None:
        return ()
    notes = []
    prediction = Prediction(prepared.validate)
    for term in state.accepted:
        if term in state.contacts:
            continue
        evidence = prediction.evidence(state.fit, term, (), 0)
        if evidence.interval95[1] < 0.0:
            state.fit = Fit(state.balances, [t for t in state.fit.terms if t is not term])
            where = ", ".join(prepared.study.joints[j] for j in term.place.joints)
            notes.append(
                f"{term.effect} {where}: suggested by the fit recordings, contradicted by the"
                " held-out ones, and left out."
            )
    return tuple(notes)


def held_out_contacts(prepared: Prepared, fit: Fit, prediction: Prediction) -> list[Found]:
    """Contacts in recordings that were held out; an event is found where it happened.

    They are taken out of the residual of these recordings.
    """
    found: list[Found] = []
    if prepared.validate is None:
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
        if share < _LEAST_CONTACT:
            break
        prediction.events.append((term, rest.beta[-term.width :].copy()))
        evidence = Evidence(
            validation_gain=share,
            interval95=(share, share),
            channels=tuple(sorted({_channel(prepared, key) for key in term.columns})),
        )
        values = event_estimates(rest, term)
        found.append((finding_of(prepared, term, values, (), evidence), (term,)))
    return found


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
    values = estimates(state.fit, accepted, seed)
    found: list[Found] = []
    for number, term in enumerate(accepted):
        plain = {name: each.value for name, each in values[number].items()}
        if CATALOGUE[term.effect].trifling(plain):
            continue
        channels = tuple(sorted({_channel(prepared, key) for key in term.columns}))
        evidence = prediction.evidence(state.fit, term, channels, seed)
        if term in state.contacts:
            evidence = _within(state, term, channels)
            others = Fit(state.balances, [t for t in state.fit.terms if t is not term])
            values[number] = event_estimates(others.extended(term), term)
        rivals = equivalents_of(state, term, study.joints, prepared.body)
        finding = finding_of(prepared, term, values[number], rivals, evidence)
        found.append((finding, (term,)))
    if prepared.validate is not None:
        found += held_out_contacts(prepared, state.fit, prediction)
    if check is not None:
        found += [(finding, ()) for finding in check.findings]
    found = merged(found, study.joints)
    found.sort(key=lambda each: -each[0].evidence.validation_gain)
    joints = joint_fits(prepared, state.fit, prediction)
    findings = tuple(finding for finding, _ in found)
    diagnosis = Diagnosis(
        verdict=verdict_of(findings, joints),
        findings=findings,
        joints=joints,
        notes=(*notes_of(prepared, state, joints), *(check.notes if check else ()), *vetoed),
    )
    return Examination(
        diagnosis=diagnosis,
        prepared=prepared,
        state=state,
        terms=tuple(terms for _, terms in found),
        prediction=prediction,
    )


def _within(state: Search, term: Term, channels: tuple[str, ...]) -> Evidence:
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


def joint_fits(prepared: Prepared, fit: Fit, prediction: Prediction) -> dict[str, JointFit]:
    """Residual of each joint before and after, on held-out recordings."""
    b = prediction.balances
    left = prediction.residual(fit)
    names = ", ".join(m.recording.name for m in b.motions)
    result = {}
    for j, name in enumerate(prepared.study.joints):
        key = next((k for k in _preferred(j) if k in b.residual), None)
        if key is None:
            result[name] = JointFit(
                before=0.0, after=0.0, noise_floor=0.0, unit="N m", data=names, excited=False
            )
            continue
        rows = b.mask[key]
        excited = bool(prepared.fit.excited[j])
        if not rows.any():
            rows, excited = np.ones_like(rows), False
        result[name] = JointFit(
            before=_rms(b.residual[key][rows]),
            after=_rms(left[key][rows]),
            noise_floor=b.floor[key],
            unit="rad" if key[0] == "servo" else "N m",
            data=names,
            excited=excited,
        )
    return result


def _preferred(j: int) -> tuple[Key, ...]:
    return (("torque", j), ("servo", j), ("drive", j), ("law", j), ("velocity", j))


def verdict_of(findings: tuple[Finding, ...], joints: dict[str, JointFit]) -> Verdict:
    """The verdict in one word."""
    judged = [each for each in joints.values() if each.excited]
    if not judged:
        return "cannot_tell"
    near = all(
        each.after <= _NEAR_FLOOR * max(each.noise_floor, 1e-12) or each.after <= 0.05 * each.before
        for each in judged
    )
    named = [f for f in findings if f.effect != "unknown"]
    if not findings and any(
        not each.excited and each.before > 3.0 * each.noise_floor > 0.0 for each in joints.values()
    ):
        return "cannot_tell"
    if not findings:
        return "no_mismatch" if near or _small(judged) else "mismatch_unexplained"
    if not named:
        return "mismatch_unexplained"
    return (
        "mismatch_explained"
        if near and len(named) == len(findings)
        else ("mismatch_partly_explained")
    )


def _small(judged: list[JointFit]) -> bool:
    """Whether no joint is far from its floor: a factor of two is no mismatch worth a name."""
    return all(each.after <= 2.0 * each.noise_floor for each in judged)


def notes_of(prepared: Prepared, state: Search, joints: dict[str, JointFit]) -> tuple[str, ...]:
    """What was assumed and what cannot be told, in words."""
    study = prepared.study
    notes = list(study.notes)
    for recording in study.recordings:
        notes += [f"{recording.name}: {note}" for note in recording.notes]
    notes.append(f"Fit and held-out recordings were parted {study.split}.")
    notes.append(
        f"Both sides of every balance were filtered at {prepared.cutoff:.3g} Hz without delay;"
        f" torque is {_source(prepared)}."
    )
    if prepared.fit.motions[0].source == "":
        notes.append(
            "Without torques, or gains of the controller, friction, play, loads and inertias cannot"
            " be told apart: only how positions follow their commands."
        )
    still = [name for name, each in joints.items() if not each.excited]
    if still:
        notes.append(f"{', '.join(still)}: moved too little to be judged.")
    if state.nuisance:
        notes.append(
            f"The model's masses, centres and inertias were adjusted within"
            f" {100 * (study.trust.rigid_body or 0.0):.3g} %, as the study allows."
        )
    return tuple(dict.fromkeys(notes))


def _source(prepared: Prepared) -> str:
    words = {
        "tau": "as the drives report it",
        "current": "in proportion to the drives' currents",
        "tau_cmd": "as commanded (none was reported)",
        "law": "by the controller's law (none was recorded)",
        "": "not known: positions are held against their commands",
    }
    return words[prepared.fit.motions[0].source]


def _channel(prepared: Prepared, key: Key) -> str:
    source = prepared.fit.motions[0].source
    return {
        "torque": "q_des" if source == "law" else source,
        "drive": "tau_cmd",
        "law": "q_des",
        "velocity": "dq",
        "tip": "tip",
        "servo": "q_des",
    }[key[0]]


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
