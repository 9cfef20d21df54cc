"""pdoik, asked in the same words as its peers."""

from collections.abc import Sequence
from time import perf_counter

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.goals.peers.body import Body
from bench.ik.goals.peers.problems import MAX_TIME, STARTS, Answer, Region


class Ours:
    """One call; restarts are its own."""

    name = "pdoik"

    def __init__(self, body: Body) -> None:
        options = pdoik.Options(
            max_time=MAX_TIME, max_restarts=STARTS - 1, self_collision=body.self_collision
        )
        self._solver = pdoik.Solver(body.robot, options)
        any_of = pdoik.Options(max_time=MAX_TIME, self_collision=body.self_collision)
        self._of_many = pdoik.Solver(body.robot, any_of)
        self._obstacles: pdoik.Cloud | list[pdoik.Shape] | None = None
        if len(body.points):
            self._obstacles = pdoik.Cloud(body.points)
        elif body.table is not None:
            self._obstacles = [pdoik.Shape.half_space("table", [0, 0, 1], [0, 0, body.table])]

    def solve(self, regions: Sequence[Region], starts: FloatArray) -> Answer:
        """Solve from the first start."""
        began = perf_counter()
        goals = [_goal(region) for region in regions]
        result = self._solver.solve(goals, q0=starts[0], obstacles=self._obstacles)
        return Answer(q=result.q, claimed=result.success, time=perf_counter() - began)

    def any_of(self, regions: Sequence[Region], starts: FloatArray) -> Answer:
        """Starts are shared among the goals."""
        began = perf_counter()
        poses = np.array([region.T for region in regions])
        result = self._of_many.solve_any(poses, q0=starts[0], obstacles=self._obstacles)
        time = perf_counter() - began
        return Answer(q=result.q, claimed=result.success, time=time, index=result.goal_index)

    def nearest(self, T: FloatArray, tip: str, starts: FloatArray) -> Answer:
        """The position comes first."""
        began = perf_counter()
        result = self._of_many.solve(T, q0=starts[0], priority="position")
        claimed = result.success or result.status == "nearest"
        return Answer(q=result.q, claimed=claimed, time=perf_counter() - began)


def _goal(region: Region) -> pdoik.Goal:
    T, tip, half_turn = region.T, region.tip, np.pi
    if region.look is not None:
        return pdoik.Goal.look_at(region.look, tip=tip)
    if region.tilt is not None and region.tilt > 0:
        return pdoik.Goal(T, tip=tip, type="axis", axis="z", rotation_slack=[region.tilt] * 3)
    if region.tilt is not None:
        return pdoik.Goal(T, tip=tip, rotation_slack=[0, 0, half_turn])
    turn = np.asarray(region.turn)
    return pdoik.Goal.region(
        T,
        position=(region.lower, region.upper),
        rotation=(-turn, turn),
        tip=tip,
        relative_to=region.relative_to,
        position_tolerance=region.tolerance,
        rotation_tolerance=region.tolerance,
    )
