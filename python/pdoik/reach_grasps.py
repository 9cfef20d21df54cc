"""Which poses are reached by any of several grasps."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik.solver import Solver

FloatArray = npt.NDArray[np.float64]
_LOOSE = 1e-6  # how far a grasp may be from a rigid motion


def rigid_grasps(grasps: npt.ArrayLike) -> FloatArray:
    """The same as an array, (N, 4, 4).

    Raises:
        ValueError: There is none, or one is no rigid motion.
    """
    array = np.asarray(grasps, dtype=np.float64)
    if array.ndim != 3 or array.shape[1:] != (4, 4) or len(array) == 0:
        raise ValueError(f"grasps has shape {array.shape}, expected (N, 4, 4), none empty")
    for k, T in enumerate(array):
        if not _is_rigid(T):
            raise ValueError(f"grasps[{k}] is no rigid motion")
    return array


def _is_rigid(T: FloatArray) -> bool:
    if not np.isfinite(T).all():
        return False
    R = T[:3, :3]
    off = max(np.abs(R @ R.T - np.eye(3)).max(), np.abs(T[3] - [0, 0, 0, 1]).max())
    return bool(off <= _LOOSE and np.linalg.det(R) > 0.0)


def reach_any(
    solver: Solver, poses: FloatArray, grasps: FloatArray, obstacles: Any, threads: int, far: int
) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float32], npt.NDArray[np.int32]]:
    """Statuses, (B,), answers, (B, n), and which grasp was met, (B,), -1 where none was.

    Grasp after grasp is asked of the poses that none before it reached: a batch each time.

    Args:
        solver: To ask.
        poses: T_base_voxel, (B, 4, 4) [m].
        grasps: T_voxel_tip, (N, 4, 4) [m].
        obstacles: As the solver takes them.
        threads: 0 for one per processor.
        far: The status that says least: of a pose that no grasp reaches another one is kept.
    """
    statuses = np.full(len(poses), far, dtype=np.uint8)
    q = np.full((len(poses), solver.robot.dof), np.nan, dtype=np.float32)
    met = np.full(len(poses), -1, dtype=np.int32)
    left = np.arange(len(poses))
    for k, grasp in enumerate(grasps):
        if not len(left):
            break
        found, answers = solver._reach_poses(poses[left] @ grasp, obstacles, threads)
        solved = found == 0
        tells_more = solved | (statuses[left] == far)
        statuses[left[tells_more]] = found[tells_more]
        q[left[solved]], met[left[solved]] = answers[solved], k
        left = left[~solved]
    return statuses, q, met
