"""Long experiments: jobs spread by Dask, results kept as they come, continued where stopped.

A campaign lives in a folder: settings.json, one Parquet file per finished job in parts/, and
trials.parquet once all are there. A part is written to a temporary name and renamed, so what is
there is whole; starting the same campaign again runs the jobs whose parts are missing.
"""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from multiprocessing import resource_tracker
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from typing import Any

import pandas as pd
from dask.distributed import Client, Future, LocalCluster, as_completed
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from bench.common.peer_library import ROOT
from bench.common.whole_files import write_whole

Row = dict[str, Any]
Job = Mapping[str, Any]


class CampaignError(RuntimeError):
    """The campaign cannot run, or some of its jobs failed."""


class Campaign:
    """A folder of results.

    Args:
        folder: Made if it is not there.
        settings: What the results depend on; JSON must keep them as they are.

    Raises:
        CampaignError: The folder holds results of other settings.
    """

    def __init__(self, folder: Path, settings: Mapping[str, Any]) -> None:
        self.folder = folder
        self._parts = folder / "parts"
        self._parts.mkdir(parents=True, exist_ok=True)
        path = folder / "settings.json"
        text = json.dumps(settings, indent=1, sort_keys=True) + "\n"
        if path.is_file() and path.read_text() != text:
            old = json.loads(path.read_text())
            changed = sorted(k for k in {*old, *settings} if old.get(k) != settings.get(k))
            raise CampaignError(
                f"{folder} holds results of other settings ({', '.join(changed)}): "
                "choose another --out, or remove it"
            )
        write_whole(path, lambda temporary: temporary.write_text(text))

    def run(
        self,
        function: Callable[[Job], list[Row]],
        jobs: Mapping[str, Job],
        client: Client,
        console: Console,
    ) -> pd.DataFrame:
        """Run the jobs whose parts are missing; all rows of all jobs.

        Args:
            function: Turns a job into rows, on a worker. It must be importable there.
            jobs: By a name that is good for a file.
            client: Of a Dask cluster.
            console: For the progress bar.

        Raises:
            CampaignError: Jobs failed; what the others gave is kept.
        """
        missing = [name for name in jobs if not self.has(name)]
        if len(missing) < len(jobs):
            console.print(f"{len(jobs) - len(missing)} of {len(jobs)} jobs are done already")
        failures = []
        with _progress(console) as progress:
            task = progress.add_task("jobs", total=len(jobs), completed=len(jobs) - len(missing))
            futures: dict[Future, str] = {
                client.submit(by_value(function), jobs[name], pure=False): name for name in missing
            }
            for future in as_completed(list(futures)):
                name = futures.pop(future)
                try:
                    self.keep(name, future.result())
                except Exception as error:  # whatever the job met
                    failures.append(f"{name}: {type(error).__name__}: {error}")
                future.release()
                progress.advance(task)
        if failures:
            raise CampaignError(
                f"{len(failures)} of {len(jobs)} jobs failed; the same command tries them again\n"
                + "\n".join(failures[:5])
            )
        return self.gather(list(jobs))

    def run_here(
        self,
        function: Callable[[Any], Sequence[Row] | pd.DataFrame],
        jobs: Mapping[str, Any],
        console: Console,
    ) -> pd.DataFrame:
        """The same in this process, one job after the other: for times that others would disturb.

        Args:
            function: Turns a job into rows.
            jobs: By a name that is good for a file.
            console: For the progress bar.
        """
        missing = [name for name in jobs if not self.has(name)]
        if len(missing) < len(jobs):
            console.print(f"{len(jobs) - len(missing)} of {len(jobs)} jobs are done already")
        with _progress(console) as progress:
            for name in progress.track(missing, description="jobs"):
                self.keep(name, function(jobs[name]))
        return self.gather(list(jobs))

    def _part(self, name: str) -> Path:
        return self._parts / f"{name}.parquet"

    def has(self, name: str) -> bool:
        """Whether a job's rows are there."""
        return self._part(name).is_file()

    def keep(self, name: str, rows: Sequence[Row] | pd.DataFrame) -> None:
        """A finished job's rows."""
        table = pd.DataFrame(rows)
        write_whole(self._part(name), lambda temporary: table.to_parquet(temporary, index=False))

    def gather(self, names: Sequence[str]) -> pd.DataFrame:
        """All rows of these jobs, which trials.parquet then has, too."""
        parts = [pd.read_parquet(self._part(name)) for name in names]
        table = pd.concat([part for part in parts if len(part)], ignore_index=True)
        write_whole(
            self.folder / "trials.parquet",
            lambda temporary: table.to_parquet(temporary, index=False),
        )
        return table


def by_value(function: Callable[[Job], list[Row]]) -> Callable[[Job], list[Row]]:
    """The function by its name and where this repository is.

    Schedulers unpickle jobs too and cannot import this package; workers may find an old copy of it
    among what was once sent to them.
    """
    module, name, root = function.__module__, function.__name__, str(ROOT)

    def call(job: Job) -> list[Row]:
        import importlib
        import sys

        if root in sys.path:
            sys.path.remove(root)
        sys.path.insert(0, root)
        rows: list[Row] = getattr(importlib.import_module(module), name)(job)
        return rows

    return call


@contextmanager
def dask_client(scheduler: str | None, workers: int | None = None) -> Iterator[Client]:
    """A client of the scheduler at an address, or of a cluster of processes on this machine.

    A foreign cluster's workers must see this repository and the folder of the results under the
    same paths, and have the Python packages.

    Args:
        scheduler: Such as "tcp://host:8786"; None for a cluster of its own, on loopback only.
        workers: Processes of such a cluster; None for one per processor.

    Raises:
        CampaignError: Nobody answers at the address.
    """
    if scheduler is None:
        with (
            TemporaryDirectory(prefix="pdoik-dask-") as scratch,  # none that others' workers see
            ExitStack() as running,
        ):
            with _interrupts_put_off():
                cluster = LocalCluster(
                    n_workers=workers or os.cpu_count() or 1,
                    threads_per_worker=1,
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",
                    silence_logs="CRITICAL",
                    local_directory=scratch,
                )
                running.enter_context(cluster)
                client = running.enter_context(Client(cluster))
                client.run(_be_stopped_by_scheduler)
            yield client
        return
    try:
        client = Client(scheduler, timeout="10s")
    except (OSError, ValueError) as error:
        raise CampaignError(f"no Dask scheduler at {scheduler}: {error}") from error
    with client:
        yield client


@contextmanager
def _interrupts_put_off() -> Iterator[None]:
    """Ctrl-C waits until the end, for this process and for those that it starts meanwhile.

    It goes to all of them: workers that it hits while they load modules would print where.
    """
    came: SimpleQueue[int] = SimpleQueue()  # to another thread of this process
    before = signal.signal(signal.SIGINT, lambda number, _: came.put(number))
    resource_tracker.ensure_running()  # which lets interrupts through where it starts
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        _hear_interrupts()
        signal.signal(signal.SIGINT, before)
    if not came.empty():
        raise KeyboardInterrupt


def _hear_interrupts() -> None:
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def _be_stopped_by_scheduler() -> None:
    """A worker does nothing on Ctrl-C, which ends programs that it runs, and who closes it."""
    signal.signal(signal.SIGINT, lambda *_: None)
    _hear_interrupts()


def _progress(console: Console) -> Progress:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    return Progress(*columns, console=console, transient=True)
