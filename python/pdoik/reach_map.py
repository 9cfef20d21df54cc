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
from pdoik.solver import Solver

FloatArray = npt.NDArray[np.float64]

_UNREADABLE = (OSError, EOFError, zipfile.BadZipFile, zlib.error)
STATUSES = (  # of the core
    *("solved", "time_limit", "exhausted", "out_of_reach", "base_collision", "blocked"),
)
SEARCH: dict[str, Any] = {  # options that find nearly all poses that have an answer
    "position_tolerance": 1e-3,
    "rotation_tolerance": 1e-3,
    "max_restarts": 16,
    "max_time": 1.0,
}


@dataclass(frozen=True, slots=True)
class Grid:
    """Poses to be asked for: each orientation at each position.

    Args:
        positions: Shape (P, 3), in the base frame [m].
        orientations: Rotations base to tip, shape (R, 3, 3).
    """

    positions: FloatArray
    orientations: FloatArray

    @classmethod
    def box(
        cls,
        low: npt.ArrayLike,
        high: npt.ArrayLike,
        step: float,
        orientations: int | npt.ArrayLike = 1,
    ) -> Grid:
        """Positions in a box, a step apart along each axis, both ends included.

        Args:
            low: The box's lowest x, y, z [m].
            high: Its highest [m].
            step: Between neighbours [m].
            orientations: That many, spread evenly over all rotations; or rotations, (R, 3, 3).

        Raises:
            ValueError: A box inside out, a step that is not positive, no orientation.
        """
        a, b = (np.asarray(corner, dtype=np.float64) for corner in (low, high))
        if a.shape != (3,) or b.shape != (3,) or not (np.isfinite([a, b]).all() and (a <= b).all()):
            raise ValueError(f"the box goes from {a} to {b}, expected finite x, y, z in order")
        if not (np.isfinite(step) and step > 0):
            raise ValueError(f"step is {step}, expected a positive length [m]")
        axes = [np.arange(np.floor((top - bottom) / step + 1e-9) + 1) * step + bottom
                for bottom, top in zip(a, b, strict=True)]  # fmt: skip
        positions = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        if isinstance(orientations, int):
            return cls(positions, even_rotations(orientations))
        return cls(positions, np.asarray(orientations, dtype=np.float64))

    def __post_init__(self) -> None:
        shapes = self.positions.shape, self.orientations.shape
        if (
            self.positions.ndim != 2
            or shapes[0][1:] != (3,)
            or self.orientations.ndim != 3
            or shapes[1][1:] != (3, 3)
            or 0 in (len(self.positions), len(self.orientations))
        ):
            raise ValueError(
                f"positions and orientations have shapes {shapes[0]} and {shapes[1]}, "
                "expected (P, 3) and (R, 3, 3), none empty"
            )
        if not (np.isfinite(self.positions).all() and np.isfinite(self.orientations).all()):
            raise ValueError("positions or orientations have NaN or infinity, expected numbers")

    def __len__(self) -> int:
        return len(self.positions) * len(self.orientations)

    def poses(self, begin: int, end: int) -> FloatArray:
        """Those from `begin` to before `end`, shape (B, 4, 4); position by position."""
        position, orientation = np.divmod(np.arange(begin, end), len(self.orientations))
        poses = np.zeros((end - begin, 4, 4))
        poses[:, :3, :3] = self.orientations[orientation]
        poses[:, :3, 3] = self.positions[position]
        poses[:, 3, 3] = 1.0
        return poses


def even_rotations(count: int) -> FloatArray:
    """Rotations spread evenly, shape (count, 3, 3): Alexa's super-Fibonacci spiral (CVPR 2022).

    Raises:
        ValueError: count is below 1.
    """
    if count < 1:
        raise ValueError(f"orientations is {count}, expected at least 1")
    if count == 1:
        return np.eye(3)[None]
    phi, psi = np.sqrt(2.0), 1.533751168755204288118041
    s = np.arange(count) + 0.5
    r, big_r = np.sqrt(s / count), np.sqrt(1.0 - s / count)
    alpha, beta = 2 * np.pi * s / phi, 2 * np.pi * s / psi
    x, y, z, w = r * np.sin(alpha), r * np.cos(alpha), big_r * np.sin(beta), big_r * np.cos(beta)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


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

    @property
    def reached(self) -> npt.NDArray[np.bool_]:
        """Shape (P, R)."""
        solved: npt.NDArray[np.bool_] = self.statuses == STATUSES.index("solved")
        return solved

    @property
    def share(self) -> FloatArray:
        """Of the orientations at each position, how many are reached, shape (P,)."""
        share: FloatArray = self.reached.mean(axis=1)
        return share

    def save(self, path: str | Path) -> None:
        """Write an .npz file that `load` reads. Replaces a file only when all is written."""
        buffer = io.BytesIO()
        np.savez_compressed(
            buffer, positions=self.grid.positions, orientations=self.grid.orientations,
            statuses=self.statuses, q=self.q, seconds=self.seconds,
        )  # fmt: skip
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
                return cls(grid, statuses, q, float(data["seconds"]))
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
        grid: The poses.
        options: None for tolerances of 1 mm and 1 mrad and 16 restarts (`SEARCH`), which is enough
            for nearly all poses that have an answer; of given ones all counts.
        threads: 0 for one per processor.
        client: A Dask client: its workers share the work, each with `threads` threads.
        progress: Told how many poses are done after each chunk; what it raises ends the work.
        chunk: Poses that are asked for at once.

    Raises:
        ValueError: As `Solver` and `Solver.solve` do, or chunk is below 1.
    """
    if chunk < 1:
        raise ValueError(f"chunk is {chunk}, expected at least 1 pose")
    options = options or Options(**SEARCH)
    began = time.perf_counter()
    statuses = np.empty(len(grid), dtype=np.uint8)
    q = np.empty((len(grid), robot.dof), dtype=np.float32)
    chunks = [(k, min(k + chunk, len(grid))) for k in range(0, len(grid), chunk)]
    if client is None:
        solver = Solver(robot, options)
        cloud = _taken_in(scene)
        parts: Iterator[tuple[int, Any]] = (
            (begin, solver._reach_poses(grid.poses(begin, end), cloud, threads))
            for begin, end in chunks
        )
    else:
        parts = _by_dask(client, robot, options, scene, grid, chunks, threads)
    done = 0
    for begin, (some_statuses, some_q) in parts:
        end = begin + len(some_statuses)
        statuses[begin:end], q[begin:end] = some_statuses, some_q
        done += len(some_statuses)
        if progress is not None:
            progress(done)
    shape = len(grid.positions), len(grid.orientations)
    return Reachability(
        grid, statuses.reshape(shape), q.reshape(*shape, -1), time.perf_counter() - began
    )


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
    grid: Grid,
    chunks: list[tuple[int, int]],
    threads: int,
) -> Iterator[tuple[int, Any]]:
    from distributed import as_completed

    shapes, allowed = [], []
    if isinstance(scene, _core.Scene):
        shapes, allowed, scene = scene.shapes, scene.allowed, scene.cloud
    points = scene.points if isinstance(scene, _core.Cloud) else scene
    shared = client.scatter((robot, options, points, shapes, allowed), broadcast=True)
    futures = {
        client.submit(_reach_chunk, shared, grid.poses(begin, end), threads, pure=False): begin
        for begin, end in chunks
    }
    for future in as_completed(futures):  # type: ignore[no-untyped-call]
        yield futures[future], future.result()


def _reach_chunk(shared: tuple[Any, ...], poses: FloatArray, threads: int) -> Any:
    robot, options, points, shapes, allowed = shared
    scene = _taken_in(points)
    if shapes:
        scene = _core.Scene(shapes, cloud=scene, allowed=allowed)
    return Solver(robot, replace(options))._reach_poses(poses, scene, threads)
