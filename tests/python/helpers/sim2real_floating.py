"""A robot on three legs whose base floats, and recordings of it by MuJoCo's inverse dynamics."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pandas as pd
import yaml
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from pdoik.recordings import Recording
from pdoik.sim2real.study import FloatingBase, Foot, Ground, Setup, Study

Array = NDArray[np.float64]

LEGS = ("a", "b", "c")
JOINTS = tuple(f"{leg}{k}" for leg in LEGS for k in range(3))
FEET = tuple(f"{leg}_foot" for leg in LEGS)
RADIUS = 0.03  # of the feet [m]
IMU_PLACE, IMU_TURN = np.array([0.05, -0.02, 0.04]), Rotation.from_euler("xyz", [0.2, -0.1, 1.0])
PERIOD = 5e-3


def _link(name: str, mass: float, com: str, size: float) -> str:
    return (
        f'<link name="{name}"><inertial><origin xyz="{com}"/><mass value="{mass}"/><inertia'
        f' ixx="{size}" iyy="{1.2 * size}" izz="{0.7 * size}" ixy="0" ixz="0" iyz="0"/></inertial>'
        "</link>"
    )


def _joint(name: str, parent: str, child: str, at: str, axis: str) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at}"/><axis xyz="{axis}"/><limit lower="-3" upper="3" effort="99"'
        ' velocity="30"/></joint>'
    )


def urdf() -> str:
    """Of the robot."""
    text = [_link("trunk", 8.0, "0.02 0.01 0.03", 0.08)]
    for leg, (x, y) in zip(LEGS, ((0.2, 0.0), (-0.1, 0.17), (-0.1, -0.17)), strict=True):
        text += [
            _link(f"{leg}_hip", 0.7, "0 0.01 0", 1e-3),
            _link(f"{leg}_thigh", 1.1, "0.01 0 -0.1", 6e-3),
            _link(f"{leg}_shank", 0.3, "0 0 -0.12", 2e-3),
            f'<link name="{leg}_foot"><collision><geometry><sphere radius="{RADIUS}"/></geometry>'
            "</collision></link>",
            _joint(f"{leg}0", "trunk", f"{leg}_hip", f"{x} {y} 0", "1 0 0"),
            _joint(f"{leg}1", f"{leg}_hip", f"{leg}_thigh", "0 0.05 0", "0 1 0"),
            _joint(f"{leg}2", f"{leg}_thigh", f"{leg}_shank", "0 0 -0.25", "0 1 0"),
            f'<joint name="{leg}_end" type="fixed"><parent link="{leg}_shank"/>'
            f'<child link="{leg}_foot"/><origin xyz="0 0 -0.25"/></joint>',
        ]
    return f'<robot name="tripod">{"".join(text)}</robot>'


def floating() -> FloatingBase:
    """What a study says of its base."""
    return FloatingBase(
        link="trunk",
        imu_position=IMU_PLACE,
        imu_rotation=IMU_TURN.as_matrix(),
        feet=tuple(Foot(link=foot, flat=False, sole=RADIUS) for foot in FEET),
        ground=Ground(friction=0.7),
    )


@dataclass
class Hidden:
    """What the machine has that its description has not."""

    friction: dict[int, float] = field(default_factory=dict)  # dry, by joint [N m]
    rotor: dict[int, float] = field(default_factory=dict)  # by joint [kg m^2]
    gain: dict[int, float] = field(default_factory=dict)  # of what torques read, by joint
    payload: float = 0.0  # at (0.1, 0, 0.1) of the trunk [kg]
    offset: dict[int, float] = field(default_factory=dict)  # of encoders: q_true - q [rad]
    acc: tuple[float, float, float] = (0.0, 0.0, 0.0)  # the accelerometer's zero [m/s^2]
    gyro: tuple[float, float, float] = (0.0, 0.0, 0.0)  # its rates' [rad/s]
    tilt: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of the IMU, in its axes [rad]


@cache
def _model(payload: float) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_string(
        urdf().replace(
            '<robot name="tripod">',
            '<robot name="tripod"><mujoco><compiler fusestatic="false" discardvisual="false"/>'
            "</mujoco>",
        )
    )
    trunk = spec.body("trunk")
    trunk.add_freejoint()
    if payload:
        held = trunk.add_body(name="held", pos=[0.1, 0.0, 0.1])
        held.mass, held.inertia, held.explicitinertial = payload, [1e-6] * 3, True
        held.ipos = [0.0, 0.0, 0.0]
    for geom in spec.geoms:
        geom.contype = geom.conaffinity = 0
        geom.mass = 0.0
    return spec.compile()


def _wave(rng: np.random.Generator, n: int, size: float, time: Array) -> tuple[Array, ...]:
    """Sums of sines and their first two derivatives, (T, n) each."""
    x, dx, ddx = np.zeros((3, len(time), n))
    for _ in range(4):
        w, p = 2 * np.pi * rng.uniform(0.2, 1.4, n), rng.uniform(0, 2 * np.pi, n)
        a, angle = size * rng.uniform(0.1, 0.4, n), np.outer(time, w) + p
        x += a * np.sin(angle)
        dx += a * w * np.cos(angle)
        ddx -= a * w * w * np.sin(angle)
    return x, dx, ddx


def recording(
    name: str, seed: int, hidden: Hidden, *, seconds: float = 8.0, noise: float = 1.0, **kept: bool
) -> Recording:
    """A run on three feet, whose forces are the smallest that carry the trunk.

    Args:
        name: of the recording.
        seed: of its motion and noise.
        hidden: what the machine has.
        seconds: it lasts.
        noise: 1 for that of usual sensors.
        kept: `pose`, `imu`, `contact`, True but where they are said not to be.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, PERIOD)
    q, dq, ddq = _wave(rng, len(JOINTS), 0.6, time)
    q += np.tile([0.0, 0.7, -1.3], 3)
    place, speed, acceleration = _wave(rng, 3, 0.05, time)
    place += [0.0, 0.0, 0.4]
    e, de, dde = _wave(rng, 3, 0.25, time)
    turn, omega, alpha = _turning(e, de, dde)
    tau = np.empty_like(q)
    model = _model(hidden.payload)
    data = mujoco.MjData(model)
    at = np.array([model.joint(joint).dofadr[0] for joint in JOINTS])
    true = q.copy()
    for j, offset in hidden.offset.items():
        true[:, j] += offset
    pushed = np.zeros((len(time), 3))
    wxyz = turn.as_quat()[:, [3, 0, 1, 2]]
    for t in range(len(time)):
        data.qpos[:3], data.qpos[3:7], data.qpos[at + 1] = place[t], wxyz[t], true[t]
        data.qvel[:3], data.qvel[3:6], data.qvel[at] = speed[t], omega[t], dq[t]
        data.qacc[:3], data.qacc[3:6], data.qacc[at] = acceleration[t], alpha[t], ddq[t]
        mujoco.mj_inverse(model, data)
        needed = data.qfrc_inverse.copy()
        columns = []
        for foot in FEET:
            jacobian = np.zeros((3, model.nv))
            spot = data.body(foot).xpos - [0.0, 0.0, RADIUS]
            mujoco.mj_jac(model, data, jacobian, None, spot, model.body(foot).id)
            columns.append(jacobian.T)
        A = np.hstack(columns)
        forces = np.linalg.lstsq(A[:6], needed[:6], rcond=None)[0]
        assert np.abs(A[:6] @ forces - needed[:6]).max() < 1e-8
        tau[t] = (needed - A @ forces)[at]
        pushed[t] = np.linalg.norm(forces.reshape(3, 3), axis=1)
    for j, level in hidden.friction.items():
        tau[:, j] += level * np.tanh(dq[:, j] / 0.01)
    for j, inertia in hidden.rotor.items():
        tau[:, j] += inertia * ddq[:, j]
    for j, gain in hidden.gain.items():
        tau[:, j] *= gain
    felt = turn.inv().apply(acceleration + np.array([0.0, 0.0, 9.81]))
    felt += np.cross(alpha, IMU_PLACE) + np.cross(omega, np.cross(omega, IMU_PLACE))
    imu = IMU_TURN * Rotation.from_rotvec(hidden.tilt)

    def seen(values: Array, size: float) -> Array:
        return values + noise * size * rng.standard_normal(values.shape)

    has = {"pose": True, "imu": True, "contact": True} | kept
    pose = np.hstack([seen(place, 5e-4), wxyz + noise * 2e-4 * rng.standard_normal(wxyz.shape)])
    return Recording(
        name=name,
        role="fit",
        start=0.0,
        time=time,
        q=seen(q, 2e-5),
        tau=seen(tau, 0.05),
        base=pose if has["pose"] else None,
        gyro=seen(imu.inv().apply(omega) + hidden.gyro, 4e-3) if has["imu"] else None,
        acc=seen(imu.inv().apply(felt) + hidden.acc, 0.05) if has["imu"] else None,
        contact=seen(pushed, 0.5) if has["contact"] else None,
        valid=np.ones(len(time), dtype=np.bool_),
        raw_period=PERIOD,
        jitter=0.0,
    )


def _turning(e: Array, de: Array, dde: Array) -> tuple[Rotation, Array, Array]:
    """Orientations by Euler angles, rates and their derivative in the body's axes."""
    h = 1e-4

    def at(s: float) -> Rotation:
        return Rotation.from_euler("ZYX", e + s * de + 0.5 * s * s * dde)

    def rates(s: float) -> Array:
        return np.asarray((at(s - h).inv() * at(s + h)).as_rotvec() / (2 * h))

    return at(0.0), rates(0.0), (rates(h) - rates(-h)) / (2 * h)


def study(
    folder: Path, hidden: Hidden, *, runs: int = 2, seconds: float = 8.0, **kept: bool
) -> Study:
    """Of some runs, the last held out."""
    robot = folder / "tripod.urdf"
    robot.write_text(urdf())
    made = [recording(f"run{k}", k, hidden, seconds=seconds, **kept) for k in range(runs + 1)]
    made[-1] = replace(made[-1], role="validate")
    return Study(
        folder=folder,
        robot=robot,
        base=floating(),
        joints=JOINTS,
        recordings=tuple(made),
        split="by the study",
        setups={each.name: Setup() for each in made},
    )


def written(folder: Path, made: Study, **keys: object) -> Path:
    """The study as a user has it, in files; keys replace those of its YAML, None takes one out."""
    entries = []
    for each in made.recordings:
        columns = {"time": each.time}
        for channel in ("q", "tau"):
            values = getattr(each, channel)
            columns |= {f"{channel}.{joint}": values[:, k] for k, joint in enumerate(JOINTS)}
        parts = {"base": ("x", "y", "z", "qw", "qx", "qy", "qz"), "contact": FEET}
        for channel in ("base", "gyro", "acc", "contact"):
            values = getattr(each, channel)
            if values is not None:
                names = parts.get(channel, ("x", "y", "z"))
                columns |= {f"{channel}.{name}": values[:, k] for k, name in enumerate(names)}
        pd.DataFrame(columns).to_csv(folder / f"{each.name}.csv", index=False)
        entry: dict[str, object] = {"file": f"{each.name}.csv", "role": each.role}
        held = {"base": "held"} if made.setup_of(each).held else {}
        entries.append(entry | held)
    rpy = IMU_TURN.as_euler("xyz").tolist()
    content: dict[str, object] = {
        "robot": "tripod.urdf",
        "base": {"imu": {"position": IMU_PLACE.tolist(), "rpy": rpy}, "feet": list(FEET)},
        "recordings": entries,
    }
    told = {key: value for key, value in (content | keys).items() if value is not None}
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(told))
    return path
