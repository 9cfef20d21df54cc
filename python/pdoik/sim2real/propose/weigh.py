"""What a motion is expected to say of each question: the refitted rival against the truth.

For a cause A that is true and a rival B, the rows that A adds along the motion are fitted by B's
columns, whatever its figures and of several shapes, with all that is ordinary beside it: friction,
offset and rotor of every joint, the other findings, bodies within the user's trust. Half of what
that leaves, in the noise of the recordings, is the expected log likelihood ratio (T-optimality,
Atkeson and Fedorov, Biometrika 62(1), 1975). So it is with B true and A fitted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray

from ..identify.candidates import same_kind
from ..motion.balances import Balances
from ..motion.place import Key, Place
from ..motion.prepare import Prepared
from ..regression.background import has_its_like
from .beside import FOUND, Beside, shapes_of
from .expected import NOTHING, Pair, Prospect, Rivalry, clarity, expected_confidence
from .foretold import Foretold
from .path import Path
from .questions import Cause, Option, Question, said, standing
from .rows import columns_at, contribution, noise_of

_OF_THE_MEAN = 0.2  # what the mean clarity counts beside the least
_KNOWN = 9.0  # decrease of the cost in the recordings from which a rival's figures are known


@dataclass(frozen=True, kw_only=True, eq=False)
class Rival:
    """What may be there instead, with its figures where the recordings tell them."""

    cause: Cause
    listed: bool
    known: bool


class Weigher:
    """Of one study and its questions."""

    def __init__(
        self, prepared: Prepared, questions: Sequence[Question], causes: Sequence[Cause]
    ) -> None:
        """Fits the rivals' figures to the recordings.

        Args:
            prepared: the study.
            questions: what is to be settled.
            causes: all that was found, the questions' own among them.
        """
        self.prepared, self.questions, self.causes = prepared, tuple(questions), tuple(causes)
        self.limits = prepared.study.thresholds
        self.noise = noise_of(prepared.fit, causes)
        self.foretold = Foretold(prepared, causes)
        self.rivals = tuple(self._rivals(question) for question in self.questions)
        self.standing = tuple(
            (question, tuple(rival for o in question.options if (rival := self._unknown(o))))
            for question in standing(self.questions, prepared)
        )
        self._variants = {q.own.key: self._alike(q.own) for q in self.questions}
        self._recorded: dict[tuple[object, object], tuple[FloatArray, float]] = {}
        self._remember()

    def _remember(self) -> None:
        """What the recordings themselves say of each pair: little, but they count afterwards."""
        plain = self._beside(self.prepared.fit, bodies=self._bodies)
        for question, rivals in zip(self.questions, self.rivals, strict=True):
            for rival in rivals:
                pairs = [(own, rival.cause) for own in self._variants[question.own.key]]
                pairs += [(rival.cause, question.own)] if rival.known else []
                for true, other in pairs:
                    left = self._left(plain, true, other)
                    self._recorded[true.key, other.key] = left

    def _unknown(self, option: Option) -> Rival | None:
        """Of an option whose figures nobody knows; None where no recording could show it."""
        places = option.places[0]
        shapes = option.effect.asked(self.prepared.fit.motions, places[0])
        if not shapes:
            return None
        cause = Cause(
            effect=option.effect, places=places, shape=shapes[0], beta=np.zeros(0), words=""
        )
        return Rival(cause=cause, listed=option.listed, known=False)

    def _alike(self, own: Cause) -> tuple[Cause, ...]:
        """A cause with the shapes that explain the recordings as well: its own, and the extremes.

        Slow motion may not tell how sharply friction turns; another motion must not rely on it.
        """
        if own.effect.costly or own.effect.fixed or not own.shape:
            return (own,)
        b = self.prepared.fit
        plain = self._beside(b, bodies=False)
        sheet = plain.sheet
        sheet.add("target", _target(b, [each for each in self.causes if each is not own]))
        beside = plain.names(own, None)
        alone, gains = sheet.left("target", beside), {}
        for shape in shapes_of(b, own):
            sheet.add(("columns", shape), columns_at(b, own, shape))
            gains[shape] = alone - sheet.left("target", [*beside, ("columns", shape)])
        least = (1.0 - self.limits.search.tie) * max(gains.values())
        kept = sorted(shape for shape, gain in gains.items() if gain >= least)
        found = [own]
        for shape in dict.fromkeys((kept[0], kept[-1])) if kept else ():
            if shape != own.shape:
                beta = sheet.fitted(("columns", shape), "target", beside)
                found.append(replace(own, shape=shape, beta=_bounded(own, beta)))
        return tuple(found)

    def _beside(self, balances: Balances, *, bodies: bool) -> Beside:
        """What is fitted beside causes on some rows."""
        return Beside(self.prepared, balances, self.noise, self.causes, bodies=bodies)

    @property
    def _bodies(self) -> bool:
        """Whether bodies may be a tenth off where nobody says so: beside what is peculiar."""
        return any(not _is_ordinary(question) for question in self.questions)

    def prospects(self, path: Path, *, costly: bool = True) -> tuple[Prospect, ...]:
        """Of each question along a path.

        Args:
            path: from rest to rest.
            costly: whether effects whose columns are simulations are looked at, too.
        """
        return self.prospects_of(self.foretold.balances(path), costly=costly)

    def prospects_of(self, balances: Balances, *, costly: bool = True) -> tuple[Prospect, ...]:
        """The same of a path's balances; then of what stands, which has no `why`."""
        plain = self._beside(balances, bodies=self._bodies)
        pairs = [*zip(self.questions, self.rivals, strict=True), *self.standing]
        return tuple(self._prospect(plain, question, rivals, costly) for question, rivals in pairs)

    def score(
        self, prospects: Sequence[Prospect], hopeless: frozenset[Pair] = frozenset()
    ) -> float:
        """The more, the better a motion settles all of them that are not hopeless."""
        asked = [clarity(each, self.limits, hopeless) for each in prospects if each.why]
        others = [clarity(each, self.limits, hopeless)[1] for each in prospects if not each.why]
        mean = np.mean([mean for _, mean in asked] + others)
        return float(min(low for low, _ in asked) + _OF_THE_MEAN * mean)

    def _prospect(
        self,
        plain: Beside,
        question: Question,
        rivals: Sequence[Rival],
        costly: bool,
    ) -> Prospect:
        own = question.own
        truth, sheet = plain.added(own), plain.sheet
        found = []
        for rival in rivals:
            if not costly and (rival.cause.is_costly or own.is_costly):
                continue
            found.append(self._rivalry(plain, own, rival))
        beside = plain.names(own, None)
        energy = sheet.left(truth, beside)
        acting = sheet.acting(truth)
        gain = energy / max(energy + acting, 1e-9)
        kept = tuple(found)
        return Prospect(
            finding=own.words,
            why=question.why,
            confidence_before=question.finding.confidence / (1 + len(question.finding.equivalents)),
            gain=gain,
            rivalries=kept,
            confidence=expected_confidence(gain, kept, self.limits),
        )

    def _rivalry(self, plain: Beside, own: Cause, rival: Rival) -> Rivalry:
        other = rival.cause
        variants = self._variants.get(own.key, (own,))
        weighed = [self._with_recorded(plain, each, other) for each in variants]
        own_left, own_share, own_t = (min(values) for values in zip(*weighed, strict=True))
        if rival.known:
            other_left, other_share, other_t = self._with_recorded(plain, other, own)
        else:
            other_left, other_share, other_t = np.inf, 1.0, np.inf
        clear = [
            self._clear(own, other, own_share, own_t),
            self._clear(other, own, other_share, other_t),
        ]
        return Rivalry(
            rival=other.words,
            listed=rival.listed,
            if_own=0.5 * own_left,
            if_rival=0.5 * other_left,
            share=min(own_share, other_share),
            clear=float(min(clear)),
        )

    def _clear(self, true: Cause, other: Cause, share: float, t: float) -> float:
        """Times what the diagnosis asks, so that it lists the other beside the true one no more.

        A name is level where it explains nearly as much and blocks of time do not tell; a coarser
        law of the same kind is listed as long as it explains nine tenths.
        """
        search = self.limits.search
        alike = same_kind(true.effect.id, other.effect.id) and true.places == other.places
        if alike and other.effect.complexity <= true.effect.complexity:
            return share / (1.0 - search.same_kind)
        return max(share / search.tie, t / search.tie_error)

    def _with_recorded(
        self, plain: Beside, true: Cause, other: Cause
    ) -> tuple[float, float, float]:
        """What the other leaves of the true one, recordings included, its share, and its t.

        Figures may differ between the two, which makes what is left less than it will be.
        """
        before, whole = self._recorded.get((true.key, other.key), (np.zeros(0), 0.0))
        left, alone = self._left(plain, true, other)
        blocks = np.concatenate([before, left])
        total = float(blocks.sum())
        error = float(np.std(blocks) * np.sqrt(len(blocks))) if len(blocks) > 1 else np.inf
        t = total / max(error, 1e-300) if 0.5 * total > NOTHING else 0.0
        return total, total / max(alone + whole, 1e-300), t

    def _left(self, plain: Beside, true: Cause, other: Cause) -> tuple[FloatArray, float]:
        """What the other leaves of the true one by blocks, and what the other findings alone do."""
        name, sheet = plain.added(true), plain.sheet
        shapes = []
        for shape in shapes_of(sheet.balances, other):
            column = ("columns", other.effect.id, other.places, shape)
            if not sheet.knows(column):
                sheet.add(column, columns_at(sheet.balances, other, shape))
            shapes.append(column)
        beside = plain.names(true, other)
        best = min(shapes, key=lambda column: sheet.left(name, [*beside, column]))
        alone = sheet.left(name, [n for n in beside if n[0] == FOUND])
        return sheet.left_by_block(name, [*beside, best]), alone

    def _rivals(self, question: Question) -> tuple[Rival, ...]:
        found = []
        for option in question.options:
            best = self._best(question, option)
            if best is not None:
                found.append(best)
        return tuple(found)

    def _best(self, question: Question, option: Option) -> Rival | None:
        """The place and shape that fit the recordings best in the place of the question's own."""
        b = self.prepared.fit
        plain = self._beside(b, bodies=False)
        sheet = plain.sheet
        target = _target(b, [cause for cause in self.causes if cause is not question.own])
        sheet.add("target", target)
        best: tuple[float, Cause] | None = None
        for places in option.places:
            for shape in option.effect.shapes(b.motions, places[0]):
                made = Cause(
                    effect=option.effect,
                    places=places,
                    shape=shape,
                    beta=np.zeros(0),
                    words=self._said(option, places),
                )
                columns = columns_at(b, made, shape)
                if not columns:
                    continue
                name = ("columns", places, shape)
                sheet.add(name, columns)
                beside = plain.names(made, question.own)
                gain = sheet.left("target", beside) - sheet.left("target", [*beside, name])
                beta = _bounded(made, sheet.fitted(name, "target", beside))
                if best is None or gain > best[0]:
                    best = gain, replace(made, beta=beta)
        if best is None:
            return None
        gain, cause = best
        known = gain > _KNOWN and bool(np.any(cause.beta))
        return Rival(cause=cause, listed=option.listed, known=known)

    def _said(self, option: Option, places: tuple[Place, ...]) -> str:
        study, body = self.prepared.study, self.prepared.body
        joints = [study.joints[j] for place in places for j in place.joints]
        links = [
            body.links[place.link]
            for place in places
            if place.link is not None and body is not None
        ]
        return said(option.effect, joints, links)


def _target(balances: Balances, causes: Sequence[Cause]) -> dict[Key, FloatArray]:
    """What recordings show beside these causes, a column for each key."""
    target = {key: values[:, None].copy() for key, values in balances.residual.items()}
    for cause in causes:
        for key, column in contribution(balances, cause).items():
            target[key] = target[key] - column
    return target


def _bounded(cause: Cause, beta: FloatArray) -> FloatArray:
    """One cause's coefficients, within its bounds; the mean over places that share them."""
    effect = cause.effect
    each = beta.reshape(len(cause.places), -1).mean(axis=0)
    if effect.fixed:
        return np.ones(1)
    lower, upper = effect.bounds
    return np.asarray(np.clip(each, lower[: len(each)], upper[: len(each)]), dtype=np.float64)


def _is_ordinary(question: Question) -> bool:
    effect = question.own.effect
    return has_its_like(effect) or effect.costly
