"""The whole arm simulated forward from its commands, and findings moved to where it agrees best.

A regression along the recorded motion sees what differentiation and filtering leave of an effect,
and takes the recorded motion for granted. The simulation does not: it runs the controller, the
drives and every finding in MuJoCo for the recorded commands, and what it logs goes through the same
filters and balances. What recorded and simulated balances differ by is what the findings' figures
still get wrong; Gauss-Newton steps move them, and a step stands only where the simulation comes
nearer to the recordings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.errors import PdoikError

from .balances import Balances
from .cutoff import noise_of
from .effects import CATALOGUE, Key
from .findings import Estimate, Evidence
from .improved_model import improved_model
from .motion import thinned
from .naming import finding_of
from .prepare import Prepared, motions_of
from .recording import FloatArray, Recording
from .regression import Fit, Term
from .simulation import SimulationError
from .split import part
from .study import Study

STEPS = 60_000  # of the simulation, of all recordings together
_STEP = 1e-3  # [s]
_SETTLING = 0.7  # at the beginning of each run [s]
_ROUNDS = 4
_CLEAR = 0.3  # standard errors that a figure must move to be worth another run
_FAR = 4.0  # sigmas, beyond which what is left counts linearly
_AS_THEY_ARE = ("external_contact", "unknown")  # simulated, but not refined
_FARTHEST = 0.5  # of its value that a figure may move in one step

Values = dict[str, float]
_NONE = np.zeros(0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Rollout:
    """What a simulation with some figures leaves between it and the recordings."""

    values: tuple[Values, ...]  # of each term
    left: dict[Key, FloatArray]  # recorded less simulated, in sigmas; rows that count only
    touched: frozenset[Key]  # balances that the terms change: the others judge nothing

    @property
    def flat(self) -> FloatArray:
        """The balances that count, one after the other."""
        return np.concatenate([self.left[k] for k in self.left if k in self.touched] or [_NONE])

    @property
    def cost(self) -> float:
        """Mean of Huber's loss, in squared sigmas."""
        return float(np.sum(huber(self.flat))) / max(len(self.flat), 1)


def huber(left: FloatArray) -> FloatArray:
    """Huber's: a knock between two samples may be logged in either."""
    size = np.abs(left)
    return np.asarray(np.where(size < _FAR, size**2, _FAR * (2.0 * size - _FAR)))


class Arm:
    """A study's arm, simulated for its commands with the terms of a fit."""

    def __init__(
        self, prepared: Prepared, fit: Fit, *, held_out: bool = False, steps: int = STEPS
    ) -> None:
        """Of the recordings to fit, or of those held out: as much of each as `steps` allow.

        Raises:
            ValueError: there is nothing to simulate: see `why_not`.
        """
        study = prepared.study
        recordings = study.validate if held_out else study.fit
        reason = why_not(study)
        if reason or study.controller is None or not recordings:
            raise ValueError(reason or "no recordings to simulate")
        self.prepared = prepared
        self._noise = noise_of([thinned(r) for r in study.fit])
        self._fit = fit
        step = min(study.controller.period or _STEP, _STEP)
        self.recordings = _beginnings(recordings, steps * step / len(recordings))
        whole = all(a is b for a, b in zip(self.recordings, recordings, strict=True))
        data = prepared.validate if held_out else prepared.fit
        self.data = data if whole and data is not None else self._balances(self.recordings)
        settled = self.data.time > _SETTLING
        rows = {key: np.flatnonzero(mask & settled) for key, mask in self.data.mask.items()}
        self.rows: dict[Key, NDArray[np.intp]] = {k: at for k, at in rows.items() if len(at)}

    def _balances(self, recordings: Sequence[Recording]) -> Balances:
        thin = [thinned(r) for r in recordings]
        p = self.prepared
        return Balances(motions_of(p.study, thin, p.body, p.cutoff, self._noise))

    def run(self, terms: Sequence[Term], values: Sequence[Values]) -> Rollout:
        """Simulate with these figures.

        Raises:
            SimulationError: the arm ran away.
        """
        findings = tuple(
            finding_of(self.prepared, term, _plain(term, each), (), _NO_EVIDENCE)
            for term, each in zip(terms, values, strict=True)
        )
        simulator = improved_model(self.prepared, findings, self._fit).simulator()
        logged = [_as_logged(simulator.replay(r, drive="controller"), r) for r in self.recordings]
        sim = self._balances(logged)
        left = {
            key: (self.data.residual[key] - sim.residual[key])[at] / self.data.sigma[key]
            for key, at in self.rows.items()
        }
        if not all(np.isfinite(each).all() for each in left.values()):
            raise SimulationError("the simulation gave no numbers")
        touched = frozenset(key for term in terms for key in term.columns)
        return Rollout(values=tuple(dict(each) for each in values), left=left, touched=touched)


def why_not(study: Study) -> str:
    """Why a study's arm cannot be simulated from its commands, in words; "" where it can."""
    if study.robot is None:
        return "no robot is known"
    if study.controller is None:
        return "no controller is known"
    if any(recording.q_des is None for recording in study.recordings):
        return "q_des was not recorded"
    return ""


def _beginnings(recordings: Sequence[Recording], longest: float) -> tuple[Recording, ...]:
    """At most so many seconds of each."""
    counts = [min(len(each.time), int(longest / each.period)) for each in recordings]
    return tuple(
        each if count == len(each.time) else part(each, 0, count)
        for each, count in zip(recordings, counts, strict=True)
    )


_NO_EVIDENCE = Evidence(validation_gain=0.0, interval95=(0.0, 0.0))


def _plain(term: Term, values: Values) -> dict[str, Estimate]:
    units = {p.name: p.unit for p in CATALOGUE[term.effect].parameters}
    return {
        name: Estimate(value=v, std=0.0, interval95=(v, v), unit=units.get(name, "-"))
        for name, v in values.items()
    }


def _as_logged(simulated: Recording, recorded: Recording) -> Recording:
    """Only with the channels that were recorded."""
    return replace(
        simulated,
        dq=None if recorded.dq is None else simulated.dq,
        tau=None if recorded.tau is None else simulated.tau,
        tau_cmd=None if recorded.tau_cmd is None else simulated.tau_cmd,
        tip=None if recorded.tip is None else simulated.tip,
    )


def refine_by_rollouts(
    arm: Arm,
    terms: Sequence[Term],
    start: Sequence[Values],
    errors: Sequence[Values],
    rounds: int = _ROUNDS,
) -> tuple[Rollout, Rollout]:
    """The rollout of the start and the best one: Gauss-Newton steps with Broyden's updates.

    The first derivatives are those of the regression's columns; every run then corrects them along
    its step, whether the step stood or not.

    Args:
        arm: what is simulated.
        terms: of the findings.
        start: their figures.
        errors: standard errors of these.
        rounds: steps at most.
    """
    first = best = arm.run(terms, start)
    figures = _figures(arm, terms, first, errors)
    if not figures:
        return first, best
    scale = np.array([each.scale for each in figures])
    A = _stacked(arm, figures, first.touched) * scale
    for _ in range(rounds):
        y = best.flat
        weighted = A * np.minimum(1.0, _FAR / np.maximum(np.abs(y), _FAR))[:, None]
        move = np.linalg.solve(weighted.T @ A + np.eye(len(scale)), weighted.T @ y)
        most = np.array([each.most for each in figures]) / scale
        move = np.clip(move, -most, most)
        if np.all(np.abs(move * scale) < [_CLEAR * each.error for each in figures]):
            break
        values = [dict(each) for each in best.values]
        for each, step in zip(figures, move * scale, strict=True):
            moved = values[each.term][each.name] + float(step)
            values[each.term][each.name] = float(np.clip(moved, each.lower, each.upper))
        try:
            there = arm.run(terms, values)
        except PdoikError:
            break
        A += np.outer(y - there.flat - A @ move, move) / float(move @ move)
        if there.cost < best.cost:
            best = there
    return first, best


@dataclass(frozen=True, kw_only=True, eq=False)
class _Figure:
    """One parameter of one term."""

    term: int
    name: str
    error: float
    scale: float  # how far it may be off by its nature, held against what data say
    most: float  # that it may move in one step
    lower: float
    upper: float
    slope: dict[Key, FloatArray]  # change of the balances per unit


def _figures(
    arm: Arm, terms: Sequence[Term], at: Rollout, errors: Sequence[Values]
) -> list[_Figure]:
    result = []
    for i, term in enumerate(terms):
        if term.effect in _AS_THEY_ARE:
            continue
        known = {each.name: each for each in CATALOGUE[term.effect].parameters}
        for name, value in at.values[i].items():
            if name in known and known[name].chosen:
                continue
            error = errors[i].get(name, 0.0)
            lower = known[name].lower if name in known else -np.inf
            upper = known[name].upper if name in known else np.inf
            h = max(0.02 * abs(value), 0.3 * error)
            h = min(h, *(0.5 * abs(value - b) for b in (lower, upper) if value != b), h)
            slope = _slope(arm, term, at.values[i], name, h)
            if slope:
                result.append(
                    _Figure(
                        term=i,
                        name=name,
                        error=error,
                        scale=max(3.0 * error, 0.2 * abs(value), 1e-9),
                        most=max(3.0 * error, _FARTHEST * abs(value)),
                        lower=lower,
                        upper=upper,
                        slope=slope,
                    )
                )
    return result


def _stacked(arm: Arm, figures: Sequence[_Figure], keys: frozenset[Key]) -> FloatArray:
    """Slopes on the rows that count, in sigmas, (rows, figures)."""
    data = arm.data
    parts = []
    for key, at in arm.rows.items():
        if key not in keys:
            continue
        none = np.zeros(len(at))
        each = [f.slope[key][at] if key in f.slope else none for f in figures]
        parts.append(np.stack(each, axis=1) / data.sigma[key])
    return np.concatenate(parts)


def _slope(arm: Arm, term: Term, values: Values, name: str, h: float) -> dict[Key, FloatArray]:
    """Change of a term's contribution per unit of one figure, (N,) for each balance."""
    effect = CATALOGUE[term.effect]
    if h <= 0.0:
        return {}
    sides = []
    for sign in (1.0, -1.0):
        moved = dict(values)
        moved[name] += sign * h
        shape, beta = effect.coefficients(moved, term.shape)
        if not effect.admissible(beta) and not effect.fixed:
            return {}
        sides.append({k: c @ beta for k, c in arm.data.compute(effect, term.place, shape).items()})
    return {
        key: (sides[0][key] - sides[1][key]) / (2.0 * h)
        for key in sides[0]
        if key in sides[1]
        and np.isfinite(sides[0][key] - sides[1][key]).all()
        and np.any(sides[0][key] != sides[1][key])
    }
