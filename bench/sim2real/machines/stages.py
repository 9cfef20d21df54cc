"""Stages of a run: worlds are made and sealed, diagnosed blind, scored."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pandas as pd

from bench.common.campaign import CampaignError, Job, Row, dask_client
from bench.common.commands import BUILD, console, run_stage, show
from bench.common.digests import digest_of, digest_of_files, digest_of_folder, tool_digest
from bench.common.provenance import provenance
from bench.common.whole_files import write_text
from bench.sim2real.machines.build import make_study
from bench.sim2real.machines.plan import spec_of
from bench.sim2real.machines.score import score
from bench.sim2real.machines.spec import FIRST_PROOF_SEED, WorldSpec
from bench.sim2real.machines.tables import all_tables, summary
from bench.sim2real.proof.conceal import SEALED, STUDIES
from bench.sim2real.proof.diagnose import diagnose
from bench.sim2real.proof.seal import seals

HERE = Path(__file__).parent
RECORD = HERE / "record.jsonl"
SCORING = ("score.py", "background.py", "tables.py")
_BORROWED = ("arm.py", "motion.py", "robots.py", "study_files.py")


def generator_digest() -> str:
    """All that decides what a world is."""
    own = [p for p in HERE.glob("*.py") if p.name not in (*SCORING, "stages.py", "__main__.py")]
    other = [HERE.parent / "concealed" / name for name in _BORROWED]
    return digest_of_files([(f"{p.parent.name}/{p.name}", p) for p in (*own, *other)])


def scoring_digest() -> str:
    """What turns truths and diagnoses into scores."""
    return digest_of_files([(name, HERE / name) for name in SCORING])


def conceal(job: Job) -> list[Row]:
    """One world: its study and, elsewhere, its truth; neither is there before both are whole."""
    if generator_digest() != job["generator"]:
        raise RuntimeError("bench/sim2real/machines is not the one that was frozen here")
    out, name = Path(job["out"]), str(job["name"])
    with tempfile.TemporaryDirectory(prefix=".making-", dir=out) as folder:
        made = Path(folder)
        spec = {**job["spec"], "faults": tuple(job["spec"]["faults"])}
        try:
            make_study(made / name, WorldSpec(**spec), made / SEALED)
        except RuntimeError as error:
            return [{"name": name, "study": "", "not_made": str(error)}]
        digest = digest_of_folder(made / name)
        for parent in (out / STUDIES, out / SEALED):
            parent.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(out / STUDIES / name, ignore_errors=True)
        (made / name).rename(out / STUDIES / name)
        (made / SEALED / f"{name}.json").replace(out / SEALED / f"{name}.json")
    return [{"name": name, "study": digest, "not_made": ""}]


@dataclass(kw_only=True)
class Run:
    """One folder, one row of seeds."""

    out: Path
    seed: int
    count: int
    scheduler: str | None = None
    workers: int | None = None

    @property
    def specs(self) -> dict[str, WorldSpec]:
        """By names that tell nothing but their order."""
        return {f"world{k:04d}": spec_of(self.seed + k) for k in range(self.count)}

    def digests(self) -> dict[str, str]:
        """Of all that is frozen."""
        plan = {name: asdict(spec) for name, spec in self.specs.items()}
        return {
            "tool": tool_digest(),
            "generator": generator_digest(),
            "scoring": scoring_digest(),
            "plan": digest_of(plan),
        }

    def conceal(self) -> None:
        """Makes the worlds and seals them; nothing is left to do where they are sealed.

        Raises:
            CampaignError: the folder was begun with another generator or plan.
        """
        self.out.mkdir(parents=True, exist_ok=True)
        now = self.digests()
        path = self.out / "seal.json"
        if path.is_file():
            old = json.loads(path.read_text())["digests"]
            changed = [key for key in ("generator", "plan") if old[key] != now[key]]
            if changed:
                raise CampaignError(f"{self.out} was made with another {' and '.join(changed)}")
            return
        jobs = {
            name: {
                "out": str(self.out),
                "generator": now["generator"],
                "name": name,
                "spec": asdict(spec),
            }
            for name, spec in self.specs.items()
        }
        settings = {key: now[key] for key in ("generator", "plan")}
        with dask_client(self.scheduler, self.workers) as client:
            rows = run_stage(self.out, "conceal", settings, conceal, jobs, client)
        missing = sorted(rows.name[rows.not_made != ""])
        there = [name for name in self.specs if name not in missing]
        seal = {
            "schema": "pdoik.machines.seal/1",
            "sealed_at": datetime.now(UTC).isoformat(timespec="seconds"),
            "seed": self.seed,
            "count": len(there),
            "not_made": missing,
            **seals(self.out, there),
            "digests": now,
        }
        write_text(path, json.dumps(seal, indent=1) + "\n")

    def _seal(self) -> dict[str, Any]:
        path = self.out / "seal.json"
        if not path.is_file():
            raise CampaignError(f"{self.out}: nothing was sealed yet")
        return dict(json.loads(path.read_text()))

    def _names(self, seal: Mapping[str, Any]) -> list[str]:
        return [name for name in self.specs if name not in seal["not_made"]]

    def diagnose(self) -> Path:
        """Diagnoses every study blind; the folder of what was said by this tool."""
        seal, tool = self._seal(), tool_digest()
        folder = self.out / f"said-{tool[:12]}"
        jobs = {
            name: {"name": name, "study": str(self.out / STUDIES / name), "tool": tool}
            for name in self._names(seal)
        }
        with dask_client(self.scheduler, self.workers) as client:
            settings = {"tool": tool, "studies": seal["studies"]}
            rows = run_stage(self.out, f"diagnose-{tool[:12]}", settings, diagnose, jobs, client)
        folder.mkdir(exist_ok=True)
        for row in rows.itertuples():
            write_text(folder / f"{row.name}.json", row.said)
        return folder

    def score(self) -> None:
        """Opens the truths, if they are those that were sealed, and scores what was said.

        Raises:
            CampaignError: they are not, or a diagnosis has seen them.
        """
        seal, tool = self._seal(), tool_digest()
        names = self._names(seal)
        found = seals(self.out, names)
        for what in ("truths", "studies"):
            if found[what] != seal[what]:
                raise CampaignError(f"{self.out}: the {what} are not those that were sealed")
        rows = []
        for name in names:
            said = json.loads((self.out / f"said-{tool[:12]}" / f"{name}.json").read_text())
            seen = [each for each in said["elsewhere"] if Path(each).is_relative_to(self.out)]
            if seen:
                raise CampaignError(f"{name}: its diagnosis opened {seen[0]}: nothing is scored")
            truth = json.loads((self.out / SEALED / f"{name}.json").read_text())
            rows.append(score(name, truth, said))
        worlds = pd.DataFrame(rows)
        worlds.to_parquet(self.out / f"worlds-{tool[:12]}.parquet", index=False, compression="zstd")
        tables = all_tables(worlds)
        head = {**provenance(BUILD), **seal["digests"], "tool": tool, "worlds": len(worlds)}
        lines = "".join(f"- {name}: {value}\n" for name, value in head.items())
        write_text(self.out / f"tables-{tool[:12]}.md", f"# Machines\n\n{lines}\n{tables}\n")
        if self.seed >= FIRST_PROOF_SEED:
            self._record(seal, tool, worlds)
        show(tables)
        console.print(f"tables: {self.out}/tables-{tool[:12]}.md")

    def _record(self, seal: Mapping[str, Any], tool: str, worlds: pd.DataFrame) -> None:
        line = {
            "date": datetime.now(UTC).isoformat(timespec="seconds"),
            **{key: seal[key] for key in ("sealed_at", "seed", "count", "truths", "studies")},
            "digests": {**seal["digests"], "tool": tool, "scoring": scoring_digest()},
            "scores": summary(worlds),
        }
        with RECORD.open("a") as file:
            file.write(json.dumps(line) + "\n")
