"""How much of the torques the described machine does not explain, against the sensors' noise."""

from typing import Any

import mujoco
import numpy as np

from bench.sim2real.legged.legs import Legs
from bench.sim2real.legged.run import Rows
from bench.sim2real.legged.spec import Array

EVERY = 0.02  # between the rows that are looked at [s]


def unexplained(legs: Legs, rows: Rows) -> Array:
    """Torques and base wrench that are missing, (T, 6 + n): [N], [N m], [N m].

    Inverse dynamics of the described machine along what its encoders say and what its pose truly
    was, less what the drives say and what the ground truly gave. A held base's wrench is nobody's.
    """
    model, data = legs.model, legs.data
    flags = int(model.opt.disableflags)
    model.opt.disableflags = flags | mujoco.mjtDisableBit.mjDSBL_CONTACT
    step = max(1, round(EVERY / rows.time[1]))
    dofs, n = legs.world.dof, legs.robot.n
    held = not rows.contact.any()
    result = np.empty((len(rows.time[::step]), 6 + n))
    for i, k in enumerate(range(0, len(rows.time), step)):
        data.qpos[:7], data.qpos[legs.world.qpos] = rows.base[k], rows.read[k]
        data.qvel[:6], data.qvel[dofs] = rows.twist[k], rows.dq[k]
        data.qacc[:6], data.qacc[dofs] = rows.acceleration[k], rows.ddq[k]
        mujoco.mj_inverse(model, data)
        left = data.qfrc_inverse.copy()
        left[dofs] -= rows.said[k]
        if not held:
            left -= _of_ground(legs, rows.force[k], rows.moment[k])
        result[i, :6], result[i, 6:] = 0.0 if held else left[:6], left[dofs]
    model.opt.disableflags = flags
    data.qvel[:], data.qacc[:] = 0.0, 0.0
    return result


def _of_ground(legs: Legs, force: Array, moment: Array) -> Array:
    """Generalized forces (6 + n,) of the ground on the feet where the robot was put."""
    total = np.zeros(legs.model.nv)
    p, r = np.zeros((3, legs.model.nv)), np.zeros((3, legs.model.nv))
    for k, foot in enumerate(legs.world.feet):
        mujoco.mj_jac(legs.model, legs.data, p, r, legs.data.xpos[foot], foot)
        total += force[k] @ p + moment[k] @ r
    return total


def visibility(legs: Legs, runs: list[Rows], noise: Array) -> dict[str, Any]:
    """Root mean squares: each joint's over its noise (n,); the base's force [N], moment [N m]."""
    left = [unexplained(legs, rows) for rows in runs]
    joints = np.sqrt(np.mean(np.concatenate(left)[:, 6:] ** 2, axis=0)) / noise
    base = np.concatenate([e for e, rows in zip(left, runs, strict=True) if rows.contact.any()])
    force, moment = (np.sqrt(np.mean(np.sum(base[:, s] ** 2, axis=1))) for s in _PARTS)
    return {
        "joints": {name: float(v) for name, v in zip(legs.robot.joints, joints, strict=True)},
        "base": {"force": float(force), "moment": float(moment)},
    }


_PARTS = (slice(0, 3), slice(3, 6))
