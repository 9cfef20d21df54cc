"""Which poses of a grid a robot reaches, among obstacles."""

from __future__ import annotations

import io
import time
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik import _core
from pdoik._files import write_whole
from pdoik.errors import LoadError
from pdoik.options import Options
from pdoik.reach_grasps import reach_any, rigid_grasps
from pdoik.reach_grid import Grid, even_rotations
from pdoik.solver import Solver

__all__ = ["SEARCH", "STATUSES", "Grid", "Reachability", "even_rotations", "reachability"]

FloatArray = npt.NDArray[np.float64]

_UNREADABLE = (OSError, EOFError, zipfile.BadZipFile, zlib.error)
STATUSES = (  # of the core
    *("solved", "time_limit", "exhausted", "out_of_reach", "base_collision", "blocked"),
    "nearest",
)
SEARCH: dict[str, Any] = {  # options that find nearly all poses that have an answer
    "position_tolerance": 1e-3,
    "rotation_tolerance": 1e-3,
    "max_restarts": 16,
    "max_time": 1.0,
}


@dataclass(frozen=True, slots=True)
class Reachability:
    """What of a grid is reached.

    A pose that is called reached has an answer whose limits, clearance and errors were judged. One
    that is not may have an answer that the starts did not come upon.
    """

    grid: Grid
    statuses: npt.NDArray[np.uint8]  # (P, R), places in STATUSES
    q: npt.NDArray[np.float32]  # (P, R, n), an answer each [rad] or [m]; NaN where there is none
    seconds: float  # that it took
    grasps: FloatArray | None = None  # (N, 4, 4), T_voxel_tip, any of which would do; or none
    met: npt.NDArray[np.int32] | None = None  # (P, R), which of them is met, -1 for none

    @property
    def reached(self) -> npt.NDArray[np.bool_]:
        """Shape (P, R)."""
        solved: npt.NDArray[np.bool_] = self.statuses == STATUSES.index("solved")
        return solved

    @property
    def share(self) -> FloatArray:
        """Share of the orientations at each position that are reached, shape (P,)."""
        share: FloatArray = self.reached.mean(axis=1)
        return share

    @property
    def reached_somehow(self) -> npt.NDArray[np.bool_]:
        """Whether any orientation is reached at each position, shape (P,)."""
        return np.asarray(self.reached.any(axis=1))

    def save(self, path: str | Path) -> None:
        """Write an .npz file that `load` reads. Replaces a file only when all is written."""
        arrays: dict[str, Any] = {
            "positions": self.grid.positions,
            "orientations": self.grid.orientations,
            "statuses": self.statuses,
            "q": self.q,
            "seconds": self.seconds,
        }
        if self.grasps is not None:
            arrays |= {"grasps": self.grasps, "met": self.met}
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **arrays)
        write_whole(path, buffer.getvalue())

    @classmethod
    def load(cls, path: str | Path) -> Reachability:
        """Read what `save` wrote.

        Raises:
            LoadError: The file is missing or is something else.
        """
        try:
            with Path(path).open("rb") as file, np.load(file, allow_pickle=False) as data:
                grid = Grid(data["positions"], data["orientations"])
                statuses, q = data["statuses"], data["q"]
                shape = len(grid.positions), len(grid.orientations)
                if statuses.shape != shape or q.ndim != 3 or q.shape[:2] != shape:
                    raise ValueError("its arrays do not belong together")
                grasps = rigid_grasps(data["grasps"]) if "grasps" in data else None
                met = data["met"] if "grasps" in data else None
                if met is not None and met.shape != shape:
                    raise ValueError("its arrays do not belong together")
                return cls(grid, statuses, q, float(data["seconds"]), grasps, met)
        except (*_UNREADABLE, ValueError, TypeError, KeyError) as error:
            raise LoadError(f"{path}: not a reachability file: {error}") from error

    def __repr__(self) -> str:
        reached = self.reached
        return (
            f"<Reachability of {reached.size} poses, {reached.mean():.1%} reached, "
            f"in {self.seconds:.3g} s>"
        )


def reachability(
    robot: _core.Robot,
    scene: _core.Scene | Sequence[_core.Shape] | _core.Cloud | npt.ArrayLike | None,
    grid: Grid,
    *,
    grasps: npt.ArrayLike | None = None,
    options: Options | None = None,
    threads: int = 0,
    client: Any = None,
    progress: Callable[[int], None] | None = None,
    chunk: int = 50_000,
) -> Reachability:
    """Which poses of a grid the robot's tip reaches: inside limits, clear of the scene.

    >>> import pdoik
    >>> robot = pdoik.Robot.builtin("panda")
    >>> grid = pdoik.Grid.box([0.3, -0.2, 0.2], [0.5, 0.2, 0.6], 0.2, orientations=8)
    >>> pdoik.reachability(robot, None, grid).share.min() > 0.2
    True

    Args:
        robot: With one tip.
        scene: Obstacles as `Solver.solve` takes them; None for none.
        grid: The poses: of the tip, or with `grasps` of what is to be grasped.
        grasps: Where the tip is in the frame of a pose of the grid, T_voxel_tip, shape (N, 4, 4)
            [m]: a pose counts as reached if any of them is met at it, the first in their order.
            None for the tip at the pose itself.
        options: None for tolerances of 1 mm and 1 mrad and 16 restarts (`SEARCH`), which is enough
            for nearly all poses that have an answer; of given ones all counts.
        threads: 0 for one per processor.
        client: A Dask client: its workers share the work, each with `threads` threads.
        progress: Called with the number of poses done after each chunk; its errors end the work.
        chunk: Poses that are asked for at once.

    Raises:
        ValueError: As `Solver` and `Solver.solve` do, chunk is below 1, or a grasp is not rigid.
    """
    if chunk < 1:
        raise ValueError(f"chunk is {chunk}, expected at least 1 pose")
    options = options or Options(**SEARCH)
    given = None if grasps is None else rigid_grasps(grasps)
    began = time.perf_counter()
    statuses = np.empty(len(grid), dtype=np.uint8)
    q = np.empty((len(grid), robot.dof), dtype=np.float32)
    met = None if given is None else np.empty(len(grid), dtype=np.int32)
    chunks = [(k, min(k + chunk, len(grid))) for k in range(0, len(grid), chunk)]
    if client is None:
        solver = Solver(robot, options)
        cloud = _taken_in(scene)
        parts: Iterator[tuple[int, Any]] = (
            (begin, _reach(solver, grid.poses(begin, end), given, cloud, threads))
            for begin, end in chunks
        )
    else:
        parts = _by_dask(client, robot, options, scene, given, grid, chunks, threads)
    done = 0
    for begin, (some_statuses, some_q, some_met) in parts:
        end = begin + len(some_statuses)
        statuses[begin:end], q[begin:end] = some_statuses, some_q
        if met is not None:
            met[begin:end] = some_met
        done += len(some_statuses)
        if progress is not None:
            progress(done)
    shape = len(grid.positions), len(grid.orientations)
    return Reachability(
        grid,
        statuses.reshape(shape),
        q.reshape(*shape, -1),
        time.perf_counter() - began,
        given,
        None if met is None else met.reshape(shape),
    )


def _reach(
    solver: Solver, poses: FloatArray, grasps: FloatArray | None, obstacles: Any, threads: int
) -> tuple[Any, Any, Any]:
    """Statuses, answers, and which grasp is met, None where there are no grasps."""
    if grasps is None:
        return *solver._reach_poses(poses, obstacles, threads), None
    far = STATUSES.index("out_of_reach")
    return reach_any(solver, poses, grasps, obstacles, threads, far)


def _taken_in(scene: Any) -> _core.Cloud | _core.Scene | None:
    """Obstacles as a solver takes them, with their points taken in once."""
    if scene is None or isinstance(scene, _core.Cloud | _core.Scene):
        return scene
    if isinstance(scene, list | tuple) and scene and isinstance(scene[0], _core.Shape):
        return _core.Scene(scene)
    return _core.Cloud(scene)


def _by_dask(
    client: Any,
    robot: _core.Robot,
    options: Options,
    scene: Any,
    grasps: FloatArray | None,
    grid: Grid,
    chunks: list[tuple[int, int]],
    threads: int,
) -> Iterator[tuple[int, Any]]:
    from distributed import as_completed

    shapes, contacts = [], []
    if isinstance(scene, _core.Scene):
        shapes, contacts, scene = scene.shapes, scene.contacts, scene.cloud
    points = scene.points if isinstance(scene, _core.Cloud) else scene
    # Names of their own: those of another call that had the same are given up while it ends.
    content = (robot, options, points, shapes, contacts, grasps)
    shared = client.scatter(content, broadcast=True, hash=False)
    futures = {
        client.submit(_reach_chunk, shared, grid.poses(begin, end), threads, pure=False): begin
        for begin, end in chunks
    }
    for future in as_completed(futures):  # type: ignore[no-untyped-call]
        yield futures[future], future.result()


def _reach_chunk(shared: tuple[Any, ...], poses: FloatArray, threads: int) -> Any:
    robot, options, points, shapes, contacts, grasps = shared
    scene = _taken_in(points)
    if shapes or contacts:
        scene = _core.Scene(shapes, cloud=scene, contacts=contacts)
    return _reach(Solver(robot, replace(options)), poses, grasps, scene, threads)
