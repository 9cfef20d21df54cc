"""A path as if it had been recorded: what the model and its findings say, with nothing in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from pdoik.recordings import FloatArray, Recording

from ..motion import Balances, CarriedBody, Key, Motion, Prepared, base_motion_of, motions_of
from ..study import Setup
from .excitation import Frame
from .path import STEP, Path
from .questions import Cause

_BELOW = 0.4  # cut-off times period, at most
_QUIET = 1e-14  # density of noise in positions that have none [rad^2/Hz]
_OF_ROWS = "noise of rows"  # of a motion's torques, as `motion.free_rows` keeps it


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sticking:
    """Dry friction against a position controller; (n,) each."""

    level: FloatArray  # of the friction [N m]
    kp: FloatArray
    kd: FloatArray
    knows_speed: bool  # whether the controller is given the speed that is asked for

    @property
    def error(self) -> FloatArray:
        """Error of a joint that stands, before it moves, (n,) [rad]."""
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """What a path is predicted to come to."""

    path: Path  # of the joints, as they are commanded
    balances: Balances | None  # None: the robot would fall
    torque: FloatArray | None  # (T, n) that it needs [N m]


class Predict:
    """Predictions of one study: what is predicted are the channels that its recordings have.

    The base is fixed, or held where it hung: joints are free of one another.
    """

    may_be_led = True  # around obstacles, by other joint angles

    note = ""  # that a user must know

    def __init__(
        self, prepared: Prepared, causes: Sequence[Cause], *, like: int = 0, held: bool = False
    ) -> None:
        """Prepare to predict.

        Args:
            prepared: the study.
            causes: that are present besides what is asked.
            like: the recording to fit that the motion is like.
            held: whether a base that floats is, by something whose forces nobody knows.
        """
        if prepared.body is None:
            raise ValueError("the study has no robot description, so no motion can be designed")
        self.prepared, self.body = prepared, prepared.body
        self.causes = tuple(causes)
        self.limits = prepared.study.thresholds
        self._like, self._held = prepared.fit.motions[like], held
        if held:
            self.note = "the base must hang, or be bolted up: enter the log with 'base: held'"
        self.start = np.asarray(self._like.recording.q[0], dtype=np.float64)
        self.cutoff = min(prepared.cutoff, _BELOW / STEP)
        self.sticking = self._sticking()

    def frame(self, frame: Frame) -> Frame:
        """What motions are drawn in, of the joints' own."""
        return frame

    def run(self, path: Path) -> Run:
        """Predicted run of a path in the coordinates of `frame`."""
        motion = self.motion(self._recording(path))
        return Run(
            path=path, balances=_Noiseless([motion], self.limits), torque=self.torque(motion)
        )

    def motion(self, recording: Recording) -> Motion:
        """Motion of a predicted recording, made as a recording's is."""
        study, like = self.prepared.study, self._like
        quiet = np.full(self.prepared.fit.n, _QUIET)
        setups = {**study.setups, recording.name: Setup(held=self._held)}
        made = motions_of(replace(study, setups=setups), [recording], self.body, self.cutoff, quiet)
        floor = like.speed_floor
        if _OF_ROWS in like.cache:
            made[0].cache[_OF_ROWS] = like.cache[_OF_ROWS]
        return replace(made[0], speed_floor=floor, still=np.abs(made[0].dq) < floor)

    def torque(self, motion: Motion) -> FloatArray:
        """(T, n) at the motion's rate that the model with its causes needs [N m]."""
        tau = motion.tau[:, : motion.n].copy()
        for cause in self.causes:
            for place in cause.places:
                columns = cause.effect.columns(motion, place, cause.shape)
                for (balance, channel), column in columns.items():
                    if balance == "torque" and not cause.effect.of_commands:
                        tau[:, channel] += column @ cause.beta[: column.shape[1]]
        return tau

    def load(self, q: FloatArray) -> FloatArray:
        """Torques (n,) that hold the joints at a configuration, where nothing else does [N m]."""
        return np.asarray(self.body.gravity(q[None])[0])

    @property
    def stuck(self) -> FloatArray:
        """Error (n,) that friction lets stand before the controller moves a joint."""
        return np.zeros(self.prepared.fit.n) if self.sticking is None else self.sticking.error

    def _sticking(self) -> Sticking | None:
        """Sticking by the causes' dry friction; None without any, or where no gains are known."""
        control, level = self.prepared.study.controller, np.zeros(self.prepared.fit.n)
        if control is None or not (control.kp > 0.0).all():
            return None
        for cause in self.causes:
            if cause.effect.one_of == "dry" and len(cause.beta):
                for place in cause.places:
                    level[place.joints[0]] += abs(float(cause.beta[0]))
        knows = self._like.recording.dq_des is not None
        made = Sticking(level=level, kp=control.kp, kd=control.kd, knows_speed=knows)
        return made if level.any() else None

    def _recording(self, path: Path) -> Recording:
        q = path.q if self.sticking is None else self.sticking.followed(path.q)
        dq = np.gradient(q, STEP, axis=0)
        ddq = np.gradient(dq, STEP, axis=0)
        study, body, like = self.prepared.study, self.body, self._like.recording
        base = None if like.base is None else np.tile(like.base[0], (len(q), 1))
        tau = body.torque(q, dq, ddq)[:, : body.n] + body.rotor * ddq
        if study.base is not None:
            made = self._logged(q, dq, tau, q, base)
            held = CarriedBody.on(body, base_motion_of(made, study.base, self.cutoff))
            tau = held.torque(q, dq, ddq)[:, : body.n] + body.rotor * ddq
        control = study.controller
        q_des = q
        if control is not None and control.kp.all():
            asked = tau - (body.gravity(q) if control.gravity_compensation else 0.0)
            if like.dq_des is None:
                asked = asked + control.kd * dq
            q_des = q + asked / control.kp
        return self._logged(q, dq, tau, q_des, base)

    def _logged(
        self,
        q: FloatArray,
        dq: FloatArray,
        tau: FloatArray,
        q_des: FloatArray,
        base: FloatArray | None,
        contact: FloatArray | None = None,
    ) -> Recording:
        """Channels as the recordings have them, (T, n) and as `Recording` says, rows STEP apart."""
        like = self._like.recording

        def if_there(name: str, values: FloatArray) -> FloatArray | None:
            there = getattr(like, name)
            return None if there is None else np.where(np.isfinite(there[:1]), values, np.nan)

        return Recording(
            name="proposed",
            role="fit",
            start=0.0,
            time=np.asarray(STEP * np.arange(len(q)), dtype=np.float64),
            q=q,
            dq=if_there("dq", dq),
            tau=tau if self._like.source in ("tau", "current", "duty") else None,
            q_des=if_there("q_des", q_des),
            dq_des=if_there("dq_des", dq),
            tau_cmd=if_there("tau_cmd", tau),
            tip=None if like.tip is None else self._tip(q),
            base=base,
            contact=contact,
            valid=np.ones(len(q), dtype=np.bool_),
            raw_period=STEP,
            jitter=0.0,
        )

    def _tip(self, q: FloatArray) -> FloatArray:
        poses = self.body.poses_and_jacobians(q, self.body.frame(self.prepared.study.tip))[0]
        xyzw = Rotation.from_matrix(poses[:, :3, :3]).as_quat()
        return np.hstack([poses[:, :3, 3], xyzw[:, [3, 0, 1, 2]]])
