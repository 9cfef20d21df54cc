"""What logs come to when they are loaded as a study: which are usable, and in what units."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from pdoik._nearest import nearest
from pdoik.errors import LoadError
from pdoik.recordings import SuspectedUnitError

from ..study import Study, load_study


@dataclass(frozen=True, slots=True, kw_only=True)
class Suspicion:
    """A unit that a channel's numbers look like."""

    unit: str
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class GivenKeys:
    """Keys that are given with the request for a draft."""

    study: Mapping[str, Any] = field(default_factory=dict)  # keys of a study: see `OF_STUDY`
    entry: Mapping[str, Any] = field(default_factory=dict)  # keys of each recording's entry
    topics: Mapping[str, str] = field(default_factory=dict)  # such keys, of bags only

    def entry_of(self, log: Path) -> dict[str, Any]:
        """What a log's entry says besides its file."""
        return {**self.entry, **(self.topics if is_bag(log) else {})}


OF_STUDY = ("joints", "columns", "units", "ignore")
"""Keys of a study that say how its logs are read."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial:
    """Logs that load together."""

    study: Study
    logs: tuple[Path, ...]  # the usable ones, as they were given
    left_out: Mapping[Path, str]  # the others, by why they cannot be used
    units: Mapping[str, Suspicion]  # by channel
    told: GivenKeys


def tried(robot: Path, logs: Sequence[Path], given: GivenKeys) -> Trial:
    """Load the logs, leaving out those that cannot be used together with others.

    Args:
        robot: URDF or MJCF.
        logs: at least one.
        given: what is known already.

    Raises:
        LoadError: the robot or a log is not there, or none of the logs can be used.
    """
    for log in logs:
        if not log.exists():
            names = [each.name for each in log.parent.iterdir()] if log.parent.is_dir() else []
            raise LoadError(f"no such log: {log}{nearest(log.name, names)}")
    loader = _Loader(robot, given)
    usable: list[Path] = []
    why: dict[Path, LoadError] = {}
    for log in (*logs, *logs):  # a log at rest is of use together with one that moves
        if log in usable:
            continue
        try:
            loader.load([*usable[:1], log])
        except LoadError as error:
            why[log] = error
        else:
            usable.append(log)
            why.pop(log, None)
        if len(usable) + len(why) == len(logs) and not usable:
            break
    if not usable:
        raise why[logs[0]]
    usable.sort(key=[*logs].index)
    study = loader.load(usable)
    left_out = {log: str(error) for log, error in why.items()}
    return Trial(study=study, logs=tuple(usable), left_out=left_out, units=loader.units, told=given)


class _Loader:
    """Loads logs as a study, with units as their numbers ask for."""

    def __init__(self, robot: Path, given: GivenKeys) -> None:
        self.units: dict[str, Suspicion] = {}
        self._robot, self._given = robot, given

    def load(self, logs: Sequence[Path]) -> Study:
        """The study of these logs; a suspected unit is taken, once for each channel."""
        while True:
            try:
                return self._loaded(logs)
            except SuspectedUnitError as error:
                if error.channel in self.units:
                    raise
                self.units[error.channel] = Suspicion(unit=error.suspected, why=error.why)

    def _loaded(self, logs: Sequence[Path]) -> Study:
        suspected = {channel: each.unit for channel, each in self.units.items()}
        content = {
            **self._given.study,
            "robot": str(self._robot.resolve()),
            "recordings": [
                {"file": str(log.resolve()), **self._given.entry_of(log)} for log in logs
            ],
            "units": {**suspected, **(self._given.study.get("units") or {})},
        }
        with tempfile.TemporaryDirectory(prefix="pdoik-study-") as folder:
            path = Path(folder) / "study.yaml"
            path.write_text(yaml.safe_dump(content), encoding="utf-8")
            return load_study(path)


def is_bag(log: Path) -> bool:
    """Whether a log has topics."""
    return log.is_dir() or log.suffix in (".mcap", ".db3", ".bag")
