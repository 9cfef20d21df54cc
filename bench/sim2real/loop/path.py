"""Paths of tip poses among obstacles, and the joint positions that `pdoik` finds for them."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

import pdoik
from bench.sim2real.frame.arm import Array
from bench.sim2real.frame.motion import STEP, Motion, smoothstep
from bench.sim2real.loop.cell import Cell

HOME = np.array([0.0, -0.3, 0.0, -2.1, 0.0, 1.9, 0.8])  # [rad]
CLEARANCE = 0.02  # asked of the solver [m]
ROOM = 0.01  # beyond that where paths are drawn, so that a corrected robot can go there too [m]
KNOT = 0.02  # of the tip's way between two solutions [m]
TURN = 0.08  # of the tip between two solutions [rad]
STRAY = 3e-5  # of the tip between two solutions, at most, where paths are drawn [m]
JUMP = 0.25  # between two solutions that follow one another [rad]
SPEED_SHARE = 0.55  # of the joints' speed limits
ACCELERATION = 5.0  # of a joint at most [rad/s^2]
REST = 1.0  # before and after a path [s]
PAUSE = 0.2  # between two legs [s]
DRAWS = 4000


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """A straight line of the tip, its turn at an even rate."""

    start: Array  # (4, 4)
    end: Array  # (4, 4)

    @property
    def knots(self) -> Array:
        """Shares of the way at which the solver is asked."""
        way = float(np.linalg.norm(self.end[:3, 3] - self.start[:3, 3]))
        turn = Rotation.from_matrix(self.start[:3, :3].T @ self.end[:3, :3]).magnitude()
        return np.linspace(0.0, 1.0, max(6, int(np.ceil(max(way / KNOT, turn / TURN)))))

    def positions(self, s: Array) -> Array:
        """Positions of the tip at shares of the way, (K, 3) [m]."""
        return np.asarray(self.start[:3, 3] + s[:, None] * (self.end - self.start)[:3, 3])

    def poses(self, s: Array) -> Array:
        """Poses of the tip at shares of the way, (K, 4, 4)."""
        ends = Rotation.from_matrix([self.start[:3, :3], self.end[:3, :3]])
        T = np.tile(np.eye(4), (len(s), 1, 1))
        T[:, :3, :3] = Slerp([0.0, 1.0], ends)(s).as_matrix()
        T[:, :3, 3] = self.positions(s)
        return T


@dataclass(frozen=True, slots=True, kw_only=True)
class Path:
    """What the tip shall do: legs, each from rest to rest in its time."""

    legs: tuple[Leg, ...]
    durations: tuple[float, ...]  # [s]
    q0: Array  # where the solver begins

    def targets(self) -> Array:
        """Tip positions wanted at every row of the commands, (K, 3) [m]."""
        parts = [leg.positions(s) for leg, s in zip(self.legs, self._shares(), strict=True)]
        return np.concatenate([*parts, parts[-1][-1:]])

    def _shares(self) -> list[Array]:
        """Shares of each leg's way at its rows; a leg ends where the next begins."""
        shares = []
        for k, duration in enumerate(self.durations):
            before = REST if k == 0 else PAUSE
            after = REST if k == len(self.durations) - 1 else 0.0
            rows = [round(x / STEP) for x in (before, duration, after)]
            s = smoothstep(np.arange(rows[1]) / rows[1])
            shares.append(np.concatenate([np.zeros(rows[0]), s, np.ones(rows[2])]))
        return shares

    def motion(self, robot: pdoik.Robot, cell: Cell) -> Motion:
        """Joint positions along the path, as the solver finds them for this robot."""
        q, parts, solver = self.q0, [], solver_of(robot)
        for leg, s in zip(self.legs, self._shares(), strict=True):
            solved = solve_leg(solver, cell, leg, q)
            if solved is None:
                raise ValueError("the solver finds no way along the path")
            q = solved[-1]
            parts.append(CubicSpline(leg.knots, solved)(s))
        return Motion.of(np.concatenate([*parts, parts[-1][-1:]]))


def solver_of(robot: pdoik.Robot, clearance: float = CLEARANCE) -> pdoik.Solver:
    """Precise, and clear of obstacles by more than the cloud's leaf leaves open."""
    options = pdoik.Options(
        position_tolerance=1e-6, rotation_tolerance=1e-6, clearance=clearance, max_time=0.05
    )
    return pdoik.Solver(robot, options)


def solve_leg(solver: pdoik.Solver, cell: Cell, leg: Leg, q: Array) -> Array | None:
    """Solutions (K, n) one after the other from q on; None where one is missing or far off."""
    solved = []
    for T in leg.poses(leg.knots):
        result = solver.solve(T, q0=q, obstacles=cell.cloud)
        if not result.success or np.max(np.abs(result.q - q)) > JUMP:
            return None
        q = result.q
        solved.append(q)
    return np.array(solved)


def random_path(robot: pdoik.Robot, cell: Cell, count: int, rng: np.random.Generator) -> Path:
    """Legs between random poses before the robot, beginning at home."""
    legs: list[Leg] = []
    durations: list[float] = []
    q, here, solver = HOME, robot.fk(HOME), solver_of(robot, CLEARANCE + ROOM)
    for _ in range(DRAWS):
        if len(legs) == count:
            return Path(legs=tuple(legs), durations=tuple(durations), q0=HOME)
        leg = Leg(start=here, end=random_pose(rng))
        way = float(np.linalg.norm(leg.end[:3, 3] - here[:3, 3]))
        if not 0.25 < way < 0.7 or not solver.solve(leg.end, q0=q).success:
            continue
        solved = solve_leg(solver, cell, leg, q)
        if solved is None or _stray(robot, leg, solved) > STRAY:
            continue
        legs.append(leg)
        durations.append(_duration(robot, leg, solved))
        q, here = solved[-1], leg.end
    raise ValueError(f"{DRAWS} legs were drawn and only {len(legs)} of {count} can be gone")


def random_pose(rng: np.random.Generator) -> Array:
    """Pose of a tip that points down, more or less, within a Panda's reach, (4, 4)."""
    T = np.eye(4)
    down = Rotation.from_euler("x", np.pi)
    tilt = Rotation.from_euler("zyx", rng.uniform([-0.7, -0.5, -0.5], [0.7, 0.5, 0.5]))
    T[:3, :3] = (tilt * down).as_matrix()
    T[:3, 3] = rng.uniform([0.3, -0.45, 0.2], [0.6, 0.45, 0.65])
    return T


def _stray(robot: pdoik.Robot, leg: Leg, solved: Array) -> float:
    """Largest distance of the tip from the leg half way between solutions [m]."""
    s = 0.5 * (leg.knots[1:] + leg.knots[:-1])
    tips = np.array([robot.fk(q)[:3, 3] for q in CubicSpline(leg.knots, solved)(s)])
    return float(np.linalg.norm(tips - leg.positions(s), axis=1).max())


def _duration(robot: pdoik.Robot, leg: Leg, solved: Array) -> float:
    """So that no joint is faster than its share of the limit, nor accelerates too much [s]."""
    spline = CubicSpline(leg.knots, solved)
    t = np.linspace(0.0, 1.0, 200)
    dq = np.gradient(spline(smoothstep(t)), t[1], axis=0)
    limits = np.array([2.175] * 4 + [2.61] * 3)
    speed = float(np.max(np.abs(dq) / (SPEED_SHARE * limits)))
    acceleration = float(np.sqrt(np.max(np.abs(np.gradient(dq, t[1], axis=0))) / ACCELERATION))
    return float(np.round(max(speed, acceleration, 0.8), 2))
