"""Small robots, recordings and controllers for the tests of the simulation."""

from __future__ import annotations

from typing import Any

import numpy as np

from pdoik.sim2real.recording import Recording
from pdoik.sim2real.study import Controller

MASS, LENGTH, INERTIA = 2.0, 0.3, 0.05  # of each link: com along x, inertia about it


def arm_urdf(n: int, axis: str = "0 1 0", *, extra: str = "") -> str:
    """Links of length 2 LENGTH one after the other, all joints about one axis of the base."""
    text = '<robot name="arm"><link name="base"/>'
    for k in range(1, n + 1):
        parent = "base" if k == 1 else f"link{k - 1}"
        x = 0.0 if k == 1 else 2 * LENGTH
        text += f"""
          <joint name="joint{k}" type="continuous">
            <parent link="{parent}"/><child link="link{k}"/>
            <origin xyz="{x} 0 0"/><axis xyz="{axis}"/>
          </joint>
          <link name="link{k}">
            <inertial>
              <origin xyz="{LENGTH} 0 0"/><mass value="{MASS}"/>
              <inertia ixx="{INERTIA}" ixy="0" ixz="0" iyy="{INERTIA}" iyz="0" izz="{INERTIA}"/>
            </inertial>{extra}
          </link>"""
    return text + "</robot>"


ABOUT_PIVOT = INERTIA + MASS * LENGTH**2
PENDULUM = arm_urdf(1)  # swings in the x z plane; q = pi / 2 hangs down
TURNTABLE = arm_urdf(1, "0 0 1")  # gravity does nothing


def commands(duration: float, period: float = 1e-3, n: int = 1, **channels: Any) -> Recording:
    """A recording whose channels are given as functions of time, of arrays (T, n), or numbers."""
    time = period * np.arange(round(duration / period) + 1)

    def filled(value: Any) -> np.ndarray:
        value = value(time) if callable(value) else value
        value = np.asarray(value, dtype=float)
        if value.ndim == 1 and value.shape == time.shape:
            value = value[:, None]
        return np.broadcast_to(value, (len(time), n)).copy()

    arrays = {name: filled(value) for name, value in {"q": 0.0, **channels}.items()}
    return Recording(
        name="rec.csv",
        role="validate",
        start=0.0,
        time=time,
        valid=np.ones(len(time), dtype=bool),
        raw_period=period,
        jitter=0.0,
        **arrays,
    )


def pd(kp: float, kd: float, n: int = 1, **options: Any) -> Controller:
    """The same gains for every joint, without a period unless given."""
    return Controller(kp=np.full(n, kp), kd=np.full(n, kd), **options)
