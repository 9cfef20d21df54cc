"""What each part of the diagnosis brings: the same worlds with one part switched off at a time.

    python -m bench.sim2real.machines --out build/bench/machines-dev --seed 0 --count 30
    python -m bench.sim2real.machines.ablations --worlds build/bench/machines-dev --joints 3

With --before, the search of another checkout as well; and other methods. Each diagnosis is a
process of its own. What was said is kept in WORLDS/ablations/TOOL/VARIANT; a run goes on where it
was stopped.
"""

import json
import os
import resource
import time
from collections.abc import Mapping
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from typing import Annotated, Any

import pandas as pd
import typer

from bench.common.campaign import CampaignError
from bench.common.commands import console, plain_errors, show
from bench.common.digests import digest_of_folder, tool_digest
from bench.common.markdown import markdown_table
from bench.common.whole_files import write_text
from bench.sim2real.frame.blind import STOPPED, THREADS, blind
from bench.sim2real.frame.sealed import SEALED, STUDIES
from bench.sim2real.machines.score import Content, score
from bench.sim2real.machines.tables import summary
from bench.sim2real.machines.variants import BEFORE, VARIANTS, switched_off
from bench.sim2real.machines.worlds import Worlds
from pdoik import PdoikError

DEVELOPMENT = 100_000  # worlds of larger seeds are for proofs
LONGEST = 3600.0  # of one diagnosis, while other work runs [s]
SHOWN = (
    *("fault named or listed, at its place", "the same, a relative counted"),
    *("precision of what is stated at 0.9", "precision of all findings"),
    *("friction found, joints", "its intervals hold", "nothing on top, a false name"),
    "crashes, refusals",
)


def main(
    worlds: Worlds,
    joints: Annotated[int, typer.Option(help="Leave out worlds of more joints than that.")] = 3,
    only: Annotated[list[str] | None, typer.Option(help="Repeatable; all variants else.")] = None,
    before: Annotated[
        Path | None, typer.Option(help="Folder that holds the package pdoik of another checkout.")
    ] = None,
) -> None:
    """Diagnose with each part switched off, score, print."""
    with plain_errors():
        truths = _truths(worlds, joints)
        os.environ.update(dict.fromkeys(THREADS, "1"))  # of the processes that follow
        names = [name for name in only or VARIANTS if name != BEFORE or before is not None]
        if wrong := {*names} - {*VARIANTS}:
            raise CampaignError(f"no variant {min(wrong)!r}; expected one of {', '.join(VARIANTS)}")
        rows = []
        for name in names:
            tool = before.resolve() if before is not None and name == BEFORE else None
            said = {world: _said(name, worlds, world, tool) for world in truths}
            rows.append([name, *_row(truths, said)])
            console.print(f"{name}: {VARIANTS[name].says} {len(said)} worlds.", highlight=False)
        show(markdown_table(["variant", *SHOWN, "seconds of a processor, median"], rows))


def _truths(worlds: Path, joints: int) -> dict[str, dict[str, Any]]:
    """Truths of the worlds of so many joints.

    Raises:
        CampaignError: there is none, or worlds that are a proof's.
    """
    paths = sorted((worlds / SEALED).glob("*.json"))
    truths = {path.stem: json.loads(path.read_text()) for path in paths}
    if any(truth["spec"]["seed"] >= DEVELOPMENT for truth in truths.values()):
        raise CampaignError(f"{worlds}: these worlds are a proof's; expected development's")
    few = {name: truth for name, truth in truths.items() if len(truth["background"]) <= joints}
    if not few:
        raise CampaignError(f"{worlds}: no worlds of up to {joints} joints")
    return few


def _row(truths: Mapping[str, Content], said: Mapping[str, Content]) -> list[str]:
    counts = summary(pd.DataFrame([score(world, truths[world], said[world]) for world in said]))
    shares = [counts.get(what, [0.0, 0.0]) for what in SHOWN]
    shown = [f"{part / of:.2f} ({part:.0f}/{of:.0f})" if of else "" for part, of in shares]
    seconds = [each["processor_seconds"] for each in said.values() if "processor_seconds" in each]
    return [*shown, f"{median(seconds):.1f}" if seconds else ""]


def _said(name: str, worlds: Path, world: str, tool: Path | None) -> dict[str, Any]:
    """What was said of a world, now or by an earlier run of the same tool."""
    digest = tool_digest() if tool is None else digest_of_folder(tool / "pdoik" / "sim2real")
    folder = worlds / "ablations" / digest[:12] / name.replace(",", "").replace(" ", "-")
    path, study = folder / f"{world}.json", worlds / STUDIES / world
    if not path.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        if tool is None:
            _in_a_process(name, study, path)
        else:
            write_text(path, json.dumps(blind(study, LONGEST, tool)) + "\n")
    return dict(json.loads(path.read_text()))


def _in_a_process(name: str, study: Path, path: Path) -> None:
    """Nothing that a variant replaces outlives its process; one that dies is an answer too."""
    begin = time.perf_counter()
    process = get_context("spawn").Process(target=_diagnose, args=(name, study, path))
    process.start()
    process.join(LONGEST)
    if process.is_alive():
        process.kill()
        process.join()
    if process.exitcode in STOPPED:
        raise RuntimeError("a diagnosis was stopped from outside")
    if not path.is_file():
        ended = {"error": f"no answer: status {process.exitcode}"}
        write_text(path, json.dumps(ended | {"seconds": time.perf_counter() - begin}) + "\n")


def _diagnose(name: str, study: Path, path: Path) -> None:
    begin, used = time.perf_counter(), time.process_time()
    try:
        said: dict[str, Any] = {"diagnosis": switched_off(name, study / "study.yaml")}
    except (PdoikError, ValueError) as error:
        said = {"error": f"{type(error).__name__}: {error}"}
    said["seconds"] = time.perf_counter() - begin
    said["processor_seconds"] = time.process_time() - used
    said["peak_gib"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    write_text(path, json.dumps(said) + "\n")


if __name__ == "__main__":
    typer.run(main)
