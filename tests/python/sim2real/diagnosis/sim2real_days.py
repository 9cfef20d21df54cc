"""Studies on disk of an arm that is another in every recording: what it holds, gains, friction.

Torques are MuJoCo's inverse dynamics of a smooth motion; commands are those that a PD controller
would have needed for them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pandas as pd
import yaml

from sim2real_motions import write_arm

JOINTS = ("j1", "j2", "j3")
PERIOD = 0.008
ROTORS = np.array([0.06, 0.05, 0.03])
KP, KD = (400.0, 400.0, 200.0), (30.0, 30.0, 12.0)
LINK, COM = "tool", (0.02, 0.0, 0.06)


@dataclass(frozen=True, kw_only=True)
class Run:
    """What a machine did, and what its study says of it."""

    mass: float = 0.0  # truly held [kg]
    compensated: float = 0.0  # that the controller knows of [kg]
    kp: tuple[float, ...] = KP
    coulomb: tuple[float, ...] = (0.0, 0.0, 0.0)
    viscous: tuple[float, ...] = (0.0, 0.0, 0.0)
    warm: tuple[float, ...] = (0.0, 0.0, 0.0)  # more dry friction at the start, gone in 5 s
    role: str = "fit"
    told: dict[str, Any] = field(default_factory=dict)


def write_days(
    folder: Path,
    runs: Sequence[Run],
    *,
    seconds: float = 24.0,
    commands: bool = False,
    torques: bool = True,
    noise: float = 0.03,
) -> Path:
    """A study of these runs; gives its YAML file.

    Args:
        folder: to write into.
        runs: one recording each.
        seconds: of each.
        commands: whether they were logged, and the controller is known.
        torques: whether they were logged.
        noise: of the torques [N m].
    """
    robot = write_arm(folder, 3)
    entries = []
    for k, run in enumerate(runs):
        name = f"run{k}.csv"
        table = pd.DataFrame(_columns(robot, run, k, seconds, noise))
        kept = [c for c in table if (torques or c[:3] != "tau") and (commands or "d" not in c)]
        table[kept].to_csv(folder / name, index=False, float_format="%.9g")
        entries.append({"file": name, "role": run.role} | run.told)
    content: dict[str, Any] = {
        "robot": robot.name,
        "tip": LINK,
        "joints": list(JOINTS),
        "recordings": entries,
        "rotor_inertia": ROTORS.tolist(),
    }
    if commands:
        content["controller"] = {"kp": list(KP), "kd": list(KD), "gravity_compensation": True}
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def _columns(robot: Path, run: Run, k: int, seconds: float, noise: float) -> dict[str, np.ndarray]:
    time = PERIOD * np.arange(round(seconds / PERIOD))
    q, dq, ddq = (_motion(time + 37.0 * k, order) for order in range(3))
    tau = torque(robot, q, dq, ddq, run.mass) + ROTORS * ddq
    dry = np.array(run.coulomb) + np.array(run.warm) * np.exp(-time / 5.0)[:, None]
    tau += dry * np.tanh(dq / 0.01) + np.array(run.viscous) * dq
    still = np.zeros_like(q)
    g = torque(robot, q, still, still, run.compensated)
    rng = np.random.default_rng(k)
    channels = {
        "q": q + 1e-5 * rng.standard_normal(q.shape),
        "tau": tau + noise * rng.standard_normal(q.shape),
        "dq": dq + 1e-3 * rng.standard_normal(q.shape),
        "q_des": q + (tau - g) / run.kp,
        "dq_des": dq,
    }
    named = {f"{c}.{j}": v[:, i] for c, v in channels.items() for i, j in enumerate(JOINTS)}
    return {"time": time} | named


def torque(
    robot: Path, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray, mass: float = 0.0
) -> np.ndarray:
    """Of the rigid body with a mass at the tool, by MuJoCo, (T, 3)."""
    spec = mujoco.MjSpec.from_file(str(robot))
    spec.compiler.fusestatic = False
    if mass:
        held = spec.body(LINK).add_body(name="held", pos=list(COM))
        held.mass, held.inertia, held.ipos = mass, [1e-9] * 3, [0.0] * 3
        held.explicitinertial = True
    model = spec.compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.dof_damping[:] = model.dof_frictionloss[:] = model.jnt_limited[:] = 0
    data = mujoco.MjData(model)
    tau = np.empty_like(q)
    for t in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[t], dq[t], ddq[t]
        mujoco.mj_inverse(model, data)
        tau[t] = data.qfrc_inverse
    return tau


def _motion(time: np.ndarray, order: int) -> np.ndarray:
    """Slow and quick by turns, or its derivatives, (T, 3)."""
    result = np.full((len(time), 3), 0.3 if order == 0 else 0.0)
    for k in range(3):
        for amplitude, frequency, phase in ((0.8, 0.11, 0.4), (0.3, 0.29, 1.1), (0.08, 0.71, 2.0)):
            omega = 2 * np.pi * frequency * (1 + 0.17 * k)
            turn = omega * time + phase * (k + 1) + order * np.pi / 2
            result[:, k] += amplitude * omega**order * np.sin(turn)
    return result
