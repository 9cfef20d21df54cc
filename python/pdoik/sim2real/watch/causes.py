"""Why a machine has changed: effects of the catalogue held against the residual since an onset."""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE, Effect
from ..effects.coulomb_friction import CoulombFriction
from ..effects.external_contact import ExternalContact
from ..effects.inertial import Payload
from ..effects.viscous_friction import ViscousFriction
from ..model.predict import places_of
from ..motion.balances import Balances
from ..motion.motion import Motion
from ..motion.place import Key, Place, Shape
from ..regression.fit import Fit, Term, term_of
from ..thresholds.watch import WatchThresholds
from .alarm import Cause, Figure
from .calibrate import variance_of
from .changes import Change
from .charts import Charts
from .residuals import ResidualRows, Residuals
from .windows import NAME

_ALWAYS = (-np.inf, np.inf)
_FEWEST = 50.0  # rows from which an effect's simplicity counts as much: fewer tell of few figures
_SMEARED = 0.5  # periods of the cut-off over which the filter smears an onset
_NEAR = 1.0  # of the CUSUM's onset, within which a better one is looked for [s]
_AT_MOST = 3.0  # standard deviations that another day's friction is off at most
_TODAY = "friction today"
_HELD = np.array([5.0, 1.0, 1.0, 1.0] + [0.02] * 6)
"""Standard deviations of a body a decimetre or two large that is taken up: kg, kg m, kg m^2."""
_WITHIN = 0.6  # distance of its centre from the last joint's frame at most [m]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Explanation:
    """The likeliest causes, as words and as changes of the model."""

    onset: float  # when it began [s]
    causes: tuple[Cause, ...] = ()
    instead: tuple[Cause, ...] = ()
    changes: tuple[Change, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Candidate:
    term: Term
    fit: Fit
    bic: float


class WeighedRows:
    """Torque balances since an onset, by the healthy noise of each row."""

    def __init__(self, motion: Motion, known: ResidualRows, onset: float, charts: Charts) -> None:
        """Of a motion and its residual's rows; joints that are not watched do not count."""
        h = charts.healthy
        self.count = 0.0  # rows that say as much as independent ones
        self._weight: dict[Key, FloatArray] = {}
        self._counts: dict[Key, NDArray[np.bool_]] = {}
        made = Balances([motion])
        time = motion.recording.start + made.time
        row = np.minimum(np.searchsorted(known.time, time - 1e-6), len(known.time) - 1)
        nearby = np.abs(known.time[row] - time) < known.step
        sigma = np.sqrt(variance_of(h, known.features[row]))  # (N, n)
        balances = copy(made)
        balances.mask, balances.residual, alike = {}, {}, {}
        for j in np.flatnonzero(charts.watched).tolist():
            key: Key = ("torque", j)
            memory = max(1.0, h.density[j, 0] / known.step)
            self._counts[key] = nearby & known.moving[row, j]
            balances.mask[key] = self._counts[key] & (time >= onset + _SMEARED / motion.cutoff)
            self._weight[key] = 1.0 / sigma[:, j]
            balances.residual[key] = made.residual[key] * self._weight[key]
            alike[key] = float(np.sqrt(memory))
            self.count += float(np.count_nonzero(balances.mask[key])) / memory
        self.balances = balances.with_noise(alike)
        self.time = time

    def term(self, effect: Effect, place: Place, shape: Shape) -> Term | None:
        """The term of an effect; None where it changes nothing."""
        made = term_of(self.balances, effect, place, shape)
        if made is None:
            return None
        columns = {key: each * self._weight[key][:, None] for key, each in made.columns.items()}
        return replace(made, columns=columns)

    def onset(self, fit: Fit, about: float) -> float:
        """The time from which on what was fitted leaves least, near another one [s]."""
        gain = np.zeros(self.balances.count)
        for key in fit.design:
            b, shown = self.balances, np.zeros(self.balances.count)
            for term, beta in fit.weighted:
                if key in term.columns and term.effect != _TODAY:
                    shown += term.columns[key] @ beta
            left = b.residual[key] - shown
            gain += np.where(self._counts[key], b.residual[key] ** 2 - left**2, 0.0)
        near = np.flatnonzero(np.abs(self.time - about) <= _NEAR)
        if not len(near):
            return about
        since = np.cumsum(gain[near][::-1])[::-1]
        best = len(since) - 1 - int(np.argmax(since[::-1]))  # rows that do not count are before it
        return float(self.time[near[best]]) if since[best] > 0.0 else about


class CauseSearch:
    """Explains the rows of a motion since an onset."""

    def __init__(self, residuals: Residuals, charts: Charts, thresholds: WatchThresholds) -> None:
        """Of a model, with the floor of its residuals."""
        self._residuals, self._charts, self._limits = residuals, charts, thresholds

    def explain(self, motion: Motion, known: ResidualRows, onset: float, most: int) -> Explanation:
        """What the residual since the onset shows.

        Args:
            motion: with some time before the onset; its torque is the model's with all changes.
            known: its residual's rows.
            onset: [s] on the log's clock.
            most: effects that may act together.
        """
        rows = WeighedRows(motion, known, onset, self._charts)
        chosen, instead, fit = self._chosen(rows, most)
        if not chosen:
            return Explanation(onset=onset)
        better = rows.onset(fit, onset)
        if most > 1 and better != onset:
            rows = WeighedRows(motion, known, better, self._charts)
            chosen, instead, fit = self._chosen(rows, most)
        return Explanation(
            onset=better,
            causes=tuple(self._cause(fit, term) for term in chosen),
            instead=instead,
            changes=tuple(_change(fit, term) for term in chosen),
        )

    def _chosen(self, rows: WeighedRows, most: int) -> tuple[list[Term], tuple[Cause, ...], Fit]:
        """The likeliest effects together, what fits as well as the first, and the fit."""
        count = max(rows.count, _FEWEST)
        fit = Fit(rows.balances, self._day(rows))
        pool = list(self._terms(rows))
        base, chosen, instead = _bic(fit, count), [], []
        for turn in range(most):
            tried = sorted(self._tried(fit, pool, count), key=lambda each: each.bic)
            needed = self._limits.beside if turn else self._limits.level
            if not tried or tried[0].bic > base - needed:
                break
            close = [each for each in tried if each.bic < tried[0].bic + self._limits.level]
            best = min(close, key=lambda each: CATALOGUE[each.term.effect].complexity)
            if not turn:
                others = (each for each in close if each is not best)
                instead = [self._cause(each.fit, each.term, each.bic - best.bic) for each in others]
            chosen.append(best.term)
            fit, base = best.fit, best.bic
        return chosen, tuple(instead), self._final(fit, chosen)

    def _final(self, fit: Fit, chosen: list[Term]) -> Fit:
        """The fit without today's friction where friction is the cause: it has no share in it."""
        rubbing = {t.place for t in chosen if CATALOGUE[t.effect].family == "friction"}
        kept = [t for t in fit.terms if t.effect != _TODAY or t.place not in rubbing]
        return Fit(fit.balances, kept)

    def _day(self, rows: WeighedRows) -> list[Term]:
        """Each joint's friction may be another one today: terms that are held to be small."""
        share, terms = self._limits.friction_change / _AT_MOST, []
        for j, friction in enumerate(self._charts.healthy.friction):
            term = rows.term(CATALOGUE[CoulombFriction.id], Place(joints=(j,)), (0.0,))
            if term is not None and friction > 0.0:
                small = np.array([(share * friction) ** -2])
                terms.append(replace(term, effect=_TODAY, prior=small))
        return terms

    def _terms(self, rows: WeighedRows) -> Iterator[Term]:
        """What may come over a machine: what may begin at a time, a load, a push."""
        motions = rows.balances.motions
        for effect in CATALOGUE.values():
            for place in self._places(effect, motions[0]):
                for shape in effect.shapes(motions, place):
                    term = rows.term(effect, place, shape)
                    if term is not None and effect.id == Payload.id:
                        term = replace(term, prior=1.0 / _HELD**2)
                    if term is not None:
                        yield term

    def _places(self, effect: Effect, motion: Motion) -> list[Place]:
        if effect.id == ExternalContact.id:
            links = range(motion.n)
            return [Place(link=link, recording=NAME, window=_ALWAYS) for link in links]
        may_begin = effect.gated and effect.sought == "candidates" and not effect.costly
        return effect.places([motion]) if may_begin or effect.id == Payload.id else []

    def _tried(self, fit: Fit, pool: list[Term], count: float) -> Iterator[_Candidate]:
        known = {term.key for term in fit.terms}
        best: dict[tuple[str, Place], _Candidate] = {}
        for term in pool:
            if term.key in known:
                continue
            with_it = fit.extended(term)
            if not self._admissible(term, with_it.beta[-term.width :]):
                continue
            candidate = _Candidate(term=term, fit=with_it, bic=_bic(with_it, count))
            if term.key not in best or candidate.bic < best[term.key].bic:
                best[term.key] = candidate
        yield from best.values()

    def _admissible(self, term: Term, beta: FloatArray) -> bool:
        """Whether an effect may have changed by so much: what the model has may also go."""
        effect = CATALOGUE[term.effect]
        if effect.id == Payload.id and np.linalg.norm(beta[1:4]) > _WITHIN * abs(beta[0]):
            return False
        total = self._before(term) + beta
        return effect.admissible(total) or effect.admissible(total - 0.1 * beta)

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

    def _cause(self, fit: Fit, term: Term, worse: float = 0.0) -> Cause:
        effect, body = CATALOGUE[term.effect], self._residuals.body
        change, before = _change(fit, term), self._before(term)
        total = effect.values(term.shape, before + change.beta)
        had = effect.values(term.shape, before)
        spread = _spread(effect, term.shape, before + change.beta, change.covariance)
        names = self._residuals.model.joints
        links = () if term.place.link is None else (body.links[term.place.link],)
        units = {each.name: each.unit.strip("-") for each in effect.parameters}
        return Cause(
            effect=effect.id,
            joints=tuple(names[j] for j in term.place.joints),
            links=links,
            change={
                name: Figure(value=value - had[name], std=spread[name], unit=units[name])
                for name, value in total.items()
            },
            worse=worse,
        )


def _bic(fit: Fit, count: float) -> float:
    """Schwarz's criterion; parameters that the prior holds count in part."""
    cost = sum(float(np.sum(fit.residual(key) ** 2)) for key in fit.design)
    cost += float(fit.beta @ (fit.prior * fit.beta))
    regular = fit.regular(fit.gram)
    free = float(np.trace(np.linalg.solve(regular, fit.gram))) if fit.size else 0.0
    return cost + free * float(np.log(count))


def _change(fit: Fit, term: Term) -> Change:
    span = fit.span(term)
    covariance = np.asarray(np.linalg.inv(fit.regular(fit.gram)), dtype=np.float64)[span, span]
    return Change(
        effect=term.effect,
        place=term.place,
        shape=term.shape,
        beta=fit.beta[span].copy(),
        covariance=covariance,
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
