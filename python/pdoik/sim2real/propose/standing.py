"""A robot that stands: its base sways, squats and turns over feet that stay where they are.

Motions are drawn as postures of the base, and of the joints beyond the legs; leg joints follow by
inverse kinematics. Each is run in MuJoCo as it will be sent, by the study's own drives: what that
gives is the recording that is predicted, and a motion in which a foot comes loose, a sole slides
off or the robot falls is none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from pdoik.recordings import FloatArray

from ..motion import Prepared
from .excitation import Frame
from .limits import Limits
from .path import STEP, Path
from .predict import Predict, Run, _Noiseless
from .questions import Cause
from .stance import Stance

_POSTURE = 6  # coordinates of the base: x y z [m], roll pitch yaw [rad], from where it stands
_REACH = 0.15  # of these, as a share of the height that it stands at [m] and of a radian
_PUSH = 0.1  # of gravity, by which the base is accelerated at most: small and slow
_EVERY = 5  # rows of a path between two that are solved for
_STEPS = 6  # of Gauss and Newton
_DAMPED = 1e-6
_BEGIN = 20  # rows of a recording that say how the robot stands


class Standing(Predict):
    """Predictions of one study whose robot stands on its feet."""

    may_be_led = False
    note = "the robot must stand on its feet: the motion was run in MuJoCo, and it stayed up"

    def __init__(self, prepared: Prepared, causes: Sequence[Cause], *, like: int) -> None:
        """Where the robot stands, by the beginning of a recording.

        Raises:
            ValueError: it cannot be said whether it would stay up; the message says why.
        """
        super().__init__(prepared, causes, like=like)
        self._stance = Stance(prepared.study, self.body.rotor)
        begun = self._like.recording
        self.start = q = np.mean(begun.q[:_BEGIN], axis=0)
        base = None if begun.base is None else np.mean(begun.base[:_BEGIN], axis=0)
        self._sent = self._deflection()
        feet = self._feet(q[None])[0][0]
        if base is None:
            base = np.array([0.0, 0.0, -feet[:, 2].min(), 1.0, 0.0, 0.0, 0.0])
        self._base = base
        turn = Rotation.from_quat(base[[4, 5, 6, 3]])
        self._places = base[:3] + turn.apply(feet)  # (feet, 3) in the world

    def _deflection(self) -> FloatArray:
        """Difference of what is sent from where the joints stand, (n,) [rad]."""
        begun, control = self._like.recording, self.prepared.study.controller
        if begun.q_des is not None:
            return np.asarray(np.mean((begun.q_des - begun.q)[:_BEGIN], axis=0))
        torque = self._like.torque
        if torque is None or control is None or control.gravity_compensation:
            return np.zeros(len(self.start))
        return np.asarray(np.mean(torque[:_BEGIN], axis=0) / control.kp)

    @cached_property
    def _legs(self) -> np.ndarray:
        """Joints (n,) that move a foot."""
        jacobian = self._feet(self.start[None])[1][0]
        return np.asarray(np.any(jacobian != 0.0, axis=(0, 1)))

    def frame(self, frame: Frame) -> Frame:
        """Postures of the base, then the joints beyond the legs."""
        height, others = float(self._base[2] - self._places[:, 2].mean()), ~self._legs
        reach = _REACH * np.array([height] * 3 + [1.0] * 3)
        rate = _PUSH * 9.81 * np.array([1.0] * 3 + [1.0 / height] * 3)
        own, zero = frame.limits, np.zeros(_POSTURE)
        limits = Limits(
            lower=np.concatenate([-reach, own.lower[others]]),
            upper=np.concatenate([reach, own.upper[others]]),
            speed=np.concatenate([np.sqrt(rate * reach), own.speed[others]]),
            acceleration=np.concatenate([rate, own.acceleration[others]]),
            torque=np.concatenate([np.full(_POSTURE, np.inf), own.torque[others]]),
        )
        start = np.concatenate([zero, frame.start[others]])
        stuck = np.concatenate([zero, frame.stuck[others]])
        return replace(frame, limits=limits, start=start, stuck=stuck, asked=())

    def load(self, q: FloatArray) -> FloatArray:
        """Nothing that is not on the feet."""
        return np.zeros(len(q))

    def run(self, path: Path) -> Run:
        """Legs that follow, and what MuJoCo's rollout of it gives."""
        joints = self._followed(path)
        sent = replace(joints, q=joints.q + self._sent)
        rolled = self._stance.roll(sent, self.start, self._base)
        if rolled is None:
            return Run(path=sent, balances=None, torque=None)
        made = self._logged(rolled.q, rolled.dq, rolled.tau, sent.q, rolled.base, rolled.contact)
        if self._like.recording.contact is None:
            made = replace(made, contact=None)
        balances = _Noiseless([self.motion(made)], self.limits)
        return Run(path=sent, balances=balances, torque=rolled.tau)

    def _followed(self, path: Path) -> Path:
        """Joints of a path of postures: feet stay."""
        rows = np.unique(np.append(np.arange(0, len(path.q), _EVERY), len(path.q) - 1))
        posture = path.q[rows]
        first = Rotation.from_quat(self._base[[4, 5, 6, 3]])
        turns = first * Rotation.from_euler("xyz", posture[:, 3:_POSTURE])
        places = self._base[:3] + posture[:, :3]
        away = self._places[None] - places[:, None]
        wanted = np.stack([turns.inv().apply(away[:, k]) for k in range(away.shape[1])], axis=1)
        q = np.tile(self.start, (len(rows), 1))
        q[:, ~self._legs] = posture[:, _POSTURE:]
        for _ in range(_STEPS):
            feet, jacobian = self._feet(q)
            J = jacobian.reshape(len(q), -1, q.shape[1])[:, :, self._legs]
            off = (wanted - feet).reshape(len(q), -1, 1)
            square = np.swapaxes(J, 1, 2) @ J + _DAMPED * np.eye(J.shape[2])
            q[:, self._legs] += np.linalg.solve(square, np.swapaxes(J, 1, 2) @ off)[:, :, 0]
        curve = CubicSpline(STEP * rows, q, bc_type="clamped")
        time = path.time
        return Path(q=curve(time), dq=curve(time, 1), ddq=curve(time, 2))

    def _feet(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Spots of the feet in the base's frame, (T, feet, 3), and their Jacobians with joints."""
        assert self.prepared.study.base is not None
        spots, jacobians = [], []
        for foot in self.prepared.study.base.feet:
            poses, J = self.body.poses_and_jacobians(q, self.body.frame(foot.link))
            arm = poses[:, :3, :3] @ np.array(foot.at)
            spots.append(poses[:, :3, 3] + arm)
            jacobians.append(J[:, :3] + np.cross(J[:, 3:], arm[:, :, None], axis=1))
        return np.stack(spots, axis=1), np.stack(jacobians, axis=1)
