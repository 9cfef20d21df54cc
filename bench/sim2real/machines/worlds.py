"""Worlds of a run with what was said of them, and how joints with and without a fault differ."""

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import pandas as pd
import typer

from bench.common.markdown import table_of
from bench.sim2real.frame.sealed import SEALED, STUDIES

Worlds = Annotated[Path, typer.Option(help="Folder of a run of bench.sim2real.machines.")]
Tool = Annotated[str, typer.Option(help="First letters of the digest of the tool.")]


class World(NamedTuple):
    """One world of a run."""

    name: str
    study: Path
    truth: dict[str, Any]
    said: dict[str, Any] | None  # as a diagnosis' file has it; None of a crash

    @property
    def faulty(self) -> set[str]:
        """Names of the joints that have a fault."""
        return {name for fault in self.truth["faults"] for name in fault["joints"]}


def worlds_of(run: Path, tool: str) -> Iterator[World]:
    """All worlds of a run, and what one tool said."""
    (folder,) = run.glob(f"said-{tool}*")
    for path in sorted((run / SEALED).glob("*.json")):
        said = json.loads((folder / path.name).read_text()).get("diagnosis")
        study = run / STUDIES / path.stem / "study.yaml"
        yield World(path.stem, study, json.loads(path.read_text()), said)


def joint_table(
    joints: pd.DataFrame, columns: Mapping[str, Callable[[pd.DataFrame], object]]
) -> str:
    """Joints without a fault, and faulty ones."""
    groups = {"without a fault": joints[~joints.faulty], "faulty": joints[joints.faulty]}
    return table_of("joints", groups.items(), {"number": len, **columns})
