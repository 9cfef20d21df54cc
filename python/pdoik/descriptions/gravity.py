"""The torque that holds a robot still, by Pinocchio or MuJoCo."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .quiet_mujoco import quiet_mujoco
from .xml import FloatArray


def gravity_by_pinocchio(model: Any, joints: Sequence[str], q: FloatArray) -> FloatArray:
    """g(q) of these joints, the others at neutral, (T, n) [N m], for q (T, n) [rad]."""
    import pinocchio as pin

    data = model.createData()
    ids = [model.getJointId(joint) for joint in joints]
    at = pin.neutral(model)
    out = np.empty_like(q)
    for row, positions in enumerate(q):
        for index, value in zip(ids, positions, strict=True):
            first, wide = model.idx_qs[index], model.nqs[index]
            at[first : first + wide] = value if wide == 1 else (np.cos(value), np.sin(value))
        g = pin.computeGeneralizedGravity(model, data, at)
        out[row] = [g[model.idx_vs[index]] for index in ids]
    return out


def gravity_by_mujoco(model: Any, joints: Sequence[str], q: FloatArray) -> FloatArray:
    """Likewise, the others as the model places them."""
    import mujoco

    data = mujoco.MjData(model)
    addresses = [model.joint(joint).qposadr[0] for joint in joints]
    dofs = [model.joint(joint).dofadr[0] for joint in joints]
    out = np.empty_like(q)
    with quiet_mujoco():
        for row, positions in enumerate(q):
            data.qpos[addresses] = positions
            mujoco.mj_forward(model, data)
            out[row] = data.qfrc_bias[dofs]
    return out
