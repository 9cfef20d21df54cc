"""Findings in the simulator's own words by what was fitted, and a verdict of their step."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import t as student

from pdoik.recordings import FloatArray

from ..findings import Equivalent, Evidence, Finding, JointFit, Verdict
from ..thresholds import SimulatorThresholds
from .candidates import ParameterId, Term, baseline, model_with
from .explain import Explained
from .property import EVERY
from .user_model import UserModel
from .vocabulary import PROPERTIES


@dataclass(frozen=True, slots=True, kw_only=True)
class Changed:
    """One property that the patch changes, and its value before."""

    parameter_id: ParameterId
    before: float
    after: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Step:
    """One of the two questions: what a log has beyond a model, with its verdict."""

    model: str  # what was compared with the log
    log: str  # simulator or machine
    verdict: Verdict
    findings: tuple[Finding, ...]  # whose names are believed
    suspected: tuple[Finding, ...]
    joints: dict[str, JointFit]  # positions on held-out data, with the patch
    changed: tuple[Changed, ...]
    explained: Explained


def step_of(explained: Explained, log: str, limits: SimulatorThresholds) -> Step:
    """Verdict, findings by what they gain on held-out data, and the joints' errors."""
    user = explained.user
    order = sorted(explained.terms, key=lambda term: -explained.share[term])
    joints = _joints(explained, limits)
    claimed = [term for term in order if explained.claims(term, limits)]
    return Step(
        model=user.name,
        log=log,
        verdict=_verdict(explained, joints, bool(explained.kept), limits),
        findings=tuple(_finding(explained, term, limits) for term in claimed),
        suspected=tuple(
            _finding(explained, term, limits)
            for term in order
            if term not in claimed and explained.there(term) >= limits.least_suspected
        ),
        joints=joints,
        changed=_changed(explained),
        explained=explained,
    )


_GAINS = {"kp": ("kp",), "kv": ("kv",), "kp_factor": ("kp",), "gain_factor": ("kp", "kv")}
"""The gains of a file that each fitted property changes."""


def _changed(explained: Explained) -> tuple[Changed, ...]:
    """What the patch changes, in words that a file has: shared gains are each joint's own."""
    user, model = explained.user, model_with(explained.user, explained.patch)
    found = {}
    for parameter_id, value in sorted(explained.patch.items(), key=lambda pair: pair[0]):
        if parameter_id.property in _GAINS:
            own = range(len(user.joints)) if parameter_id.index == EVERY else (parameter_id.index,)
            for mine in (
                ParameterId(name, k) for name in _GAINS[parameter_id.property] for k in own
            ):
                after = baseline(replace(user, model=model), mine)
                found[mine] = Changed(parameter_id=mine, before=baseline(user, mine), after=after)
        else:
            found[parameter_id] = Changed(
                parameter_id=parameter_id, before=baseline(user, parameter_id), after=value
            )
    return tuple(found.values())


def place_of(user: UserModel, parameter_id: ParameterId) -> str:
    """The joint or link of a parameter, in words."""
    if parameter_id.index == EVERY:
        return "all joints"
    if PROPERTIES[parameter_id.property].place == "link":
        return str(user.model.body(user.body_of(parameter_id.index)).name)
    return user.joints[parameter_id.index]


def _finding(explained: Explained, term: Term, limits: SimulatorThresholds) -> Finding:
    user, held_out = explained.user, explained.held_out
    gains = explained.gains[term]
    gain = explained.share[term]
    error = float(np.std(gains, ddof=1)) * np.sqrt(len(gains)) if len(gains) > 1 else np.inf
    share = gain * error / max(float(gains.sum()), 1e-300)  # of its gain, by how blocks differ
    values = explained.patch if term in explained.kept else explained.values
    blocks = max(3, explained.blocks - len(explained.values))
    width = float(student.ppf(0.975, blocks))
    parameters = {}
    for parameter_id in term.parameter_ids:
        value = values.get(parameter_id, baseline(user, parameter_id))
        parameters[parameter_id.property] = explained.estimate(parameter_id, value, width)
    rivals = explained.rivals[term]
    linked = PROPERTIES[term.parameter_ids[0].property].place == "link"
    places = tuple(
        dict.fromkeys(place_of(user, parameter_id) for parameter_id in term.parameter_ids)
    )
    if term.indices == {EVERY}:
        places = user.joints
    name = places[0] if len(places) == 1 else "all joints"
    said = ", ".join(
        f"{each.property} {baseline(user, each):.3g} -> {parameters[each.property].value:.3g}"
        f" {PROPERTIES[each.property].unit}"
        for each in term.parameter_ids
    )
    return Finding(
        effect=term.name,
        joints=() if linked else places,
        links=places if linked else (),
        recordings=tuple(each.file or each.name for each in held_out.recordings),
        statement=f"{name}: {said}",
        parameters=parameters,
        equivalents=tuple(
            Equivalent(
                effect=each.term.name,
                **{
                    "links"
                    if PROPERTIES[each.term.parameter_ids[0].property].place == "link"
                    else "joints": (place_of(user, each.term.parameter_ids[0]),)
                },
            )
            for each in rivals
        ),
        decided_by=_decided_by(explained, term),
        evidence=Evidence(
            validation_gain=gain,
            interval95=(gain - 1.96 * share, gain + 1.96 * share),
            channels=("q", "tau") if held_out.torque else ("q",),
        ),
        weight=gain,
        confidence=explained.confidence(term, limits),
    )


_SPEED = {"damping", "kv"}
_LOAD = {"mass", "payload", "ref", "stiffness", "kp", "gains"}


def _decided_by(explained: Explained, term: Term) -> str:
    """The motion that would part a term from its rivals; "" where none would, or none is needed."""
    names = {each.term.name for each in explained.rivals[term] if not each.same} | {term.name}
    if len(names) == 1:
        return ""
    if "frictionloss" in names and names & _SPEED:
        return "the same path at a quarter and at four times the speed: dry friction stays the same"
    if "armature" in names:
        return "faster reversals: inertia grows with the square of the frequency"
    if names & _LOAD:
        return "rest at several postures across the range: loads turn with gravity, gains do not"
    return "motion of this joint alone, slow and fast"


def _joints(explained: Explained, limits: SimulatorThresholds) -> dict[str, JointFit]:
    held_out = explained.held_out
    found = {}
    for k, joint in enumerate(explained.user.joints):
        measured = held_out.measured[:, k]
        found[joint] = JointFit(
            before=_rms(measured - explained.before[:, k]),
            after=_rms(measured - explained.after[:, k]),
            noise_floor=float(np.hypot(explained.noise[k], explained.of_step[k])),
            unit="rad",
            data=", ".join(dict.fromkeys(each.name for each in held_out.recordings)),
            excited=bool(np.ptp(measured) > limits.moves),
        )
    return found


def _verdict(
    explained: Explained,
    joints: dict[str, JointFit],
    found: bool,
    limits: SimulatorThresholds,
) -> Verdict:
    moved = [fit for fit in joints.values() if fit.excited]
    if not moved:
        return "cannot_tell"
    if all(fit.before <= limits.alike * fit.noise_floor for fit in moved) and not found:
        return "no_mismatch"
    before = sum(fit.before**2 - fit.noise_floor**2 for fit in moved)
    after = sum(max(fit.after**2 - fit.noise_floor**2, 0.0) for fit in moved)
    if not found:
        return "mismatch_unexplained"
    if after <= (1.0 - limits.explained) * before:
        return "mismatch_explained"
    return "mismatch_partly_explained"


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
