"""Findings made of terms: names, places and words."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE, Effect
from ..findings import ERRORS, Equivalent, Estimate, Evidence, Finding, Support
from ..motion import Gate, Key, Motion, Place, Prepared
from ..study import Study
from .fit import Term

Found = tuple[Finding, tuple[Term, ...]]


def finding_of(
    prepared: Prepared,
    term: Term,
    values: dict[str, Estimate],
    equivalents: tuple[Equivalent, ...],
    evidence: Evidence,
    support: Support | None = None,
) -> Finding:
    """The finding a term stands for."""
    study = prepared.study
    place = without_idle_gate(term.place, study)
    effect = CATALOGUE[term.effect]
    joints = tuple(study.joints[j] for j in place.joints)
    links = link_of(prepared, term)
    if effect.on == "link" and joints and prepared.body is not None:
        links = (prepared.body.links[place.joints[0]],)
    plain = {name: each.value for name, each in values.items()}
    where = where_in_words(effect.on, joints, links)
    recordings = tuple(r.name for r in study.fit)
    if place.held is not None:
        where = f"The body known as {place.held.label}"
        recordings = tuple(r.name for r in study.fit if study.setup_of(r).payload == place.held)
    if place.recording is not None:
        recordings = (place.recording,)
    window, positions, begins = place.window, None, None
    if place.gate is not None and place.gate.of == "time":
        window = ends_of(place.gate, [r.time - r.time[0] for r in study.fit])
    elif place.gate is not None and place.gate.of == "clock":
        begins = begin_of(place.gate, prepared.fit.motions)
        recordings = recordings[recordings.index(begins[0]) :]
    elif place.gate is not None:
        positions = ends_of(place.gate, [r.q[:, place.joints[0]] for r in study.fit])
    decided = effect.decided_by if equivalents or effect.confused_with else ""
    return Finding(
        effect=effect.id,
        joints=joints,
        links=links,
        recordings=recordings,
        window=window,
        begins=begins,
        positions=positions,
        edge=place.gate.edge if place.gate else 0.0,
        regime=effect.regime(_inside(where)) + gate_in_words(place.gate, ", only ", begins),
        statement=_sentence(effect.statement(where, plain))
        + gate_in_words(place.gate, " Only ", begins)
        + _of_unclear_figures(effect, values),
        parameters=values,
        equivalents=equivalents,
        decided_by=decided,
        evidence=evidence,
        support=support,
        variant=effect.variant(term.shape) if place.held is None else place.held.label,
        shape=term.shape,
    )


def link_of(prepared: Prepared, term: Term) -> tuple[str, ...]:
    """The link a term sits at, or the foot; () where at none."""
    if term.place.foot is not None and prepared.study.base is not None:
        return (prepared.study.base.feet[term.place.foot].link,)
    if term.place.link is None or prepared.body is None:
        return ()
    return (prepared.body.links[term.place.link],)


def channel_of(prepared: Prepared, key: Key) -> str:
    """The column a balance rests on."""
    source = prepared.fit.motions[0].source
    return {
        "torque": "q_des" if source == "law" else source,
        "drive": "tau_cmd",
        "law": "q_des",
        "velocity": "dq",
        "tip": "tip",
        "servo": "q_des",
        "base": "acc" if "acc" in prepared.study.recordings[0].channels else "base",
        "imu": "gyro" if key[1] < 3 else "acc",
        "foot": "base",
        "tilt": "base",
        "grip": source,
    }[key[0]]


def described(prepared: Prepared, term: Term) -> str:
    """An effect and its place in words."""
    place = term.place
    where = " and ".join(prepared.study.joints[j] for j in place.joints) or "the base"
    for link in link_of(prepared, term):
        where = link
    if place.held is not None:
        where = place.held.label
    if place.window is not None:
        where += f", {place.window[0]:.2f} to {place.window[1]:.2f} s of {place.recording}"
    since = place.gate is not None and place.gate.of == "clock"
    begins = begin_of(place.gate, prepared.fit.motions) if place.gate and since else None
    where += gate_in_words(place.gate, ", only ", begins)
    return f"{CATALOGUE[term.effect].words} at {where}"


def begin_of(gate: Gate, motions: Sequence[Motion]) -> tuple[str, float]:
    """The recording in which a gate of the study's clock opens, and when in it [s]."""
    within = [m for m in motions if m.clock <= gate.low] or motions[:1]
    last = max(within, key=lambda m: m.clock)
    return last.recording.name, float(max(gate.low - last.clock, 0.0))


def gate_in_words(gate: Gate | None, start: str, begins: tuple[str, float] | None = None) -> str:
    """When or where something acts, after `start`; "" where it always does."""
    if gate is None:
        return ""
    unit, before, after = (
        ("s", "until", "after") if gate.of == "time" else ("rad", "below", "above")
    )
    if begins is not None:
        words = f"since {begins[1]:.3g} s of {begins[0]}"
    elif np.isinf(gate.low):
        words = f"{before} {gate.high:.3g} {unit}"
    elif np.isinf(gate.high):
        words = f"{after} {gate.low:.3g} {unit}"
    else:
        words = f"from {gate.low:.3g} to {gate.high:.3g} {unit}"
    return f"{start}{words}{'.' if start.startswith(' ') else ''}"


def without_idle_gate(place: Place, study: Study) -> Place:
    """A place; without its gate where that is open in all fitted recordings throughout."""
    gate = place.gate
    if gate is None or gate.of == "clock":
        return place
    j = place.joints[0]
    axes = [r.time - r.time[0] if gate.of == "time" else r.q[:, j] for r in study.fit]
    always = all((gate.weight(np.array([x.min(), x.max()])) >= 1.0).all() for x in axes)
    return replace(place, gate=None) if always else place


def ends_of(gate: Gate, values: list[FloatArray]) -> tuple[float, float]:
    """A gate's ends, an open one where the recordings end."""
    low, high = min(float(v.min()) for v in values), max(float(v.max()) for v in values)
    return max(gate.low, low), min(gate.high, high)


def _of_unclear_figures(effect: Effect, values: dict[str, Estimate]) -> str:
    """What to know of a body none of whose figures is larger than its error, in words."""
    if effect.is_body and all(abs(each.value) < ERRORS * each.std for each in values.values()):
        return " None of its figures is clear by itself; what they do together is."
    return ""


def _sentence(text: str) -> str:
    """A sentence, with names of places in small letters where they do not begin it."""
    return re.sub(r"(?<=[a-z,] )(Joint|Joints|Link|The)\b", lambda word: word[0].lower(), text)


def _inside(where: str) -> str:
    """A place as it is named within a sentence."""
    first, _, rest = where.partition(" ")
    return f"{first.lower()} {rest}" if first in ("Joint", "Joints", "Link", "The") else where


def where_in_words(on: str, joints: tuple[str, ...], links: tuple[str, ...]) -> str:
    """Where an effect sits, as the begin of a sentence."""
    if links:
        said = ", ".join(links)
        return said if "link" in links[0].lower() else f"Link {said}"
    if joints:
        said = " and ".join(joints)
        return said if "joint" in said.lower() else f"Joint{'s' * (len(joints) > 1)} {said}"
    return {"base": "The base", "foot": "Every foot"}.get(on, "The robot")
