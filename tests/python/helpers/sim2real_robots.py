"""Small robots, parts, recordings and controllers for the tests of the simulation."""

from __future__ import annotations

from typing import Any

import numpy as np

from pdoik.recordings import Recording
from pdoik.sim2real.effects import parts_of
from pdoik.sim2real.simulation import Part
from pdoik.sim2real.study import Controller
from sim2real_recordings import even_recording

G = 9.81  # [m/s^2]
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
MJCF = f"""
<mujoco>
  <compiler angle="degree"/>
  <asset><mesh name="shell" file="no/where.stl"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="link1">
      <inertial pos="{LENGTH} 0 0" mass="{MASS}" diaginertia="0.05 0.05 0.05"/>
      <joint name="joint1" axis="0 1 0" damping="0.3" frictionloss="0.5" armature="0.1"
             range="-10 10" limited="true"/>
      <geom type="mesh" mesh="shell"/>
      <body name="finger"><joint name="slider" type="slide"/><geom size="0.01"/></body>
    </body>
  </worldbody>
  <actuator><position joint="joint1" kp="100"/></actuator>
  <keyframe><key qpos="0 0"/></keyframe>
</mujoco>"""  # the pendulum, with a drive, a shape, a floor and a finger that are to be left out


def parts(effect: str, joint: str = "joint1", **values: float) -> tuple[Part, ...]:
    """Of an effect in one joint."""
    return parts_of(effect, [joint], values=values)


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
    return even_recording(time, role="validate", **arrays)


def pd(kp: float, kd: float, n: int = 1, **options: Any) -> Controller:
    """The same gains for every joint, without a period unless given."""
    return Controller(kp=np.full(n, kp), kd=np.full(n, kd), **options)
