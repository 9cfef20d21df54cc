"""Other ways to name a fault, and ours with single stages switched off, on the same worlds.

    python -m bench.sim2real.machines --out build/bench/dev --seed 0 --count 60 --only conceal
    python -m bench.sim2real.machines.rivals --worlds build/bench/machines-dev

What each says of a world is kept in WORLDS/rivals/METHOD/; a run goes on where it was stopped.
"""

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
from bench.common.sealed import SEALED, STUDIES
from bench.common.whole_files import write_text
from bench.sim2real.machines.regression import named_by_regression, named_stepwise
from bench.sim2real.machines.score import score
from bench.sim2real.machines.tables import summary
from bench.sim2real.machines.worlds import Worlds
from pdoik import PdoikError
from pdoik.sim2real import diagnose
from pdoik.sim2real.thresholds import Thresholds

Method = Callable[[Path], dict[str, Any]]

OFF: dict[str, tuple[str, float]] = {
    "no first search beside the background": ("background.peculiar", 1e9),
    "what looks peculiar not held against the background": ("background.stands_t", -1e9),
    "joints' friction not weighed as sets": ("search.better_set", 1e9),
    "left-out sessions not asked": ("confidence.suspected", 0.0),
    "the torque's scale not in the intervals": ("figures.torque_scale", 0.0),
}
"""What is switched off: by which threshold, and what it is set to."""


def _ours(study: Path, changed: dict[str, float]) -> dict[str, Any]:
    """The diagnosis as its file would have it, with other thresholds."""
    return dict(json.loads(diagnose(study, thresholds=Thresholds().changed(changed)).to_json()))


def _theirs(study: Path, method: Callable[[Path], list[dict[str, Any]]]) -> dict[str, Any]:
    return {"verdict": "", "joints": {}, "notes": [], "findings": method(study)}


_squares = {
    name: partial(_theirs, method=partial(named_by_regression, bodies=bodies))
    for name, bodies in (("friction free", False), ("bodies free too", True))
}
METHODS: dict[str, Method] = {
    "ours": partial(_ours, changed={}),
    **{f"least squares, {name}": method for name, method in _squares.items()},
    "our library, stepwise by BIC": partial(_theirs, method=named_stepwise),
    **{f"ours, {name}": partial(_ours, changed=dict([off])) for name, off in OFF.items()},
}
SHOWN = (
    *("fault named or listed, at its place", "the same, a relative counted"),
    *("precision of what is stated at 0.9", "precision of all findings"),
    *("friction found, joints", "its intervals hold", "nothing on top, a false name"),
    *("unnamed cause, no false name beside", "crashes, refusals"),
)


def main(
    worlds: Worlds,
    only: Annotated[list[str] | None, typer.Option(help="Repeatable; all methods else.")] = None,
    joints: Annotated[int, typer.Option(help="Leave out worlds of more joints than that.")] = 7,
) -> None:
    """Name, score, print."""
    with plain_errors():
        paths = sorted((worlds / SEALED).glob("*.json"))
        truths = {path.stem: json.loads(path.read_text()) for path in paths}
        truths = {n: t for n, t in truths.items() if len(t["background"]) <= joints}
        rows = []
        for name in only or METHODS:
            folder = worlds / "rivals" / name.replace(" ", "-").replace(",", "")
            folder.mkdir(parents=True, exist_ok=True)
            table = pd.DataFrame(
                [
                    score(world, truth, _said(METHODS[name], worlds, world, folder))
                    for world, truth in truths.items()
                ]
            )
            counts = summary(table)
            shares = [counts.get(what, (0.0, 0.0)) for what in SHOWN]
            said = [f"{part / of:.2f} ({part:.0f}/{of:.0f})" if of else "" for part, of in shares]
            rows.append([name, *said, f"{table.seconds.median():.1f}"])
            console.print(f"{name}: {len(table)} worlds")
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
