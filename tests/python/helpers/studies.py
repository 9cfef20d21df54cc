"""Studies on disk for the tests of what pdoik.sim2real reads: a plane arm of two joints."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml

URDF = """<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
    <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="fore"><inertial><origin xyz="0.15 0 0"/><mass value="{mass}"/>
    <inertia ixx="0.005" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="60" velocity="3"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-2.5" upper="2.5" effort="30" velocity="3"/></joint>
  <joint name="flange" type="fixed"><parent link="fore"/><child link="tool"/>
    <origin xyz="0.3 0 0"/></joint>
</robot>
"""

MJCF = """<mujoco>
  <worldbody><body name="upper">
    <joint name="shoulder" axis="0 1 0" armature="0.05" range="-170 170"/>
    <inertial pos="0.2 0 0" mass="2" diaginertia="0.01 0.02 0.02"/>
    <body name="fore" pos="0.4 0 0">
      <joint name="elbow" axis="0 1 0" armature="0.02" range="-140 140"/>
      <inertial pos="0.15 0 0" mass="{mass}" diaginertia="0.005 0.01 0.01"/>
      <site name="tool" pos="0.3 0 0"/>
    </body></body></worldbody>
</mujoco>
"""

JOINTS = ("shoulder", "elbow")


def motion(time: np.ndarray) -> np.ndarray:
    """Positions of the two joints, (T, 2)."""
    return np.stack([0.8 * np.sin(2 * time) + 0.1, 0.6 * np.cos(3 * time) - 0.2], axis=1)


def speed(time: np.ndarray) -> np.ndarray:
    """The derivative of `motion`."""
    return np.stack([1.6 * np.cos(2 * time), -1.8 * np.sin(3 * time)], axis=1)


def columns(time: np.ndarray) -> dict[str, np.ndarray]:
    """A recording of the arm: positions, speeds, and torques about as large as gravity's."""
    q, dq = motion(time), speed(time)
    g = -9.81 * np.stack(
        [
            2 * 0.2 * np.cos(q[:, 0]) + 0.4 * np.cos(q[:, 0]) + 0.15 * np.cos(q.sum(axis=1)),
            0.15 * np.cos(q.sum(axis=1)),
        ],
        axis=1,
    )
    table = {"time": time}
    for k, joint in enumerate(JOINTS):
        table |= {f"q.{joint}": q[:, k], f"dq.{joint}": dq[:, k]}
        table |= {f"tau.{joint}": g[:, k] + 0.5 * np.sign(dq[:, k])}
    return table


def log(seconds: float = 8.0, rate: float = 100.0, start: float = 0.0) -> pd.DataFrame:
    """`columns` at even times."""
    time = np.arange(round(seconds * rate)) / rate
    table = pd.DataFrame(columns(time))
    table["time"] += start
    return table


def write_study(
    folder: Path,
    logs: Mapping[str, pd.DataFrame] | None = None,
    model: str | None = URDF.format(mass=1),
    /,
    **keys: Any,
) -> Path:
    """A study of these logs and this robot; `keys` replace its own, None takes one away."""
    content: dict[str, Any] = {}
    if model is not None:
        content["robot"] = "arm.urdf" if "<robot" in model else "arm.xml"
        (folder / content["robot"]).write_text(model)
    logs = logs if logs is not None else {"a.csv": log(), "b.csv": log(5.0)}
    for name, table in logs.items():
        table.to_csv(folder / name, index=False)
    names = list(logs)
    content["joints"] = list(JOINTS)
    content["recordings"] = [{"file": name, "role": "fit"} for name in names[:-1] or names]
    if len(names) > 1:
        content["recordings"].append({"file": names[-1], "role": "validate"})
    content |= keys
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump({k: v for k, v in content.items() if v is not None}))
    return path
