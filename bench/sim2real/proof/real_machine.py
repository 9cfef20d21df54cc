"""A real machine whose recordings may be there, and its study."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from bench.sim2real.proof.real_counts import Content, Fact, Told, crashed


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine whose recordings may be there."""

    name: str  # of the recordings' folder
    title: str
    withheld: str  # the physics that its model does not have
    doubtful: str  # what keeps these recordings from proving more
    known: dict[str, Fact]  # in words, and what a diagnosis says of it
    build: Callable[[Path, Path], dict[str, Any]]  # writes what it needs, gives the study
    under: str = ""  # folder of the recordings' folder

    def recorded(self, recordings: Path) -> Path:
        """Where its recordings are, if they are there."""
        return recordings / self.under / self.name

    def told(self, diagnosis: Content) -> dict[str, Told]:
        """What a diagnosis says of what is known; a crash agrees with nothing."""
        outcomes = {fact: says(diagnosis) for fact, says in self.known.items()}
        if crashed(diagnosis):
            return {k: replace(v, words="no answer", agrees=False) for k, v in outcomes.items()}
        return outcomes


def write_study(machine: Machine, recordings: Path, folder: Path) -> None:
    """A study folder with copies of the recordings."""
    folder.mkdir(parents=True)
    study = machine.build(machine.recorded(recordings), folder)
    (folder / "study.yaml").write_text(yaml.safe_dump(study, sort_keys=False))
