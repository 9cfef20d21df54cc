"""Stages of a run: worlds are made and sealed, diagnosed blind, scored."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import pandas as pd

from bench.common.commands import BUILD, console, show
from bench.common.digests import digest_of_files
from bench.common.provenance import provenance
from bench.common.sealed import Plan, SealedRun, append_record
from bench.common.whole_files import write_text
from bench.sim2real.machines.build import make_study
from bench.sim2real.machines.plan import FIRST_PROOF_SEED, WorldSpec, spec_of
from bench.sim2real.machines.score import score
from bench.sim2real.machines.tables import all_tables, summary

__all__ = ["Run", "WorldSpec", "generator_digest", "make_study", "plan", "scoring_digest"]

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


def plan(seed: int, count: int) -> Plan:
    """One row of seeds."""
    return Plan(seed=seed, specs={f"world{k:04d}": spec_of(seed + k) for k in range(count)})


@dataclass(kw_only=True)
class Run(SealedRun):
    """Another tool may be run on the same worlds: what was said is kept by the tool's digest."""

    room: ClassVar[str] = __name__
    schema: ClassVar[str] = "pdoik.machines.seal/1"
    fixed: ClassVar[tuple[str, ...]] = ("generator", "plan")

    def diagnose(self, into: str = "", stage: str = "") -> None:
        tool = self.frozen["tool"][:12]
        super().diagnose(into or f"said-{tool}", stage or f"diagnose-{tool}")

    def score(self) -> None:
        """Opens the truths, if they are those that were sealed, and scores what was said."""
        seal, tool = self.seal(), self.frozen["tool"]
        short = tool[:12]
        both = self.opened(f"said-{short}")
        worlds = pd.DataFrame([score(name, *each) for name, each in both.items()])
        worlds.to_parquet(self.out / f"worlds-{short}.parquet", index=False, compression="zstd")
        tables = all_tables(worlds)
        head = {**provenance(BUILD), **seal["digests"], "tool": tool, "worlds": len(worlds)}
        lines = "".join(f"- {name}: {value}\n" for name, value in head.items())
        write_text(self.out / f"tables-{short}.md", f"# Machines\n\n{lines}\n{tables}\n")
        if self.plan.seed >= FIRST_PROOF_SEED:
            kept = ("sealed_at", "seed", "count", "truths", "studies")
            digests = {**seal["digests"], "tool": tool, "scoring": scoring_digest()}
            line = {key: seal[key] for key in kept} | {"digests": digests}
            append_record(RECORD, {**line, "scores": summary(worlds)})
        show(tables)
        console.print(f"tables: {self.out}/tables-{short}.md")
