"""Worlds made under neutral names, sealed, diagnosed blind, and only then scored.

Studies lie in one folder, their truths in another. The seal, digests of both, is written before
anything is diagnosed; each stage goes on where it was stopped.
"""

from __future__ import annotations

import importlib
import json
import shutil
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import Any, ClassVar

import pandas as pd

from bench.common.campaign import CampaignError, Job, Row
from bench.common.commands import console, run_campaign, show, write_report
from bench.common.digests import digest_of, digest_of_files, digest_of_folder, tool_digest
from bench.common.whole_files import write_text
from bench.sim2real.frame.blind import LONGEST, diagnose

HERE = Path(__file__).parent
STUDIES, SEALED = "studies", "sealed"
FROZEN, SEAL = "frozen.json", "seal.json"
Stage = StrEnum("Stage", {name.upper(): name for name in ("conceal", "diagnose", "score")})
GENERATORS = ("arm.py", "motion.py", "robots.py", "streams.py", "study_files.py")
SCORERS = ("blind.py", "one.py", "score.py")
Tables = Callable[[pd.DataFrame, Sequence[str]], str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """One kind of worlds: what makes them, and what scores what is said of them.

    A module has it as ROOM, so that workers find it by the module's name.
    """

    schema: str  # of the seal
    make_study: Callable[..., Any]  # of the study's folder, its spec and the truth's folder
    spec: type  # what a world is asked to be; fields that JSON can hold
    generators: Sequence[Path]  # the files that decide what a world is
    scorers: Sequence[Path]  # the files that turn truths and diagnoses into scores
    longest: float = LONGEST  # that a diagnosis may take [s]
    score: Callable[[str, Any, Any], Row] | None = None  # a row of a name, a truth, what was said
    tables: Tables | None = None  # of the rows, and the names of worlds that could not be made
    summary: Callable[[pd.DataFrame], Any] | None = None  # what a record keeps of the rows
    record: Path | None = None  # of runs of the proof's seeds
    first_proof_seed: int = 0

    @classmethod
    def of(cls, module: str) -> Room:
        room: Room = importlib.import_module(module).ROOM
        return room

    def generator(self) -> str:
        """A digest of all that decides what a world is, the frame's files too."""
        return _digest((*self.generators, *(HERE / name for name in GENERATORS)))

    def scoring(self) -> str:
        """A digest of all that decides a score."""
        return _digest((*self.scorers, *(HERE / name for name in SCORERS)))


def _digest(files: Iterable[Path]) -> str:
    return digest_of_files((f"{path.parent.name}/{path.name}", path) for path in files)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """The worlds of one run by their neutral names."""

    seed: int
    specs: dict[str, Any]  # dataclasses, in the order of the names, which tells nothing

    def facts(self) -> dict[str, Any]:
        """All that the plan fixes before anything is made."""
        return {"seed": self.seed, "specs": {n: asdict(spec) for n, spec in self.specs.items()}}

    def digest(self) -> str:
        return digest_of(self.facts())


def conceal(job: Job) -> list[Row]:
    """One study and its truth; neither is there before both are whole.

    A world that cannot be made is a row that says so.

    Raises:
        RuntimeError: the generator on this worker is not the frozen one.
    """
    room = Room.of(job["room"])
    if room.generator() != job["generator"]:
        raise RuntimeError("the generator of these worlds is not the one that was frozen here")
    out, name = Path(job["out"]), str(job["name"])
    study, truth = out / STUDIES / name, out / SEALED / f"{name}.json"
    with tempfile.TemporaryDirectory(prefix=".making-", dir=out) as folder:
        made = Path(folder)
        try:
            room.make_study(made / name, room.spec(**job["spec"]), made / SEALED)
        except RuntimeError as error:
            return [{"name": name, "study": "", "not_made": str(error)}]
        digest = digest_of_folder(made / name)
        for parent in (study.parent, truth.parent):
            parent.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(study, ignore_errors=True)  # of a run that was stopped in between
        (made / name).rename(study)
        (made / SEALED / truth.name).replace(truth)
    return [{"name": name, "study": digest, "not_made": ""}]


def seals(out: Path, names: Iterable[str]) -> dict[str, str]:
    """Digests of the truths and of the studies as they lie there.

    Raises:
        CampaignError: there are other truths or studies than these.
    """
    names = sorted(names)
    for folder in (SEALED, STUDIES):
        there = sorted(path.name.removesuffix(".json") for path in (out / folder).glob("*"))
        if there != names:
            wrong = sorted({*there} ^ {*names})
            raise CampaignError(f"{out / folder}: not the plan's studies ({', '.join(wrong[:5])})")
    truths = digest_of_files((f"{name}.json", out / SEALED / f"{name}.json") for name in names)
    return {"truths": truths, "studies": digest_of_folder(out / STUDIES)}


@dataclass(kw_only=True)
class SealedRun:
    """One folder, one plan."""

    out: Path
    plan: Plan
    room: str  # the module that has ROOM
    scheduler: str | None = None
    workers: int | None = None
    frozen: dict[str, str] = field(default_factory=dict)

    fixed: ClassVar[tuple[str, ...]] = ("tool", "generator", "plan")  # for good, of a folder

    def run(self, only: Iterable[Stage] | None = None) -> None:
        """Freezes what decides, then goes through the stages, or some of them."""
        stages = [stage for stage in Stage if stage in (only or Stage)]
        self.freeze(anew=Stage.CONCEAL in stages)
        for stage in stages:
            getattr(self, stage)()

    def freeze(self, *, anew: bool = True) -> None:
        """Prints and stores the digests of all that decides the scores.

        Args:
            anew: whether worlds may be made; if not, what made those that are there may be other.

        Raises:
            CampaignError: the folder was begun with another tool, generator or plan.
        """
        self.out.mkdir(parents=True, exist_ok=True)
        room = Room.of(self.room)
        self.frozen = {
            "tool": tool_digest(),
            "generator": room.generator(),
            "scoring": room.scoring(),
            "plan": self.plan.digest(),
        }
        path = self.out / FROZEN
        if path.is_file():
            old = json.loads(path.read_text())["digests"]
            changed = [key for key in self.fixed if old[key] != self.frozen[key]]
            if changed and anew:
                raise CampaignError(
                    f"{self.out} was begun with another {' and '.join(changed)}: choose another"
                    " --out, or remove it"
                )
        else:
            content = {"digests": self.frozen, "plan": self.plan.facts()}
            write_text(path, json.dumps(content, indent=1) + "\n")
        for name, digest in self.frozen.items():
            console.print(f"{name:9} sha256 {digest}", highlight=False)

    def stage(
        self,
        name: str,
        settings: Mapping[str, Any],
        function: Callable[[Job], list[Row]],
        jobs: Mapping[str, Job],
    ) -> pd.DataFrame:
        """All rows of a stage, run where they are not there yet."""
        console.print(f"[bold]{name}[/]", highlight=False)
        folder = self.out / name
        return run_campaign(folder, settings, function, jobs, self.scheduler, self.workers)

    def conceal(self) -> bool:
        """Makes the worlds and seals them; False where they are sealed already."""
        if (self.out / SEAL).is_file():
            return False
        common = {"out": str(self.out), "generator": self.frozen["generator"], "room": self.room}
        jobs = {  # in the names' order, so that no file's time tells what is in it
            name: {**common, "name": name, "spec": asdict(spec)}
            for name, spec in sorted(self.plan.specs.items())
        }
        settings = {key: self.frozen[key] for key in ("generator", "plan")}
        rows = self.stage("conceal", settings, conceal, jobs)
        self.write_seal(rows.name[rows.not_made != ""])
        return True

    def write_seal(self, not_made: Iterable[str] = ()) -> dict[str, Any]:
        """What was sealed, kept in the run's folder, and the plan's worlds that were not made."""
        missing = sorted(not_made)
        there = [name for name in self.plan.specs if name not in missing]
        seal = {
            "schema": Room.of(self.room).schema,
            "sealed_at": datetime.now(UTC).isoformat(timespec="seconds"),
            "seed": self.plan.seed,
            "count": len(there),
            "not_made": missing,
            **seals(self.out, there),
            "digests": self.frozen,
        }
        write_text(self.out / SEAL, json.dumps(seal, indent=1) + "\n")
        return seal

    def seal(self) -> dict[str, Any]:
        """As it was written.

        Raises:
            CampaignError: nothing was sealed.
        """
        path = self.out / SEAL
        if not path.is_file():
            raise CampaignError(f"{self.out}: nothing was sealed yet; run the stage conceal first")
        return dict(json.loads(path.read_text()))

    def names(self) -> list[str]:
        """The studies that were sealed."""
        return sorted({*self.plan.specs} - {*self.seal()["not_made"]})

    def diagnose(self, into: str = "diagnoses", stage: str = "diagnose") -> None:
        """Diagnoses every study blind, and keeps what was said in a folder."""
        seal, tool = self.seal(), self.frozen["tool"]
        jobs = {
            name: {
                "name": name,
                "study": str(self.out / STUDIES / name),
                "tool": tool,
                "longest": Room.of(self.room).longest,
            }
            for name in self.names()
        }
        settings = {"tool": tool, "studies": seal["studies"]}
        rows = self.stage(stage, settings, diagnose, jobs)
        (self.out / into).mkdir(exist_ok=True)
        for row in rows.itertuples():
            write_text(self.out / into / f"{row.name}.json", row.said)

    def opened(self, folder: str = "diagnoses") -> dict[str, tuple[dict[str, Any], dict[str, Any]]]:
        """Each study's truth, if it is the one that was sealed, and what was said of it.

        Raises:
            CampaignError: they are others, or a diagnosis is missing or has seen a truth.
        """
        seal, names = self.seal(), self.names()
        for what, digest in seals(self.out, names).items():
            if digest != seal[what]:
                raise CampaignError(
                    f"{self.out}: the {what} are not those that were sealed"
                    f" (sealed {seal[what][:16]}, found {digest[:16]}): nothing is scored"
                )
        both = {}
        for name in names:
            path = self.out / folder / f"{name}.json"
            if not path.is_file():
                raise CampaignError(f"{path}: no diagnosis yet; run the stage diagnose first")
            said = json.loads(path.read_text())
            seen = [each for each in said["elsewhere"] if Path(each).is_relative_to(self.out)]
            if seen:
                raise CampaignError(f"{name}: its diagnosis opened {seen[0]}: nothing is scored")
            both[name] = json.loads((self.out / SEALED / f"{name}.json").read_text()), said
        return both


@dataclass(kw_only=True)
class ToolsRun(SealedRun):
    """Other tools may be run on the same worlds: what each said is kept by its digest."""

    fixed: ClassVar[tuple[str, ...]] = ("generator", "plan")

    @property
    def short(self) -> str:
        """First digits of the tool's digest."""
        return self.frozen["tool"][:12]

    def diagnose(self, into: str = "", stage: str = "") -> None:
        super().diagnose(into or f"said-{self.short}", stage or f"diagnose-{self.short}")

    def score(self) -> None:
        """Opens the truths, if they are those that were sealed, and scores what was said."""
        room = Room.of(self.room)
        assert room.score is not None
        assert room.tables is not None
        seal, both = self.seal(), self.opened(f"said-{self.short}")
        worlds = pd.DataFrame([room.score(name, *each) for name, each in both.items()])
        path = self.out / f"worlds-{self.short}"
        worlds.to_parquet(path.with_suffix(".parquet"), index=False, compression="zstd")
        tables = room.tables(worlds, seal["not_made"])
        digests = {**seal["digests"], "tool": self.frozen["tool"]}
        head = {"sealed at": seal["sealed_at"], **digests, "worlds": len(worlds)}
        report = self.out / f"tables-{self.short}.md"
        write_report(report, tables, head)
        if room.record is not None and self.plan.seed >= room.first_proof_seed:
            kept = ("sealed_at", "seed", "count", "truths", "studies")
            line = {key: seal[key] for key in kept}
            line["digests"] = {**digests, "scoring": room.scoring()}
            append_record(room.record, {**line, "scores": room.summary and room.summary(worlds)})
        show(tables)
        console.print(f"tables: {report}")


def append_record(path: Path, line: Mapping[str, Any]) -> bool:
    """Adds a line to a record of runs unless it is there but for its date; whether it did."""
    bare = dict(line)
    if any({k: v for k, v in old.items() if k != "date"} == bare for old in record(path)):
        return False
    date = datetime.now(UTC).isoformat(timespec="seconds")
    with path.open("a") as file:
        file.write(json.dumps({"date": date, **bare}) + "\n")
    return True


def record(path: Path) -> list[dict[str, Any]]:
    """All lines of a record, the oldest first."""
    if not path.is_file():
        return []
    return [json.loads(line) for line in path.read_text().splitlines() if line.strip()]
