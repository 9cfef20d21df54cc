"""Gains of a controller that an MJCF has as position actuators."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pdoik.descriptions import RobotDescription, quiet_mujoco


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorGains:
    """Gains of position actuators by joint: torque = kp (command - q) - kd dq."""

    kp: tuple[float, ...]  # [N m/rad]
    kd: tuple[float, ...]  # [N m s/rad]
    torque_limit: tuple[float, ...] | None  # [N m]; None where not all have one


def actuator_gains(robot: Path, joints: Sequence[str]) -> ActuatorGains | None:
    """Gains in an MJCF; None for a URDF, or where a joint has no position actuator of its own."""
    import mujoco

    described = RobotDescription.of_file(robot)
    if described.kind != "mjcf":
        return None
    with quiet_mujoco():
        model = described.mujoco
    at: dict[str, int] = {}
    for k in range(model.nu):
        joint = int(model.actuator_trnid[k, 0])
        if model.actuator_trntype[k] == mujoco.mjtTrn.mjTRN_JOINT and _is_position(model, k):
            at.setdefault(model.joint(joint).name, k)
    if not all(joint in at for joint in joints):
        return None
    rows = [at[joint] for joint in joints]
    gear = model.actuator_gear[rows, 0]
    limits = np.abs(gear) * np.max(np.abs(model.actuator_forcerange[rows]), axis=1)
    limited = bool(np.all(model.actuator_forcelimited[rows]))
    return ActuatorGains(
        kp=tuple((gear**2 * model.actuator_gainprm[rows, 0]).tolist()),
        kd=tuple((-(gear**2) * model.actuator_biasprm[rows, 2]).tolist()),
        torque_limit=tuple(limits.tolist()) if limited else None,
    )


def _is_position(model: object, k: int) -> bool:
    """Whether actuator k's force is kp (command - q) - kv dq, with positive gains."""
    import mujoco

    gain, bias = model.actuator_gainprm[k], model.actuator_biasprm[k]  # type: ignore[attr-defined]
    fixed = model.actuator_gaintype[k] == mujoco.mjtGain.mjGAIN_FIXED  # type: ignore[attr-defined]
    affine = model.actuator_biastype[k] == mujoco.mjtBias.mjBIAS_AFFINE  # type: ignore[attr-defined]
    return bool(fixed and affine and gain[0] > 0.0 and bias[1] == -gain[0] and bias[2] <= 0.0)
