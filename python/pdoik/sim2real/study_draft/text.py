"""The text of a draft: YAML with a comment for each key that its user may need."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from pdoik.recordings import Recording

from .facts import Facts
from .trial import is_bag

_DIGITS = 6


def study_text(facts: Facts, questions: Mapping[str, str]) -> str:
    """A study that loads as it stands."""
    return "\n".join(_lines(facts, questions)) + "\n"


def _lines(facts: Facts, questions: Mapping[str, str]) -> Iterator[str]:
    study, robot, held = facts.trial.study, facts.robot, facts.held_out
    yield "# A study for `pdoik diagnose`, drafted by `pdoik study new`. Lines that begin with"
    yield "#   # ?   ask what could not be guessed. Then: pdoik study check THIS_FILE"
    yield ""
    yield f"# The model that is believed: {len(robot.joints)} joints that move."
    yield f"robot: {_value(facts.path_of(robot.path))}"
    yield ""
    yield f"# In the robot and in all logs, in the robot's order: {len(study.joints)}."
    yield from _asked(questions, "joints")
    yield from _mapping({"joints": list(study.joints)})
    yield ""
    yield from _tip(facts, questions)
    yield "# Figures are fitted to recordings with role fit; those with role validate only judge."
    yield f"# Held out: {_plain(f'{held.name}: {held.why}' if held.name else held.why)}"
    yield from _asked(questions, "session")
    yield from _asked(questions, "payload")
    yield "recordings:"
    for log, parts in facts.by_log.items():
        yield from _recording(facts, log, parts)
    for log, why in facts.trial.left_out.items():
        yield f"  # ?  left out: {_plain(log.name)}: {_plain(why)}"
    yield ""
    yield from _units(facts, questions)
    yield from _asked(questions, "tau")
    yield from _asked(questions, "q_des")
    yield from _controller(facts, questions)
    yield from _rotors(facts, questions)
    yield "# trust: {rigid_body: 0.1}  # the model's masses and inertias are about a tenth off"
    yield "# trust: {torque: 0.04}  # the torques' own scale is about 4 % off"
    reading = facts.trial.told.study
    if reading.get("columns"):
        yield "# Which column is which."
        yield from _mapping({"columns": reading["columns"]})
    if reading.get("ignore"):
        yield from _mapping({"ignore": reading["ignore"]})
    else:
        yield "# ignore: []  # columns that look like a channel and are none"
    yield "# max_rows: 2000000  # of a file; a longer one is refused"


def _tip(facts: Facts, questions: Mapping[str, str]) -> Iterator[str]:
    links = [*facts.robot.masses]
    last = links[-1] if links else "tool"
    if "tip" in facts.channels:
        yield "# The pose of a link was logged (tip.x ...)."
        yield from _asked(questions, "tip")
    else:
        yield "# The link whose pose was measured; no pose (tip.x ... tip.qw) was logged."
    yield f"# tip: {_value(last)}"
    yield ""


def _recording(facts: Facts, log: Path, parts: tuple[Recording, ...]) -> Iterator[str]:
    first = parts[0]
    seconds = sum(float(r.time[-1] - r.time[0]) for r in parts)
    name = facts.name_of(log)
    yield f"  - file: {_value(facts.path_of(log))}"
    yield f"    # {seconds:.3g} s at {1.0 / first.raw_period:.4g} Hz: {' '.join(first.channels)}"
    for note in first.notes:
        yield f"    # {_plain(note)}"
    yield f"    role: {'validate' if name == facts.held_out.name else 'fit'}"
    keys = facts.trial.told.entry_of(log)
    if is_bag(log):
        for key in ("topic", "command_topic"):
            topic = keys.pop(key, None)
            what = "JointState" if key == "topic" else "commands: JointState or JointTrajectory"
            yield f"    {key}: {_value(topic)}" if topic else f"    # {key}: /name  # of {what}"
    for key, value in keys.items():
        yield f"    {key}: {_value(value)}"
    link = _value(facts.robot.joints[facts.trial.study.joints[-1]].link)
    yield "    # session: monday  # the day, or whatever else was the same"
    yield f"    # payload: {{link: {link}, mass: 1.0, com: [0, 0, 0.05]}}  # attached: kg, m"
    yield "    # window: [0, 30]  # of the file [s]"


def _units(facts: Facts, questions: Mapping[str, str]) -> Iterator[str]:
    reading = facts.trial.told.study
    units = {k: each.unit for k, each in facts.trial.units.items()} | (reading.get("units") or {})
    if units:
        looks = "that the numbers look like" if facts.trial.units else "as they were given"
        yield f"# Units {looks}; all others are SI."
        yield from _asked(questions, "units")
        yield from _mapping({"units": units})
    else:
        yield "# All numbers may be in SI units: they fit the robot's limits, and one another."
        yield "# units: {q: deg, dq: rpm, tau: N.cm, time: ms}"
    yield ""


def _controller(facts: Facts, questions: Mapping[str, str]) -> Iterator[str]:
    n = len(facts.trial.study.joints)
    yield "# tau = kp (q_des - q) + kd (dq_des - dq) + gravity, by joint: N m/rad, N m s/rad."
    yield from _asked(questions, "controller")
    gains = facts.gains
    if gains is None:
        yield "# controller:"
        yield "#   type: pd  # or pid, cascade, voltage, table, unknown"
        yield f"#   kp: [{', '.join(['100'] * n)}]"
        yield f"#   kd: [{', '.join(['10'] * n)}]"
        yield "#   gravity_compensation: false"
        yield "#   period: 0.001  # [s]"
    else:
        law: dict[str, Any] = {"type": "pd", "kp": _numbers(gains.kp), "kd": _numbers(gains.kd)}
        if gains.torque_limit is not None and min(gains.torque_limit) > 0.0:
            law["torque_limit"] = _numbers(gains.torque_limit)
        yield "# Guessed from the MJCF's position actuators."
        yield from _mapping({"controller": law})
        yield "  # gravity_compensation: true"
        yield "  # period: 0.001  # [s]"
    yield ""


def _rotors(facts: Facts, questions: Mapping[str, str]) -> Iterator[str]:
    rotors = facts.trial.study.rotor_inertia
    yield "# Rotors' inertias seen at the joints [kg m^2]."
    if rotors is not None:
        yield "# Those of the description, its armatures:"
        yield f"# rotor_inertia: [{', '.join(f'{each:.4g}' for each in rotors)}]"
    else:
        yield from _asked(questions, "rotor_inertia")
        yield f"# rotor_inertia: [{', '.join(['0.05'] * len(facts.trial.study.joints))}]"
    yield ""


def _asked(questions: Mapping[str, str], key: str) -> Iterator[str]:
    if key in questions:
        yield f"# ?  {_plain(questions[key])}"


def _mapping(content: dict[str, Any]) -> list[str]:
    text = yaml.safe_dump(content, default_flow_style=None, sort_keys=False, width=100)
    return text.rstrip("\n").split("\n")


def _value(value: object) -> str:
    text = yaml.safe_dump(value, default_flow_style=True, width=float("inf"))
    return text.removesuffix("\n").removesuffix("...").rstrip("\n")


def _numbers(values: tuple[float, ...]) -> list[float]:
    return [float(f"{each:.{_DIGITS}g}") for each in np.asarray(values)]


def _plain(text: str) -> str:
    """The text in one line."""
    return " ".join(text.split())
