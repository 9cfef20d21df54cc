"""Long logs of the example's arm in MuJoCo, and what may come over it."""

from __future__ import annotations

from functools import lru_cache

import mujoco
import numpy as np

from bench.sim2real import example

Columns = dict[str, np.ndarray]


@lru_cache
def _log(seed: int, seconds: float) -> tuple[tuple[str, ...], np.ndarray]:
    module = example
    module.SECONDS = seconds
    names, rows = module.recording(seed)
    return tuple(names), rows


def log(seed: int, seconds: float = 40.0) -> Columns:
    """A healthy log: time, q.<joint>, tau.<joint> and what else the example logs."""
    names, rows = _log(seed, seconds)
    return {name: rows[:, k].copy() for k, name in enumerate(names)}


def changed(columns: Columns, kind: str, joint: str, since: float) -> Columns:
    """The same motion with the torque it would take; of a load by MuJoCo's inverse dynamics."""
    other = dict(columns)
    time = columns["time"]
    on = time >= since
    q = np.stack([columns[f"q.{each}"] for each in example.JOINTS], axis=1)
    dq = np.gradient(q, time, axis=0)
    j = example.JOINTS.index(joint)
    tau = columns[f"tau.{joint}"]
    if kind == "friction":
        more = example.LEVEL * np.tanh(dq[:, j] / 0.01) + example.DAMPING * dq[:, j]
        other[f"tau.{joint}"] = tau + np.where(on, more, 0.0)
    elif kind == "offset":
        other[f"tau.{joint}"] = tau + np.where(on, 0.5, 0.0)
    elif kind == "gain":
        other[f"tau.{joint}"] = tau * np.where(on, 1.15, 1.0)
    else:
        more = _of_load(q, dq, time)
        for k, each in enumerate(example.JOINTS):
            other[f"tau.{each}"] = columns[f"tau.{each}"] + np.where(on, more[:, k], 0.0)
    return other


def _of_load(q: np.ndarray, dq: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Torques of another 0.4 kg in the hand, (T, 3)."""
    smooth = np.stack([np.convolve(c, np.ones(9) / 9, mode="same") for c in dq.T], axis=1)
    ddq = np.gradient(smooth, time, axis=0)
    torques = []
    module = example
    own = module.MASS
    for mass in (own, own + 0.4):
        module.MASS = mass
        model, _ = module.machine()
        module.MASS = own
        data = mujoco.MjData(model)
        out = np.empty_like(q)
        for t in range(len(q)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[t], smooth[t], ddq[t]
            mujoco.mj_inverse(model, data)
            out[t] = data.qfrc_inverse
        torques.append(out)
    return torques[1] - torques[0]
