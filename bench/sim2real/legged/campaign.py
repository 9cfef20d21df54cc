"""Worlds made, diagnosed blind and scored, one job each; what was done is not done again."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict
from pathlib import Path
from shutil import copytree, rmtree
from typing import Any

import pandas as pd

from bench.common.campaign import Campaign, Job, Row, dask_client
from bench.common.commands import console
from bench.common.digests import digest_of, digest_of_files, tool_digest
from bench.common.whole_files import write_text
from bench.sim2real.legged.build import make_study
from bench.sim2real.legged.run import FallenError
from bench.sim2real.legged.score import score
from bench.sim2real.legged.spec import Spec
from bench.sim2real.proof.diagnose import ONE, environment

HERE = Path(__file__).parent
JUDGING = ("score.py", "tables.py", "campaign.py", "plan.py", "__main__.py")
LONGEST = 1800.0  # of one diagnosis [s]


def generator_digest() -> str:
    """All that decides what a world is."""
    return digest_of_files((p.name, p) for p in HERE.glob("*.py") if p.name not in JUDGING)


def run(
    out: Path, specs: dict[str, Spec], scheduler: str | None, workers: int | None
) -> pd.DataFrame:
    """All rows of a plan; worlds that are there are taken, each tool has its own results.

    Scores are of what was said, whenever that was.
    """
    tool, generator = tool_digest(), generator_digest()
    worlds = out / f"worlds-{generator[:12]}"
    said = out / f"said-{tool[:12]}-{generator[:12]}"
    settings = {"tool": tool, "generator": generator}
    facts = {name: asdict(spec) for name, spec in specs.items()}
    jobs = {
        f"{name}-{digest_of(facts[name])[:8]}": {
            "worlds": str(worlds),
            "said": str(said),
            "name": name,
            "spec": facts[name],
            **settings,
        }
        for name in specs
    }
    with dask_client(scheduler, workers) as client:
        campaign = Campaign(said, settings)
        made = campaign.run(one_world, jobs, client, console)
    return pd.DataFrame([_scored(row, worlds, said) for row in made.to_dict("records")])


def _scored(row: dict[str, Any], worlds: Path, said: Path) -> dict[str, Any]:
    """A world's truth beside its answer; the row as it is of a world that could not be made."""
    if row["not_made"]:
        return row
    spec = Spec(**{key: row[key] for key in ("seed", "robot", "background", "kind")})
    truth = json.loads((worlds / "truth" / f"{spec.name}.json").read_text())
    answer = json.loads((said / "answers" / f"{spec.name}.json").read_text())
    return {**score(row["name"], truth, answer), "not_made": ""}


def one_world(job: Job) -> list[Row]:
    """Makes a world where it is not yet, diagnoses it, keeps what was said.

    Raises:
        RuntimeError: pdoik or the generator is not the one of the campaign.
    """
    if tool_digest() != job["tool"] or generator_digest() != job["generator"]:
        raise RuntimeError(
            "pdoik or bench/sim2real/legged is not the one that the campaign began with"
        )
    spec, worlds = Spec(**job["spec"]), Path(job["worlds"])
    study, truth = worlds / "studies" / spec.name, worlds / "truth" / f"{spec.name}.json"
    if not study.is_dir():
        worlds.mkdir(parents=True, exist_ok=True)
        try:
            _make(worlds, study, truth, spec)
        except FallenError as error:
            return [{"name": job["name"], **job["spec"], "not_made": str(error)}]
    said = diagnosed(study)
    answer = Path(job["said"]) / "answers" / f"{spec.name}.json"
    answer.parent.mkdir(parents=True, exist_ok=True)
    write_text(answer, json.dumps(said, indent=1))
    return [{"name": job["name"], **job["spec"], "not_made": ""}]


def _make(worlds: Path, study: Path, truth: Path, spec: Spec) -> None:
    """A study is there when it is whole."""
    with tempfile.TemporaryDirectory(prefix=".making-", dir=worlds) as folder:
        made = Path(folder) / spec.name
        make_study(made, spec, truth)
        study.parent.mkdir(exist_ok=True)
        rmtree(study, ignore_errors=True)
        made.rename(study)


def diagnosed(study: Path, longest: float = LONGEST) -> dict[str, Any]:
    """What the pdoik of this process says of a copy of a study; a crash is an answer too."""
    import pdoik

    with tempfile.TemporaryDirectory(prefix="pdoik-legged-") as folder:
        copytree(study, Path(folder) / "study")
        tool = {"PYTHONPATH": str(Path(pdoik.__file__).parents[1])}
        begin = time.perf_counter()
        try:
            done = subprocess.run(
                [sys.executable, "-P", str(ONE), "study/study.yaml", "result.json"],
                cwd=folder,
                env=environment(folder) | tool,
                capture_output=True,
                text=True,
                timeout=longest,
                check=False,
            )
            ended = f"status {done.returncode}: {(done.stderr.strip().splitlines() or ['?'])[-1]}"
        except subprocess.TimeoutExpired:
            ended = f"no answer within {longest:g} s"
        took = time.perf_counter() - begin
        result = Path(folder) / "result.json"
        if not result.is_file():
            return {"error": ended, "seconds": took}
        return dict(json.loads(result.read_text()))
