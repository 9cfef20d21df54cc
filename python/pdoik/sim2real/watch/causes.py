"""Why a machine has changed: hypotheses of the kernel, compared on the rows since an onset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE, Effect
from ..effects.bodies import LinkInertials, Payload
from ..effects.contacts import ExternalContact
from ..effects.drives import TorqueGain
from ..effects.friction import CoulombFriction, ViscousFriction
from ..identify import (
    Hypothesis,
    Linearisation,
    Model,
    Pool,
    Series,
    anomalous,
    fits_with,
    ordinary,
    serious,
)
from ..model import places_of
from ..motion import Balances, Key, Motion, Place, Shape
from ..regression import TRUST, Term, term_of
from ..thresholds import Thresholds
from .alarm import Cause, Figure
from .changes import Change
from .charts import Charts
from .residuals import ResidualRows, Residuals
from .windows import NAME

_ALWAYS = (-np.inf, np.inf)
_SHOWN = 0.1  # numerics: of its noise, by which a direction of the bodies moves some row
_SMEARED = 0.5  # numerics: periods of the cut-off over which the filter smears an onset
_NEAR = 1.0  # numerics: of the CUSUM's onset, within which a better one is looked for [s]
_STILL_THERE = 0.1  # share of a change by which an effect that has gone may seem to overshoot
_MOVES = 12  # at most, from one set of causes to another


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Explanation:
    """The likeliest causes, as words and as changes of the model."""

    onset: float  # when it began [s]
    causes: tuple[Cause, ...] = ()
    instead: tuple[Cause, ...] = ()
    changes: tuple[Change, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class _Changed(Hypothesis):
    """A change of an effect that the model may already have some of."""

    before: FloatArray  # (k,) the effect's coefficients in the model

    @classmethod
    def of(cls, hypothesis: Hypothesis, before: FloatArray) -> _Changed:
        """A hypothesis of the catalogue's effect, as a change of what is there."""
        given = {each.name: getattr(hypothesis, each.name) for each in fields(hypothesis)}
        return cls(**given, before=before)

    def admissible(self, beta: FloatArray) -> bool:
        """Whether what is there after the change makes physical sense; an effect may go."""
        effect, total = CATALOGUE[self.term.effect], self.before + beta
        return effect.admissible(total) or effect.admissible(total - _STILL_THERE * beta)


class RowsSince:
    """Torque balances since an onset, each row over its healthy noise, as the kernel's rows."""

    def __init__(
        self,
        motion: Motion,
        known: ResidualRows,
        onset: float,
        charts: Charts,
        thresholds: Thresholds,
    ) -> None:
        """Rows of a motion and its residual; joints that are not watched do not count."""
        made = Balances([motion], thresholds)
        self.time = motion.recording.start + made.time
        self.balances = copy(made)  # in N m, with the rows that count
        self.balances.mask, self.balances.residual = {}, {}
        self._weight: dict[Key, FloatArray] = {}
        self._counts: dict[Key, NDArray[np.bool_]] = {}
        row = np.minimum(np.searchsorted(known.time, self.time - 1e-6), len(known.time) - 1)
        nearby = np.abs(known.time[row] - self.time) < known.step
        healthy, series = charts.healthy, {}
        weight = 1.0 / np.sqrt(healthy.variance_at(known.features[row]))  # (N, n)
        for j in np.flatnonzero(charts.watched).tolist():
            key: Key = ("torque", j)
            self._counts[key] = nearby & known.moving[row, j]
            self._weight[key] = weight[:, j]
            since = self._counts[key] & (self.time >= onset + _SMEARED / motion.cutoff)
            self.balances.mask[key], self.balances.residual[key] = since, made.residual[key]
            rows = np.flatnonzero(since)
            if len(rows):
                memory = max(1.0, healthy.density[j, 0] / known.step)
                series[key] = Series(
                    rows=rows,
                    target=(made.residual[key] * weight[:, j])[rows],
                    floor=1.0,
                    parts=(slice(0, len(rows)),),
                    independent=len(rows) / memory,
                )
        self.data = Linearisation(series)
        self._healthy = Model(self.data, (), rounds=0)
        self._healthy.noise = dict.fromkeys(series, 1.0)

    def model(self, hypotheses: Sequence[Hypothesis]) -> Model:
        """The kernel's, with the noise of the healthy machine, which is known."""
        return Model(self.data, hypotheses, self._healthy, rounds=0)

    def over_noise(self, columns: Mapping[Key, FloatArray]) -> dict[Key, FloatArray]:
        """Columns over the healthy noise, of the joints that are watched."""
        own = self._weight
        return {key: each * own[key][:, None] for key, each in columns.items() if key in own}

    def whitened(self, hypothesis: Hypothesis) -> Hypothesis:
        """A hypothesis with its columns over the healthy noise."""
        term = hypothesis.term
        return replace(hypothesis, term=replace(term, columns=self.over_noise(term.columns)))

    def onset(self, model: Model, causes: Sequence[Hypothesis], about: float) -> float:
        """The time from which on the causes leave least, near another one [s]."""
        gain = np.zeros(len(self.time))
        for key, counts in self._counts.items():
            target, part = self.balances.residual[key] * self._weight[key], np.zeros_like(gain)
            for cause in causes:
                if key in cause.term.columns:
                    part += cause.term.columns[key] @ model.beta[model.span(cause)]
            gain += np.where(counts, target**2 - (target - part) ** 2, 0.0)
        near = np.flatnonzero(np.abs(self.time - about) <= _NEAR)
        if not len(near):
            return about
        since = np.cumsum(gain[near][::-1])[::-1]
        best = len(since) - 1 - int(np.argmax(since[::-1]))  # rows that do not count are before it
        return float(self.time[near[best]]) if since[best] > 0.0 else about


@dataclass(frozen=True, kw_only=True, eq=False)
class _Comparison:
    """Sets of causes on the same rows: by their evidence and odds, the likeliest is chosen."""

    rows: RowsSince
    today: tuple[Hypothesis, ...]  # friction of another day, always in the model
    pool: Pool

    def model(self, causes: Sequence[Hypothesis]) -> Model:
        """Regression of these causes; where friction has changed, none of it is another day's."""
        rubbing = {h.term.place for h in causes if CATALOGUE[h.term.effect].family == "friction"}
        parts = [each for each in self.today if each.term.place not in rubbing]
        return self.rows.model((*parts, *causes))

    def likeliest(self, most: int) -> tuple[Hypothesis, ...]:
        """Causes that are added, replaced and dropped as long as that is worth it, likeliest first.

        Args:
            most: causes that may act together.
        """
        believed = self.rows.balances.thresholds.diagnosis
        causes: tuple[Hypothesis, ...] = ()
        for _ in range(_MOVES):
            now, moves = self.log_posterior(causes), [(0.0, causes)]
            others = self._others(causes) if len(causes) < most else []
            moves += [(odds - now - believed.worth, (*causes, other)) for odds, other in others]
            for cause in causes:
                rest = _without(causes, cause)
                moves.append((self.log_posterior(rest) - now + believed.worth, rest))
                others = self._others(rest, cause)
                moves += [(odds - now - believed.better, (*rest, other)) for odds, other in others]
            gain, after = max(moves, key=lambda move: move[0])
            if gain <= 0.0:
                break
            causes = after
        return tuple(sorted(causes, key=lambda each: self.log_posterior(_without(causes, each))))

    def log_posterior(self, causes: Sequence[Hypothesis]) -> float:
        """Of these causes and no others; -inf where they make no sense."""
        return self.model(causes).log_posterior

    def rivals(self, causes: tuple[Hypothesis, ...]) -> list[tuple[float, Hypothesis]]:
        """Other causes in the place of the first that are a hundredth as likely at least.

        Each with the log odds by which it is less likely.
        """
        first, rest, now = causes[0], causes[1:], self.log_posterior(causes)
        found = [(now - odds, other) for odds, other in self._others(rest, first)]
        level = self.rows.balances.thresholds.diagnosis.level
        return [(worse, other) for worse, other in found if worse < level]

    def _others(
        self, causes: Sequence[Hypothesis], gone: Hypothesis | None = None
    ) -> list[tuple[float, Hypothesis]]:
        """What could be there as well: the likeliest few, with the log posterior of all then."""
        taken = {each.key for each in (*causes, gone) if each is not None}
        found = [
            (self.log_posterior((*causes, other)), other)
            for other in (each.hypothesis for each in serious(self.pool.scored(self.model(causes))))
            if other.key not in taken and fits_with(other, causes)
        ]
        return sorted(found, key=lambda each: -each[0])


def _without(causes: Sequence[Hypothesis], gone: Hypothesis) -> tuple[Hypothesis, ...]:
    return tuple(each for each in causes if each is not gone)


class CauseSearch:
    """Explains the rows of a motion since an onset."""

    def __init__(self, residuals: Residuals, charts: Charts, thresholds: Thresholds) -> None:
        """Search with a model's residuals and the floor of these."""
        self._residuals, self._charts, self._limits = residuals, charts, thresholds

    def explain(self, motion: Motion, known: ResidualRows, onset: float, most: int) -> Explanation:
        """What the residual since the onset shows.

        Args:
            motion: with some time before the onset; its torque is the model's with all changes.
            known: its residual's rows.
            onset: [s] on the log's clock.
            most: effects that may act together.
        """
        comparison = self._comparison(motion, known, onset)
        causes = comparison.likeliest(most)
        if not causes:
            return Explanation(onset=onset)
        better = comparison.rows.onset(comparison.model(causes), causes, onset)
        if most > 1 and better != onset:
            comparison = self._comparison(motion, known, better)
            causes = comparison.likeliest(most) or causes
        model, rest = comparison.model(causes), causes[1:]
        return Explanation(
            onset=better,
            causes=tuple(self._cause(model, each) for each in causes),
            instead=tuple(
                self._cause(comparison.model((other, *rest)), other, worse=2.0 * worse)
                for worse, other in comparison.rivals(causes)
            ),
            changes=tuple(_change(model, each) for each in causes),
        )

    def _comparison(self, motion: Motion, known: ResidualRows, onset: float) -> _Comparison:
        rows = RowsSince(motion, known, onset, self._charts, self._limits)
        return _Comparison(
            rows=rows,
            today=tuple(self._today(rows)),
            pool=Pool(rows.data, list(self._changed(rows))),
        )

    def _today(self, rows: RowsSince) -> Iterator[Hypothesis]:
        """Friction and bodies are not quite what is known of them today."""
        today = self._charts.today
        for j in np.flatnonzero(self._charts.healthy.friction > 0.0).tolist():
            sizes = np.sqrt(np.diag(today.friction_covariance(j)))
            kinds = (CoulombFriction.id, (0.0,)), (ViscousFriction.id, ())
            for (effect, shape), size in zip(kinds, sizes, strict=True):
                term = term_of(rows.balances, CATALOGUE[effect], Place(joints=(j,)), shape)
                if term is not None:
                    yield rows.whitened(ordinary(term, size))
        yield from self._bodies(rows, today.bodies_covariance)

    def _bodies(self, rows: RowsSince, covariance: FloatArray) -> Iterator[Hypothesis]:
        """Directions in which the links' parameters are uncertain, each by one standard deviation.

        Those that move no row by a tenth of its noise are left out.
        """
        effect, links = CATALOGUE[LinkInertials.id], range(len(covariance) // 10)
        terms = [term_of(rows.balances, effect, Place(link=link), ()) for link in links]
        square, vectors = np.linalg.eigh(covariance)
        directions = vectors * np.sqrt(np.maximum(square, 0.0))  # (k, k)
        columns: dict[Key, FloatArray] = {}
        for link, term in enumerate(terms):
            for key, column in {} if term is None else term.columns.items():
                part = column @ directions[10 * link : 10 * link + 10]
                columns[key] = columns.get(key, 0.0) + part
        columns = rows.over_noise(columns)
        moved = [np.abs(column).max(axis=0) for column in columns.values()]
        shown = np.max(moved, axis=0, initial=0.0) > _SHOWN
        if shown.any():
            term = Term(
                effect=TRUST,
                place=Place(),
                shape=(),
                columns={key: column[:, shown] for key, column in columns.items()},
                prior=np.ones(int(np.count_nonzero(shown))),
            )
            yield ordinary(term, 1.0)

    def _changed(self, rows: RowsSince) -> Iterator[Hypothesis]:
        """What may begin at a time, a load, a push: as likely of every kind, loads more often."""
        motions = rows.balances.motions
        for effect in CATALOGUE.values():
            for place in _places(effect, motions[0]):
                shapes = effect.shapes(motions, place)
                for shape in shapes:
                    term = term_of(rows.balances, effect, place, shape)
                    if term is not None:
                        odds = effect.odds if effect.id == Payload.id else Effect.odds
                        odds = np.log(odds / (1.0 - odds)) - np.log(len(shapes))
                        made = replace(anomalous(rows.balances, term), log_odds=float(odds))
                        if effect.id == TorqueGain.id:
                            made = replace(made, precision=np.array([self._limits.watch.gain**-2]))
                        yield rows.whitened(_Changed.of(made, self._before(term)))

    def _before(self, term: Term) -> FloatArray:
        """What the model and the changes so far have of an effect at its place, (k,)."""
        effect, before = CATALOGUE[term.effect], np.zeros(term.width)
        body = self._residuals.body
        for finding in self._residuals.model.findings:
            if finding.effect == effect.id:
                places = places_of(finding, body, self._residuals.model.joints)
                if term.place in places:
                    before = before + effect.coefficients(finding.values, finding.shape)[1]
        for change in self._residuals.changes:
            if (change.effect, change.place) == (term.effect, term.place):
                before = before + change.beta
        if effect.id == CoulombFriction.id:
            before = before + body.friction[term.place.joints[0]]
        elif effect.id == ViscousFriction.id:
            before = before + body.damping[term.place.joints[0]]
        return before

    def _cause(self, model: Model, hypothesis: Hypothesis, worse: float = 0.0) -> Cause:
        term, change = hypothesis.term, _change(model, hypothesis)
        effect, before = CATALOGUE[term.effect], self._before(term)
        total = effect.values(term.shape, before + change.beta)
        had = effect.values(term.shape, before)
        spread = _spread(effect, term.shape, before + change.beta, change.covariance)
        names = self._residuals.model.joints
        link = term.place.link
        return Cause(
            effect=effect.id,
            joints=tuple(names[j] for j in term.place.joints),
            links=() if link is None else (self._residuals.body.links[link],),
            change={
                name: Figure(
                    value=value - had[name], std=spread[name], unit=effect.unit_of(name).strip("-")
                )
                for name, value in total.items()
            },
            worse=worse,
        )


def _places(effect: Effect, motion: Motion) -> list[Place]:
    if effect.id == ExternalContact.id:
        links = range(motion.n)
        return [Place(link=link, recording=NAME, window=_ALWAYS) for link in links]
    may_begin = effect.gated and effect.sought == "candidates" and not effect.costly
    return effect.places([motion]) if may_begin or effect.id == Payload.id else []


def _change(model: Model, hypothesis: Hypothesis) -> Change:
    """Coefficients with the kernel's covariance."""
    span, term = model.span(hypothesis), hypothesis.term
    return Change(
        effect=term.effect,
        place=term.place,
        shape=term.shape,
        beta=model.beta[span].copy(),
        covariance=model.inverse[span, span],
    )


def _spread(
    effect: Effect, shape: Shape, beta: FloatArray, covariance: FloatArray
) -> dict[str, float]:
    """Standard errors of the parameters, to first order."""
    here = effect.values(shape, beta)
    square = dict.fromkeys(here, 0.0)
    values, vectors = np.linalg.eigh(covariance)
    for value, vector in zip(values, vectors.T, strict=True):
        moved = effect.values(shape, beta + np.sqrt(max(value, 0.0)) * vector)
        for name in square:
            square[name] += (moved[name] - here[name]) ** 2
    return {name: float(np.sqrt(each)) for name, each in square.items()}
