"""What robot and logs show of a study."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from pdoik.descriptions import RobotFacts
from pdoik.recordings import Recording
from pdoik.recordings.names import ALONG_THE_ARM

from .actuators import ActuatorGains
from .hold_out import HoldOut, hold_out
from .trial import Trial


@dataclass(frozen=True, kw_only=True, eq=False)
class Facts:
    """All that was found out of robot and logs."""

    folder: Path  # of the study: its paths are relative to it
    robot: RobotFacts
    trial: Trial
    gains: ActuatorGains | None

    @cached_property
    def held_out(self) -> HoldOut:
        """The recording that only judges."""
        return hold_out({self.name_of(log): parts for log, parts in self.by_log.items()})

    @property
    def by_log(self) -> dict[Path, tuple[Recording, ...]]:
        """Each usable log's recording, in the parts that a study without roles makes of it."""
        study = self.trial.study
        return {
            log: tuple(r for r in study.recordings if (r.file or r.name) == self.name_of(log))
            for log in self.trial.logs
        }

    @property
    def counted(self) -> bool:
        """Whether joints' columns were known by numbers alone."""
        notes = (note for each in self.trial.study.recordings for note in each.notes)
        return any(note.endswith(ALONG_THE_ARM) for note in notes)

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels that all usable logs have."""
        every = [set(r.channels) for r in self.trial.study.recordings]
        first = self.trial.study.recordings[0].channels
        return tuple(name for name in first if all(name in each for each in every))

    def name_of(self, log: Path) -> str:
        """What the study calls a log's recording."""
        alike = [each for each in self.trial.logs if each.name == log.name]
        return log.name if len(alike) == 1 else str(log.resolve())

    def path_of(self, path: Path) -> str:
        """A path as the study names it: relative where it is near the folder, else absolute."""
        folder = self.folder.resolve()
        relative = os.path.relpath(path.resolve(), folder)
        return str(path.resolve()) if relative.startswith(f"..{os.sep}..") else relative
