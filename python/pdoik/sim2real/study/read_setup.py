"""What the entry of a recording says of how it was made: robot, payload, gains, day."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np

from pdoik._nearest import nearest
from pdoik.descriptions import RobotFacts, robot_facts
from pdoik.errors import LoadError
from pdoik.recordings import FloatArray

from . import keys
from .check_robot import check_robot
from .controller import Controller
from .controller_key import given_controller, known_controller
from .key_tables import PAYLOAD
from .keys import Entry
from .payload import Payload
from .study import Setup

_MORE_THAN_NOTHING = float(np.nextafter(0.0, 1.0))
_COLDEST = -273.15  # numerics: [deg C]


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyContext:
    """The parts of a study that its recordings' entries refer to."""

    folder: Path
    joints: tuple[str, ...]
    facts: RobotFacts | None
    floats: bool  # its base
    tip: str | None
    controller: Any  # the study's key, as it was written


def setups_of(
    recordings: Sequence[Entry], simulations: Sequence[Entry], study: StudyContext
) -> dict[str, Setup]:
    """Setups by the recording's name, of those entries that say something.

    Raises:
        LoadError: something in them is not as expected, or does not fit the study's robot.
    """
    found: dict[str, Setup] = {}
    for entry in (*recordings, *simulations):
        if not entry.told:
            continue
        if entry.name in found:
            raise LoadError(
                f"simulation ({entry.name}): {next(iter(entry.told))}: is said of the recording of"
                " this name, and holds for its simulation too"
            )
        found[entry.name] = _setup(entry, study)
    return found


def _setup(entry: Entry, study: StudyContext) -> Setup:
    source, content = entry.name, entry.told
    robot = _robot(content.get("robot"), source, study)
    facts = study.facts if robot is None else robot
    payload = _payload(content.get("payload"), f"{source}: payload", study.joints, facts)
    controller = _controller(content.get("controller"), source, study)
    return Setup(
        robot=None if robot is None else robot.path,
        payload=payload,
        controller=controller,
        compensated=_compensated(content, source, controller, study),
        session=_label(content.get("session"), f"{source}: session"),
        temperature=_temperature(content.get("temperature"), source, study.joints),
        held=_held(content.get("base"), source),
        surface=keys.text(content.get("surface"), f"{source}: surface") or "",
    )


def _robot(content: Any, source: str, study: StudyContext) -> RobotFacts | None:
    """Facts of the entry's own description: same joints, same links; None without one."""
    name = keys.text(content, f"{source}: robot")
    if name is None:
        return None
    if study.facts is None:
        raise LoadError(f"{source}: robot: expected one of the study first, 'robot:'")
    try:
        facts = robot_facts(study.folder / Path(name).expanduser())
        check_robot(facts, study.joints, study.tip, floats=study.floats)
    except LoadError as error:
        raise LoadError(f"{source}: {error}") from error
    for joint in study.joints:
        own, expected = facts.joints[joint], study.facts.joints[joint]
        if own.link != expected.link:
            raise LoadError(
                f"{source}: robot: joint {joint!r} moves link {own.link!r}, expected"
                f" {expected.link!r} as in {study.facts.path.name}"
            )
        if (own.type == "prismatic") != (expected.type == "prismatic"):
            raise LoadError(
                f"{source}: robot: joint {joint!r} is {own.type}, expected {expected.type} as in"
                f" {study.facts.path.name}"
            )
    return facts


def _payload(
    content: Any, source: str, joints: tuple[str, ...], facts: RobotFacts | None
) -> Payload | None:
    if content is None:
        return None
    mapping = keys.checked(content, PAYLOAD, source)
    if facts is None:
        raise LoadError(f"{source}: expected a robot that holds it, 'robot:'")
    for key in ("link", "mass", "com"):
        if mapping.get(key) is None:
            raise LoadError(f"{source}: expected '{key}:'")
    link = keys.text(mapping["link"], f"{source}: link") or ""
    if link not in facts.masses:
        raise LoadError(
            f"{source}: link: {facts.path.name} has no link {link!r}{nearest(link, facts.masses)}"
        )
    moved = {facts.joints[joint].link for joint in joints}
    if moved.isdisjoint(facts.chain(link)):
        raise LoadError(
            f"{source}: link: {link!r} is moved by no joint of the study, expected one of those"
            f" after {', '.join(sorted(moved))}"
        )
    x, y, z = keys.vector(mapping["com"], f"{source}: com", 3).tolist()
    payload = Payload(
        link=link,
        mass=keys.number(mapping["mass"], f"{source}: mass", least=_MORE_THAN_NOTHING),
        com=(x, y, z),
        inertia=_inertia(mapping.get("inertia"), f"{source}: inertia"),
    )
    if not payload.is_body:
        raise LoadError(
            f"{source}: inertia: no body has {mapping['inertia']!r}; expected moments about its own"
            " centre, none negative and none more than the other two together"
        )
    return payload


def _inertia(content: Any, source: str) -> tuple[float, float, float, float, float, float]:
    """Inertia from 3 moments or xx xy yy xz yz zz [kg m^2]; zeros for a point."""
    if content is None:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if isinstance(content, list) and len(content) == 3:
        xx, yy, zz = keys.vector(content, source, 3).tolist()
        return (xx, 0.0, yy, 0.0, 0.0, zz)
    if not isinstance(content, list) or len(content) != 6:
        raise LoadError(
            f"{source}: expected a list of 3 moments, or of 6: xx xy yy xz yz zz, got {content!r}"
        )
    xx, xy, yy, xz, yz, zz = keys.vector(content, source, 6).tolist()
    return (xx, xy, yy, xz, yz, zz)


def _controller(content: Any, source: str, study: StudyContext) -> Controller | None:
    """The study's, with what the entry says otherwise."""
    if content is None:
        return None
    if study.controller is None:
        raise LoadError(f"{source}: controller: expected one of the study first, 'controller:'")
    if not isinstance(content, dict):
        raise LoadError(f"{source}: controller: expected 'key: value' lines, got {content!r}")
    try:
        known = _known({**study.controller, **content}, study.joints)
    except LoadError as error:
        raise LoadError(f"{source}: {error}") from error
    if known is None:
        raise LoadError(f"{source}: controller: expected 'type: pd' with 'kp:' and 'kd:'")
    return known


def _known(content: Any, joints: tuple[str, ...]) -> Controller | None:
    return known_controller(given_controller(content, joints))


def _compensated(
    content: Mapping[str, Any], source: str, own: Controller | None, study: StudyContext
) -> bool:
    value = content.get("compensated", False)
    if not isinstance(value, bool):
        raise LoadError(f"{source}: compensated: expected true or false, got {value!r}")
    if value and "robot" not in content and "payload" not in content:
        raise LoadError(f"{source}: compensated: expected 'payload:' or 'robot:' with it")
    known = own or _known(study.controller, study.joints)
    if value and not (known is not None and known.gravity_compensation):
        raise LoadError(
            f"{source}: compensated: expected a controller with 'gravity_compensation: true'"
        )
    return value


def _held(content: Any, source: str) -> bool:
    if content not in (None, "held"):
        raise LoadError(f"{source}: base: expected held, got {content!r}")
    return content is not None


def _label(content: Any, source: str) -> str:
    """Text, a number, or a day."""
    if isinstance(content, bool) or not isinstance(content, str | int | float | date | None):
        raise LoadError(f"{source}: expected text or a number, got {content!r}")
    return "" if content is None else str(content)


def _temperature(content: Any, source: str, joints: tuple[str, ...]) -> FloatArray | None:
    """Temperature of every joint, (n,) [deg C]; None without one."""
    if content is None:
        return None
    source = f"{source}: temperature"
    if isinstance(content, dict):
        keys.checked(content, joints, source)
        missing = [joint for joint in joints if joint not in content]
        if missing:
            raise LoadError(f"{source}: nothing for joint {missing[0]!r}")
        content = [content[joint] for joint in joints]
    if not isinstance(content, list):
        content = [keys.number(content, source)] * len(joints)
    values = keys.vector(content, source, len(joints), "joints")
    if (values < _COLDEST).any():
        raise LoadError(f"{source}: expected degrees Celsius, got {values.min():g}")
    return values
