"""How the robot follows what is dragged: near where it is, and far only if it must."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

import pdoik

from .goals import Request

FloatArray = npt.NDArray[np.float64]
Scene = pdoik.Scene | FloatArray

_HOPELESS = ("out_of_reach", "base_collision", "blocked")
_WORTH_A_JUMP = 0.05  # of orientation, where it may be as near as can be [rad]
_LONG = 1.0  # for all solutions at least [s]


class Follower:
    """Looks near the posture shown last; far from it only where nothing is to be had nearby.

    Where the far search fails, too, the nearby answer stays: a robot that cannot do what it is
    asked should lean towards it, not flicker between postures. Of several requests it stays with
    the one it meets for as long as it can follow that.
    """

    def __init__(self, robot: pdoik.Robot, options: pdoik.Options) -> None:
        self.options = options
        # The page says so where a robot without hulls cannot keep off what it shows.
        options = replace(options, ignore_obstacles_without_hulls=True)
        self._near = pdoik.Solver(robot, replace(options, max_restarts=0))
        self._several = len(robot.tip_links) > 1  # limbs that no goal moves would drift
        far = replace(options, prefer="nearest") if self._several else options
        self._far = pdoik.Solver(robot, far)
        self._robot, self._long = robot, replace(options, max_time=max(options.max_time, _LONG))

    def solve(
        self, asked: Sequence[Request], held: int, q: FloatArray, scene: Scene
    ) -> tuple[pdoik.Result, pdoik.Result, int]:
        """What to show, what the search said, and the number of the request that is shown.

        Args:
            asked: Any one of them will do.
            held: The number of the one that was met last.
            q: The posture shown last, (n,).
            scene: What is in the way.
        """
        posture = q if self._several and self.options.method == "default" else None
        near = self._near.solve(asked[held], q0=q, obstacles=scene, posture=posture)
        paper = self.options.method == "paper"  # which has no restarts
        if near.success or (len(asked) == 1 and (paper or near.status in _HOPELESS)):
            return near, near, held
        if len(asked) == 1:
            far = self._far.solve(asked[0], q0=q, obstacles=scene, posture=posture)
            return (far if _is_better(far, near) else near), far, 0
        far = self._far.solve_any(asked, q0=q, obstacles=scene, posture=posture)
        if _is_better(far, near):
            return far, far, far.goal_index
        return near, far, held

    def judge(
        self, asked: Sequence[Request], q: FloatArray, scene: Scene
    ) -> tuple[pdoik.Result, int]:
        """The verdict on a posture by the request that it meets, or comes nearest to."""
        verdicts = [self._near.judge(goals, q, obstacles=scene) for goals in asked]
        best = min(
            range(len(asked)), key=lambda k: (not verdicts[k].success, verdicts[k].position_error)
        )
        return verdicts[best], best

    def clearances(self, q: FloatArray, scene: Scene) -> list[pdoik.ObstacleClearance]:
        return self._near.clearances(q, scene)

    def solve_all(self, goals: Request, limit: int, q: FloatArray, scene: Scene) -> pdoik.Solutions:
        """All distinct solutions, the nearest to q first; takes a second or two at most.

        Its solver is one of its own, so that the robot can be dragged meanwhile.
        """
        solver = pdoik.Solver(self._robot, self._long)
        return solver.solve_all(goals, limit, q, scene)


def _is_better(far: pdoik.Result, near: pdoik.Result) -> bool:
    """Whether a posture elsewhere is worth going there."""
    if far.status != "nearest":
        return far.success
    return near.status != "nearest" or far.rotation_error < near.rotation_error - _WORTH_A_JUMP
