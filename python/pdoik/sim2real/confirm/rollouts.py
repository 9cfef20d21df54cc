"""The whole arm simulated forward from its commands, with what was found, compared with recordings.

A regression along the recorded motion sees what differentiation and filtering leave of an effect,
and takes the recorded motion for granted. The simulation does not: it runs the controller, the
drives and every finding in MuJoCo for the recorded commands, and what it logs goes through the same
filters and balances.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray, Recording

from ..effects import CATALOGUE, not_simulated
from ..findings import Estimate, Evidence
from ..model import Model, simulator_in
from ..motion import Balances, Key, Prepared, motions_of, noise_of, thinned
from ..regression import Fit, Term, finding_of, improved_model
from ..simulation import SimulationError
from ..study import Study, part

STEPS = 60_000  # of the simulation, of all recordings together
_STEP = 1e-3  # [s]
FAR = 4.0  # numerics: sigmas, beyond which what is left counts linearly

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
    """Huber's loss, (N,): a knock between two samples may be logged in either."""
    size = np.abs(left)
    return np.asarray(np.where(size < FAR, size**2, FAR * (2.0 * size - FAR)))


class Arm:
    """A study's arm, simulated for its commands with the terms of a fit."""

    def __init__(
        self, prepared: Prepared, fit: Fit, *, held_out: bool = False, steps: int = STEPS
    ) -> None:
        """Takes the recordings to fit, or those held out: as much of each as `steps` allow.

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
        settled = self.data.time > study.thresholds.diagnosis.settling
        rows = {key: np.flatnonzero(mask & settled) for key, mask in self.data.mask.items()}
        self.rows: dict[Key, NDArray[np.intp]] = {k: at for k, at in rows.items() if len(at)}

    def _balances(self, recordings: Sequence[Recording]) -> Balances:
        thin = [thinned(r) for r in recordings]
        p = self.prepared
        motions = motions_of(p.study, thin, p.body, p.cutoff, self._noise)
        return Balances(motions, p.study.thresholds)

    def run(self, terms: Sequence[Term], values: Sequence[Values]) -> Rollout:
        """Simulate with these figures.

        Raises:
            SimulationError: the arm ran away.
            ValueError: one of the terms is none that can be simulated.
        """
        findings = tuple(
            finding_of(self.prepared, term, _plain(term, each), (), Evidence.once(0.0))
            for term, each in zip(terms, values, strict=True)
        )
        for reason in filter(None, map(not_simulated, findings)):
            raise ValueError(reason)
        model = improved_model(self.prepared, findings, self._fit)
        logged = [_as_logged(each, r) for each, r in self._replayed(model)]
        sim = self._balances(logged)
        left = {
            key: (self.data.residual[key] - sim.residual[key])[at] / self.data.sigma[key]
            for key, at in self.rows.items()
        }
        if not all(np.isfinite(each).all() for each in left.values()):
            raise SimulationError("the simulation gave no numbers")
        touched = frozenset(key for term in terms for key in term.columns)
        return Rollout(values=tuple(dict(each) for each in values), left=left, touched=touched)

    def _replayed(self, model: Model) -> Iterator[tuple[Recording, Recording]]:
        """Every recording simulated from its commands as it was made, and itself."""
        plain = model.simulator()
        for recording in self.recordings:
            setup = self.prepared.study.setup_of(recording)
            simulator = plain if setup.is_plain else simulator_in(model, setup)
            yield simulator.replay(recording, drive="controller"), recording


def why_not(study: Study) -> str:
    """Why a study's arm cannot be simulated from its commands, in words; "" where it can."""
    if study.robot is None:
        return "no robot is known"
    if study.floats:
        return "its base is not fixed"
    if study.controller is None:
        return "no controller is known"
    if any(r.q_des is None or not np.isfinite(r.q_des).all() for r in study.recordings):
        return "q_des was not recorded of every joint"
    return ""


def _beginnings(recordings: Sequence[Recording], longest: float) -> tuple[Recording, ...]:
    """The beginning of each recording, `longest` seconds at most."""
    counts = [min(len(each.time), int(longest / each.period)) for each in recordings]
    return tuple(
        each if count == len(each.time) else part(each, 0, count)
        for each, count in zip(recordings, counts, strict=True)
    )


def _plain(term: Term, values: Values) -> dict[str, Estimate]:
    unit_of = CATALOGUE[term.effect].unit_of
    return {name: Estimate.normal(v, 0.0, unit_of(name)) for name, v in values.items()}


def _as_logged(simulated: Recording, recorded: Recording) -> Recording:
    """The simulated recording, only with the channels that were recorded."""
    return replace(
        simulated,
        dq=None if recorded.dq is None else simulated.dq,
        tau=None if recorded.tau is None else simulated.tau,
        tau_cmd=None if recorded.tau_cmd is None else simulated.tau_cmd,
        tip=None if recorded.tip is None else simulated.tip,
    )
