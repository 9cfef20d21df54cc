"""What the machine's computer writes: noise, quantised torque, jitter, lost rows."""

from __future__ import annotations

import mujoco
import numpy as np

from bench.sim2real.concealed.arm import Array, quaternion, rotation_rpy
from bench.sim2real.concealed.equipment import Sensors
from bench.sim2real.concealed.world import Run, Truth


def channels_of(truth: Truth, run: Run) -> dict[str, Array]:
    """Channels at the controller's ticks before noise; effects on channels are applied.

    The drive reports torque as its mean over the logging period about the tick.
    """
    sensors, control = run.world.sensors, run.world.control
    half = max(1, round(0.5 * sensors.log_period / control.period))
    total = np.vstack([np.zeros(truth.tau.shape[1]), np.cumsum(truth.tau, axis=0)])
    ticks = np.arange(len(truth.time))
    low, high = np.maximum(ticks - half, 0), np.minimum(ticks + half, len(ticks))
    channels = {
        "time": truth.time.copy(),
        "q": truth.q_read.copy(),
        "dq": truth.dq_read.copy(),
        "tau": (total[high] - total[low]) / (high - low)[:, None],
        "q_des": truth.q_des.copy(),
        "dq_des": truth.dq_des.copy(),
        "tau_cmd": truth.tau_cmd.copy(),
    }
    for effect in run.world.effects:
        effect.change_channels(channels, run)
    return channels


def rows_of(channels: dict[str, Array], run: Run) -> Array:
    """Ticks that reach the file: every few, some jittered, some lost, rarely a gap."""
    sensors, control, rng = run.world.sensors, run.world.control, run.rng
    count = len(channels["time"])
    every = sensors.log_period / control.period
    rows = np.arange(0.0, count - 1.0, every)
    rows = np.rint(rows + rng.normal(0.0, sensors.jitter, len(rows))).astype(int)
    rows = np.unique(np.clip(rows, 0, count - 1))
    keep = rng.random(len(rows)) >= sensors.dropped
    if rng.random() < 0.2:
        start = rng.integers(len(rows) - 20)
        keep[start : start + rng.integers(5, 15)] = False
    keep[0] = True
    return rows[keep]


def tip_of(run: Run, qpos: Array) -> tuple[Array, Array]:
    """True position and rotation of the tip in the base."""
    run.data.qpos[:] = qpos
    mujoco.mj_kinematics(run.model, run.data)
    return run.data.site_xpos[0].copy(), run.data.site_xmat[0].reshape(3, 3).copy()


def tip_poses(truth: Truth, run: Run, rows: Array) -> Array:
    """Measured tip poses (T, 7): x y z qw qx qy qz in the base."""
    sensors, rng = run.world.sensors, run.rng
    result = np.empty((len(rows), 7))
    for index, row in enumerate(rows):
        position, rotation = tip_of(run, truth.qpos[row])
        turn = rotation_rpy(rng.normal(0.0, sensors.tip_turn_noise, 3))
        result[index, :3] = position + rng.normal(0.0, sensors.tip_noise, 3)
        result[index, 3:] = quaternion(turn @ rotation)
    return result


def measured(channels: dict[str, Array], run: Run, rows: Array) -> dict[str, Array]:
    """The rows with noise and quantisation; clocks are read a little late or early."""
    sensors, rng = run.world.sensors, run.rng
    noise = noise_of(sensors, run)
    result = {name: values[rows] for name, values in channels.items()}
    shape = result["tau"].shape
    tau = result["tau"] + rng.normal(0.0, 1.0, shape) * noise["tau"]
    result["tau"] = np.rint(tau / sensors.tau_step) * sensors.tau_step
    for name in ("q", "dq"):  # beyond what the controller read: usually none
        result[name] = result[name] + rng.normal(0.0, 1.0, shape) * noise[name]
    result["time"] = result["time"] + rng.normal(0.0, 2e-5, len(rows))
    return result


def noise_of(sensors: Sensors, run: Run) -> dict[str, Array]:
    """Standard deviations (n,) that the logger adds to each channel."""
    n = run.world.arm.n
    noise = {"tau": sensors.tau_noise.copy(), "q": np.zeros(n), "dq": np.zeros(n)}
    for effect in run.world.effects:
        effect.change_noise(noise)
    return noise
