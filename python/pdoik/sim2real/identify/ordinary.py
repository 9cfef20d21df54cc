"""What every machine has: always in the model, sized and never selected.

Joints rub, rotors turn with them, sensors' zeros and scales are a little off, drawings are a tenth
wrong, friction is another one on another day. Each part has a prior: its usual size.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.drives import TorqueGain, TorqueOffset
from ..effects.friction import CoulombFriction, ViscousFriction
from ..effects.transmission import RotorInertia
from ..motion import Balances, Place, Shape
from ..regression import (
    DAYS,
    SCALE,
    SPEED,
    ZERO,
    Fit,
    Term,
    Tolerance,
    imu_parts,
    term_of,
    trusted,
    usual_torque,
)
from .hypothesis import Hypothesis, ordinary
from .model import Model
from .pool import Pool

OF_JOINTS = (
    ViscousFriction.id,
    CoulombFriction.id,
    TorqueOffset.id,
    RotorInertia.id,
    TorqueGain.id,
)
"""Ordinary parts of a joint's torque."""

OF_DAYS = CoulombFriction.id
"""Ordinary dry friction, of which other laws are finer ones."""

_WIDTHS = (0.0, 0.005, 0.01, 0.02, 0.04, 0.06, 0.1, 0.15, 0.3)
"""Speeds within which Coulomb friction may turn [rad/s]."""

_HALVINGS = 3  # of the distance to the next width

_CHANGES = (ViscousFriction.id, CoulombFriction.id)  # from day to day


@dataclass(kw_only=True, eq=False)
class Ordinary:
    """The ordinary part of a study's model, with choices that evidence makes."""

    balances: Balances
    bodies: float  # the model's inertial figures are right to this share; 0: exactly
    widths: dict[int, Shape] = field(default_factory=dict)  # of each joint's Coulomb friction
    levels: dict[tuple[str, int], float] = field(default_factory=dict)  # that days change
    days: float = 0.0  # by which share; 0: as is usual
    _frictions: dict[tuple[int, int, float, float], Pool] = field(default_factory=dict)
    _days: dict[tuple[str, int, int, Shape], Term] = field(default_factory=dict)

    @property
    def joints(self) -> list[int]:
        """Joints whose torque is judged."""
        b = self.balances
        return [
            j
            for j in range(b.n)
            if ("torque", j) in b.residual and b.excited[j] and b.mask["torque", j].any()
        ]

    @property
    def _reported(self) -> list[int]:
        """Joints whose torque is known as well as their motion."""
        return [j for j in range(self.balances.n) if ("torque", j) in self.balances.residual]

    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """All hypotheses of the ordinary part."""
        found = [h for j in self.joints for h in self._of_joint(j)]
        found += [h for j in self.joints for h in self._of_days(j)]
        found += [h for j in self._reported for h in self._of_calibration(j)]
        found += [ordinary(term, sizes) for term, sizes in imu_parts(self.balances)]
        bodies = trusted(self.balances, self.bodies)
        return (*found, *(ordinary(term, 1.0 / np.sqrt(term.prior)) for term in bodies))

    def _of_joint(self, j: int) -> Iterator[Hypothesis]:
        b, believed = self.balances, self.balances.thresholds.priors
        usual = usual_torque(b, j)
        acceleration = np.concatenate([m.ddq[:, j] for m in b.motions])
        accelerated = float(np.sqrt(np.mean(acceleration**2)))
        speed = float(np.sqrt(np.mean(np.concatenate([m.dq[:, j] for m in b.motions]) ** 2)))
        sizes = {
            ViscousFriction.id: believed.friction * usual / max(speed, 1e-9),
            CoulombFriction.id: believed.friction * usual,
            TorqueOffset.id: believed.offset * usual,
            RotorInertia.id: believed.rotor * usual / max(accelerated, 1e-9),
        }
        if not b.loads_are_inferred:  # noise and all: scales of all torques would shrink it
            sizes[TorqueGain.id] = believed.torque
        for name, size in sizes.items():
            term = self.term(name, j)
            if term is not None:
                yield ordinary(term, max(size, 1e-12), positive=name in _POSITIVE)

    def term(self, name: str, j: int, shape: Shape | None = None) -> Term | None:
        """The term of a joint's part; None where it changes nothing."""
        effect, place = CATALOGUE[name], Place(joints=(j,))
        if shape is None:
            shape = effect.shapes(self.balances.motions, place)[0]
            if name == CoulombFriction.id:
                shape = self.widths.get(j, (0.02,))
        return term_of(self.balances, effect, place, shape)

    def _of_days(self, j: int) -> Iterator[Hypothesis]:
        """Friction of each session less the mean's."""
        session = self.sessions
        share = self.days or self.balances.thresholds.priors.days
        for name in _CHANGES:
            size = share * self.levels.get((name, j), 0.0)
            plain = self.term(name, j)
            if plain is None or size <= 0.0:
                continue
            for k in range(int(session.max()) + 1):
                at = name, j, k, plain.shape
                if at not in self._days:
                    here = (session == k)[:, None]
                    self._days[at] = Term(
                        effect=DAYS,
                        place=plain.place,
                        shape=(),
                        columns={key: c * here for key, c in plain.columns.items()},
                        prior=np.ones(1),
                    )
                yield ordinary(self._days[at], size)

    def _of_calibration(self, j: int) -> Iterator[Hypothesis]:
        """Tolerances of joint j's drive and speed sensor, as exact as these are made."""
        b, believed = self.balances, self.balances.thresholds.priors
        sizes = {
            ZERO: believed.drive_zero * max(usual_torque(b, j), 1e-9),
            SCALE: believed.drive_scale,
            SPEED: believed.speed_scale,
        }
        for kind, size in sizes.items():
            term = term_of(b, Tolerance(), Place(joints=(j,)), (kind,))
            if term is not None:
                yield ordinary(term, size)

    @property
    def sessions(self) -> NDArray[np.intp]:
        """Session of every row, as the study gives it, or the file that its recording is of."""
        b = self.balances
        if b.told is not None:
            return np.asarray(b.told[b.recording], dtype=np.intp)
        files = [m.recording.file or m.recording.name for m in b.motions]
        return np.array([files.index(each) for each in files], dtype=np.intp)[b.recording]

    def fitted_to(self, model: Model, joints: Collection[int]) -> Ordinary:
        """The likeliest: what days change, and the widths of some joints' Coulomb friction."""
        levels, widths = dict(self.levels), dict(self.widths)
        own = {(h.term.effect, h.term.place): s for h, s in model.placed if h.ordinary}
        for j in self.joints:
            for name in _CHANGES:
                span = own.get((name, Place(joints=(j,))))
                if span is not None:
                    levels[name, j] = float(abs(model.beta[span][0]))
            if j in joints:
                widths[j] = self._width(model, j)
        days = self._share_of_days(model) if joints else self.days
        return replace(self, widths=widths, levels=levels, days=days)

    def _share_of_days(self, model: Model) -> float:
        """The share by which friction differs between sessions, the likeliest of three."""
        believed = self.balances.thresholds.priors
        now = self.days or believed.days
        if len(np.unique(self.sessions)) < 2 or not any(
            each.term.effect == DAYS for each in model.hypotheses
        ):
            return now
        best, most = now, -np.inf
        for factor in (1.0 / believed.days_more, 1.0, believed.days_more):
            share = factor * believed.days
            scaled = [
                ordinary(each.term, share / now / np.sqrt(each.precision))
                if each.term.effect == DAYS
                else each
                for each in model.hypotheses
            ]
            evidence = Model(model.data, scaled, model).log_evidence
            if evidence > most:
                best, most = share, evidence
        return best

    def _width(self, model: Model, j: int) -> Shape:
        """Width of a joint's Coulomb friction, the likeliest with all else."""
        place, now = Place(joints=(j,)), self.widths.get(j, (0.02,))
        here = [
            h
            for h in model.hypotheses
            if h.ordinary and h.term.effect == CoulombFriction.id and h.term.place == place
        ]
        if not here:
            return now
        size = here[0].precision[0] ** -0.5
        others = [h for h in model.hypotheses if not any(h is each for each in here)]
        bare, tried = Model(model.data, others, model, rounds=0), {now[0], *_WIDTHS}
        odds: dict[float, float] = {}
        for _ in range(_HALVINGS):
            for width in sorted(tried - odds.keys()):
                for each in self._alone(model, j, width, size).scored(bare):
                    odds[width] = each.log_odds
            if not odds:
                return now
            best, widths = max(odds, key=lambda width: odds[width]), sorted(odds)
            at = widths.index(best)
            neighbours = (widths[max(at - 1, 0)], widths[min(at + 1, len(widths) - 1)])
            tried = {0.5 * (best + other) for other in neighbours}
        return (best,)

    def _alone(self, model: Model, j: int, width: float, size: float) -> Pool:
        """Coulomb friction of a width alone, made once: its columns and sums serve many models."""
        at = (id(model.data), j, width, size)
        if at not in self._frictions:
            term = self.term(CoulombFriction.id, j, (width,))
            made = [] if term is None else [ordinary(term, size, positive=True)]
            self._frictions[at] = Pool(model.data, made)
        return self._frictions[at]


_POSITIVE = (ViscousFriction.id, CoulombFriction.id, RotorInertia.id)


def days_of(terms: Sequence[Term], term: Term) -> list[Term]:
    """What a joint's friction differs by in each session: nothing without that friction."""
    if term.effect not in _CHANGES or term.place.gate is not None:
        return []
    return [
        each
        for each in terms
        if each.effect == DAYS
        and each.place == term.place
        and all(
            key in term.columns and bool(np.all((column == 0.0) | (column == term.columns[key])))
            for key, column in each.columns.items()
        )
    ]


def changes_of(fit: Fit) -> list[tuple[Term, FloatArray]]:
    """Friction that differs from day to day: the term, and by how much another day may differ."""
    found = [(term, days_of(fit.terms, term)) for term in fit.terms]
    return [(term, 1.0 / np.sqrt(days[0].prior)) for term, days in found if days]
