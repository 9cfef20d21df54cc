"""A run of the proof: its stages, and what is printed and stored between them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from bench.common.campaign import CampaignError, dask_client
from bench.common.commands import BUILD, console, run_stage, show
from bench.common.digests import digest_of_files
from bench.common.provenance import provenance
from bench.common.whole_files import write_text
from bench.sim2real.proof import confusion, failures, record, seal, true_model
from bench.sim2real.proof.conceal import SEALED, STUDIES, conceal, conceal_jobs
from bench.sim2real.proof.diagnose import diagnose
from bench.sim2real.proof.plan import Plan
from bench.sim2real.proof.score import score
from bench.sim2real.proof.tables import all_tables, notes_of
from bench.sim2real.proof.true_model import refit

FROZEN = "frozen.json"


@dataclass(kw_only=True)
class Run:
    """One folder, one plan."""

    out: Path
    plan: Plan
    frozen: dict[str, str] = field(default_factory=dict)

    def freeze(self) -> None:
        """Prints and stores the digests of all that decides the scores.

        Raises:
            CampaignError: the folder was begun with another tool, generator or plan.
        """
        self.out.mkdir(parents=True, exist_ok=True)
        self.frozen = seal.digests(self.plan)
        path = self.out / FROZEN
        if path.is_file():
            old = json.loads(path.read_text())["digests"]
            changed = [k for k in ("tool", "generator", "plan") if old[k] != self.frozen[k]]
            if changed:
                raise CampaignError(
                    f"{self.out} was begun with another {' and '.join(changed)}: choose another"
                    " --out, or remove it"
                )
        else:
            content = {"digests": self.frozen, "plan": self.plan.facts()}
            write_text(path, json.dumps(content, indent=1) + "\n")
        for name, digest in self.frozen.items():
            console.print(f"{name:9} sha256 {digest}", highlight=False)

    def conceal(self, scheduler: str | None, workers: int | None) -> None:
        """Makes the worlds and seals them; nothing is left to do where they are sealed."""
        if seal.read_seal(self.out) is not None:
            return
        specs = {name: asdict(spec) for name, spec in self.plan.specs.items()}
        with dask_client(scheduler, workers) as client:
            settings = {key: self.frozen[key] for key in ("generator", "plan")}
            jobs = conceal_jobs(self.out, specs, self.frozen["generator"])
            rows = run_stage(self.out, "conceal", settings, conceal, jobs, client)
        not_made = rows.name[rows.not_made != ""]
        sealed = seal.write_seal(self.out, self.plan, self.frozen, not_made)
        if self.plan.proof:
            record.append(record.sealed_line(sealed))

    def diagnose(self, scheduler: str | None, workers: int | None) -> None:
        """Diagnoses every study blind.

        Raises:
            CampaignError: nothing was sealed.
        """
        sealed = self._seal()
        for when in record.earlier_runs(sealed) if self.plan.proof else ():
            console.print(f"[bold]this tool was run on these seeds before: {when}[/]")
        tool = self.frozen["tool"]
        jobs = {
            name: {"name": name, "study": str(self.out / STUDIES / name), "tool": tool}
            for name in seal.made(self.plan, sealed)
        }
        with dask_client(scheduler, workers) as client:
            settings = {"tool": tool, "studies": sealed["studies"]}
            rows = run_stage(self.out, "diagnose", settings, diagnose, jobs, client)
        folder = self.out / "diagnoses"
        folder.mkdir(exist_ok=True)
        for row in rows.itertuples():
            write_text(folder / f"{row.name}.json", row.said)

    def score(self, scheduler: str | None, workers: int | None) -> None:
        """Opens the truths, if they are those that were sealed, and scores what was said.

        Raises:
            CampaignError: they are not, or diagnoses are missing.
        """
        sealed = self._seal()
        seal.verify(self.out, self.plan, sealed)
        console.print("the truths are those that were sealed")
        said = {name: self._said(name) for name in seal.made(self.plan, sealed)}
        decoy = {
            n: ":" in spec.effect or spec.effect == "still" for n, spec in self.plan.specs.items()
        }
        jobs = {name: {"out": str(self.out), "name": name} for name in said if not decoy[name]}
        with dask_client(scheduler, workers) as client:
            own = digest_of_files([("true_model.py", Path(true_model.__file__))])
            settings = {"tool": self.frozen["tool"], "truths": sealed["truths"], "own": own}
            true = run_stage(self.out, f"refit-{own[:8]}", settings, refit, jobs, client)
        left = dict(zip(true.name, map(json.loads, true.true), strict=True))
        rows = []
        for name in said:
            truth = json.loads((self.out / SEALED / f"{name}.json").read_text())
            rows.append(score(name, truth, said[name], left.get(name, {})))
        studies = pd.DataFrame(rows).merge(true[["name", "why_not"]], on="name", how="left")
        self._write(studies, sealed)

    def _write(self, studies: pd.DataFrame, sealed: Mapping[str, Any]) -> None:
        studies.to_parquet(self.out / ".studies.parquet", index=False, compression="zstd")
        (self.out / ".studies.parquet").replace(self.out / "studies.parquet")
        confusion.draw(studies, self.out / "confusion.png")
        count = failures.write_pages(studies, self.out / "failures")
        tables = all_tables(studies, notes_of(studies))
        write_text(self.out / "tables.md", f"# The proof\n\n{self.head(sealed)}\n{tables}")
        if self.plan.proof:
            record.append(record.scored_line(sealed, self.frozen["scoring"], studies))
        show(tables)
        console.print(f"tables: {self.out}/tables.md; {count} failures: {self.out}/failures")

    def head(self, sealed: Mapping[str, Any]) -> str:
        """Provenance, digests and seal; other code than was frozen is said."""
        kind = "the proof's" if self.plan.proof else "development's: these figures prove nothing"
        facts = {
            **provenance(BUILD),
            "studies": f"{sealed['count']}, seeds {kind}, first {self.plan.seed}",
            "worlds that could not be made": self._not_made(sealed),
            "sealed at": sealed["sealed_at"],
            "seal of the truths": sealed["truths"],
            "seal of the studies": sealed["studies"],
            **{f"digest of the {name}": each for name, each in sealed["digests"].items()},
        }
        if sealed["digests"]["scoring"] != self.frozen["scoring"]:
            facts["scored by other code than was frozen"] = self.frozen["scoring"]
        for when in record.earlier_runs(sealed) if self.plan.proof else ():
            facts["this tool ran on these seeds before"] = when
        return "".join(f"- {name}: {value}\n" for name, value in facts.items())

    def _not_made(self, sealed: Mapping[str, Any]) -> str:
        specs = [self.plan.specs[name] for name in sealed["not_made"]]
        return ", ".join(f"{each.seed} {each.effect} {each.hide}" for each in specs) or "none"

    def _seal(self) -> dict[str, Any]:
        sealed = seal.read_seal(self.out)
        if sealed is None:
            raise CampaignError(f"{self.out}: nothing was sealed yet; run the stage conceal first")
        console.print(f"sealed {sealed['sealed_at']}", highlight=False)
        for what in ("truths", "studies"):
            console.print(f"{what:9} sha256 {sealed[what]}", highlight=False)
        return sealed

    def _said(self, name: str) -> dict[str, Any]:
        path = self.out / "diagnoses" / f"{name}.json"
        if not path.is_file():
            raise CampaignError(f"{path}: no diagnosis yet; run the stage diagnose first")
        said = json.loads(path.read_text())
        seen = [each for each in said["elsewhere"] if Path(each).is_relative_to(self.out)]
        if seen:
            raise CampaignError(f"{name}: its diagnosis opened {seen[0]}: nothing is scored")
        return dict(said)
