"""Command line: other methods, and ours with stages switched off, on worlds that were made before.

    python -m bench.sim2real.machines --out build/bench/dev --seed 0 --count 60 --only conceal
    python -m bench.sim2real.machines.rivals --worlds build/bench/machines-dev

What each says of a world is kept in WORLDS/rivals/METHOD/; a run goes on where it was stopped.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer

from bench.common.commands import console, plain_errors, show
from bench.common.markdown import markdown_table
from bench.common.whole_files import write_text
from bench.sim2real.machines.rivals.ablations import OFF, diagnosed
from bench.sim2real.machines.rivals.regression import named_by_regression
from bench.sim2real.machines.rivals.stepwise import named_stepwise
from bench.sim2real.machines.score import score
from bench.sim2real.machines.tables import summary
from bench.sim2real.proof.conceal import SEALED, STUDIES
from pdoik import PdoikError

Method = Callable[[Path], dict[str, Any]]


def _findings(method: Callable[[Path], list[dict[str, Any]]], study: Path) -> dict[str, Any]:
    return {"verdict": "", "joints": {}, "notes": [], "findings": method(study)}


METHODS: dict[str, Method] = {
    "ours": partial(diagnosed, changed={}),
    "least squares, friction free": partial(_findings, partial(named_by_regression, bodies=False)),
    "least squares, bodies free too": partial(_findings, partial(named_by_regression, bodies=True)),
    "our library, stepwise by BIC": partial(_findings, named_stepwise),
    **{f"ours, {name}": partial(diagnosed, changed=dict([off])) for name, off in OFF.items()},
}


SHOWN = (
    "fault named or listed, at its place",
    "the same, a relative counted",
    "precision of what is stated at 0.9",
    "precision of all findings",
    "friction found, joints",
    "its intervals hold",
    "nothing on top, a false name",
    "unnamed cause, no false name beside",
    "crashes, refusals",
)


def _share(part: float, whole: float) -> str:
    return f"{part / whole:.2f} ({part:.0f}/{whole:.0f})" if whole else ""


def main(
    worlds: Annotated[Path, typer.Option(help="Folder of a run of bench.sim2real.machines.")],
    only: Annotated[list[str] | None, typer.Option(help="Repeatable; all methods else.")] = None,
    joints: Annotated[int, typer.Option(help="Leave out worlds of more joints than that.")] = 7,
) -> None:
    """Name, score, print."""
    with plain_errors():
        truths = {
            path.stem: json.loads(path.read_text())
            for path in sorted((worlds / SEALED).glob("*.json"))
        }
        truths = {n: t for n, t in truths.items() if len(t["background"]) <= joints}
        rows = []
        for name in only or METHODS:
            folder = worlds / "rivals" / name.replace(" ", "-").replace(",", "")
            folder.mkdir(parents=True, exist_ok=True)
            scored = [
                score(world, truth, _said(METHODS[name], worlds, world, folder))
                for world, truth in truths.items()
            ]
            table = pd.DataFrame(scored)
            counts = summary(table)
            seconds = f"{table.seconds.median():.1f}"
            rows.append([name, *(_share(*counts.get(what, (0.0, 0.0))) for what in SHOWN), seconds])
            console.print(f"{name}: {len(scored)} worlds")
        show(markdown_table(["method", *SHOWN, "seconds"], rows))


def _said(method: Method, worlds: Path, world: str, folder: Path) -> dict[str, Any]:
    """What was said of a world, now or before."""
    path = folder / f"{world}.json"
    if path.is_file():
        return dict(json.loads(path.read_text()))
    begin = time.perf_counter()
    try:
        said: dict[str, Any] = {"diagnosis": method(worlds / STUDIES / world / "study.yaml")}
    except (PdoikError, ValueError) as error:
        said = {"error": f"{type(error).__name__}: {error}"}
    said["seconds"] = time.perf_counter() - begin
    write_text(path, json.dumps(said) + "\n")
    return said


if __name__ == "__main__":
    typer.run(main)
