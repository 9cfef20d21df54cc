"""The draft of a study: what could be guessed of it, what is to be asked."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pdoik.descriptions import robot_facts
from pdoik.errors import LoadError

from ..study import read_part
from .actuators import actuator_gains
from .facts import Facts
from .questions import guesses_of, questions_of
from .text import study_text
from .trial import OF_STUDY, GivenKeys, Trial, tried


@dataclass(frozen=True, slots=True, kw_only=True)
class Draft:
    """A study's text, and what its writer has to know."""

    text: str  # YAML with comments
    guesses: tuple[str, ...]  # in words
    questions: tuple[str, ...]


def draft_study(
    robot: str | os.PathLike[str],
    logs: Sequence[str | os.PathLike[str]],
    *,
    folder: str | os.PathLike[str] = ".",
    topic: str | None = None,
    command_topic: str | None = None,
    reading: str | os.PathLike[str] | None = None,
    entry: Mapping[str, Any] | None = None,
) -> Draft:
    """A commented study of a robot and logs, with what could be guessed, that loads as it stands.

    Units are those that the numbers ask for, held out is the recording whose motion the others
    cover but do not repeat, and gains are those of an MJCF's position actuators. Logs that cannot
    be used together with the others are left out, and named.

    Args:
        robot: URDF or MJCF.
        logs: recordings of any kind that a study may name; at least one.
        folder: that the study is meant for.
        topic: of joint states in bags, where there are several.
        command_topic: of commands in bags.
        reading: a YAML file whose `joints:`, `columns:`, `units:` and `ignore:`, as in a study,
            say how the logs are read, where names and numbers do not.
        entry: what each recording's entry says of how to read it: `rate`, `demo`, `env` ...

    Raises:
        LoadError: the robot or a log is not there or cannot be read, or none of the logs can be
            used; the message names what was expected, and the nearest name.
    """
    if not logs:
        raise LoadError("logs: expected one at least")
    path = Path(robot)
    facts = robot_facts(path)
    topics = {"topic": topic, "command_topic": command_topic}
    given = GivenKeys(
        study={} if reading is None else _read(Path(reading)),
        entry=dict(entry or {}),
        topics={key: value for key, value in topics.items() if value is not None},
    )
    trial = tried(path, list(dict.fromkeys(Path(log) for log in logs)), given)
    gains = actuator_gains(path, trial.study.joints) if "q_des" in _any_channel(trial) else None
    found = Facts(folder=Path(folder), robot=facts, trial=trial, gains=gains)
    asked = questions_of(found)
    return Draft(
        text=study_text(found, asked),
        guesses=guesses_of(found),
        questions=tuple(asked.values()),
    )


def _read(path: Path) -> dict[str, Any]:
    return {key: value for key, value in read_part(path).items() if key in OF_STUDY}


def _any_channel(trial: Trial) -> set[str]:
    return {name for each in trial.study.recordings for name in each.channels}
