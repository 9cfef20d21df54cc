"""How visible something is in the truth itself: residuals of the believed model over the noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.sim2real.concealed.arm import Array
from bench.sim2real.concealed.equipment import Controller, Sensors
from bench.sim2real.concealed.logger import noise_of, tip_of
from bench.sim2real.concealed.motion import STEP, Motion
from bench.sim2real.concealed.reference import Dynamics
from bench.sim2real.concealed.world import Run, Truth

EVERY = 0.02  # seconds between two rows that are judged


def torque_along(dynamics: Dynamics, time: Array, motion: Motion) -> Array:
    """The believed torques of the commanded motion at the given times."""
    rows = np.minimum(np.rint(time / STEP).astype(int), len(motion.q) - 1)
    return dynamics.torque(motion.q[rows], motion.dq[rows], motion.ddq[rows])


def torque_residual(dynamics: Dynamics, truth: Truth, tau: Array, control: Controller) -> Array:
    """Torque less inverse dynamics of the true motor motion, (T, n), both over the same window."""
    half = max(1, round(2e-3 / control.period))
    every = round(EVERY / control.period)
    rows = np.arange(50 * half, len(truth.time) - 50 * half, every)
    ddq = (truth.dq[rows + half] - truth.dq[rows - half]) / (2 * half * control.period)
    dq = 0.5 * (truth.dq[rows + half] + truth.dq[rows - half])
    return tau[rows] - dynamics.torque(truth.q[rows], dq, ddq)


def command_residual(dynamics: Dynamics, truth: Truth, tau: Array, control: Controller) -> Array:
    """Torque less the control law at the logged commands and readings, (T, n)."""
    every = round(EVERY / control.period)
    rows = np.arange(0, len(truth.time), every)
    law = control.kp * (truth.q_des[rows] - truth.q_read[rows])
    law += control.kd * (truth.dq_des[rows] - truth.dq_read[rows])
    if control.gravity_compensation:
        law += np.array([dynamics.gravity(q) for q in truth.q_read[rows]])
    return tau[rows] - law


def tip_residual(dynamics: Dynamics, truth: Truth, run: Run) -> Array:
    """True tip less the believed one at the encoders' positions, (T, 3) [m]."""
    rows = np.arange(0, len(truth.time), round(0.1 / run.world.control.period))
    tips = np.array([tip_of(run, truth.qpos[row])[0] for row in rows])
    return tips - dynamics.tips(truth.q[rows])[0]


def visibility(
    dynamics: Dynamics,
    runs: Sequence[Run],
    truths: Sequence[Truth],
    channels: Sequence[dict[str, Array]],
    control: Controller,
    sensors: Sensors,
) -> dict[str, list[float]]:
    """Per joint, root mean squares of the residuals in units of each channel's noise."""

    def rms(rows: list[Array], noise: Array) -> list[float]:
        return [round(float(x), 3) for x in np.sqrt(np.mean(np.vstack(rows) ** 2, axis=0)) / noise]

    pairs = list(zip(truths, channels, strict=True))
    noisier = noise_of(sensors, runs[0]) if runs else {}
    q_noise = np.hypot(sensors.q_noise, sensors.q_step / np.sqrt(12.0))
    seen = {
        "torque": rms(
            [torque_residual(dynamics, t, c["tau"], control) for t, c in pairs], sensors.tau_noise
        ),
        "command": rms(
            [command_residual(dynamics, t, c["tau"], control) for t, c in pairs], sensors.tau_noise
        ),
        "dq": rms([c["dq"] - t.dq_read for t, c in pairs], sensors.dq_noise),
        "q": rms([c["q"] - t.q_read for t, c in pairs], q_noise),
        "noise": [
            round(float(max(a, b)), 3)
            for a, b in zip(
                noisier["tau"] / sensors.tau_noise,
                np.hypot(1.0, noisier["dq"] / sensors.dq_noise),
                strict=True,
            )
        ],
    }
    if sensors.tip:
        shifts = [tip_residual(dynamics, t, run) for t, run in zip(truths, runs, strict=True)]
        seen["tip"] = rms(shifts, np.full(3, sensors.tip_noise))
    return seen
