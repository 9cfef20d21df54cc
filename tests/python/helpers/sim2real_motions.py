"""Smooth motions of small arms in space, with every channel, for tests of the effects."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pdoik.recordings import Recording
from pdoik.sim2real.motion import Motion, RigidBody, motion_of
from pdoik.sim2real.study import Controller
from sim2real_recordings import even_recording

PERIOD = 0.004
CUTOFF = 10.0  # [Hz]
INSIDE = slice(250, -250)  # where the filters' ends are not felt
AXES = ("0 0 1", "0 1 0", "0.6 0.8 0")


def write_arm(folder: Path, n: int) -> Path:
    """A URDF of n joints j1 .. jn with skew axes and links l1 .. ln, and a tool on the last."""
    text = '<robot name="arm"><link name="base"/>'
    for k in range(1, n + 1):
        parent, origin = ("base", "0 0 0.1") if k == 1 else (f"l{k - 1}", "0.3 0.05 0.1")
        text += f"""
        <joint name="j{k}" type="revolute"><parent link="{parent}"/><child link="l{k}"/>
          <origin xyz="{origin}" rpy="{0.2 * k} {-0.1 * k} 0.3"/><axis xyz="{AXES[k - 1]}"/>
          <limit lower="-3" upper="3" effort="90" velocity="3"/></joint>
        <link name="l{k}"><inertial><origin xyz="0.15 {0.04 * k} 0.06"/>
          <mass value="{2.5 - k / 2}"/>
          <inertia ixx="0.02" iyy="0.03" izz="0.025" ixy="0.002" ixz="-0.001" iyz="0.003"/>
        </inertial></link>"""
    text += f"""<link name="tool"/><joint name="flange" type="fixed"><parent link="l{n}"/>
      <child link="tool"/><origin xyz="0.2 0.03 -0.05" rpy="0.1 0.2 0.3"/></joint></robot>"""
    path = folder / f"arm{n}.urdf"
    path.write_text(text)
    return path


def wave(time: np.ndarray, n: int, order: int = 0) -> np.ndarray:
    """Positions, or their derivatives of an order, (T, n)."""
    result = np.zeros((len(time), n))
    for k in range(n):
        for amplitude, frequency, phase in ((0.7, 0.21, 0.4), (0.25, 0.53, 1.1), (0.05, 1.3, 2.0)):
            omega = 2 * np.pi * frequency * (1 + 0.17 * k)
            turn = omega * time + phase * (k + 1) + order * np.pi / 2
            result[:, k] += amplitude * omega**order * np.sin(turn)
    return result + (0.3 if order == 0 else 0.0)


def pd(n: int, **options: Any) -> Controller:
    """Gains that differ from joint to joint."""
    options = {"gravity_compensation": True} | options
    return Controller(kp=100.0 + 20.0 * np.arange(n), kd=8.0 + np.arange(n), **options)


def recording(body: RigidBody | None, n: int, seconds: float = 14.0, **channels: Any) -> Recording:
    """The wave with torques as the body needs them; channels replace these, None leaves one out."""
    time = PERIOD * np.arange(round(seconds / PERIOD))
    q, dq, ddq = (wave(time, n, order) for order in range(3))
    tau = 5.0 * q if body is None else body.dynamics(q, dq, ddq).tau
    made: dict[str, Any] = {
        "q": q,
        "dq": dq,
        "tau": tau,
        "tau_cmd": tau + 0.3 * np.sin(3.0 * time)[:, None],
        "q_des": wave(time + 0.01, n),
        "dq_des": wave(time + 0.01, n, 1),
    }
    return even_recording(time, start=100.0, **(made | channels))


def measured_tip(body: RigidBody, q: np.ndarray, link: str = "tool") -> np.ndarray:
    """The tip's pose as a recording has it, (T, 7)."""
    from scipy.spatial.transform import Rotation

    poses, _ = body.poses_and_jacobians(q, body.frame(link))
    xyzw = Rotation.from_matrix(poses[:, :3, :3]).as_quat()
    return np.hstack([poses[:, :3, 3], xyzw[:, [3, 0, 1, 2]]])


def moved(
    folder: Path,
    n: int = 3,
    *,
    tip: bool = False,
    controller: Controller | None = None,
    rotor: float = 0.05,
    seconds: float = 14.0,
    **channels: Any,
) -> Motion:
    """The arm's motion; `channels` replace those of the recording."""
    names = tuple(f"j{k}" for k in range(1, n + 1))
    body = RigidBody(write_arm(folder, n), names, np.full(n, rotor))
    run = recording(body, n, seconds, **channels)
    if tip:
        run = replace(run, tip=measured_tip(body, run.q))
    noise = np.full(n, 1e-14)
    return motion_of(run, body, controller, CUTOFF, noise, "tool" if tip else None)
