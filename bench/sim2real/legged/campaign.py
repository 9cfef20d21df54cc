"""Worlds made, diagnosed blind and scored, one job each; what was done is not done again."""

import json
import tempfile
from dataclasses import asdict
from pathlib import Path
from shutil import rmtree
from typing import Any

import pandas as pd

import pdoik
from bench.common.blind import blind
from bench.common.campaign import Job, Row
from bench.common.commands import run_campaign
from bench.common.digests import digest_of, digest_of_files, tool_digest
from bench.common.whole_files import write_text
from bench.sim2real.legged.build import make_study
from bench.sim2real.legged.run import FallenError
from bench.sim2real.legged.score import score
from bench.sim2real.legged.spec import Spec

HERE = Path(__file__).parent
JUDGING = ("score.py", "tables.py", "campaign.py", "plan.py", "__main__.py")
LONGEST = 1800.0  # of one diagnosis [s]


def digests() -> dict[str, str]:
    """Of the tool, and of all that decides what a world is."""
    own = ((p.name, p) for p in HERE.glob("*.py") if p.name not in JUDGING)
    return {"tool": tool_digest(), "generator": digest_of_files(own)}


def run(
    out: Path, specs: dict[str, Spec], scheduler: str | None, workers: int | None
) -> pd.DataFrame:
    """All rows of a plan; worlds that are there are taken, each tool has its own results.

    Scores are of what was said, whenever that was.
    """
    settings = digests()
    short = settings["generator"][:12]
    worlds, said = out / f"worlds-{short}", out / f"said-{settings['tool'][:12]}-{short}"
    common = {"worlds": str(worlds), "said": str(said), "digests": settings}
    jobs = {
        f"{name}-{digest_of(asdict(spec))[:8]}": {**common, "name": name, "spec": asdict(spec)}
        for name, spec in specs.items()
    }
    made = run_campaign(said, settings, one_world, jobs, scheduler, workers)
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
    """Makes a world where it is not yet, diagnoses it, keeps what was said."""
    if digests() != job["digests"]:
        raise RuntimeError("pdoik or bench/sim2real/legged is not what the campaign began with")
    spec, worlds = Spec(**job["spec"]), Path(job["worlds"])
    study, row = worlds / "studies" / spec.name, {"name": job["name"], **job["spec"]}
    if not study.is_dir():  # it is there when it is whole
        worlds.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".making-", dir=worlds) as folder:
            made = Path(folder) / spec.name
            try:
                make_study(made, spec, worlds / "truth" / f"{spec.name}.json")
            except FallenError as error:
                return [{**row, "not_made": str(error)}]
            study.parent.mkdir(exist_ok=True)
            rmtree(study, ignore_errors=True)
            made.rename(study)
    answer = Path(job["said"]) / "answers" / f"{spec.name}.json"
    answer.parent.mkdir(parents=True, exist_ok=True)
    said = blind(study, LONGEST, Path(pdoik.__file__).parents[1])
    write_text(answer, json.dumps(said, indent=1))
    return [{**row, "not_made": ""}]
