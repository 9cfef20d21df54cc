"""Clouds of a thousand to a million points: intake, update, memory, questions and solves.

    python -m bench.ik.clouds --out build/bench/clouds

Compared with coal's octree and k-d trees, on one processor; every job has a process of its own.
With --vamp DIR, where PyPI's vamp-planner's sources are unpacked, also with VAMP's CAPT.
Peers whose packages are missing are left out with a line. Results are kept as they come, and the
same command continues where it was stopped. --quick takes a minute.
"""

import json
import os
import sys
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer

from bench.common import commands
from bench.common.campaign import Campaign
from bench.common.peer_library import ROOT
from bench.ik.clouds.capt import build_capt, settings_for
from bench.ik.clouds.picture import draw
from bench.ik.clouds.structures import OURS, STRUCTURES, missing
from bench.ik.clouds.tables import all_tables
from bench.ik.experiment import ARMS, output_of, tell

COUNTS = (1_000, 10_000, 100_000, 1_000_000)
SOLVE_COUNTS = (136, 10_000, 100_000, 1_000_000)
ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def main(
    out: commands.OutFolder = commands.BUILD / "clouds",
    quick: commands.Quick = False,
    most: Annotated[int, typer.Option(min=1000, help="Points of the largest cloud.")] = COUNTS[-1],
    repeats: Annotated[int, typer.Option(min=3, help="Intakes of a cloud, and updates.")] = 101,
    seconds: Annotated[
        float, typer.Option(help="For the repeats of one cloud at most; three at least.")
    ] = 4.0,
    configurations: Annotated[
        int, typer.Option(min=3, help="Asked about, per arm and cloud; a third touch.")
    ] = 240,
    targets: Annotated[int, typer.Option(min=1, help="Solves per arm and cloud.")] = 256,
    vamp: Annotated[
        Path | None, typer.Option(help="Where the sources of PyPI's vamp-planner are unpacked.")
    ] = None,
    seed: commands.Seed = 7,
    build: commands.BuildFolder = commands.BUILD,
    processor: Annotated[int, typer.Option(min=0, help="Which one runs it all.")] = 0,
) -> None:
    """Measure what clouds cost."""
    if quick:
        most, seconds, out = min(most, 100_000), 0.2, out.with_name(out.name + "-quick")
        configurations, targets = min(configurations, 24), min(targets, 20)
    with commands.plain_errors():
        library = None
        if vamp is not None:
            with commands.console.status("building VAMP's structure"):
                library = str(build_capt(build, vamp))
        settings = {
            "experiment": "clouds",
            "repeats": repeats,
            "seconds": seconds,
            "configurations": configurations,
            "targets": targets,
            "seed": seed,
            "vamp": vamp is not None,
        }
        jobs = plan(settings, most, available(), library)
        rows = measured(Campaign(out, settings), jobs, processor)
        draw(rows, out / "clouds.png")
        tell(out, all_tables(rows, seed), name="clouds", also=", clouds.png")


def available() -> list[str]:
    """The structures that can be made here; a line for each other."""
    reasons = {name: missing(name) for name in STRUCTURES}
    for name, reason in reasons.items():
        if reason is not None:
            commands.console.print(f"without {name}: {reason}", highlight=False)
    return [name for name, reason in reasons.items() if reason is None]


def plan(
    settings: Mapping[str, Any], most: int, names: list[str], capt: str | None
) -> dict[str, dict[str, Any]]:
    """All jobs up to the largest cloud, by a name that is good for a file.

    They are on the structures of these names, and with the library of VAMP's on that, too.
    """
    jobs = []
    for count in [count for count in COUNTS if count <= most]:
        vamps = settings_for(count) if capt is not None else []
        made = [*names, *vamps]
        jobs.append({"kind": "intake", "points": count, "names": made})
        jobs += [{"kind": "memory", "name": name, "points": count} for name in made]
        jobs.append({"kind": "update", "name": OURS, "points": count})
        jobs += [{"kind": "query", "robot": arm, "points": count} for arm in ARMS]
        jobs += [{"kind": "capt", "name": n, "robot": "panda", "points": count} for n in vamps]
    sizes = [count for count in SOLVE_COUNTS if count <= most]
    jobs += [
        {"kind": "solve", "name": OURS, "robot": arm, "points": 0, "sizes": sizes} for arm in ARMS
    ]
    jobs = [{**settings, "library": capt, "name": "", "robot": "", **job} for job in jobs]
    return {_file_name(job): job for job in jobs}


def measured(
    campaign: Campaign, jobs: Mapping[str, Mapping[str, Any]], processor: int
) -> pd.DataFrame:
    """The rows of all jobs, run where they are not there yet."""
    return campaign.run_here(partial(fresh_process, processor=processor), jobs, commands.console)


def fresh_process(job: Mapping[str, Any], processor: int) -> list[dict[str, Any]]:
    """The rows of one job."""
    command = [sys.executable, "-m", "bench.ik.clouds.trials", processor]
    environment = {**os.environ, **dict.fromkeys(ONE_THREAD, "1")}
    answer = output_of(command, _file_name(job), input=json.dumps(job), env=environment, cwd=ROOT)
    return json.loads(answer)


def _file_name(job: Mapping[str, Any]) -> str:
    words = [job["kind"], job["name"], job["robot"], job["points"]]
    text = "-".join(str(word) for word in words if word != "")
    return "".join(letter if letter.isalnum() or letter in "-." else "_" for letter in text)


if __name__ == "__main__":
    typer.run(main)
