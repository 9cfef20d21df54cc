"""Soak test: ten million solves and a million tracker steps, each judged by code of its own.

    python -m bench.ik.soak --out build/bench/soak
    python -m bench.ik.soak --replay build/bench/soak/failures/CASE.json

Random robots, goals, clouds and options (bench/ik/soak), all from seeds. Every answer is judged by
Pinocchio and by the hulls' definition, by brute force in double precision. Results are kept as they
come and the same command continues where it was stopped; --solves and --steps may be raised.
What fails is written to failures/ and ends the command with status 1: a file there can be replayed,
and is a test once it lies in tests/python/benches/ik/soak_cases. --quick is a two-minute version.
"""

import json
from collections.abc import Mapping
from itertools import product
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer

from bench.common import commands
from bench.common.digests import core_digest
from bench.common.whole_files import write_text
from bench.ik.experiment import tell
from bench.ik.soak import solves as solving
from bench.ik.soak import tracking
from bench.ik.soak.cases import read_case
from bench.ik.soak.report import report
from bench.ik.soak.trees import FAMILIES

SHARES = {  # of a family in all solves and in all steps
    "panda": (0.22, 0.15),
    "ur10": (0.15, 0.12),
    "iiwa14": (0.15, 0.12),
    "h1": (0.05, 0.12),
    "random tree": (0.23, 0.2),
    "from_dh": (0.14, 0.14),
    "floating base": (0.06, 0.15),
}
SOLVES, STEPS = 50_000, 20_000  # of a job, at most: ten to thirty seconds
JOBS = 40  # at least, about


def main(
    out: commands.OutFolder = commands.BUILD / "soak",
    quick: commands.Quick = False,
    solves: Annotated[int, typer.Option(min=0, help="In all, at least.")] = 10_000_000,
    steps: Annotated[int, typer.Option(min=0, help="Of trackers, at least.")] = 1_000_000,
    seed: commands.Seed = 0,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = None,
    replay: Annotated[
        list[Path] | None, typer.Option(help="Ask this once more instead; repeatable.")
    ] = None,
) -> None:
    """Solve, track, judge, and keep what failed."""
    if replay:
        raise typer.Exit(1 if sum(replayed(path) for path in replay) else 0)
    if quick:
        out = out.with_name(out.name + "-quick")
        solves, steps = min(solves, 100_000), min(steps, 20_000)
    with commands.plain_errors():
        trials = {}
        for kind, total, most, run_job in (
            ("solve", solves, SOLVES, solving.run_job),
            ("tracking", steps, STEPS, tracking.run_job),
        ):
            size = min(most, -(-total // JOBS))
            settings = {"experiment": kind, "seed": seed, "of_a_job": size, "core": core_digest()}
            jobs = jobs_of(kind, total, size, seed)
            trials[kind] = pd.DataFrame()
            if jobs:
                folder = out / kind
                trials[kind] = commands.run_campaign(
                    folder, settings, run_job, jobs, scheduler, workers
                )
        failed = write_failures(out / "failures", trials)
    text = report(trials["solve"], trials["tracking"], seed)
    tell(out, text, name="soak")
    if failed:
        commands.console.print(f"{failed} cases that failed: {out}/failures")
        raise typer.Exit(1)


def jobs_of(kind: str, total: int, size: int, seed: int) -> dict[str, dict[str, Any]]:
    """Jobs of `size` each, `total` in all or a little more, the families by turns."""
    share = {family: shares[kind == "tracking"] for family, shares in SHARES.items()}
    counts = {f: -(-round(total * share[f]) // size) if total else 0 for f in FAMILIES}
    jobs = {}
    for index, family in product(range(max(counts.values())), FAMILIES):
        if index < counts[family]:
            name, key = f"{family.replace(' ', '_')}-{index:04d}", [FAMILIES.index(family), index]
            job = {"seed": seed, "family": family, "key": key, "name": name, "count": size}
            jobs[name] = job
    return jobs


def write_failures(folder: Path, trials: Mapping[str, pd.DataFrame]) -> int:
    """A file for each case that was kept; how many there are."""
    count = 0
    for table in trials.values():
        for text in table.get("cases", ()):
            for name, case in json.loads(text).items() if text else ():
                folder.mkdir(parents=True, exist_ok=True)
                write_text(folder / f"{name}.json", json.dumps(case, indent=1) + "\n")
                count += 1
    return count


def replayed(path: Path) -> bool:
    """Whether a case still fails; says how."""
    case = read_case(path)
    complaints = (tracking if case["kind"] == "tracking" else solving).replay(case)
    was = ", ".join(case["complaints"])
    now = ", ".join(complaints) or "nothing to complain of"
    commands.console.print(f"{path.name}: was {was}; now {now}", highlight=False, soft_wrap=True)
    return bool(complaints)


if __name__ == "__main__":
    typer.run(main)
