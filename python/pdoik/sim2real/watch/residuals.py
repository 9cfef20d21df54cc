"""Residual torques of a window less the model, and the columns that charts compare them with."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray, Recording

from ..effects import CATALOGUE
from ..effects.drives import OF_BOTH, TorqueGain, TorqueOffset
from ..effects.friction import CoulombFriction, PreslidingHysteresis
from ..model import Model, body_of, places_of, torque_of, torques_along
from ..motion import Motion, Place, dilated, motion_of, zero_phase
from .changes import Change, torque_of_changes
from .windows import Window, kept_every

CHART_EFFECTS = (
    (TorqueOffset.id, (OF_BOTH,)),
    (CoulombFriction.id, (0.0,)),
    (TorqueGain.id, (OF_BOTH,)),
)
"""A change shows in a joint's torque always, with its direction, or with its load."""

_STILL = 0.3  # periods of the cut-off around rest that say nothing, as in the balances
_SURE = 2.0  # standard errors within which what was learnt of a change may be wrong
AT_MOST = 3.0  # standard deviations by which another day's friction differs at most
_SLIDES = 4.0  # displacements of a presliding joint after which it slides
_WARM = 1e6  # the machine has run this long [s]: what fades at a start has faded


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResidualRows:
    """Rows of a window's core."""

    time: FloatArray  # (N,) of the log's clock [s]
    step: float  # between rows [s]
    residual: FloatArray  # (N, n) measured less the model and what has changed [N m]
    allowed: FloatArray  # (N, n) of it, that what is known of friction and changes leaves open
    columns: FloatArray  # (N, n, 3) of the charts
    bodies: FloatArray  # (N, n, k) torques per unit of the links' inertial parameters
    features: FloatArray  # (N, n, 4) that the noise's variance depends on
    moving: NDArray[np.bool_]  # (N, n) where a row says something

    def __getitem__(self, part: slice | NDArray[np.bool_]) -> ResidualRows:
        """Some of them."""
        changed = {name: getattr(self, name)[part] for name in _ARRAYS}
        return replace(self, **changed)


_ARRAYS = ("time", "residual", "allowed", "columns", "bodies", "features", "moving")


def friction_columns(rows: ResidualRows) -> FloatArray:
    """Direction and speed of each joint at the rows, (N, n, 2)."""
    direction = rows.columns[:, :, 1]
    return np.stack([direction, direction * np.sqrt(rows.features[:, :, 1])], axis=2)


def joined(parts: Iterable[ResidualRows]) -> ResidualRows:
    """Rows of several windows of one stream."""
    all_of = list(parts)

    stacked = {name: np.concatenate([getattr(each, name) for each in all_of]) for name in _ARRAYS}
    return ResidualRows(step=all_of[0].step, **stacked)


class Ordinary(Protocol):
    """What every machine differs by from its model, as it is known today."""

    def torque(self, friction: FloatArray, bodies: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Its torque and the variance of that, (T, n), by columns (T, n, 2) and (T, n, k)."""


class Residuals:
    """The model along windows of a log, by the filters of the diagnosis."""

    def __init__(self, model: Model, position_noise: FloatArray, slides: float) -> None:
        """Findings that hold in a part of a recording only are none of the machine as it is now.

        Args:
            model: with a robot and the diagnosis's cut-off.
            position_noise: (n,) density of white noise in positions [rad^2/Hz].
            slides: travel after which dry friction is at its level [rad].

        Raises:
            ValueError: the model has no robot or no cut-off.
        """
        body = body_of(model)
        if model.cutoff is None:
            raise ValueError("the model has no cut-off: it was not made by a diagnosis")
        lasting = tuple(each for each in model.findings if each.window is None)
        self.model = replace(model, findings=lasting)
        self.cutoff = model.cutoff
        self.changes: tuple[Change, ...] = ()
        self.today: Ordinary | None = None  # friction and bodies as they are, less the model's
        self.body = body
        self._noise = position_noise
        self._slides = np.full(len(model.joints), slides)
        for finding in lasting:
            if finding.effect == PreslidingHysteresis.id:
                for place in places_of(finding, body, model.joints):
                    far = _SLIDES * finding.values["displacement"]
                    self._slides[place.joints[0]] = max(slides, far)

    def motion(self, recording: Recording) -> Motion:
        """The motion, whose torque is what the model says."""
        made = motion_of(
            recording, self.body, None, self.cutoff, self._noise, self.model.tip, since=_WARM
        )
        smooth, sharp = torques_along(self.model, made)
        return replace(made, tau=smooth + sharp)

    def motion_now(self, recording: Recording) -> tuple[Motion, FloatArray]:
        """The same with all changes that are known, and by how much these may be off, (T, n)."""
        motion = self.motion(recording)
        changed, variance = torque_of_changes(self.changes, motion)
        allowed = _SURE * np.sqrt(variance)
        if self.today is not None:
            off, varies = self.today.torque(_friction(motion), _bodies(motion))
            changed, allowed = changed + off, allowed + AT_MOST * np.sqrt(varies)
        return replace(motion, tau=motion.tau + changed), allowed

    def rows(self, window: Window) -> ResidualRows:
        """The rows of a window's core."""
        recording = window.rows.recording()
        motion, allowed = self.motion_now(recording)
        assert motion.torque is not None
        first, step = _core(window, motion)
        columns = np.stack([_columns(motion, j) for j in range(motion.n)], axis=1)  # (T, n, 3)
        off = (motion.torque - motion.tau)[:, :, None]
        raw = np.concatenate([off, columns, _bodies(motion)], axis=2)
        filtered = zero_phase(raw, motion.cutoff, motion.period)[first]
        inertia = np.diagonal(motion.mass_matrix, axis1=1, axis2=2) + self.body.rotor
        features = np.stack(
            [np.ones_like(motion.dq), motion.dq**2, (inertia * motion.ddq) ** 2, motion.tau**2],
            axis=2,
        )
        around = int(_STILL / (motion.cutoff * motion.period))
        moving = motion.valid[:, None] & ~dilated(motion.still | self._sticks(motion), around)
        return ResidualRows(
            time=recording.start + motion.time[first],
            step=step,
            residual=filtered[:, :, 0],
            allowed=allowed[first],
            columns=filtered[:, :, 1 : 1 + len(CHART_EFFECTS)],
            bodies=filtered[:, :, 1 + len(CHART_EFFECTS) :],
            features=features[first],
            moving=moving[first],
        )

    def _sticks(self, motion: Motion) -> NDArray[np.bool_]:
        """Where a joint has not yet gone far since its direction changed, or the window began.

        Dry friction then has any value within its level, by what went before; (T, n).
        """
        turned = np.diff(np.sign(motion.dq), axis=0, prepend=0.0) != 0.0
        turned[0] = True
        index = np.arange(len(turned))[:, None]
        last = np.maximum.accumulate(np.where(turned, index, 0), axis=0)
        gone = np.abs(motion.q - np.take_along_axis(motion.q, last, axis=0))
        return np.asarray(gone < self._slides, dtype=np.bool_)

    def friction(self, motion: Motion) -> FloatArray:
        """Friction by the description and the findings, (T, n) [N m]."""
        body = self.body
        friction = body.damping * motion.dq + body.friction * np.sign(motion.dq)
        for finding in self.model.findings:
            if finding.effect in CATALOGUE and CATALOGUE[finding.effect].family == "friction":
                friction = friction + torque_of(finding, motion, self.model.joints)
        return np.asarray(friction, dtype=np.float64)


def _core(window: Window, motion: Motion) -> tuple[slice, float]:
    """Samples of a window's core that are kept, and the time between them [s]."""
    slack = 0.01 * motion.period
    time = motion.recording.start + motion.time
    first, last = np.searchsorted(time, np.array(window.core) - slack)
    every = kept_every(motion.cutoff, motion.period)
    return slice(int(first), int(last), every), every * motion.period


def _columns(motion: Motion, j: int) -> FloatArray:
    """The charts' columns of a joint, (T, 3)."""
    place = Place(joints=(j,))
    made = (
        CATALOGUE[effect].columns(motion, place, shape)["torque", j][:, 0]
        for effect, shape in CHART_EFFECTS
    )
    return np.stack(list(made), axis=1)


def _friction(motion: Motion) -> FloatArray:
    """Direction and speed of each joint, (T, n, 2)."""
    rubs = CATALOGUE[CoulombFriction.id]
    direction = [
        rubs.columns(motion, Place(joints=(j,)), (0.0,))["torque", j][:, 0] for j in range(motion.n)
    ]
    return np.stack([np.stack(direction, axis=1), motion.dq], axis=2)


def _bodies(motion: Motion) -> FloatArray:
    """Torques per unit of the ten inertial parameters of every link, (T, n, 10 L)."""
    regressor = motion.regressor()
    return regressor.reshape(*regressor.shape[:2], -1)
