"""What a diagnosis leaves open: each finding, and what may be there instead of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE, Effect
from ..findings import Diagnosis, Equivalent, Finding
from ..model import places_of
from ..motion import Balances, Key, Place, Prepared, Shape
from ..regression import where_in_words
from ..thresholds import ProposeThresholds

ENOUGH = ProposeThresholds().enough
"""Confidence from which a finding needs no further motion."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cause:
    """An effect with its figures, at a place, or at several that share them."""

    effect: Effect
    places: tuple[Place, ...]
    shape: Shape
    beta: FloatArray
    words: str

    @property
    def key(self) -> tuple[object, ...]:
        """The same for the same cause with the same figures."""
        return self.effect.id, self.places, self.shape, tuple(self.beta.tolist())

    @property
    def is_costly(self) -> bool:
        """Whether its columns are a simulation of their own."""
        return self.effect.costly

    def columns(self, balances: Balances) -> dict[Key, FloatArray]:
        """Columns of each coefficient, (N, k) by key, those of several places side by side."""
        found = [balances.columns(self.effect, place, self.shape) for place in self.places]
        widths = [next((c.shape[1] for c in each.values()), 0) for each in found]
        ends = np.cumsum([0, *widths])
        result: dict[Key, FloatArray] = {}
        for each, first, last in zip(found, ends[:-1], ends[1:], strict=True):
            for key, column in each.items():
                result.setdefault(key, np.zeros((balances.count, int(ends[-1]))))
                result[key][:, first:last] = column
        return result

    def contribution(self, balances: Balances) -> dict[Key, FloatArray]:
        """What it adds with its figures, (N,) by key."""
        total: dict[Key, FloatArray] = {}
        for place in self.places:
            for key, column in balances.columns(self.effect, place, self.shape).items():
                total[key] = total.get(key, 0.0) + column @ self.beta[: column.shape[1]]
        return total


@dataclass(frozen=True, kw_only=True, eq=False)
class Option:
    """What may be there instead, its figures not known yet."""

    effect: Effect
    places: tuple[tuple[Place, ...], ...]  # those to choose from
    listed: bool  # by the diagnosis; else only often confused with it


@dataclass(frozen=True, kw_only=True, eq=False)
class Question:
    """A finding that is not settled."""

    finding: Finding
    own: Cause
    options: tuple[Option, ...]
    why: str  # what is open, in words


def open_findings(diagnosis: Diagnosis) -> tuple[Finding, ...]:
    """What is suspected, and findings that list equivalents or are less sure than is enough.

    What is listed as another name of the same body, a payload in the hand and an error of the
    hand, is distinguished by no motion: it is no equivalent here.
    """
    found = [
        replace(each, equivalents=tuple(e for e in each.equivalents if not _one_body(each, e)))
        for each in (*diagnosis.findings, *diagnosis.suspected)
    ]
    sure = len(diagnosis.findings)
    return tuple(
        each
        for k, each in enumerate(found)
        if k >= sure or each.equivalents or each.confidence < ENOUGH
    )


def _one_body(finding: Finding, other: Equivalent) -> bool:
    names = CATALOGUE.get(finding.effect), CATALOGUE.get(other.effect)
    bodies = all(effect is not None and effect.is_body for effect in names)
    return bodies and finding.links == other.links and finding.effect != other.effect


def beyond_motion(finding: Finding) -> str:
    """Why no motion settles a finding, in words; "" where one may."""
    effect = CATALOGUE.get(finding.effect)
    name = finding.effect.replace("_", " ")
    if effect is None or effect.sought == "last":
        return f"{name}: it has no name whose torque could be predicted"
    if effect.sought == "windows":
        return f"{name}: it happened once"
    if effect.sought == "channels":
        return f"{name}: it is in the log, whatever the robot does"
    return ""


def questions_of(findings: Iterable[Finding], prepared: Prepared) -> tuple[Question, ...]:
    """One for each finding that a motion may settle.

    Args:
        findings: `open_findings` of the study's diagnosis.
        prepared: the study.
    """
    return tuple(_question(each, prepared) for each in findings if not beyond_motion(each))


def cause_of(finding: Finding, prepared: Prepared) -> Cause:
    """What a finding says, along any motion."""
    effect = CATALOGUE[finding.effect]
    shape, beta = effect.coefficients(finding.values, finding.shape)
    places = places_of(finding, prepared.body, prepared.study.joints)
    return Cause(
        effect=effect,
        places=tuple(_always(place) for place in places),
        shape=shape,
        beta=beta,
        words=said(effect, finding.joints, finding.links),
    )


def said(effect: Effect, joints: Sequence[str], links: Sequence[str]) -> str:
    """An effect and its place in words."""
    where = where_in_words(effect.on, tuple(joints), tuple(links))
    return f"{effect.words} at {where[0].lower()}{where[1:]}"


def _question(finding: Finding, prepared: Prepared) -> Question:
    listed = [
        Option(effect=CATALOGUE[each.effect], places=(at,), listed=True)
        for each in finding.equivalents
        if each.effect in CATALOGUE and (at := _at(each.effect, each.joints, each.links, prepared))
    ]
    own = cause_of(finding, prepared)
    names = {option.effect.id for option in listed} | {finding.effect}
    confused = [CATALOGUE[name] for name in own.effect.confused_with if name in CATALOGUE]
    others = [
        Option(effect=effect, places=near, listed=False)
        for effect in confused
        if effect.id not in names
        and not (effect.is_body and own.effect.is_body)
        and effect.sought == "candidates"
        and (near := _near(effect, own, prepared))
    ]
    reasons = []
    if finding.equivalents:
        names_of = ", ".join(each.effect.replace("_", " ") for each in finding.equivalents)
        reasons.append(f"explained as well by {names_of}")
    if finding.confidence < ENOUGH:
        reasons.append(f"confidence {finding.confidence:.2f}")
    if not reasons:
        reasons.append("only suspected: what is ordinary may explain it")
    return Question(finding=finding, own=own, options=(*listed, *others), why="; ".join(reasons))


def standing(questions: Iterable[Question], prepared: Prepared) -> tuple[Question, ...]:
    """What every joint has, and is confused with, at the joints in question.

    Where a name turns out to be another one's, these would be open next. Each is as large as what
    the recordings show of the joint's torque that the model leaves unexplained.
    """
    b = prepared.fit
    joints = sorted({j for q in questions for place in q.own.places for j in place.joints})
    taken = {(q.own.effect.id, place) for q in questions for place in q.own.places}
    found = []
    for j in joints:
        place = Place(joints=(j,))
        for effect in CATALOGUE.values():
            if not effect.is_plain or (effect.id, place) in taken:
                continue
            options = tuple(
                Option(effect=other, places=((place,),), listed=False)
                for name in effect.confused_with
                if (other := CATALOGUE.get(name)) is not None
                and not (other.costly or other.is_body or other.sought != "candidates")
                and place in other.places(b.motions)
            )
            shape = next(iter(effect.asked(b.motions, place)), ())
            columns = b.compute(effect, place, shape).get(("torque", j))
            if not options or columns is None:
                continue
            size = max(b.rms(("torque", j)), 5.0 * b.sigma["torque", j])
            amount = size / max(b.rms(("torque", j), columns[:, 0]), 1e-9)
            words = said(effect, (prepared.study.joints[j],), ())
            own = Cause(
                effect=effect, places=(place,), shape=shape, beta=np.array([amount]), words=words
            )
            finding = Finding(effect=effect.id, joints=(prepared.study.joints[j],))
            found.append(Question(finding=finding, own=own, options=options, why=""))
    return tuple(found)


def _at(
    effect: str, joints: tuple[str, ...], links: tuple[str, ...], prepared: Prepared
) -> tuple[Place, ...]:
    found = places_of(
        Finding(effect=effect, joints=joints, links=links), prepared.body, prepared.study.joints
    )
    return tuple(_always(place) for place in found)


def _near(effect: Effect, own: Cause, prepared: Prepared) -> tuple[tuple[Place, ...], ...]:
    """Places of another effect at the joints or links of a cause, one cause each."""
    here = {k for place in own.places for k in _indices(place)}
    base = any(not _indices(place) for place in own.places)
    places = effect.places(prepared.fit.motions)
    near = [place for place in places if base or not _indices(place) or here & {*_indices(place)}]
    return tuple((place,) for place in near if place.held is None)


def _indices(place: Place) -> tuple[int, ...]:
    return place.joints if place.link is None else (*place.joints, place.link)


def _always(place: Place) -> Place:
    """Place without a window of time, which no other motion has."""
    if place.gate is not None and place.gate.of != "position":
        place = replace(place, gate=None)
    return replace(place, recording=None, window=None)
