"""A small study for `pdoik diagnose`: an arm whose elbow rubs and whose hand holds something.

python -m bench.sim2real.example FOLDER       writes FOLDER/study.yaml, arm.urdf and three CSVs
pdoik diagnose FOLDER/study.yaml --out report
pdoik compare FOLDER/compare.yaml --out comparison

The machine is MuJoCo's. Its elbow has dry and viscous friction and its forearm carries a weight,
and arm.urdf says nothing of either. The same files come out every time.
"""

import argparse
from pathlib import Path

import mujoco
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

JOINTS = ("base", "shoulder", "elbow")
LEVEL, DAMPING = 0.8, 0.3  # of the elbow's friction [N m], [N m s/rad]
MASS, REACH = 0.5, 0.24  # of what the hand holds [kg], along the forearm [m]
KP, KD = np.array([120.0, 160.0, 90.0]), np.array([9.0, 12.0, 5.0])
ROTOR = (0.05, 0.06, 0.03)  # known from the drives' data sheets [kg m^2]
STEP, RATE, SECONDS = 0.001, 100, 14.0  # of the controller [s], of the log [Hz], of a recording [s]
PHYSICS = 4  # steps of it while the controller holds its torque
NOISE_Q, NOISE_TAU = 2e-5, 0.04  # [rad], [N m]

URDF = """<?xml version="1.0"?>
<robot name="arm">
  <link name="stand"/>
  <link name="column">
    <inertial>
      <origin xyz="0 0 0.1"/><mass value="2.0"/>
      <inertia ixx="0.012" ixy="0" ixz="0" iyy="0.012" iyz="0" izz="0.005"/>
    </inertial>
  </link>
  <link name="upper_arm">
    <inertial>
      <origin xyz="0.16 0 0"/><mass value="1.6"/>
      <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.018" iyz="0" izz="0.018"/>
    </inertial>
  </link>
  <link name="forearm">
    <inertial>
      <origin xyz="0.11 0 0"/><mass value="0.9"/>
      <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.006" iyz="0" izz="0.006"/>
    </inertial>
  </link>
  <joint name="base" type="revolute">
    <parent link="stand"/><child link="column"/><axis xyz="0 0 1"/>
    <limit lower="-2.8" upper="2.8" effort="60" velocity="4"/>
  </joint>
  <joint name="shoulder" type="revolute">
    <parent link="column"/><child link="upper_arm"/><axis xyz="0 1 0"/>
    <origin xyz="0 0 0.25"/>
    <limit lower="-2.0" upper="2.0" effort="60" velocity="4"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper_arm"/><child link="forearm"/><axis xyz="0 1 0"/>
    <origin xyz="0.32 0 0"/>
    <limit lower="-2.4" upper="2.4" effort="30" velocity="4"/>
  </joint>
</robot>
"""

STUDY = f"""robot: arm.urdf
joints: [{", ".join(JOINTS)}]
recordings:
  - {{file: monday.csv, role: fit}}
  - {{file: tuesday.csv, role: fit}}
  - {{file: friday.csv, role: validate}}
controller:
  type: pd
  kp: [{", ".join(f"{k:g}" for k in KP)}]
  kd: [{", ".join(f"{k:g}" for k in KD)}]
  gravity_compensation: true
  period: {STEP}
rotor_inertia: [{", ".join(f"{i:g}" for i in ROTOR)}]
"""


COMPARE = STUDY.replace("robot: arm.urdf", "simulator: {urdf: arm.urdf}")
"""The same arm as a user's simulator, for `pdoik compare`."""


def machine() -> tuple[mujoco.MjModel, mujoco.MjModel]:
    """The arm as it is, and as its makers describe it, for the controller's gravity."""
    spec = mujoco.MjSpec.from_string(URDF)
    for joint, inertia in zip(JOINTS, ROTOR, strict=True):
        spec.joint(joint).armature = inertia
    described = spec.compile()
    held = spec.body("forearm").add_body(name="held", pos=[REACH, 0.0, 0.03])
    held.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.03, 0.0, 0.0], mass=MASS)
    model = spec.compile()
    for each in (model, described):
        each.opt.timestep = STEP / PHYSICS
        each.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        each.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    elbow = model.joint("elbow").dofadr
    model.dof_damping[elbow], model.dof_frictionloss[elbow] = DAMPING, LEVEL
    model.dof_solimp[:] = (0.999, 0.999, 1e-3, 0.5, 2.0)
    model.dof_solref[:] = (2.0 * STEP / PHYSICS, 1.0)
    return model, described


def aims(rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Desired positions and speeds: sums of sines that begin at rest; (T, n) each."""
    t = STEP * np.arange(round(SECONDS / STEP))[:, None, None]
    omega = 2 * np.pi * rng.uniform(0.08, 0.6, (4, len(JOINTS)))
    size = rng.uniform(0.15, 0.45, (4, len(JOINTS))) / np.sqrt(omega)
    phase = rng.uniform(0, 2 * np.pi, (4, len(JOINTS)))
    swing = size * (np.sin(omega * t + phase) - np.sin(phase))
    speed = size * omega * np.cos(omega * t + phase)
    fade = 1 - np.exp(-(t[:, 0] ** 2))
    slope = 2 * t[:, 0] * np.exp(-(t[:, 0] ** 2))
    q, dq = swing.sum(axis=1), speed.sum(axis=1)
    return fade * q + np.array([0.0, -0.3, 0.9]), fade * dq + slope * q


def recording(seed: int) -> tuple[list[str], FloatArray]:
    rng = np.random.default_rng(seed)
    model, described = machine()
    data, believed = mujoco.MjData(model), mujoco.MjData(described)
    q_des, dq_des = aims(rng)
    data.qpos[:] = q_des[0]
    every = round(1.0 / (RATE * STEP))
    rows = []
    for k in range(len(q_des)):
        believed.qpos[:] = data.qpos
        mujoco.mj_forward(described, believed)
        tau = KP * (q_des[k] - data.qpos) + KD * (dq_des[k] - data.qvel) + believed.qfrc_bias
        if k % every == 0:
            q = data.qpos + rng.normal(0, NOISE_Q, 3)
            measured = tau + rng.normal(0, NOISE_TAU, 3)
            rows.append([k * STEP, *q, *q_des[k], *dq_des[k], *measured])
        data.qfrc_applied[:] = tau
        mujoco.mj_step(model, data, PHYSICS)
    channels = ("q", "q_des", "dq_des", "tau")
    return ["time", *(f"{c}.{j}" for c in channels for j in JOINTS)], np.array(rows)


def main(folder: Path) -> None:
    """Write the study."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "arm.urdf").write_text(URDF)
    for seed, day in enumerate(("monday", "tuesday", "friday"), start=1):
        names, rows = recording(seed)
        np.savetxt(
            folder / f"{day}.csv", rows, fmt="%.6g", delimiter=",", header=",".join(names),
            comments="",
        )  # fmt: skip
    (folder / "study.yaml").write_text(STUDY)
    (folder / "compare.yaml").write_text(COMPARE)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Write a small study to try the diagnosis on.")
    parser.add_argument("folder", type=Path)
    main(parser.parse_args().folder)
