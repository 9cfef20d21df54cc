"""Fit every link's surface: each kind once, what is kept not at all, several at a time."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from .hulls import FloatArray
from .kept import file_of, read_fit, write_fit
from .solid import areas
from .surface_fit import SurfaceFit, Wanted, fit_surface
from .twins import Motion, motion_between, moved_fit


class LinkNews(NamedTuple):
    """What became of a link just now."""

    link: str
    state: Literal["begun", "fitted", "kept", "like"]
    like: str | None  # the link whose geometry is the same, moved or mirrored
    n_capsules: int
    seconds: float  # that its fit took
    done: int  # links that are done
    links: int  # of so many
    share: float  # of the work that is done, about


Tell = Callable[[LinkNews], None]


class _Job(NamedTuple):
    link: str
    triangles: FloatArray
    wanted: Wanted
    file: Path | None  # where its fit is kept


def fit_surfaces(
    surfaces: Mapping[str, tuple[FloatArray, Wanted]],
    folder: Path | None,
    processes: int,
    tell: Tell | None,
) -> dict[str, SurfaceFit]:
    """The fits of links' triangles (T, 3, 3), by link; whatever the processes, the same ones.

    Args:
        surfaces: Of each link, with what is wanted.
        folder: Where fits are kept, each as soon as it is done; None for nowhere.
        processes: How many links are fitted at a time; 1 for in this process.
        tell: Called for each link.
    """
    like = _twins(surfaces)
    jobs = [
        _Job(link, *surface, None if folder is None else file_of(folder, *surface))
        for link, surface in surfaces.items()
        if link not in like
    ]
    work = {job.link: float(np.sqrt(areas(job.triangles).sum())) for job in jobs}
    done: dict[str, SurfaceFit] = {}

    def say(link: str, state: Literal["begun", "fitted", "kept", "like"], seconds: float) -> None:
        if tell is not None:
            share = sum(work.get(each, 0.0) for each in done) / max(sum(work.values()), 1e-12)
            count = len(done[link].capsules) if link in done else 0
            twin = like[link][0] if link in like else None
            tell(LinkNews(link, state, twin, count, seconds, len(done), len(surfaces), share))

    for job in jobs:
        if job.file is not None and (kept := read_fit(job.file)) is not None:
            done[job.link] = kept.named(job.link)
    for link in list(done):
        say(link, "kept", 0.0)
    todo = sorted((job for job in jobs if job.link not in done), key=lambda job: -work[job.link])
    for link, fit, seconds in _fitted(todo, processes, lambda link: say(link, "begun", 0.0)):
        done[link] = fit
        say(link, "fitted", seconds)
    for link, (twin, motion) in like.items():
        done[link] = moved_fit(done[twin], motion).named(link)
        say(link, "like", 0.0)
    return {link: done[link] for link in surfaces}


def _twins(
    surfaces: Mapping[str, tuple[FloatArray, Wanted]],
) -> dict[str, tuple[str, Motion]]:
    """Links whose surface is an earlier link's, moved or mirrored: that link, and how."""
    like: dict[str, tuple[str, Motion]] = {}
    firsts: list[str] = []
    for link, (triangles, wanted) in surfaces.items():
        for first in firsts:
            if surfaces[first][1] != wanted:
                continue
            motion = motion_between(surfaces[first][0], triangles)
            if motion is not None:
                like[link] = first, motion
                break
        else:
            firsts.append(link)
    return like


def _fitted(
    jobs: list[_Job], processes: int, begun: Callable[[str], None]
) -> Iterator[tuple[str, SurfaceFit, float]]:
    """Each job's link, its fit and its seconds, as they come."""
    if processes == 1 or len(jobs) < 2:
        for job in jobs:
            begun(job.link)
            yield _fit(job)
        return
    waiting, running = list(jobs), set[Future[tuple[str, SurfaceFit, float]]]()
    with _pool(min(processes, len(jobs))) as pool:
        while waiting or running:
            while waiting and len(running) < processes:
                job = waiting.pop(0)
                begun(job.link)
                running.add(pool.submit(_fit, job))
            finished, running = wait(running, return_when=FIRST_COMPLETED)
            for future in finished:
                yield future.result()


def _fit(job: _Job) -> tuple[str, SurfaceFit, float]:
    start = time.perf_counter()
    with threadpool_limits(limits=1, user_api="blas"):  # how many share a sum decides its rounding
        fit = fit_surface(job.link, job.triangles, job.wanted)
    if job.file is not None:
        write_fit(job.file, fit)
    return job.link, fit, time.perf_counter() - start


@contextmanager
def _pool(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that start afresh: a fork would copy others' threads in the midst of their work."""
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(processes, context, initializer=_begin_worker)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


def _begin_worker() -> None:
    """Ends without a word at Ctrl-C, and with the process that started it, however that ends."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.environ.setdefault("IGL_NUM_THREADS", "1")  # libigl's, as it begins: processes are enough
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
