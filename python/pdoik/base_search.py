"""Where a base, or the part that is worked on, should stand so that whole paths work."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from os import sched_getaffinity
from pathlib import Path
from threading import local
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from pdoik import _core
from pdoik._files import write_whole
from pdoik.base_looks import Question, look, looker
from pdoik.base_paths import given_obstacles, given_path, listed
from pdoik.base_places import (
    FIGURES,
    STATUSES,
    BasePlace,
    BasePlaces,
    Moves,
    npz_of,
    places_of,
)
from pdoik.options import Options

__all__ = ["BasePlace", "BasePlaces", "place_base"]

FloatArray = npt.NDArray[np.float64]

_NOT_LOOKED_AT = STATUSES.index("not_looked_at")
_STATION = 0.1  # for a station's search: all processors are busy [s]
_KEPT_EVERY = 1.0  # [s]


def place_base(
    robot: _core.Robot,
    paths: Any,
    obstacles: Any = None,
    *,
    region: Mapping[str, Any] | npt.ArrayLike,
    move: Moves = "base",
    part: Sequence[_core.Shape] = (),
    free: Literal["x", "y", "z"] | Sequence[float] | None = None,
    spacing: float | None = None,
    closed: bool = False,
    lock: Mapping[str, float] | None = None,
    options: Options | None = None,
    costs: Mapping[str, float] | None = None,
    max_time: float = 1.0,
    every: int = 10,
    threads: int = 0,
    client: Any = None,
    progress: Callable[[int], None] | None = None,
    chunk: int = 8,
    keep: str | Path | None = None,
) -> BasePlaces:
    """Try places for a robot's base, or for the part, and say how well whole paths work from each.

    From each place the robot first has to reach every tenth station. Where it does, each path is
    asked for as one motion, by `Solver.solve_path`.

    >>> import numpy as np
    >>> import pdoik
    >>> seam = np.tile(np.diag([1.0, -1.0, -1.0, 1.0]), (30, 1, 1))
    >>> seam[:, :3, 3] = np.linspace([1.2, -0.2, 0.3], [1.2, 0.2, 0.3], 30)
    >>> robot = pdoik.Robot.builtin("ur10")
    >>> found = pdoik.place_base(robot, seam, region={"x": (-1.0, 1.0, 0.5)})
    >>> found.best.success
    True

    Args:
        robot: Who follows them.
        paths: One path, or a list of them: poses, shape (N, 4, 4) [m], or lists of Goals; one path
            alone whose stations have several goals each as a list of itself. In the world's frame;
            with `move="part"` in the part's.
        obstacles: As in `Solver.solve`, in the world's frame; with `move="part"` in the base's.
            What the base stands on should be allowed to touch it (`Scene`), or is nearest of all.
        region: The places, in the world's frame, or with `move="part"` of the part in the base's:
            what is tried of "x", "y", "z" [m] and "yaw" [rad], a number each or (from, to, step);
            or rows x, y, z, yaw, shape (K, 4).
        move: What is placed: "base", or "part", with its paths.
        part: Obstacles that stay with the paths: the part itself.
        free: As in `solve_path`, of poses.
        spacing: As in `solve_path`, of poses: they are corners [m].
        closed: Whether paths go on to their first station, and end where they began.
        lock: As in `Solver.solve`.
        options: Of the solver, with the time of each station's search; None for 0.1 s and what a
            robot has by default.
        costs: As in `Solver.solve_path`.
        max_time: For each path, from each place [s].
        every: Stations from one that is looked at first to the next.
        threads: 0 for one per processor.
        client: A Dask client: its workers share the work, each with `threads` threads.
        progress: Called with the number of places done after each chunk; its errors end the work.
        chunk: Places that are asked for at once.
        keep: An .npz file that what is done is kept in all along. If it is there, and of the same
            question, the work goes on from it.

    Returns:
        All places, with the best.

    Raises:
        ValueError: As `Solver` and `Solver.solve_path` do; a region is empty or no number, every or
            chunk is below 1, a goal is of the centre of mass; keep is of another question.
        LoadError: keep is not such a file.
    """
    for name, value in (("every", every), ("chunk", chunk)):
        if value < 1:
            raise ValueError(f"{name} is {value}, expected at least 1")
    if move not in ("base", "part"):
        raise ValueError(f"move is {move!r}, expected 'base' or 'part'")
    options = options or Options(max_time=_STATION)
    question = Question(
        robot=robot,
        options=options,
        paths=tuple(given_path(path, free, spacing) for path in listed(paths)),
        obstacles=given_obstacles(obstacles),
        part=tuple(part),
        move=move,
        asked={
            "closed": closed,
            "lock": None if lock is None else dict(lock),
            "costs": None if costs is None else dict(costs),
            "max_time": max_time,
            "reconfigure": False,
        },
        every=every,
    )
    found = _Found.of(question, places_of(region), keep)
    question.try_out()
    left = np.flatnonzero(found.statuses == _NOT_LOOKED_AT)
    chunks = [left[k : k + chunk] for k in range(0, len(left), chunk)]
    parts = (
        _by_threads(question, found.places, chunks, threads)
        if client is None
        else _by_dask(client, question, found.places, chunks, threads)
    )
    try:
        for rows, (statuses, figures) in parts:
            found.take(rows, statuses, figures)
            if progress is not None:
                progress(int((found.statuses != _NOT_LOOKED_AT).sum()))
    finally:
        found.keep(at_once=True)
    return found.result()


class _Found:
    """What is known so far, and the file that it is kept in."""

    def __init__(self, places: FloatArray, question: Question, keep: Path | None) -> None:
        self.places = places
        self.statuses = np.full(len(places), _NOT_LOOKED_AT, dtype=np.uint8)
        self.figures = np.full((len(places), len(FIGURES)), np.nan)
        self.figures[:, :2] = 0.0
        self._question, self._file = question, keep
        self._digest = question.digest(places)
        self._before, self._began = 0.0, time.perf_counter()
        self._kept_at, self._is_kept = self._began, True

    @classmethod
    def of(cls, question: Question, places: FloatArray, keep: str | Path | None) -> _Found:
        """Nothing, or what a file holds.

        Raises:
            LoadError: There is one, of something else.
            ValueError: It is of another question, or there is no such folder.
        """
        if keep is None:
            return cls(places, question, None)
        file = Path(keep)
        if file.suffix.lower() != ".npz":
            raise ValueError(f"keep is {str(keep)!r}, expected a name that ends in .npz")
        if not file.parent.is_dir():
            raise ValueError(f"keep: there is no folder {file.parent}")
        found = cls(places, question, file)
        if file.exists():
            found._go_on(file)
        return found

    def _go_on(self, file: Path) -> None:
        known = BasePlaces.load(file)
        with np.load(file, allow_pickle=False) as data:
            digest = str(data["question"]) if "question" in data else ""
        if digest != self._digest:
            raise ValueError(f"keep: {file} is of another question; expected another name")
        self.statuses, self.figures = known.statuses, known.figures
        self._before = known.seconds

    def take(
        self, rows: npt.NDArray[np.int64], statuses: npt.NDArray[np.uint8], figures: FloatArray
    ) -> None:
        """What became of some places."""
        self.statuses[rows], self.figures[rows] = statuses, figures
        self._is_kept = False
        self.keep()

    def keep(self, at_once: bool = False) -> None:
        """Write the file, not too often."""
        now = time.perf_counter()
        if (
            self._file is None
            or self._is_kept
            or (now < self._kept_at + _KEPT_EVERY and not at_once)
        ):
            return
        write_whole(self._file, npz_of(self.result(), question=np.array(self._digest)))
        self._kept_at, self._is_kept = now, True

    def result(self) -> BasePlaces:
        """Table of places as it is now."""
        return BasePlaces(
            places=self.places,
            statuses=self.statuses,
            figures=self.figures,
            move=self._question.move,
            seconds=self._before + time.perf_counter() - self._began,
            ways=self._question.ways(),
        )


Looked = tuple[npt.NDArray[np.uint8], FloatArray]  # statuses (B,) and figures (B, 6)


def _by_threads(
    question: Question,
    places: FloatArray,
    chunks: Sequence[npt.NDArray[np.int64]],
    threads: int,
) -> Iterator[tuple[npt.NDArray[np.int64], Looked]]:
    with _Lookers(question, threads) as lookers:
        for rows in chunks:
            yield rows, lookers.look(places[rows])


def _by_dask(
    client: Any,
    question: Question,
    places: FloatArray,
    chunks: Sequence[npt.NDArray[np.int64]],
    threads: int,
) -> Iterator[tuple[npt.NDArray[np.int64], Looked]]:
    from distributed import as_completed

    # Names of their own: those of another call that had the same are given up while it ends.
    shared = client.scatter(question, broadcast=True, hash=False)
    futures = {
        client.submit(_look_chunk, shared, places[rows], threads, pure=False): rows
        for rows in chunks
    }
    for future in as_completed(futures):  # type: ignore[no-untyped-call]
        yield futures[future], future.result()


def _look_chunk(question: Question, places: FloatArray, threads: int) -> Looked:
    with _Lookers(question, threads) as lookers:
        return lookers.look(places)


class _Lookers:
    """Threads, each with solvers of its own."""

    def __init__(self, question: Question, threads: int) -> None:
        self._question = question
        self._own = local()
        self._pool = ThreadPoolExecutor(threads or len(sched_getaffinity(0)))

    def __enter__(self) -> _Lookers:
        return self

    def __exit__(self, *error: object) -> None:
        self._pool.shutdown(cancel_futures=True)

    def look(self, places: FloatArray) -> Looked:
        """What becomes of some places, shape (B, 4)."""
        found = list(self._pool.map(self._look, places))
        statuses = np.array([status for status, _ in found], dtype=np.uint8)
        return statuses, np.array([figures for _, figures in found]).reshape(-1, len(FIGURES))

    def _look(self, place: FloatArray) -> tuple[int, list[float]]:
        if not hasattr(self._own, "solver"):
            self._own.first, self._own.solver = looker(self._question)
        return look(self._question, self._own.first, self._own.solver, place)
