"""What a motion is expected to say of each question, by the kernel's model of what it would show.

For a cause A that is true and a rival B, what A adds along the motion is fitted by B, whatever its
figures and of several shapes, with all that is ordinary, the other findings, and bodies
within the user's trust; see `identify.predicted`. So it is with B true and A fitted. The recordings
themselves count, too: little, but they are there afterwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import Effect
from ..identify import (
    Hypothesis,
    Model,
    Noise,
    Ordinary,
    Remainder,
    all_else,
    anomalous,
    expected,
    recorded,
    remainder,
)
from ..motion import Balances, Key, Place, Prepared, Shape
from ..regression import Term
from .expected import Pair, Prospect, Rivalry, clarity, expected_confidence
from .figures import Figure, figures
from .questions import Cause, Option, Question, said, standing

_OF_THE_MEAN = 0.2  # what the mean clarity counts relative to the least
_SHAPES = 4  # of a rival that are tried


@dataclass(frozen=True, kw_only=True, eq=False)
class Rival:
    """What may be there instead, with its figures where the recordings give them."""

    cause: Cause
    listed: bool
    known: bool


class Weigher:
    """Likelihood ratios of one study's questions."""

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
        trusted = prepared.study.trust.rigid_body
        self._bodies = self.limits.priors.bodies if trusted is None else trusted
        fit = prepared.fit
        self._recorded = recorded(fit, self._bodies, _hypotheses(fit, self.causes))
        self.noise = Noise.of(self._recorded)
        self.rivals = tuple(self._rivals(question) for question in self.questions)
        self.standing = tuple(
            (question, tuple(rival for o in question.options if (rival := self._unknown(o))))
            for question in standing(self.questions, prepared)
        )
        self._variants = {q.own.key: self._alike(q.own) for q in self.questions}
        self._before: dict[tuple[object, object], float] = {}
        for question, rivals in zip(self.questions, self.rivals, strict=True):
            for rival in rivals:
                pairs = [(own, rival.cause) for own in self._variants[question.own.key]]
                pairs += [(rival.cause, question.own)] if rival.known else []
                for pair in pairs:
                    self._before[pair[0].key, pair[1].key] = self._ratio(self._recorded, fit, *pair)

    def _unknown(self, option: Option) -> Rival | None:
        """Rival of an option whose figures nobody knows; None where no recording could show it."""
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

        Slow motion may not show how sharply friction turns; another motion must not rely on it.
        """
        if own.effect.costly or own.effect.fixed or not own.shape:
            return (own,)
        target = self._target(own)
        plain = all_else(self._recorded, (own.effect.id, own.places))
        before = remainder(plain, target).information
        left = {
            shape: made
            for shape in _shapes(self.prepared.fit, own)
            if (made := self._with(plain, own, shape, target)) is not None
        }
        if not left:
            return (own,)
        least = min(each.information for each, _ in left.values())
        level = 2.0 * self.limits.diagnosis.level  # log odds within which they are rivals
        kept = sorted(s for s, (each, _) in left.items() if each.information <= least + level)
        kept = kept if before > least else []
        return (
            own,
            *(
                replace(own, shape=shape, beta=_bounded(own, left[shape][1]))
                for shape in (dict.fromkeys((kept[0], kept[-1])) if kept else ())
                if shape != own.shape
            ),
        )

    def _with(
        self, plain: Model, cause: Cause, shape: Shape, target: dict[Key, FloatArray]
    ) -> tuple[Remainder, FloatArray] | None:
        """What a model with a cause of a shape leaves of a target, and the cause's coefficients."""
        hypothesis = hypothesis_of(self.prepared.fit, replace(cause, shape=shape))
        if hypothesis is None:
            return None
        whole = plain.with_(hypothesis)
        found = remainder(whole, target)
        return found, found.coefficients[whole.span(hypothesis)]

    def prospects(self, balances: Balances, *, costly: bool = True) -> tuple[Prospect, ...]:
        """Prospects of each question along a predicted motion; then of what stands, without `why`.

        Args:
            balances: of the motion.
            costly: whether effects whose columns are simulations are looked at, too.
        """
        model = self._model(balances)
        pairs = [*zip(self.questions, self.rivals, strict=True), *self.standing]
        return tuple(self._prospect(model, balances, *pair, costly) for pair in pairs)

    def _model(self, balances: Balances) -> Model:
        """All that is believed and was found, on a predicted motion's rows."""
        ordinary = Ordinary(balances=balances, bodies=self._bodies).hypotheses()
        free = [replace(each, positive=False) for each in ordinary]
        found = [each for each in self.causes if not each.is_costly]
        return self.noise.model(balances, [*free, *_hypotheses(balances, found)])

    def figures(self, balances: Balances) -> tuple[Figure, ...]:
        """How well what every joint has is known, by the recordings and with a motion as well."""
        return figures(self._recorded, self._model(balances), self.prepared.study.joints)

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
        model: Model,
        balances: Balances,
        question: Question,
        rivals: Sequence[Rival],
        costly: bool,
    ) -> Prospect:
        own, limits = question.own, self.limits
        kept = tuple(
            self._rivalry(model, balances, own, rival)
            for rival in rivals
            if costly or not (rival.cause.is_costly or own.is_costly)
        )
        hypothesis = hypothesis_of(balances, own)
        background = all_else(model, (own.effect.id, own.places))
        if hypothesis is None:  # nothing of it shows
            support = None
        else:
            beta = np.tile(own.beta, len(own.places))[: hypothesis.width]
            believed = float(hypothesis.precision @ beta**2)
            made = expected(background, own.contribution(balances), hypothesis, believed, limits)
            support = made.support(1.0, limits.propose.doubt)
        return Prospect(
            finding=own.words,
            why=question.why,
            confidence_before=question.finding.confidence / (1 + len(question.finding.equivalents)),
            gain=0.0 if support is None else support.gain,
            rivalries=kept,
            confidence=expected_confidence(support, kept, limits),
        )

    def _rivalry(self, model: Model, balances: Balances, own: Cause, rival: Rival) -> Rivalry:
        def ratio(true: Cause, other: Cause) -> float:
            before = self._before.get((true.key, other.key), 0.0)
            return before + self._ratio(model, balances, true, other)

        variants = self._variants.get(own.key, (own,))
        return Rivalry(
            rival=rival.cause.words,
            listed=rival.listed,
            if_own=min(ratio(each, rival.cause) for each in variants),
            if_rival=ratio(rival.cause, own) if rival.known else np.inf,
            level=self.limits.diagnosis.level,
        )

    def _ratio(self, model: Model, balances: Balances, true: Cause, other: Cause) -> float:
        """Log likelihood of what is true over the other's, with all else refitted."""
        causes = ((each.effect.id, each.places) for each in (true, other))
        plain, shown = all_else(model, *causes), true.contribution(balances)
        made = (hypothesis_of(balances, replace(other, shape=s)) for s in _shapes(balances, other))
        models = [plain.with_(each) for each in made if each is not None] or [plain]
        return min(remainder(each, shown).log_ratio for each in models)

    def _rivals(self, question: Question) -> tuple[Rival, ...]:
        found = (self._best(question, option) for option in question.options)
        return tuple(each for each in found if each is not None)

    def _best(self, question: Question, option: Option) -> Rival | None:
        """The place and shape that fit the recordings best in the place of the question's own."""
        target, motions, own = self._target(question.own), self.prepared.fit.motions, question.own
        best: tuple[float, Cause] | None = None
        for places in option.places:
            pair = (own.effect.id, own.places), (option.effect.id, places)
            plain = all_else(self._recorded, *pair)
            before = remainder(plain, target).information
            for shape in option.effect.shapes(motions, places[0]):
                made = Cause(
                    effect=option.effect,
                    places=places,
                    shape=shape,
                    beta=np.zeros(0),
                    words=self._said(option, places),
                )
                found = self._with(plain, made, shape, target)
                if found is None:
                    continue
                gain = before - found[0].information
                if best is None or gain > best[0]:
                    best = gain, replace(made, beta=_bounded(made, found[1]))
        if best is None:
            return None
        gain, cause = best
        known = gain > self.limits.propose.known and bool(np.any(cause.beta))
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

    def _target(self, own: Cause) -> dict[Key, FloatArray]:
        """Residual of the recordings without all other causes, (N,) for each key."""
        fit = self.prepared.fit
        target = {key: values.copy() for key, values in fit.residual.items()}
        for cause in self.causes:
            if cause is not own:
                for key, values in cause.contribution(fit).items():
                    target[key] -= values
        return target


def hypothesis_of(balances: Balances, cause: Cause) -> Hypothesis | None:
    """A cause as the kernel has it, at all its places; None where it changes nothing."""
    columns = cause.columns(balances)
    if not columns:
        return None
    width = next(iter(columns.values())).shape[1]
    each = width // len(cause.places)
    prior = cause.effect.prior_at(balances.motions[0], cause.places[0], each)
    term = Term(
        effect=cause.effect.id,
        place=cause.places[0],
        shape=cause.shape,
        columns=columns,
        prior=np.tile(prior, len(cause.places)),
    )
    return anomalous(balances, term)


def _hypotheses(balances: Balances, causes: Sequence[Cause]) -> list[Hypothesis]:
    made = (hypothesis_of(balances, each) for each in causes)
    return [each for each in made if each is not None]


def _shapes(balances: Balances, cause: Cause) -> list[Shape]:
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


def _ends(effect: Effect, shapes: Sequence[Shape]) -> list[Shape]:
    """The lowest and highest of a single nonlinear parameter: the diagnosis goes as far."""
    if not shapes or len(shapes[0]) != 1:
        return []
    low, high = min(shapes), max(shapes)
    ends = effect.shape_bounds(low)[0][0], effect.shape_bounds(high)[0][1]
    return [(end,) for end in ends if np.isfinite(end)]


def _bounded(cause: Cause, beta: FloatArray) -> FloatArray:
    """One cause's coefficients, within its bounds; the mean over places that share them."""
    effect = cause.effect
    each = beta.reshape(len(cause.places), -1).mean(axis=0)
    if effect.fixed:
        return np.ones(1)
    lower, upper = effect.bounds
    return np.asarray(np.clip(each, lower[: len(each)], upper[: len(each)]), dtype=np.float64)
