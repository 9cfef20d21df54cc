"""The draft of a study: what could be guessed of it, what is to be asked, in words."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pdoik.descriptions import robot_facts
from pdoik.errors import LoadError

from ..study import read_part
from .actuators import actuator_gains
from .facts import Facts
from .text import study_text
from .trial import OF_STUDY, GivenKeys, Trial, tried

_NAMED = 6  # numerics: joints in one sentence


def guesses_of(facts: Facts) -> tuple[str, ...]:
    """Guesses, in words, of joints, units, gains and the recording to hold out."""
    study = facts.trial.study
    said = [
        f"{len(study.joints)} joints are in both robot and logs: {_listed(study.joints)}",
        f"logged of all: {' '.join(facts.channels)}",
    ]
    said += [f"{k} is taken to be in {s.unit}: {s.why}" for k, s in facts.trial.units.items()]
    if facts.gains is not None:
        said.append("the controller's gains are those of the MJCF's position actuators")
    held = facts.held_out
    said.append(f"held out: {held.name} ({held.why})" if held.name else f"held out: {held.why}")
    said += [f"left out: {log.name}: {why}" for log, why in facts.trial.left_out.items()]
    return tuple(said)


def questions_of(facts: Facts) -> dict[str, str]:
    """Questions by the study's key that answers them."""
    study, channels = facts.trial.study, facts.channels
    asked: dict[str, str] = {}
    if facts.counted:
        asked["joints"] = (
            f"the logs count their joints: is {_listed(study.joints)} their order, from the base?"
        )
    others = [name for name in facts.robot.joints if name not in study.joints]
    if others:
        said = f"not logged, so held at zero: {_listed(others)}. Is that so?"
        asked["joints"] = f"{asked['joints']} {said}" if facts.counted else said
    for channel, each in facts.trial.units.items():
        said = f"is {channel} in {each.unit}? {each.why}"
        asked["units"] = f"{asked['units']}; {said}" if "units" in asked else said
    asked |= _of_torque(facts)
    asked |= _of_controller(facts)
    if study.rotor_inertia is None:
        asked["rotor_inertia"] = (
            "inertia of each drive's rotor, seen at the joint (times the gear ratio squared)?"
            " Without it, it is fitted"
        )
    if "tip" in channels:
        asked["tip"] = "of which link was the pose measured? Without it, of the last one"
    asked["payload"] = "was anything held or attached that the robot's description does not know?"
    if len(facts.trial.logs) > 1:
        asked["session"] = "were the recordings made on one day?"
    return asked


def _of_torque(facts: Facts) -> dict[str, str]:
    channels, runs = facts.channels, facts.trial.study.recordings
    if "tau" in channels:
        same = all(
            r.tau is not None and r.tau_cmd is not None and np.array_equal(r.tau, r.tau_cmd)
            for r in runs
        )
        if same:
            return {"tau": "tau is tau_cmd, number by number: is any torque measured?"}
        return {"tau": "is tau measured (by a sensor, or from the motor's current), or commanded?"}
    if "current" in channels:
        return {"tau": "what is each motor's torque constant times its gear ratio?"}
    if "duty" in channels:
        return {"tau": "what is the supply's voltage, and the motors' torque per volt?"}
    if "tau_cmd" in channels:
        return {"tau": "only a commanded torque was logged: is what was given measured anywhere?"}
    return {"tau": "no torque, current or duty was logged: can the drives log one?"}


def _of_controller(facts: Facts) -> dict[str, str]:
    if "q_des" not in facts.channels:
        return {"q_des": "no commanded positions (q_des) were logged: can they be?"}
    if facts.gains is not None:
        return {"controller": "are the MJCF's gains those of the recorded machine's controller?"}
    return {
        "controller": "gains of the controller, and does it compensate gravity? Without them, they"
        " are estimated where an effort was logged"
    }


def _listed(names: tuple[str, ...] | list[str]) -> str:
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more


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
