"""Regions as tasks of mink, whose targets follow the tip where a region leaves it free."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.goals.peers.problems import Region

TASK_DAMPING = 0.03  # as bench/ik/methods/mink_qp.py has it
TURN = 0.3  # metres that a radian counts as [m]
INSIDE = 0.8  # of a slack, where a tip outside is drawn to


@dataclass(frozen=True, slots=True, kw_only=True)
class Aim:
    """Tasks of a region: their targets at a configuration, and what is missing there."""

    tasks: list[Any]
    update: Callable[[Any], float]  # gives the error over the tolerance


def aim_of(mink: Any, region: Region) -> Aim:
    """The aim of any region."""
    if region.look is not None:
        return _look_aim(mink, region)
    if region.relative_to:
        return _grip_aim(mink, region)
    if region.tilt is not None:
        return _axis_aim(mink, region)
    return _box_aim(mink, region)


def _look_aim(mink: Any, region: Region) -> Aim:
    task = mink.LookAtTask(region.tip, "body", axis=(0, 0, 1), cost=TURN, lm_damping=TASK_DAMPING)
    task.set_target(region.look)
    return Aim(
        tasks=[task],
        update=lambda at: float(np.linalg.norm(task.compute_error(at))) / region.tolerance,
    )


def _grip_aim(mink: Any, region: Region) -> Aim:
    task = mink.RelativeFrameTask(
        region.tip, "body", region.relative_to, "body", 1.0, TURN, lm_damping=TASK_DAMPING
    )
    task.set_target(mink.SE3.from_matrix(region.T))
    return Aim(tasks=[task], update=lambda at: _worse(task.compute_error(at)) / region.tolerance)


def _axis_aim(mink: Any, region: Region) -> Aim:
    """A place, and an axis that is drawn to the nearest direction that will do."""
    z = region.T[:3, 2]
    place = mink.FrameTask(region.tip, "body", 1.0, 0.0, lm_damping=TASK_DAMPING)
    place.set_target(mink.SE3.from_matrix(region.T))
    axis = mink.AxisAlignTask(region.tip, "body", cost=TURN, lm_damping=TASK_DAMPING)

    def update(at: Any) -> float:
        own = at.get_transform_frame_to_world(region.tip, "body").as_matrix()[:3, 2]
        normal = np.cross(z, own)
        sine = float(np.linalg.norm(normal))
        tilt = np.arctan2(sine, own @ z)
        turn = min(tilt, INSIDE * region.tilt) / max(sine, 1e-12)
        axis.set_target(Rotation.from_rotvec(turn * normal).apply(z))
        off = np.linalg.norm(place.compute_error(at)[:3])
        return float(max(off, tilt - region.tilt)) / region.tolerance

    return Aim(tasks=[place, axis], update=update)


def _box_aim(mink: Any, region: Region) -> Aim:
    """A pose that is drawn to the nearest inside, and free along what it may leave open."""
    T = region.T
    lower, upper, most = (np.array(each) for each in (region.lower, region.upper, region.turn))
    inset = np.where(np.isfinite(upper), 0.5 * (1 - INSIDE) * (upper - lower), 0.0)
    task = mink.FrameTask(region.tip, "body", 1.0, TURN, lm_damping=TASK_DAMPING)

    def update(at: Any) -> float:
        off = np.linalg.inv(T) @ at.get_transform_frame_to_world(region.tip, "body").as_matrix()
        place, turn = off[:3, 3], Rotation.from_matrix(off[:3, :3]).as_rotvec()
        beyond = place - np.clip(place, lower, upper)
        turned = turn - np.clip(turn, -most, most)
        off[:3, 3] = np.where(beyond != 0, np.clip(place, lower + inset, upper - inset), place)
        turn = np.where(turned != 0, np.clip(turn, -INSIDE * most, INSIDE * most), turn)
        off[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
        task.set_target(mink.SE3.from_matrix(T @ off))
        missing = float(max(np.linalg.norm(beyond), np.linalg.norm(turned)))
        if most.any():
            task.set_position_cost(float(missing > 0))
            task.set_orientation_cost(TURN * (missing > 0))
        else:  # the tip's axes are T's in the end
            task.set_position_cost(np.where((lower < upper) & (beyond == 0), 0.0, 1.0))
        return missing / region.tolerance

    return Aim(tasks=[task], update=update)


def _worse(error: FloatArray) -> float:
    """The larger of the errors of place and turn."""
    return float(max(np.linalg.norm(error[:3]), np.linalg.norm(error[3:])))
