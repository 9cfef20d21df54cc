"""What recordings must have that simulators run under, and what their commands make drives do."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from pdoik.recordings import FloatArray, Recording

from ..thresholds import SimulatorThresholds
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


def check_base_at_rest(recording: Recording, limits: SimulatorThresholds) -> None:
    """Check that the base was held, by its pose and its gyroscope where these were logged.

    Raises:
        ValueError: it was not.
    """
    said = []
    if recording.base is not None:
        shift = float(np.max(np.ptp(recording.base[:, :3], axis=0)))
        if shift > limits.base_shift:
            said.append(f"base.x, .y, .z change by {shift:.2g} m")
    if recording.gyro is not None:
        spin = recording.gyro - np.median(recording.gyro, axis=0)  # less what it is off by
        rms = float(np.sqrt(np.mean(np.sum(spin**2, axis=1))))
        if rms > limits.base_spin:
            said.append(f"its gyroscope turns at {rms:.2g} rad/s")
    if said:
        raise ValueError(
            f"{recording.name}: the base moves ({', '.join(said)}); pdoik compare runs simulators"
            " with the base fixed: record it hung up or clamped and leave this one out, or let"
            " pdoik diagnose judge it with the study's key 'base:'"
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


def follow(model: Any, data: Any) -> None:
    """Put joints that an equality ties to others where these make them be."""
    kind = int(mujoco.mjtEq.mjEQ_JOINT)
    for k in range(model.neq):
        if int(model.eq_type[k]) != kind or not model.eq_active0[k]:
            continue
        one, two = int(model.eq_obj1id[k]), int(model.eq_obj2id[k])
        at = int(model.jnt_qposadr[one])
        x = 0.0
        slope = model.eq_data[k, 1:5]
        speed = 0.0
        if two >= 0:
            there = int(model.jnt_qposadr[two])
            x = float(data.qpos[there] - model.qpos0[there])
            speed = float(data.qvel[int(model.jnt_dofadr[two])])
        powers = x ** np.arange(1, 5)
        data.qpos[at] = model.qpos0[at] + model.eq_data[k, 0] + float(slope @ powers)
        rates = np.arange(1, 5) * x ** np.arange(4)
        data.qvel[int(model.jnt_dofadr[one])] = float(slope @ rates) * speed


def settle_actuators(user: UserModel, data: Any, command: FloatArray) -> None:
    """Filters and delays of the model's own begin with the command of the run's start."""
    model = user.model
    for k, actuator in enumerate(user.actuators):
        count = int(model.actuator_actnum[actuator])
        if count:
            at = int(model.actuator_actadr[actuator])
            data.act[at : at + count] = command[k]
        if hasattr(model, "actuator_history") and int(model.actuator_history[actuator, 0]) > 0:
            size = int(model.actuator_history[actuator, 0])
            mujoco.mj_initCtrlHistory(model, data, actuator, None, np.full((size, 1), command[k]))
