"""Seconds and memory of studies of minutes and of an hour, each diagnosed in a process of its own.

    python -m bench.sim2real.diagnosis.long_studies --out build/bench/diagnosis

Panda with Coulomb friction in every joint, three recordings at 250 Hz.
"""

import json
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np
import typer

from bench.common import commands as cli
from bench.common.markdown import markdown_table
from bench.sim2real.concealed import build
from bench.sim2real.concealed.draft import Draft, draft_of
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.motion import Style, recording_motion

LONG = 40.0  # of each of three recordings [s]
FACTORS = (1, 2, 4, 30)
REPEATS = 3
TIMED = """
import json, resource, sys, time
from pdoik.sim2real import diagnose
begin = time.perf_counter()
findings = diagnose(sys.argv[1]).findings
seconds = time.perf_counter() - begin
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
print(json.dumps([seconds, memory, len(findings)]))
"""


def main(out: cli.OutFolder = cli.BUILD / "diagnosis", seed: cli.Seed = 5000) -> None:
    """Make the studies, diagnose them, print the table."""
    table = times_table(seed)
    out.mkdir(parents=True, exist_ok=True)
    cli.write_report(out / "times.md", table)
    cli.show(table)


def times_table(seed: int) -> str:
    """Seconds and peak memory, by length of recordings."""
    rows = []
    for factor in FACTORS:
        with (
            tempfile.TemporaryDirectory(prefix="pdoik-diagnosis-") as folder,
            cli.console.status(f"three recordings of {factor * LONG:g} s"),
        ):
            samples = long_study(Path(folder) / "study", seed, factor * LONG)
            runs = [alone(Path(folder) / "study" / "study.yaml") for _ in range(REPEATS)]
        seconds, memory, findings = np.median(runs, axis=0)
        figures = [f"{seconds:.1f}", f"{1e6 * seconds / samples:.0f}", f"{memory:.2f}"]
        rows.append([f"3 x {factor * LONG:g} s", samples, *figures, int(findings)])
    header = ["recordings", "samples", "median seconds", "us per sample", "peak memory [GiB]"]
    return markdown_table([*header, "findings"], rows)


def alone(study: Path) -> list[float]:
    """Seconds, GiB and findings of one diagnosis in a process of its own."""
    command = [sys.executable, "-c", TIMED, str(study)]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return json.loads(said.splitlines()[-1])


def long_study(folder: Path, seed: int, duration: float) -> int:
    """Panda with Coulomb friction in every joint, logged at 250 Hz; the number of samples."""
    spec = WorldSpec(seed=seed, effect="coulomb_friction", size=20.0)

    def draft(spec: WorldSpec) -> Draft:
        short, rng = draft_of(spec), spec.stream("long")
        kinds = (("sines", "reversals"), ("moves", "sines"), ("reversals", "sines", "moves"))
        motions = [recording_motion(short.arm, rng, kind, duration, 0.7, Style()) for kind in kinds]
        sensors = replace(short.sensors, log_period=0.004)
        return replace(short, motions=motions, roles=["fit", "fit", "validate"], sensors=sensors)

    drawn = build.drawn

    def everywhere(draft: Draft, attempt: int = 0) -> tuple[Effect, ...]:
        plans = [replace(draft.plan, places=(joint,)) for joint in range(draft.arm.n)]
        return tuple(drawn(replace(draft, plan=plan), attempt)[0] for plan in plans)

    with mock.patch.multiple(build, draft_of=draft, drawn=everywhere):
        build.make_study(folder, spec)
    return sum(len(path.read_text().splitlines()) - 1 for path in folder.glob("rec*.csv"))


if __name__ == "__main__":
    typer.run(main)
