"""Reads a study, from YAML or made in Python, as a checked `Study`."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from pdoik.descriptions import RobotFacts, robot_file
from pdoik.errors import LoadError
from pdoik.recordings import (
    STILL,
    FloatArray,
    Recording,
    RobotLog,
    check_names,
    columns_key,
    joints_of,
    moves,
    read_log,
    units_from,
)

from . import keys as study_keys
from .base_key import base_from, check_base
from .check_robot import armatures, check_robot
from .controller_key import given_controller, known_controller
from .keys import Entry
from .read_setup import StudyContext, setups_of
from .simulator_key import simulator_from
from .split import split
from .study import Setup, Study


def load_study(source: str | os.PathLike[str] | Study) -> Study:
    """Read and check a study.

    Args:
        source: A YAML file, whose paths are relative to its folder, or a `Study` made in Python.

    Raises:
        LoadError: something in it or in its files is not as expected; the message names the file,
            the key or column, what was expected and what came.
        ValueError: a `Study` made in Python contradicts itself.
    """
    if isinstance(source, Study):
        return check_study(source)
    path = Path(source)
    if path.is_dir():
        raise LoadError(f"study: expected a YAML file, got the folder {path}")
    content = study_keys.read_keys(path)
    folder = path.resolve().parent
    simulator = simulator_from(content.get("simulator"), folder)
    units = units_from(content.get("units"), path.name)
    ignore = study_keys.names(content.get("ignore"), "ignore") or ()
    named = study_keys.names(content.get("joints"), "joints")
    tip = study_keys.text(content.get("tip"), "tip")
    robot = study_keys.text(content.get("robot"), "robot")
    described = None if robot is None else robot_file(folder / Path(robot).expanduser())
    facts = None if described is None else described.facts
    base = base_from(content.get("base"), facts)
    floats = base is not None
    if facts is not None and named is not None:
        check_robot(facts, named, tip, floats=floats)  # before the files, which may be long
    max_rows = content.get("max_rows")
    entries = study_keys.entries(content["recordings"], folder, "recordings", max_rows)
    simulations = study_keys.entries(
        content.get("simulation") or [], folder, "simulation", max_rows
    )
    key = columns_key(content.get("columns"), f"{path.name}: columns")

    def log_of(entry: Entry, joints: tuple[str, ...] | None) -> RobotLog:
        return read_log(
            entry.path,
            name=entry.name,
            joints=joints,
            robot=described,
            columns=key if entry.columns is None else entry.columns,
            units=units,
            ignore=ignore,
            every=entry.part.every,
            window=entry.part.window,
            max_rows=entry.part.max_rows,
            numbered=False,
            **entry.reading,
        )

    logs = [log_of(each, named) for each in entries]
    joints, notes = (named, ()) if named is not None else _common_joints(logs, facts)
    notes += () if facts is None else check_robot(facts, joints, tip, floats=floats)
    notes += () if facts is not None else ("no robot: only channels and drives can be judged",)
    given = given_controller(content.get("controller"), joints)
    rotor_inertia = _rotor_inertia(content.get("rotor_inertia"), joints, facts)
    context = StudyContext(
        folder=folder,
        joints=joints,
        facts=facts,
        floats=floats,
        tip=tip,
        controller=content.get("controller"),
    )
    setups = setups_of(entries, simulations, context)

    feet = () if base is None else tuple(foot.link for foot in base.feet)

    def recording(log: RobotLog, entry: Entry) -> Recording:
        setup = setups.get(entry.name, Setup())
        own = described if setup.robot is None else robot_file(setup.robot)
        made = replace(log, names=joints, robot=own).recording(entry.role, feet, ask=True)
        check_base(base, made, setup.held)
        return made

    recordings = []
    for entry in entries:
        log = logs.pop(0)  # as long as an hour: no two forms of all are kept
        check_names(log.table, joints, ignore)
        recordings.append(recording(log, entry))
        del log
    simulation = [recording(log_of(each, joints), each) for each in simulations]
    _check_still(recordings, joints)
    parted, how = split(tuple(recordings))
    return check_study(
        Study(
            folder=folder,
            source=path.resolve(),
            robot=None if facts is None else facts.path,
            base=base,
            tip=tip,
            joints=joints,
            recordings=parted,
            split=how,
            controller=known_controller(given),
            told=given,
            simulation=tuple(simulation),
            simulator=simulator,
            trust=study_keys.trust_from(content.get("trust")),
            rotor_inertia=rotor_inertia,
            setups=setups,
            notes=(
                *notes,
                *(f"{name}: {note}" for name, setup in setups.items() for note in setup.notes),
                *(f"{each.name}: {note}" for each in recordings for note in each.notes),
                *((f"held-out data were parted {how}",) if how != "by the study" else ()),
            ),
        )
    )


def check_study(study: Study) -> Study:
    """The study itself, if its parts fit together.

    Raises:
        ValueError: an array has the wrong shape, or no recording is there to fit.
    """
    n = len(study.joints)
    if not n:
        raise ValueError("joints: expected at least one")
    for recording in (*study.recordings, *study.simulation):
        rows = len(recording.time)
        for channel in recording.channels:
            shape = (rows, _width(study, channel))
            came = getattr(recording, channel).shape
            if came != shape:
                raise ValueError(f"{recording.name}: {channel} is {came}, expected {shape}")
        if recording.valid.shape != (rows,):
            raise ValueError(f"{recording.name}: valid is {recording.valid.shape}, not ({rows},)")
    names = [recording.name for recording in study.recordings]
    if len(set(names)) != len(names):
        raise ValueError("recordings: two have the same name")
    known = {each.file or each.name for each in (*study.recordings, *study.simulation)}
    if not known.issuperset(study.setups):
        unknown = min(set(study.setups) - known)
        raise ValueError(f"setups: no recording {unknown!r}, expected one of {sorted(known)}")
    vectors: dict[str, FloatArray | None] = {"rotor_inertia": study.rotor_inertia}
    if study.controller is not None:
        vectors |= {
            "controller.kp": study.controller.kp,
            "controller.kd": study.controller.kd,
            "controller.torque_limit": study.controller.torque_limit,
        }
    for recording_name, setup in study.setups.items():
        vectors[f"{recording_name}: temperature"] = setup.temperature
        if setup.controller is not None:
            vectors[f"{recording_name}: controller.kp"] = setup.controller.kp
            vectors[f"{recording_name}: controller.kd"] = setup.controller.kd
    for name, values in vectors.items():
        if values is not None and values.shape != (n,):
            raise ValueError(f"{name} is {values.shape}, expected ({n},): one for each joint")
    if not study.fit:
        raise ValueError("recordings: none has the role fit")
    return study


def _width(study: Study, channel: str) -> int:
    """Columns of a channel."""
    if channel == "contact":
        return 0 if study.base is None else len(study.base.feet)
    return {"tip": 7, "base": 7, "gyro": 3, "acc": 3}.get(channel, len(study.joints))


def _common_joints(
    logs: list[RobotLog], facts: RobotFacts | None
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The joints that every recording has a position of, and notes on the others."""
    each = [joints_of(log.table.columns) for log in logs]
    common = [joint for joint in each[0] if all(joint in others for others in each)]
    shown = "; ".join(
        f"{log.name}: {'; '.join((', '.join(joints) or 'none', *log.table.unsettled))}"
        for log, joints in zip(logs, each, strict=True)
    )
    if not common:
        raise LoadError(
            f"recordings: no joint has a column 'q.<joint>' in all of them ({shown}); with"
            " 'joints:' the study can say which joints it is about"
        )
    notes = [
        f"joint {joint} left out: not all recordings have it"
        for joint in sorted({joint for joints in each for joint in joints} - set(common))
    ]
    if facts is None:
        return tuple(common), tuple(notes)
    known = [joint for joint in facts.joints if joint in common]
    if not known:
        check_robot(facts, common, None)  # names the nearest
    notes += [
        f"joint {joint} left out: the robot has none of this name"
        for joint in common
        if joint not in known
    ]
    return tuple(known), tuple(notes)


def _rotor_inertia(
    content: object, joints: tuple[str, ...], facts: RobotFacts | None
) -> FloatArray | None:
    if content is not None:
        return study_keys.per_joint(content, "rotor_inertia", joints)
    return None if facts is None else armatures(facts, joints)


def _check_still(recordings: list[Recording], joints: tuple[str, ...]) -> None:
    fit = [each for each in recordings if each.role == "fit"]
    if fit and not any(moves(each).any() for each in fit):
        files = ", ".join(each.name for each in fit)
        raise LoadError(
            f"{files}: no joint moves by more than {STILL:g} rad; expected motion"
            f" of {', '.join(joints)}"
        )
