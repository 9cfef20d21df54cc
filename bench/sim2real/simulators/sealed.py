"""`pdoik compare` on machines that have what its user's simulator has no words for, sealed first.

Run from the root:

    python -m bench.sim2real.simulators.sealed --out build/bench/simulators_sealed --pairs 44

The first seed is drawn by the system where none is given. seal.json is written before anything is
compared: the digests of that seed, of the generator, of the tool and of what scores. Then each pair
is made (worlds.py), compared by its folder alone, and its answer held against what
was said. Finished pairs are kept, and the same command goes on where it was stopped; with another
tool, generator or seed it refuses.
"""

import json
import secrets
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from bench.common.campaign import CampaignError
from bench.common.commands import BUILD, console, plain_errors, show, write_report
from bench.common.digests import digest_of, digest_of_files, tool_digest
from bench.common.whole_files import write_text
from bench.sim2real.proof.run import generator_digest
from bench.sim2real.simulators.scores import tables
from bench.sim2real.simulators.worlds import Job, jobs_of, make
from pdoik.sim2real.simulators import compare
from pdoik.sim2real.simulators.findings import Step

STUDIES, ANSWERS, SAID = "studies", "answers", "said"


def main(
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = BUILD / "simulators_sealed",
    pairs: Annotated[int, typer.Option(min=1, help="How many.")] = 44,
    first: Annotated[
        int | None, typer.Option(help="First seed, below 10000 for development; else drawn.")
    ] = None,
    table: Annotated[
        bool, typer.Option("--table", help="Of what is there; no pair is made.")
    ] = False,
) -> None:
    """Seal, make, compare, score what is there."""
    with plain_errors():
        seal = sealed(out, pairs, first)
        for job in () if table else jobs_of(int(seal["seed"]), pairs):
            path = out / SAID / f"{job.name}.json"
            if not path.is_file():
                write_text(path, json.dumps(_said(out, job), indent=1) + "\n")
                console.print(f"{job.name} {job.effect} {job.background}", highlight=False)
    names = sorted(path.stem for path in (out / ANSWERS).glob("*.json"))
    names = [name for name in names if (out / SAID / f"{name}.json").is_file()]
    text = tables(
        [json.loads((out / ANSWERS / f"{name}.json").read_text()) for name in names],
        [json.loads((out / SAID / f"{name}.json").read_text()) for name in names],
    )
    write_report(out / "tables.md", text, seal)
    show(text)


def sealed(out: Path, pairs: int, first: int | None) -> dict[str, Any]:
    """What is frozen: written where there is nothing, and else what was written."""
    path = out / "seal.json"
    old = json.loads(path.read_text()) if path.is_file() else None
    seed = first if first is not None else 1_000_000 + secrets.randbelow(2**31)
    if old is not None:
        seed = int(old["seed"])
    here = Path(__file__).parent
    seal = {
        "seed": seed,
        "digest of the seed": digest_of(seed),
        "pairs": pairs,
        "tool": tool_digest(),
        "generator": digest_of(
            [generator_digest(), digest_of_files([("worlds", here / "worlds.py")])]
        ),
        "scoring": digest_of_files([("scores", here / "scores.py")]),
    }
    if old is None:
        for name in (STUDIES, ANSWERS, SAID):
            (out / name).mkdir(parents=True, exist_ok=True)
        write_text(path, json.dumps(seal, indent=1) + "\n")
        console.print(json.dumps(seal, indent=1), highlight=False)
        return seal
    changed = [key for key in seal if key != "pairs" and seal[key] != old[key]]
    if changed:
        raise CampaignError(f"{out} was begun with another {' and '.join(changed)}")
    return seal


def _said(out: Path, job: Job) -> dict[str, Any]:
    """What is said of a pair that is made now."""
    folder = out / STUDIES / job.name
    try:
        make(job, folder, out / ANSWERS / f"{job.name}.json")
    except RuntimeError as error:
        return {"not made": str(error), "findings": []}
    return said_of(folder / "compare.yaml")


def said_of(study: Path) -> dict[str, Any]:
    """What a comparison says of a study: verdict, findings, errors."""
    try:
        step = compare(study).machine
    except (ValueError, RuntimeError) as error:
        return {"error": str(error), "findings": []}
    assert step is not None
    before, after = (
        float(np.sqrt(np.mean([getattr(fit, side) ** 2 for fit in step.joints.values()])))
        for side in ("before", "after")
    )
    return {
        "verdict": step.verdict,
        "before": before,
        "after": after,
        "findings": [_finding(step, k) for k in range(len(step.findings) + len(step.suspected))],
    }


def _finding(step: Step, k: int) -> dict[str, Any]:
    finding = (*step.findings, *step.suspected)[k]
    return {
        "effect": finding.effect,
        "joints": list(finding.joints),
        "links": list(finding.links),
        "claimed": k < len(step.findings),
        "confidence": finding.confidence,
        "gain": finding.evidence.validation_gain,
        "values": {name: each.value for name, each in finding.parameters.items()},
        "intervals": {name: list(each.interval95) for name, each in finding.parameters.items()},
        "equivalents": [
            {"effect": each.effect, "joints": list(each.joints), "links": list(each.links)}
            for each in finding.equivalents
        ],
    }


if __name__ == "__main__":
    typer.run(main)
