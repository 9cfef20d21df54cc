"""What the machine's computer writes: noise, quantised torque, jitter, lost rows.

And how visible something is in the truth itself: residuals of the believed model over the noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from bench.sim2real.concealed.reference import Dynamics
from bench.sim2real.concealed.world import Run, Truth, World
from bench.sim2real.frame.arm import Array, quaternion, rotation_rpy
from bench.sim2real.frame.motion import STEP, Motion
from bench.sim2real.frame.study_files import write_recording


@dataclass(frozen=True, slots=True, kw_only=True)
class Take:
    """One recording of a run."""

    run: Run
    truth: Truth
    channels: dict[str, Array]  # before noise

    @classmethod
    def of(cls, run: Run) -> Take:
        """Simulates it."""
        truth = run.simulate()
        return cls(run=run, truth=truth, channels=channels_of(truth, run))

    def write(
        self, path: Path, logged: list[str], shuffle: np.random.Generator, *, tip: bool
    ) -> dict[str, Array]:
        """Writes the CSV; what time, q, dq and tau of its rows were before noise."""
        kept = rows_of(self.channels, self.run)
        data = measured(self.channels, self.run, kept)
        poses = tip_poses(self.truth, self.run, kept) if tip else None
        write_recording(path, data, logged, poses, shuffle)
        truth = self.truth
        true = {"time": truth.time, "q": truth.q, "dq": truth.dq, "tau": self.channels["tau"]}
        return {name: values[kept] for name, values in true.items()}


def channels_of(truth: Truth, run: Run) -> dict[str, Array]:
    """Channels at the controller's ticks before noise; effects on channels are applied.

    The drive reports torque as its mean over the logging period about the tick.
    """
    sensors, control = run.world.sensors, run.world.control
    half = max(1, round(0.5 * sensors.log_period / control.period))
    total = np.vstack([np.zeros(truth.tau.shape[1]), np.cumsum(truth.tau, axis=0)])
    ticks = np.arange(len(truth.time))
    low, high = np.maximum(ticks - half, 0), np.minimum(ticks + half, len(ticks))
    read = {"time": truth.time, "q": truth.q_read, "dq": truth.dq_read, "q_des": truth.q_des}
    read |= {"dq_des": truth.dq_des, "tau_cmd": truth.tau_cmd}
    channels = {name: values.copy() for name, values in read.items()}
    channels["tau"] = (total[high] - total[low]) / (high - low)[:, None]
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
    noise = noise_of(run)
    result = {name: values[rows] for name, values in channels.items()}
    shape = result["tau"].shape
    tau = result["tau"] + rng.normal(0.0, 1.0, shape) * noise["tau"]
    result["tau"] = np.rint(tau / sensors.tau_step) * sensors.tau_step
    for name in ("q", "dq"):  # beyond what the controller read: usually none
        result[name] = result[name] + rng.normal(0.0, 1.0, shape) * noise[name]
    result["time"] = result["time"] + rng.normal(0.0, 2e-5, len(rows))
    return result


def noise_of(run: Run) -> dict[str, Array]:
    """Standard deviations (n,) that the logger adds to each channel."""
    n = run.world.arm.n
    noise = {"tau": run.world.sensors.tau_noise.copy(), "q": np.zeros(n), "dq": np.zeros(n)}
    for effect in run.world.effects:
        effect.change_noise(noise)
    return noise


EVERY = 0.02  # seconds between two rows that are judged


def torque_along(dynamics: Dynamics, time: Array, motion: Motion) -> Array:
    """The believed torques of the commanded motion at the given times."""
    rows = np.minimum(np.rint(time / STEP).astype(int), len(motion.q) - 1)
    return dynamics.torque(motion.q[rows], motion.dq[rows], motion.ddq[rows])


def torque_residual(take: Take) -> Array:
    """Torque less inverse dynamics of the true motor motion, (T, n), both over the same window."""
    world, truth = take.run.world, take.truth
    period = world.control.period
    half, every = max(1, round(2e-3 / period)), round(EVERY / period)
    rows = np.arange(50 * half, len(truth.time) - 50 * half, every)
    ddq = (truth.dq[rows + half] - truth.dq[rows - half]) / (2 * half * period)
    dq = 0.5 * (truth.dq[rows + half] + truth.dq[rows - half])
    return take.channels["tau"][rows] - world.believed.torque(truth.q[rows], dq, ddq)


def command_residual(take: Take) -> Array:
    """Torque less the control law at the logged commands and readings, (T, n)."""
    world, control, truth = take.run.world, take.run.world.control, take.truth
    rows = np.arange(0, len(truth.time), round(EVERY / control.period))
    law = control.kp * (truth.q_des[rows] - truth.q_read[rows])
    law += control.kd * (truth.dq_des[rows] - truth.dq_read[rows])
    if control.gravity_compensation:
        law += np.array([world.believed.gravity(q) for q in truth.q_read[rows]])
    return take.channels["tau"][rows] - law


def tip_residual(take: Take) -> Array:
    """True tip less the believed one at the encoders' positions, (T, 3) [m]."""
    world, truth = take.run.world, take.truth
    rows = np.arange(0, len(truth.time), round(0.1 / world.control.period))
    tips = np.array([tip_of(take.run, truth.qpos[row])[0] for row in rows])
    return tips - world.believed.tips(truth.q[rows])[0]


def visibility(world: World, takes: Sequence[Take]) -> dict[str, list[float]]:
    """Per joint, root mean squares of the residuals in units of each channel's noise."""
    sensors = world.sensors

    def rms(rows: list[Array], noise: Array) -> list[float]:
        return [round(float(x), 3) for x in np.sqrt(np.mean(np.vstack(rows) ** 2, axis=0)) / noise]

    noisier = noise_of(takes[0].run)
    noise = np.maximum(
        noisier["tau"] / sensors.tau_noise, np.hypot(1.0, noisier["dq"] / sensors.dq_noise)
    )
    read = [(take.channels, take.truth) for take in takes]
    seen = {
        "torque": rms(list(map(torque_residual, takes)), sensors.tau_noise),
        "command": rms(list(map(command_residual, takes)), sensors.tau_noise),
        "dq": rms([channels["dq"] - truth.dq_read for channels, truth in read], sensors.dq_noise),
        "q": rms([channels["q"] - truth.q_read for channels, truth in read], sensors.q_seen),
        "noise": [round(float(each), 3) for each in noise],
    }
    if sensors.tip:
        seen["tip"] = rms(list(map(tip_residual, takes)), np.full(3, sensors.tip_noise))
    return seen
