"""What is asked of a reachability map, and whether a map is this robot's; needs no browser."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik.errors import LoadError
from pdoik.reach_map import SEARCH

from .obstacles import Obstacles
from .session import Session

FloatArray = npt.NDArray[np.float64]

MOST_POSES = 5_000_000
_CHUNK = 256  # poses between two looks at whether to go on; a hard one takes 10 ms and more
_POSTURES = 2000  # that the default box is made from
_BOX_STEP = 0.05  # [m]
_MOST_CHECKED = 500  # answers of a file
_FOREIGN = 0.02  # a robot's own answers are nearer to their places [m]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReachRequest:
    """A map to be computed, by a solver of its own.

    Attributes:
        robot: With one tip.
        options: Of the solver.
        obstacles: None for none.
        grid: The poses.
    """

    robot: pdoik.Robot
    options: pdoik.Options
    obstacles: Obstacles | None
    grid: pdoik.Grid

    @classmethod
    def of(cls, session: Session, grid: pdoik.Grid, *, with_obstacles: bool) -> ReachRequest:
        """What the session keeps to and, if wanted, its obstacles as they are now.

        A robot without hulls cannot keep off them.

        Raises:
            ValueError: The robot has several tips, or nothing is asked of its tip.
        """
        if len(session.robot.tip_links) != 1:
            raise ValueError("a reachability map is of one tip: choose one in Files")
        (goal,) = session.goals.values()
        if goal == "free" or goal == "look_at":  # mypy narrows by these
            raise ValueError("the tip is free to be anywhere, so that there is nothing to reach")
        obstacles = session.obstacles
        counts = with_obstacles and obstacles.there and len(session.robot.occupancy) > 0
        return cls(
            robot=session.robot,
            options=replace(session.options, goal=goal, priority="both", **SEARCH),
            obstacles=obstacles if counts else None,
            grid=grid,
        )

    def compute(self, progress: Callable[[int], None]) -> pdoik.Reachability:
        """The map; leaves one processor to whoever else wants to solve.

        Args:
            progress: Called with how many poses are done; what it raises ends the work.

        Raises:
            ValueError: The cloud cannot be thinned so finely, or the solver refuses the robot.
        """
        scene = None
        if self.obstacles is not None:
            points = self.obstacles.placed(self.obstacles.thinned())
            scene = self.obstacles.scene(points)
        threads = max(len(os.sched_getaffinity(0)) - 1, 1)
        return pdoik.reachability(
            self.robot, scene, self.grid, options=self.options, threads=threads,
            progress=progress, chunk=_CHUNK,
        )  # fmt: skip


def default_box(robot: pdoik.Robot) -> tuple[FloatArray, FloatArray]:
    """A box around what the tip reaches: its lowest and its highest x, y, z [m].

    It holds the tip of random postures and 3 % more at each side, by steps of 50 mm.
    """
    lower = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    upper = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    postures = np.random.default_rng(0).uniform(lower, upper, (_POSTURES, robot.dof))
    (tip, *_) = robot.tip_links
    reached = np.array([robot.fk(q, tip)[:3, 3] for q in postures])
    margin = 0.03 * np.ptp(reached, axis=0)
    low = np.floor((reached.min(axis=0) - margin) / _BOX_STEP)
    high = np.ceil((reached.max(axis=0) + margin) / _BOX_STEP)
    return (low * _BOX_STEP).round(3), (high * _BOX_STEP).round(3)


def box_grid(low: npt.ArrayLike, high: npt.ArrayLike, step: float, orientations: int) -> pdoik.Grid:
    """`Grid.box`, unless it is too large for a page.

    Raises:
        ValueError: More than `MOST_POSES`, or what `Grid.box` refuses.
    """
    a, b = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    if step > 0 and np.isfinite([a, b]).all() and (a <= b).all():
        with np.errstate(over="ignore"):
            poses = float(np.prod(np.floor((b - a) / step + 1e-9) + 1)) * orientations
        if poses > MOST_POSES:
            raise ValueError(
                f"the grid has {poses:,.0f} poses, the page takes up to {MOST_POSES:,}; "
                "choose a longer step, a smaller box or fewer orientations"
            )
    return pdoik.Grid.box(a, b, step, orientations)


def load_map(path: str | Path, robot: pdoik.Robot) -> pdoik.Reachability:
    """Read a map of this robot, as `Reachability.save` wrote it.

    The file does not name its robot; its answers must put the robot's tip where they should.

    Raises:
        LoadError: The file is something else, too large for a page, or of another robot or tip.
    """
    result = pdoik.Reachability.load(path)
    if len(result.grid) > MOST_POSES:
        raise LoadError(f"{path}: {len(result.grid):,} poses, the page takes up to {MOST_POSES:,}")
    joints = result.q.shape[2]
    if joints != robot.dof:
        raise LoadError(f"{path}: of a robot with {joints} joints, {robot.name} has {robot.dof}")
    if len(robot.tip_links) != 1:
        raise LoadError(f"{path}: of a robot with one tip, {robot.name} has several")
    places, turns = np.nonzero(result.reached)
    some = np.linspace(0, len(places) - 1, min(len(places), _MOST_CHECKED)).astype(int)
    answers = result.q[places[some], turns[some]].astype(np.float64)  # (K, n)
    if not np.isfinite(answers).all():
        raise LoadError(f"{path}: a pose that is called reached has an answer with NaN or infinity")
    if len(some):
        tips = np.array([robot.fk(q)[:3, 3] for q in answers])
        off = np.linalg.norm(tips - result.grid.positions[places[some]], axis=1)
        if np.median(off) > _FOREIGN:
            raise LoadError(
                f"{path}: of another robot or tip; its answers put the tip of {robot.name} "
                f"{1e3 * np.median(off):.0f} mm from where they should"
            )
    return result
