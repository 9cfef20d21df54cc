"""A path as if it had been recorded: what the model and its findings say, with nothing in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from ..motion.balances import Balances
from ..motion.motion import Motion, motion_of
from ..motion.place import Key
from ..motion.prepare import Prepared
from ..study.recording import FloatArray, Recording
from .path import STEP, Path
from .questions import Cause

_COARSE = 2  # rows of a path that a look takes together, where the balances' cut-off allows
_BELOW = 0.4  # cut-off times period, at most


def followed(asked: FloatArray, stuck: FloatArray) -> FloatArray:
    """Positions (T, n) of joints that stand until they are asked to be `stuck` (n,) elsewhere."""
    q = np.empty_like(asked)
    at = asked[0]
    for t, row in enumerate(asked):
        at = np.minimum(np.maximum(at, row - stuck), row + stuck)
        q[t] = at
    return q


class _Noiseless(Balances):
    """Balances of channels without noise: none is looked for."""

    def _noise(self, key: Key, values: list[FloatArray]) -> float:
        return 0.0


class Foretold:
    """Of one study: what is foretold are the channels that its recordings have."""

    def __init__(self, prepared: Prepared, causes: Sequence[Cause]) -> None:
        """`causes` are there beside what is asked."""
        if prepared.body is None:
            raise ValueError("the study has no robot description, so no motion can be designed")
        self.prepared, self.body = prepared, prepared.body
        self.causes = tuple(causes)
        self.limits = prepared.study.thresholds
        first = prepared.fit.motions[0]
        self._like = first.recording
        self._noise = np.full(prepared.fit.n, 1e-14)
        every = _COARSE if prepared.cutoff <= _BELOW / (_COARSE * STEP) else 1
        self.every = every
        self.cutoff = min(prepared.cutoff, _BELOW / (every * STEP))
        self._stuck = self._sticking()

    def balances(self, path: Path) -> Balances:
        """Of the path, with residuals of nothing."""
        return _Noiseless([self.motion(path)], self.limits)

    def motion(self, path: Path) -> Motion:
        """As a recording's is."""
        study = self.prepared.study
        made = motion_of(
            self._recording(path),
            self.body,
            study.controller,
            self.cutoff,
            self._noise,
            study.tip,
            0.0,
            self.limits,
        )
        floor = self.prepared.fit.motions[0].speed_floor
        return replace(made, speed_floor=floor, still=np.abs(made.dq) < floor)

    def torque(self, balances: Balances) -> FloatArray:
        """(T, n) at the motion's rate that the model with its causes needs [N m]."""
        motion = balances.motions[0]
        tau = motion.tau.copy()
        for cause in self.causes:
            for place in cause.places:
                columns = cause.effect.columns(motion, place, cause.shape)
                for (balance, channel), column in columns.items():
                    if balance == "torque" and not cause.effect.of_commands:
                        tau[:, channel] += column @ cause.beta[: column.shape[1]]
        return tau

    def _sticking(self) -> FloatArray:
        """Error (n,) that each joint's dry friction lets stand before the controller moves it."""
        control = self.prepared.study.controller
        stuck = np.zeros(self.prepared.fit.n)
        if control is None:
            return stuck
        for cause in self.causes:
            if cause.effect.one_of == "dry" and len(cause.beta):
                for place in cause.places:
                    stiff = max(float(control.kp[place.joints[0]]), 1e-9)
                    stuck[place.joints[0]] += abs(float(cause.beta[0])) / stiff
        return stuck

    def _recording(self, path: Path) -> Recording:
        asked_for, step = path.q[:: self.every], self.every * STEP
        q = followed(asked_for, self._stuck) if self._stuck.any() else asked_for
        dq = np.gradient(q, step, axis=0)
        ddq = np.gradient(dq, step, axis=0)
        study, body, like = self.prepared.study, self.body, self._like
        tau = body.torque(q, dq, ddq) + body.rotor * ddq
        control = study.controller
        q_des = q
        if control is not None and control.kp.all():
            asked = tau - (body.gravity(q) if control.gravity_compensation else 0.0)
            if like.dq_des is None:
                asked = asked + control.kd * dq
            q_des = q + asked / control.kp
        time = np.asarray(step * np.arange(len(q)), dtype=np.float64)

        def if_there(name: str, values: FloatArray) -> FloatArray | None:
            there = getattr(like, name)
            return None if there is None else np.where(np.isfinite(there[:1]), values, np.nan)

        source = self.prepared.fit.motions[0].source
        return Recording(
            name="proposed",
            role="fit",
            start=0.0,
            time=time,
            q=q,
            dq=if_there("dq", dq),
            tau=tau if source in ("tau", "current", "duty") else None,
            q_des=if_there("q_des", q_des),
            dq_des=if_there("dq_des", dq),
            tau_cmd=if_there("tau_cmd", tau),
            tip=None if like.tip is None else self._tip(q),
            valid=np.ones(len(q), dtype=np.bool_),
            raw_period=step,
            jitter=0.0,
        )

    def _tip(self, q: FloatArray) -> FloatArray:
        poses = self.body.poses_and_jacobians(q, self.body.frame(self.prepared.study.tip))[0]
        xyzw = Rotation.from_matrix(poses[:, :3, :3]).as_quat()
        return np.hstack([poses[:, :3, 3], xyzw[:, [3, 0, 1, 2]]])
