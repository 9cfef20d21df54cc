"""A user's MJCF, and machines that are the same but for something, stepped by MuJoCo itself."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from pdoik.recordings import Recording

JOINTS = ("shoulder", "elbow", "wrist")
PERIOD = 5e-3  # of the logs [s]

MJCF = """<mujoco model="arm">
  <!-- the user's own words -->
  <compiler angle="degree"/>
  <option timestep="0.002" integrator="implicitfast"/>
  <default>
    <joint damping="0.3" armature="0.01"/>
    <position forcerange="-80 80"/>
  </default>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0" range="-170 170"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="1.5" contype="0" conaffinity="0"/>
      <body name="fore" pos="0.3 0 0">
        <joint name="elbow" axis="0 1 0"   frictionloss='0.1'/>  <!-- spaces and quotes stay -->
        <inertial pos="0.15 0 0" mass="1.0" diaginertia="0.001 0.008 0.008"/>
        <body name="hand" pos="0.3 0 0">
          <joint name="wrist" axis="0 0 1"/>
          <geom type="box" size="0.05 0.02 0.02" pos="0.05 0 0" mass="0.3" contype="0" conaffinity="0"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="servo1" joint="shoulder" kp="120" kv="4"/>
    <position joint="elbow" kp="80" kv="3"/>
    <general name="servo3" joint="wrist" gainprm="15" biastype="affine" biasprm="0 -15 -0.3"/>
  </actuator>
</mujoco>
"""  # noqa: E501

Change = Callable[[Any], None]  # of a mujoco.MjSpec


def commands(seconds: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Times (T,) and q_des (T, 3): sines, slow and fast."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, PERIOD)
    q = np.tile([0.4, 0.5, 0.0], (len(time), 1))
    for low, high, size in ((0.1, 0.4, 0.3), (0.6, 1.5, 0.15), (2.0, 3.5, 0.04)):
        f, phase = rng.uniform(low, high, 3), rng.uniform(0.0, 2 * np.pi, 3)
        q += size * np.sin(2 * np.pi * f * time[:, None] + phase)
    return time, q


def stepped(
    q_des: np.ndarray,
    change: Change | None = None,
    *,
    delay: float = 0.0,
    step: float = 5e-4,
    mjcf: str = MJCF,
) -> tuple[np.ndarray, np.ndarray]:
    """Positions and torques (T, n) of a model with a change, by plain MuJoCo in short steps."""
    spec = mujoco.MjSpec.from_string(mjcf)
    if change is not None:
        change(spec)
    model = spec.compile()
    model.opt.timestep = step
    data = mujoco.MjData(model)
    data.qpos[:] = q_des[0]
    each = round(PERIOD / step)
    late = round(delay / step)
    q, tau = np.empty_like(q_des), np.empty_like(q_des)
    for k in range(len(q_des) * each):
        if k % each == 0:
            q[k // each] = data.qpos
        data.ctrl[:] = q_des[max(k - late, 0) // each]
        mujoco.mj_step(model, data)
        if k % each == 0:
            tau[k // each] = data.qfrc_actuator
    return q, tau


def log(
    seconds: float,
    seed: int,
    change: Change | None = None,
    *,
    name: str = "run.csv",
    role: str = "fit",
    noise: float = 2e-4,
    delay: float = 0.0,
    step: float = 5e-4,
    mjcf: str = MJCF,
    joints: int = 3,
) -> Recording:
    """Commands and positions of such a machine, as its encoders show them."""
    time, q_des = commands(seconds, seed)
    q_des = q_des[:, :joints]
    q, _ = stepped(q_des, change, delay=delay, step=step, mjcf=mjcf)
    q = q + np.random.default_rng(seed + 100).normal(0.0, noise, q.shape)
    return Recording(
        name=name,
        role="fit" if role == "fit" else "validate",
        start=0.0,
        time=time,
        q=q,
        q_des=q_des,
        valid=np.ones(len(time), dtype=bool),
        raw_period=PERIOD,
        jitter=0.0,
    )


def write_csv(path: Path, recording: Recording, joints: tuple[str, ...] = JOINTS) -> None:
    """As users log it."""
    assert recording.q_des is not None
    names = ["time", *(f"q.{j}" for j in joints), *(f"q_des.{j}" for j in joints)]
    columns = np.column_stack([recording.start + recording.time, recording.q, recording.q_des])
    np.savetxt(path, columns, delimiter=",", header=",".join(names), comments="", fmt="%.9g")
