"""`pdoik compare` on machines that have what its user's simulator has no words for, sealed first.

Run from the root:

    python -m bench.simulators_sealed --out build/bench/simulators_sealed --pairs 44

Studies and answers are made first (bench/simulator_worlds.py) and their digests are written to
seal.json, with that of the tool. Then every study is compared, by its folder alone; then the
answers are held against what was said, if their digests are still those. Finished pairs are kept,
and the same command goes on where it was stopped. The first seed is drawn by the system where none
is given, and is told only in seal.json.
"""

from __future__ import annotations

import json
import secrets
import sys
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

sys.path.append(str(Path(__file__).parent))  # the other experiments go by plain names

from bench.proof.digests import digest_of_folder, tool_digest
from bench.simulator_worlds import jobs_of, make

from campaign_cli import BUILD, console, show
from pdoik.sim2real.simulators import compare
from pdoik.sim2real.simulators.findings import Step
from simulator_scores import tables
from whole_files import write_text

STUDIES, ANSWERS, SAID = "studies", "answers", "said"


def main(
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = BUILD / "simulators_sealed",
    pairs: Annotated[int, typer.Option(min=1, help="How many.")] = 44,
    first: Annotated[
        int | None, typer.Option(help="First seed, below 10000 for development; else drawn.")
    ] = None,
) -> None:
    """Make and seal, compare, score what is there."""
    seal = sealed(out, pairs, first)
    for folder in sorted((out / STUDIES).iterdir()):
        path = out / SAID / f"{folder.name}.json"
        if not path.is_file():
            write_text(path, json.dumps(said_of(folder / "compare.yaml"), indent=1) + "\n")
            console.print(f"{folder.name} compared", highlight=False)
    if _digests(out) != seal["digests"]:
        raise typer.Exit(f"{out}: studies or answers are not those that were sealed")
    names = sorted(path.stem for path in (out / SAID).glob("*.json"))
    text = tables(
        [json.loads((out / ANSWERS / f"{name}.json").read_text()) for name in names],
        [json.loads((out / SAID / f"{name}.json").read_text()) for name in names],
    )
    facts = "".join(f"- {key}: {value}\n" for key, value in seal.items())
    write_text(out / "tables.md", f"{facts}\n{text}")
    show(text)


def sealed(out: Path, pairs: int, first: int | None) -> dict[str, Any]:
    """The seal of the studies there, which are made where there are none."""
    path = out / "seal.json"
    if path.is_file():
        return dict(json.loads(path.read_text()))
    seed = first if first is not None else 1_000_000 + secrets.randbelow(2**31)
    for name in (STUDIES, ANSWERS, SAID):
        (out / name).mkdir(parents=True, exist_ok=True)
    left_out = []
    for job in jobs_of(seed, pairs):
        answer = out / ANSWERS / f"{job.name}.json"
        if answer.is_file():
            continue
        try:
            make(job, out / STUDIES / job.name, answer)
        except RuntimeError as error:
            left_out.append(str(error))
    seal = {
        "seed": seed,
        "pairs": pairs,
        "not made": left_out,
        "tool": tool_digest(),
        "digests": _digests(out),
    }
    write_text(path, json.dumps(seal, indent=1) + "\n")
    return seal


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


def _digests(out: Path) -> dict[str, str]:
    return {name: digest_of_folder(out / name) for name in (STUDIES, ANSWERS)}


if __name__ == "__main__":
    typer.run(main)
