"""What recorded commands make a simulator's drives do, step by step."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from pdoik.recordings import FloatArray, Recording

from .user_model import UserModel


def check_commands(recording: Recording, joints: Sequence[str]) -> None:
    """Check that q_des was logged of every joint.

    Raises:
        ValueError: it was not.
    """
    q_des = recording.q_des
    for k, joint in enumerate(joints):
        if q_des is None or not np.isfinite(q_des[:, k]).all():
            raise ValueError(
                f"{recording.name}: expected a column 'q_des.{joint}': a simulator is run under"
                f" the commands; it has {', '.join(recording.channels)}"
            )


def fed_forward(user: UserModel, recording: Recording) -> FloatArray | None:
    """Torques (T, n) that a controller outside the model adds, whatever the candidate is.

    They are kd dq_des, and the gravity of the user's own model at the measured positions.
    """
    law = user.law
    if law is None or (recording.dq_des is None and not law.gravity_compensation):
        return None
    torque = np.zeros_like(recording.q)
    if recording.dq_des is not None:
        torque += law.kd * np.nan_to_num(recording.dq_des)
    if law.gravity_compensation:
        data = mujoco.MjData(user.model)
        for k, q in enumerate(recording.q):
            data.qpos[list(user.qpos)] = q
            mujoco.mj_fwdPosition(user.model, data)
            mujoco.mj_fwdVelocity(user.model, data)
            torque[k] += data.qfrc_bias[list(user.dof)]
    return torque


def mean_over(time: FloatArray, values: FloatArray, begin: FloatArray, dt: float) -> FloatArray:
    """Mean over [begin, begin + dt] of a command that is held from sample to sample, (K,)."""
    period = float(time[1] - time[0])
    edges = np.append(time, time[-1] + period)
    integral = np.append(0.0, np.cumsum(values * period))

    def until(t: FloatArray) -> FloatArray:
        inside = np.interp(t, edges, integral)
        before = np.minimum(t - edges[0], 0.0) * values[0]
        after = np.maximum(t - edges[-1], 0.0) * values[-1]
        return np.asarray(inside + before + after)

    return (until(begin + dt) - until(begin)) / dt
