"""Joint-level logs as CSV; `pdoik view h1 --replay` shows them."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.common.whole_files import write_text
from bench.humanoid.world.simulate import Run
from pdoik.view.h1_shapes import JOINT_NAMES

SIGNALS = ("q_des", "q", "dq", "tau")  # [rad], [rad], [rad/s], [N m]
BASE = tuple(f"base.{name}" for name in ("x", "y", "z", "qw", "qx", "qy", "qz"))
OBJECT = tuple(f"object.{name}" for name in ("x", "y", "z", "qw", "qx", "qy", "qz"))


def log_columns(*, with_object: bool = False) -> list[str]:
    """Time [s], each signal's 19 joints (q_des.left_ankle_joint, ...), the pelvis, the object."""
    joints = [f"{signal}.{joint}" for signal in SIGNALS for joint in JOINT_NAMES]
    return ["time", *joints, *BASE, *(OBJECT if with_object else ())]


def write_log(run: Run, path: str | Path, every: int = 1) -> None:
    """Write a run's rows, each or each so-manieth; the file appears whole or not at all.

    The pelvis' pose in the world [m] is in the columns BASE. Where something flew, its pose in the
    pelvis' frame [m] is in the columns OBJECT.
    """
    with_object = bool(len(run.distance))
    signals = [getattr(run, signal) for signal in SIGNALS]
    parts = [run.time[:, None], *signals, run.qpos[:, :7]]
    if with_object:
        parts.append(object_in_pelvis(run))
    text = io.StringIO()
    header = ",".join(log_columns(with_object=with_object))
    np.savetxt(text, np.hstack(parts)[::every], "%.9g", delimiter=",", header=header, comments="")
    write_text(Path(path), text.getvalue())


def object_in_pelvis(run: Run) -> FloatArray:
    """T_pelvis_object, (T, 7): position [m] and wxyz."""
    pelvis = Rotation.from_quat(run.qpos[:, 3:7], scalar_first=True)
    position = pelvis.inv().apply(run.object_pose[:, :3] - run.qpos[:, :3])
    turn = pelvis.inv() * Rotation.from_quat(run.object_pose[:, 3:], scalar_first=True)
    return np.hstack([position, turn.as_quat(scalar_first=True)])
