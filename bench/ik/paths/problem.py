"""A path to follow, as it is drawn, as the library is asked, and the way that it leaves."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.paths.arms import robot_of
from bench.ik.paths.solids import World

TOOL_AXIS = np.array([0.0, 0.0, 1.0])  # which is at the goal where the turn about it is free
ANY_TURN = ([0.0, 0.0, -np.pi], [0.0, 0.0, np.pi])
MAX_TIME = 10.0  # [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """Stations of a tool of one arm in a world."""

    key: str  # that it can be drawn again by
    arm: str
    T: FloatArray  # of the tool in the base frame, (N, 4, 4)
    tool: FloatArray = field(default_factory=lambda: np.eye(4))  # on the flange, (4, 4)
    free: bool = False  # whether it may turn about its z
    as_region: bool = False  # how that is said
    closed: bool = False
    world: World = field(default_factory=World)

    @property
    def robot(self) -> pdoik.Robot:
        """The library's."""
        return robot_of(self.arm)

    @property
    def last(self) -> int:
        """Where the path ends, in stations."""
        return len(self.T) - (0 if self.closed else 1)

    def goals(self) -> Any:
        """The stations as `solve` and `solve_path` take them."""
        if not self.free:
            return self.T
        if self.as_region:
            return [pdoik.Goal.region(T, rotation=ANY_TURN) for T in self.T]
        return [pdoik.Goal(T, type="axis", axis="z") for T in self.T]

    def solver(self, **options: Any) -> pdoik.Solver:
        """A new one."""
        return pdoik.Solver(self.robot, pdoik.Options(**options))

    def ask(self, solver: pdoik.Solver | None = None, **options: Any) -> Any:
        """The library's answer."""
        asked: dict[str, Any] = {"max_time": MAX_TIME, "closed": self.closed, **options}
        obstacles, goals = self.world.given(), self.goals()
        solver = solver or self.solver()
        return solver.solve_path(goals, obstacles, T_tip_tool=self.tool, **asked)

    def wanted(self, at: FloatArray) -> FloatArray:
        """Where the tool is to be at places of the path, straight from station to station.

        It turns evenly; if the turn about its z is free, so does that axis, and x and y are any.

        Args:
            at: In stations, shape (B,).
        """
        first = np.clip(np.floor(at).astype(int), 0, max(self.last - 1, 0))
        next_ = (first + 1) % len(self.T)
        share = np.clip(at - first, 0.0, 1.0)[:, None]
        one, other = self.T[first], self.T[next_]
        T = one.copy()
        T[:, :3, 3] += share * (other[:, :3, 3] - one[:, :3, 3])
        if self.free:
            turn = _least_turn(one[:, :3, 2], other[:, :3, 2])
            T[:, :3, :3] = Rotation.from_rotvec(share * turn).as_matrix() @ one[:, :3, :3]
        else:
            to = one[:, :3, :3].swapaxes(1, 2) @ other[:, :3, :3]
            turn = Rotation.from_matrix(to).as_rotvec()
            T[:, :3, :3] = one[:, :3, :3] @ Rotation.from_rotvec(share * turn).as_matrix()
        return np.asarray(T)

    def errors(self, T_is: FloatArray, T_wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Errors of position [m] and of turn [rad], (B,) each."""
        position = np.linalg.norm(T_is[:, :3, 3] - T_wanted[:, :3, 3], axis=1)
        if self.free:
            turn = np.linalg.norm(_least_turn(T_is[:, :3, 2], T_wanted[:, :3, 2]), axis=1)
        else:
            left = T_wanted[:, :3, :3].swapaxes(1, 2) @ T_is[:, :3, :3]
            turn = Rotation.from_matrix(left).magnitude()
        return position, turn


def _least_turn(one: FloatArray, other: FloatArray) -> FloatArray:
    """Rotation vectors that take unit vectors to others, (B, 3)."""
    across = np.cross(one, other)
    sine = np.linalg.norm(across, axis=1)
    angle = np.arctan2(sine, np.einsum("bi,bi->b", one, other))
    return np.asarray(across * (angle / np.where(sine > 0.0, sine, 1.0))[:, None])
