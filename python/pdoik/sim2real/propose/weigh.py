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

from ..effects import CATALOGUE, Effect
from ..motion.balances import Balances
from ..motion.place import Key, Place, Shape
from ..motion.prepare import Prepared
from ..regression.background import has_its_like
from ..regression.trusted_bodies import trusted
from ..select.candidates import same_kind
from ..study.recording import FloatArray
from .expected import NOTHING, Pair, Prospect, Rivalry, clarity, expected_confidence
from .foretold import Foretold
from .path import Path
from .questions import Cause, Option, Question, said, standing
from .rows import Columns, Noise, Sheet, columns_at, contribution, noise_of

Name = tuple[object, ...]  # of columns: what kind they are, and whose

_FOUND = "found"
_SHAPES = 4  # of a rival that are tried
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
        sheet = Sheet(balances=self.prepared.fit, noise=self.noise)
        plain = self._ordinary(sheet, bodies=self._bodies)
        for question, rivals in zip(self.questions, self.rivals, strict=True):
            for rival in rivals:
                pairs = [(own, rival.cause) for own in self._variants[question.own.key]]
                pairs += [(rival.cause, question.own)] if rival.known else []
                for true, other in pairs:
                    left = self._left(sheet, plain, true, other)
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
        sheet = Sheet(balances=b, noise=self.noise)
        plain = self._ordinary(sheet, bodies=False)
        sheet.add("target", _target(b, [each for each in self.causes if each is not own]))
        beside = self._beside(plain, own, None)
        alone, gains = sheet.left("target", beside), {}
        for shape in self._shapes(b, own):
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
        sheet = Sheet(balances=balances, noise=self.noise)
        plain = self._ordinary(sheet, bodies=self._bodies)
        pairs = [*zip(self.questions, self.rivals, strict=True), *self.standing]
        return tuple(
            self._prospect(sheet, plain, question, rivals, costly) for question, rivals in pairs
        )

    def score(
        self, prospects: Sequence[Prospect], hopeless: frozenset[Pair] = frozenset()
    ) -> float:
        """The more, the better a motion settles all of them that are not hopeless."""
        asked = [clarity(each, self.limits, hopeless) for each in prospects if each.why]
        others = [clarity(each, self.limits, hopeless)[1] for each in prospects if not each.why]
        mean = np.mean([mean for _, mean in asked] + others)
        return float(min(low for low, _ in asked) + _OF_THE_MEAN * mean)

    def _ordinary(self, sheet: Sheet, *, bodies: bool) -> dict[Name, Cause | None]:
        """Adds what is ordinary, and what else was found; their names, with causes where any."""
        balances = sheet.balances
        names: dict[Name, Cause | None] = {}
        for j in range(balances.n):
            place = Place(joints=(j,))
            for effect in CATALOGUE.values():
                if not effect.ordinary or effect.complexity > 1:
                    continue
                if place not in effect.places(balances.motions):
                    continue
                for shape in effect.asked(balances.motions, place)[:1]:
                    columns = balances.compute(effect, place, shape)
                    name = ("ordinary", effect.id, place)
                    if columns:
                        sheet.add(name, columns)
                        cause = Cause(
                            effect=effect, places=(place,), shape=shape, beta=np.ones(1), words=""
                        )
                        names[name] = cause
        for found in self.causes:
            columns = columns_at(balances, found, found.shape)
            if columns and not found.is_costly:
                sheet.add((_FOUND, *found.key), columns)
                names[_FOUND, *found.key] = found
        trust = self.prepared.study.trust.rigid_body
        for term in trusted(balances, trust or (self.limits.background.bodies if bodies else 0.0)):
            body = ("body", term.place.link)
            sheet.add(body, term.columns, term.prior)
            names[body] = None
        return names

    def _prospect(
        self,
        sheet: Sheet,
        plain: dict[Name, Cause | None],
        question: Question,
        rivals: Sequence[Rival],
        costly: bool,
    ) -> Prospect:
        own = question.own
        truth = self._added(sheet, own)
        found = []
        for rival in rivals:
            if not costly and (rival.cause.is_costly or own.is_costly):
                continue
            found.append(self._rivalry(sheet, plain, own, rival))
        beside = self._beside(plain, own, None)
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

    def _rivalry(
        self, sheet: Sheet, plain: dict[Name, Cause | None], own: Cause, rival: Rival
    ) -> Rivalry:
        other = rival.cause
        variants = self._variants.get(own.key, (own,))
        weighed = [self._with_recorded(sheet, plain, each, other) for each in variants]
        own_left, own_share, own_t = (min(values) for values in zip(*weighed, strict=True))
        if rival.known:
            other_left, other_share, other_t = self._with_recorded(sheet, plain, other, own)
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
        self, sheet: Sheet, plain: dict[Name, Cause | None], true: Cause, other: Cause
    ) -> tuple[float, float, float]:
        """What the other leaves of the true one, recordings included, its share, and its t.

        Figures may differ between the two, which makes what is left less than it will be.
        """
        before, whole = self._recorded.get((true.key, other.key), (np.zeros(0), 0.0))
        left, alone = self._left(sheet, plain, true, other)
        blocks = np.concatenate([before, left])
        total = float(blocks.sum())
        error = float(np.std(blocks) * np.sqrt(len(blocks))) if len(blocks) > 1 else np.inf
        t = total / max(error, 1e-300) if 0.5 * total > NOTHING else 0.0
        return total, total / max(alone + whole, 1e-300), t

    def _left(
        self, sheet: Sheet, plain: dict[Name, Cause | None], true: Cause, other: Cause
    ) -> tuple[FloatArray, float]:
        """What the other leaves of the true one by blocks, and what the other findings alone do."""
        name = self._added(sheet, true)
        shapes = []
        for shape in self._shapes(sheet.balances, other):
            column = ("columns", other.effect.id, other.places, shape)
            if not sheet.knows(column):
                sheet.add(column, columns_at(sheet.balances, other, shape))
            shapes.append(column)
        beside = self._beside(plain, true, other)
        best = min(shapes, key=lambda column: sheet.left(name, [*beside, column]))
        alone = sheet.left(name, [n for n in beside if n[0] == _FOUND])
        return sheet.left_by_block(name, [*beside, best]), alone

    def _added(self, sheet: Sheet, cause: Cause) -> Name:
        """The name of a cause's contribution, which is added where it is new."""
        name = ("true", *cause.key)
        if not sheet.knows(name):
            sheet.add(name, contribution(sheet.balances, cause))
        return name

    def _beside(
        self, plain: dict[Name, Cause | None], one: Cause, other: Cause | None
    ) -> list[Name]:
        """Names of what is fitted beside two causes: nothing that is either of them."""
        kept = []
        for name, cause in plain.items():
            if cause is not None and any(
                _is_the_same(cause, each) for each in (one, other) if each is not None
            ):
                continue
            if cause is None and one.effect.is_body and name[1] in _links(one):
                continue
            kept.append(name)
        return kept

    def _shapes(self, balances: Balances, cause: Cause) -> list[Shape]:
        """The one it was found with, and others."""
        effect = cause.effect
        if effect.costly:
            return [cause.shape]
        variant = effect.variant(cause.shape)
        shapes = [
            shape
            for shape in effect.shapes(balances.motions, cause.places[0])
            if effect.variant(shape) == variant
        ]
        step = max(1, -(-len(shapes) // _SHAPES))
        return list(dict.fromkeys([cause.shape, *shapes[::step], *_ends(effect, shapes)]))

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
        sheet = Sheet(balances=b, noise=self.noise)
        plain = self._ordinary(sheet, bodies=False)
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
                beside = self._beside(plain, made, question.own)
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


def _ends(effect: Effect, shapes: Sequence[Shape]) -> list[Shape]:
    """The lowest and highest of a single nonlinear parameter: the diagnosis goes as far."""
    if not shapes or len(shapes[0]) != 1:
        return []
    low, high = min(shapes), max(shapes)
    ends = effect.shape_bounds(low)[0][0], effect.shape_bounds(high)[0][1]
    return [(end,) for end in ends if np.isfinite(end)]


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


def _is_the_same(plain: Cause, cause: Cause) -> bool:
    """Whether what is ordinary at a joint is a cause itself, or a coarser name for it."""
    alike = plain.effect.id == cause.effect.id or same_kind(plain.effect.id, cause.effect.id)
    return alike and plain.places[0] in [replace(p, gate=None) for p in cause.places]


def _links(cause: Cause) -> set[int | None]:
    return {place.link for place in cause.places}


def _is_ordinary(question: Question) -> bool:
    effect = question.own.effect
    return has_its_like(effect) or effect.costly


__all__ = ["Columns", "Noise", "Rival", "Weigher"]
