"""Command line: held-out motions of a run's worlds, replayed by the models that were diagnosed.

    python -m bench.sim2real.machines.replayed --worlds build/bench/machines [--tool DIGEST]

Each machine's own controller drives its model as it was told and with the findings. Errors are of
positions, against the machine's; beside them those of the machine itself on a day of mean friction.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer

from bench.common.commands import console, plain_errors, show
from bench.common.markdown import markdown_table
from bench.common.whole_files import write_text
from bench.sim2real.machines.replayed.replay import replays_of
from bench.sim2real.proof.conceal import SEALED, STUDIES


def main(
    worlds: Annotated[Path, typer.Option(help="Folder of a run of bench.sim2real.machines.")],
    tool: Annotated[str, typer.Option(help="First letters of the digest of the tool.")] = "",
    most: Annotated[int, typer.Option(help="Worlds, the first ones.")] = 10_000,
) -> None:
    """Replay what is missing, print."""
    with plain_errors():
        (said,) = worlds.glob(f"said-{tool}*")
        kept = worlds / f"replayed-{said.name.removeprefix('said-')}"
        kept.mkdir(exist_ok=True)
        rows = []
        for path in sorted((worlds / SEALED).glob("*.json"))[:most]:
            if not (kept / path.name).exists():
                _replay(worlds, said, kept, path)
            rows += json.loads((kept / path.name).read_text())
        show(_table(pd.DataFrame(rows)))


def _replay(worlds: Path, said: Path, kept: Path, path: Path) -> None:
    told = json.loads((said / path.name).read_text()).get("diagnosis")
    study = worlds / STUDIES / path.stem / "study.yaml"
    truth = json.loads(path.read_text())
    rows = [] if told is None else replays_of(path.stem, study, truth, json.dumps(told))
    write_text(kept / path.name, json.dumps([asdict(row) for row in rows]))
    console.print(path.stem)


def _table(table: pd.DataFrame) -> str:
    moved = table[table.moved > 0.01]
    rows = []
    for what, part in (
        ("without a fault", moved[~moved.faulty]),
        ("faulty", moved[moved.faulty]),
    ):
        ran = part.dropna()
        better = ran.after / ran.before
        rows.append(
            [
                what,
                str(len(part)),
                str(int(part.before.isna().sum())),
                str(int(part.after.isna().sum())),
                *(f"{1e3 * ran[name].median():.2f}" for name in ("before", "after", "another_day")),
                f"{better.median():.2f}",
                f"{better.quantile(0.9):.2f}",
                f"{(better < 1.0).mean():.2f}",
            ]
        )
    header = ["joints", "number", "ran away as told", "ran away as diagnosed"]
    header += ["as told, median [mrad]", "as diagnosed [mrad]", "the machine, another day [mrad]"]
    header += ["after over before, median", "nine of ten below", "better"]
    return markdown_table(header, rows)


if __name__ == "__main__":
    typer.run(main)
