"""A path as if it had been recorded: what the model and its findings say, with nothing in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from pdoik.recordings import FloatArray, Recording

from ..motion.balances import Balances
from ..motion.motion import Motion, motion_of
from ..motion.place import Key
from ..motion.prepare import Prepared
from .path import STEP, Path
from .questions import Cause

_BELOW = 0.4  # cut-off times period, at most


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sticking:
    """Dry friction against a position controller; (n,) each."""

    level: FloatArray  # of the friction [N m]
    kp: FloatArray
    kd: FloatArray
    knows_speed: bool  # whether the controller is told the speed that is asked for

    @property
    def error(self) -> FloatArray:
        """By which a joint that stands is off before it moves [rad]."""
        return self.level / self.kp

    def followed(self, asked: FloatArray) -> FloatArray:
        """Positions (T, n), STEP apart, that joints without inertia take where these are asked for.

        kp (asked - q) + kd (d asked - dq) = level sign(dq); what is below the level moves nothing.
        """
        speed = np.gradient(asked, STEP, axis=0) if self.knows_speed else np.zeros_like(asked)
        damping = np.maximum(self.kd, self.kp * STEP)
        q, at = np.empty_like(asked), asked[0].copy()
        for t in range(len(asked)):
            drive = self.kp * (asked[t] - at) + self.kd * speed[t]
            beyond = drive - np.clip(drive, -self.level, self.level)
            at = at + STEP * beyond / damping
            q[t] = at
        rubbing = self.level > 0.0
        return np.where(rubbing, q, asked)


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
        self.cutoff = min(prepared.cutoff, _BELOW / STEP)
        self.sticking = self._sticking()

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

    @property
    def stuck(self) -> FloatArray:
        """Error (n,) that friction lets stand before the controller moves a joint."""
        return np.zeros(self.prepared.fit.n) if self.sticking is None else self.sticking.error

    def _sticking(self) -> Sticking | None:
        """By the causes' dry friction; None without any, or where no gains are known."""
        control, level = self.prepared.study.controller, np.zeros(self.prepared.fit.n)
        if control is None or not (control.kp > 0.0).all():
            return None
        for cause in self.causes:
            if cause.effect.one_of == "dry" and len(cause.beta):
                for place in cause.places:
                    level[place.joints[0]] += abs(float(cause.beta[0]))
        knows = self._like.dq_des is not None
        made = Sticking(level=level, kp=control.kp, kd=control.kd, knows_speed=knows)
        return made if level.any() else None

    def _recording(self, path: Path) -> Recording:
        asked_for, step = path.q, STEP
        q = asked_for if self.sticking is None else self.sticking.followed(asked_for)
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
