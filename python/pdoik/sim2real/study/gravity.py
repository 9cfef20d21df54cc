"""The torque that holds a model still, to judge the size of recorded torques."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from pdoik.errors import LoadError
from pdoik.recordings import FloatArray

from .quiet_mujoco import quiet_mujoco


def gravity_torque(path: Path, joints: tuple[str, ...], q: FloatArray) -> FloatArray:
    """g(q) of these joints, the others at zero, (T, n) [N m].

    Args:
        path: URDF, by Pinocchio, or MJCF, by MuJoCo.
        joints: Columns of q.
        q: (T, n) [rad].
    """
    if ElementTree.parse(path).getroot().tag == "mujoco":
        return _by_mujoco(path, joints, q)
    import pinocchio as pin

    try:
        model = pin.buildModelFromUrdf(str(path))
    except (ValueError, RuntimeError) as error:
        raise LoadError(f"{path.name}: Pinocchio cannot read it: {error}") from error
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


def _by_mujoco(path: Path, joints: tuple[str, ...], q: FloatArray) -> FloatArray:
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(path))
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
