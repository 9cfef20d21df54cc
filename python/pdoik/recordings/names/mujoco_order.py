"""Which entries of MuJoCo's state vectors belong to which joint of a model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pdoik.descriptions import RobotDescription


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One number of a vector."""

    joint: str
    gear: float = 1.0  # of an actuator: the joint's torque over its force
    commands: str = ""  # channel that its control is a number of, if it is one
    command: float = 1.0  # by what its control is multiplied to be that

    def channel_and_factor(self, vector: str) -> tuple[str, float]:
        """What an actuator's "ctrl" or "actuator_force" is for the joint, "" if it is nothing."""
        return ("tau", self.gear) if vector == "actuator_force" else (self.commands, self.command)


@dataclass(frozen=True, slots=True, kw_only=True)
class MujocoOrder:
    """Entries of hinges and slides, by address; those of free and ball joints are none."""

    name: str = ""  # of the model's file
    sizes: Mapping[str, int] = field(default_factory=dict)  # of qpos, dof, actuator
    entries: Mapping[tuple[str, int], Entry] = field(default_factory=dict)


def mujoco_order(robot: RobotDescription | None) -> MujocoOrder:
    """The order of an MJCF; without entries for any other description, or none."""
    if robot is None or robot.kind != "mjcf":
        return MujocoOrder()
    import mujoco

    model = robot.mujoco
    single = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
    entries: dict[tuple[str, int], Entry] = {}
    for k in range(model.njnt):
        if int(model.jnt_type[k]) in single:
            entry = Entry(joint=model.joint(k).name)
            entries["qpos", int(model.jnt_qposadr[k])] = entry
            entries["dof", int(model.jnt_dofadr[k])] = entry
    for k in range(model.nu):
        joint = int(model.actuator_trnid[k, 0])
        if int(model.actuator_trntype[k]) != int(mujoco.mjtTrn.mjTRN_JOINT):
            continue
        if int(model.jnt_type[joint]) in single:
            entries["actuator", k] = _actuator(model, k, model.joint(joint).name)
    sizes = {"qpos": model.nq, "dof": model.nv, "actuator": model.nu}
    return MujocoOrder(name=robot.place.name, sizes=sizes, entries=entries)


def _actuator(model: Any, k: int, joint: str) -> Entry:
    """What a number for actuator `k` commands: by its gain and bias, as MuJoCo computes a force.

    force = gain ctrl + bias0 + bias1 length + bias2 velocity, with length = gear q: of a position
    actuator bias1 = -gain, of a speed actuator bias2 = -gain, of a motor all biases are zero.
    """
    import mujoco

    gear = float(model.actuator_gear[k, 0])
    gain, bias = float(model.actuator_gainprm[k, 0]), model.actuator_biasprm[k, :3]
    fixed = int(model.actuator_gaintype[k]) == int(mujoco.mjtGain.mjGAIN_FIXED)
    none = int(model.actuator_biastype[k]) == int(mujoco.mjtBias.mjBIAS_NONE)
    affine = int(model.actuator_biastype[k]) == int(mujoco.mjtBias.mjBIAS_AFFINE)
    direct = int(model.actuator_dyntype[k]) == int(mujoco.mjtDyn.mjDYN_NONE)
    if gain == 0.0 or gear == 0.0 or not (fixed and direct):
        return Entry(joint=joint, gear=gear)
    if none:
        return Entry(joint=joint, gear=gear, commands="tau_cmd", command=gain * gear)
    if affine and np.isclose(bias[1], -gain):
        return Entry(joint=joint, gear=gear, commands="q_des", command=1 / gear)
    if affine and bias[1] == 0.0 and np.isclose(bias[2], -gain):
        return Entry(joint=joint, gear=gear, commands="dq_des", command=1 / gear)
    return Entry(joint=joint, gear=gear)
