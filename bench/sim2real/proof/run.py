"""A run of the proof: what its worlds are, and what is printed and stored of the scores."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd

from bench.common.commands import BUILD, console, show
from bench.common.digests import digest_of_files
from bench.common.provenance import provenance
from bench.common.whole_files import write_text, write_whole
from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.sealed import Room, SealedRun, append_record, record
from bench.sim2real.proof import confusion, failures, true_model
from bench.sim2real.proof.plan import Plan
from bench.sim2real.proof.reach import scores_of
from bench.sim2real.proof.score import score
from bench.sim2real.proof.tables import all_tables, notes_of
from bench.sim2real.proof.true_model import refit

HERE = Path(__file__).parent
RECORD = HERE / "record.jsonl"  # every run of the proof's seeds, bad ones too


WORLDS = HERE.parent / "concealed"
ROOM = Room(
    schema="pdoik.proof.seal/1",
    make_study=make_study,
    spec=WorldSpec,
    generators=[path for path in WORLDS.glob("*.py") if path.name != "score.py"],
    scorers=[
        *(path for path in HERE.glob("*.py") if not path.name.startswith("peers_")),
        WORLDS / "score.py",
    ],
)


@dataclass(kw_only=True)
class Run(SealedRun):
    """One folder, one plan."""

    plan: Plan
    room: str = __name__

    def conceal(self) -> bool:
        made = super().conceal()
        if made and self.plan.proof:
            append_record(RECORD, record_line("sealed", self.seal()))
        return made

    def diagnose(self, into: str = "diagnoses", stage: str = "diagnose") -> None:
        for when in self._earlier(self._told()):
            console.print(f"[bold]this tool was run on these seeds before: {when}[/]")
        super().diagnose(into, stage)

    def score(self) -> None:
        """Opens the truths, if they are those that were sealed, and scores what was said."""
        sealed, both = self._told(), self.opened()
        console.print("the truths are those that were sealed")
        decoy = {
            n: ":" in spec.effect or spec.effect == "still" for n, spec in self.plan.specs.items()
        }
        jobs = {name: {"out": str(self.out), "name": name} for name in both if not decoy[name]}
        own = digest_of_files([("true_model.py", Path(true_model.__file__))])
        settings = {"tool": self.frozen["tool"], "truths": sealed["truths"], "own": own}
        true = self.stage(f"refit-{own[:8]}", settings, refit, jobs)
        left = dict(zip(true.name, map(json.loads, true.true), strict=True))
        rows = [score(name, *each, left.get(name, {})) for name, each in both.items()]
        studies = pd.DataFrame(rows).merge(true[["name", "why_not"]], on="name", how="left")
        self._write(studies, sealed)

    def _write(self, studies: pd.DataFrame, sealed: Mapping[str, Any]) -> None:
        write_whole(
            self.out / "studies.parquet",
            lambda path: studies.to_parquet(path, index=False, compression="zstd"),
        )
        confusion.draw(studies, self.out / "confusion.png")
        count = failures.write_pages(studies, self.out / "failures")
        tables = all_tables(studies, notes_of(studies))
        write_text(self.out / "tables.md", f"# The proof\n\n{self.head(sealed)}\n{tables}")
        if self.plan.proof:
            append_record(RECORD, scored_line(sealed, self.frozen["scoring"], studies))
        show(tables)
        console.print(f"tables: {self.out}/tables.md; {count} failures: {self.out}/failures")

    def head(self, sealed: Mapping[str, Any]) -> str:
        """Provenance, digests and seal; other code than was frozen is said."""
        kind = "the proof's" if self.plan.proof else "development's: these figures prove nothing"
        specs = [self.plan.specs[name] for name in sealed["not_made"]]
        facts = {
            **provenance(BUILD),
            "studies": f"{sealed['count']}, seeds {kind}, first {self.plan.seed}",
            "worlds that could not be made": ", ".join(
                f"{each.seed} {each.effect} {each.hide}" for each in specs
            )
            or "none",
            "sealed at": sealed["sealed_at"],
            "seal of the truths": sealed["truths"],
            "seal of the studies": sealed["studies"],
            **{f"digest of the {name}": each for name, each in sealed["digests"].items()},
        }
        if sealed["digests"]["scoring"] != self.frozen["scoring"]:
            facts["scored by other code than was frozen"] = self.frozen["scoring"]
        for when in self._earlier(sealed):
            facts["this tool ran on these seeds before"] = when
        return "".join(f"- {name}: {value}\n" for name, value in facts.items())

    def _told(self) -> dict[str, Any]:
        sealed = self.seal()
        console.print(f"sealed {sealed['sealed_at']}", highlight=False)
        for what in ("truths", "studies"):
            console.print(f"{what:9} sha256 {sealed[what]}", highlight=False)
        return sealed

    def _earlier(self, sealed: Mapping[str, Any]) -> Iterable[str]:
        return earlier_runs(sealed, RECORD) if self.plan.proof else ()


def record_line(event: str, seal: Mapping[str, Any]) -> dict[str, Any]:
    """That a run began: it is kept even where it is never scored."""
    kept = ("sealed_at", "seed", "count", "truths", "studies", "digests")
    return {"event": event, "pdoik": version("pdoik"), **{key: seal[key] for key in kept}}


def scored_line(seal: Mapping[str, Any], scoring: str, studies: pd.DataFrame) -> dict[str, Any]:
    """That it was scored, by which code, and how it came out."""
    counts = {str(name): int(count) for name, count in studies.group.value_counts().items()}
    return {
        **record_line("scored", seal),
        "scored_by": scoring,
        "counts": counts,
        "wrong": int((~studies.right).sum()),
        "scores": scores_of(studies),
    }


def earlier_runs(seal: Mapping[str, Any], path: Path) -> list[str]:
    """When this same tool was run on these seeds before, in other runs than this one."""
    return [
        f"{old['date']} ({old['event']})"
        for old in record(path)
        if old["seed"] == seal["seed"]
        and old["digests"]["tool"] == seal["digests"]["tool"]
        and old["sealed_at"] != seal["sealed_at"]
    ]
