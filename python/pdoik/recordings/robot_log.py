"""A robot's log as arrays: joints by name, SI units, a clock, and what is doubtful about them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from pdoik._nearest import nearest
from pdoik.descriptions import RobotDescription
from pdoik.errors import LoadError

from .check_recording import to_recording
from .columns import CONTACT, POSE, SUPPLY, VECTORS, Table, channel_of, joints_of
from .duty import check_duty
from .logs import MAX_ROWS, Part, entry_keys
from .names import ColumnsKey, Known, columns_key, listed, mujoco_order
from .read import read_table
from .recording import CHANNELS, FloatArray, Recording, Role
from .suspect_units import check_units
from .suspected_unit import SuspectedUnitError
from .units import Units, parent, units_from

_SI = {
    "q": ("rad", "m"),
    "dq": ("rad/s", "m/s"),
    "tau": ("N.m", "N"),
    "current": ("A", "A"),
    "duty": ("1", "1"),
    "voltage": ("V", "V"),
    "tip": ("m", "m"),
    "base": ("m", "m"),
    "gyro": ("rad/s", "rad/s"),
    "acc": ("m/s^2", "m/s^2"),
}
_PARTS = {"tip": POSE, "base": POSE, **VECTORS}
_EPOCH = (5e8, 5e9)  # stamps between are seconds since 1970


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """The unit of a channel or a column."""

    si: str  # in which it is given
    logged: str  # in which the log has it
    source: Literal["named", "log", "assumed"]  # by whom: who reads it, the log, or nobody


@dataclass(frozen=True, slots=True, kw_only=True)
class Clock:
    """What times a log has."""

    source: str  # what they were read from, in words
    start: float  # of the first row, on that clock [s]
    period: float  # median step [s]; NaN of one row
    jitter: float  # standard deviation of the steps [s]
    repeated: int  # rows whose time is that of the row before
    backwards: int  # rows whose time is before that of the row before

    @property
    def since_1970(self) -> bool:
        """Whether the times are seconds of the calendar."""
        return _EPOCH[0] < self.start < _EPOCH[1]


def _array(channel: str, what: str) -> property:
    return property(lambda log: log.array(channel), doc=f"{what}, (T, n); None: not logged.")


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotLog:
    """The rows of a log as it has them: nothing is resampled, left out or repaired.

    Arrays are (T, n) in the order of `names`, in SI units, NaN where nothing was logged; None where
    a channel was not logged at all. `recording` gives the same on even times, with what is faulty
    mended.

    Attributes:
        table: The columns in the log's own units.
        names: Of the joints, (n).
        said: What is known of the columns' units.
        robot: Its description, if one was given and has the joints.
        left_out: Joints of the log that it has not, in words.
    """

    table: Table
    names: tuple[str, ...]
    said: Units
    robot: RobotDescription | None = None
    left_out: tuple[str, ...] = ()

    q = _array("q", "Positions [rad], [m] of prismatic joints")
    dq = _array("dq", "Speeds [rad/s], [m/s]")
    tau = _array("tau", "Torques [N m], forces [N], as drives report them")
    current = _array("current", "Motor currents [A]")
    duty = _array("duty", "Share of the supply that motors are given, -1 to 1")
    voltage = _array("voltage", "Of the supply [V]")
    q_des = _array("q_des", "Commanded positions [rad], [m]")
    dq_des = _array("dq_des", "Commanded speeds [rad/s], [m/s]")
    tau_cmd = _array("tau_cmd", "Commanded torques [N m], forces [N]")

    @property
    def name(self) -> str:
        """What messages call it."""
        return self.table.name

    @property
    def time(self) -> FloatArray:
        """Times since the first row, (T,) [s]."""
        return self.table.time

    @property
    def start(self) -> float:
        """Time of the first row on the log's clock [s]."""
        return self.table.start

    @property
    def notes(self) -> tuple[str, ...]:
        """How columns were understood, and what was not read, in words."""
        return (*self.table.notes, *self.left_out)

    @property
    def unread(self) -> tuple[str, ...]:
        """Columns that were not read."""
        return self.table.others

    @property
    def channels(self) -> tuple[str, ...]:
        """What was logged, of joints first: names for `array`."""
        return tuple(each for each in (*CHANNELS, *_PARTS) if self._columns(each))

    @property
    def supply(self) -> FloatArray | None:
        """Voltage of the supply that all joints share, (T,) [V]; None: not logged."""
        volts = self.table.columns.get(SUPPLY)
        return None if volts is None else volts * self.said.factor("voltage")

    @property
    def contacts(self) -> dict[str, FloatArray]:
        """Readings of feet's sensors by link, (T,) each."""
        found = self.table.columns.items()
        return {name[len(CONTACT) :]: each for name, each in found if name.startswith(CONTACT)}

    def array(self, channel: str) -> FloatArray | None:
        """A channel in SI units, None where it was not logged.

        Args:
            channel: One of joints, (T, n); "tip" or "base", (T, 7) x y z qw qx qy qz; "gyro" or
                "acc", (T, 3).

        Raises:
            ValueError: There is no such channel.
        """
        if channel not in (*CHANNELS, *_PARTS):
            known = (*CHANNELS, *_PARTS)
            raise ValueError(f"no channel {channel!r}{nearest(channel, known)}")
        if not self._columns(channel):
            return None
        parts = _PARTS.get(channel, self.names)
        out = np.full((len(self.time), len(parts)), np.nan)
        for k, part in enumerate(parts):
            values = self.table.columns.get(f"{channel}.{part}")
            if values is not None:
                turned = part.startswith("q") and channel in ("tip", "base")
                factor = 1.0 if turned else self.said.factor(*self._unit_key(channel, part))
                out[:, k] = values * factor
        return out

    @cached_property
    def units(self) -> dict[str, Unit]:
        """Units by channel; by column, "q.gripper", where those of a channel differ."""
        found: dict[str, Unit] = {}
        for channel in self.channels:
            each = {column: self._unit(column) for column in self._columns(channel)}
            same = len(set(each.values())) == 1
            found |= {channel: next(iter(each.values()))} if same else each
        return found

    @cached_property
    def clock(self) -> Clock:
        """What the times are."""
        steps = np.diff(self.time[np.isfinite(self.time)])
        return Clock(
            source=self.table.clock,
            start=self.start,
            period=float(np.median(steps)) if len(steps) else np.nan,
            jitter=float(np.std(steps)) if len(steps) else np.nan,
            repeated=int((steps == 0).sum()),
            backwards=int((steps < 0).sum()),
        )

    @cached_property
    def suspected(self) -> tuple[SuspectedUnitError, ...]:
        """Channels whose numbers look like another unit's, one after the other taken at its word.

        `read_log(..., units={each.channel: each.suspected for each in log.suspected})` reads the
        log so. Empty, too, of a log that is no recording: then `recording` says why.
        """
        found: dict[str, SuspectedUnitError] = {}
        log = self
        while True:
            try:
                log.recording(ask=True)
            except SuspectedUnitError as error:
                if error.channel in found:
                    break
                found[error.channel] = error
                if error.channel == "time":
                    break  # nothing else can be judged on such times
                named = {**log.said.named, error.channel: error.suspected}
                log = replace(log, said=replace(log.said, named=named))
            except LoadError:
                break
            else:
                break
        return tuple(found.values())

    def recording(
        self, role: Role = "fit", feet: Sequence[str] = (), *, ask: bool = False
    ) -> Recording:
        """The log on even times, in SI units, with what is faulty mended or left out, and noted.

        Readings that jump and come back are left out, encoders that wrap are unwrapped, gaps are
        bridged and marked.

        Args:
            role: Of the recording.
            feet: Links whose sensors' columns are its contacts, in this order.
            ask: Whether numbers that look like another unit's are an error.

        Raises:
            LoadError: A joint has no positions, time runs backwards, or it is too short or faulty.
            SuspectedUnitError: `ask`, and a unit is suspected.
        """
        slides = tuple(each for each in self.names if self._slides(each))
        made = to_recording(self.table, self.names, role, self.said, slides, tuple(feet))
        if ask:
            check_units(made, self.names, self.said, self.robot)
            check_duty(made, self.names, self.said)
        return made

    def __str__(self) -> str:
        """What was read and what is doubtful, a line for each channel."""
        clock = self.clock
        odd = {"repeat the time before": clock.repeated, "go back in time": clock.backwards}
        said = {"named": "as named", "log": "as the log says", "assumed": "assumed"}
        lines = [
            f"{self.name}: {len(self.time)} rows in {self.time[-1]:.6g} s, joints"
            f" {', '.join(self.names) or 'none'}",
            f"  time: {clock.source}; a row each {clock.period:.4g} s"
            + "".join(f"; {count} {what}" for what, count in odd.items() if count),
            *(
                f"  {name} [{unit.si}]: logged in {unit.logged}, {said[unit.source]}"
                for name, unit in self.units.items()
            ),
            *(f"  suspected: {each}" for each in self.suspected),
            *(f"  {note}" for note in self.notes),
        ]
        if self.unread:
            lines.append(f"  not read: {listed(self.unread)}")
        return "\n".join(lines)

    def _columns(self, channel: str) -> list[str]:
        parts = _PARTS.get(channel, self.names)
        return [column for part in parts if (column := f"{channel}.{part}") in self.table.columns]

    def _slides(self, joint: str) -> bool:
        joints = {} if self.robot is None else self.robot.facts.joints
        return joint in joints and joints[joint].type == "prismatic"

    def _unit_key(self, channel: str, part: str) -> tuple[str, bool]:
        """What `Units` calls a column, and whether it is of a prismatic joint."""
        return (channel, False) if channel in _PARTS else (f"{channel}.{part}", self._slides(part))

    def _unit(self, column: str) -> Unit:
        channel, _, part = column.partition(".")
        key, slides = self._unit_key(channel, part)
        logged, source = self.said.said_of(key)
        linear = slides or logged in ("m", "mm", "m/s", "mm/s", "N")
        si = _SI[parent(channel)][linear]
        if slides and source == "named" and self.said.factor(key, prismatic=True) == 1.0:
            logged = si
        return Unit(si=si, logged=logged or si, source=source)


def read_log(
    path: str | os.PathLike[str],
    *,
    name: str = "",
    joints: Sequence[str] | None = None,
    robot: str | os.PathLike[str] | RobotDescription | None = None,
    columns: Mapping[str, Any] | ColumnsKey | None = None,
    units: Mapping[str, str] | Units | None = None,
    ignore: Sequence[str] = (),
    every: int = 1,
    window: tuple[float, float] | None = None,
    max_rows: int = MAX_ROWS,
    numbered: bool = True,
    **how: Any,
) -> RobotLog:
    """Read a log of joints: CSV, a ROS bag, MCAP, Parquet, NPZ, HDF5, LeRobot, MATLAB, JSON lines.

    Columns are understood by their names, or as `columns` says; of two that may be the same channel
    nothing is guessed. Units are those that are named, or that the log says, else SI; numbers that
    hardly can be SI are in `RobotLog.suspected`.

    Args:
        path: A file or folder.
        name: What messages call it; the file's name otherwise.
        joints: Whose channels are read, in this order; all that have a name otherwise.
        robot: A description (a file, or what `load_robot` takes): its joints' names, which slide,
            and the addresses of MuJoCo's state vectors.
        columns: Which columns are which channels, as in a study: `{"q": "enc_{index}"}`,
            `{"tau": {"elbow": "motor 2 Nm"}}`, `{"time": "stamp"}`.
        units: Of channels or columns: `{"q": "deg", "tau.elbow": "mN.m"}`.
        ignore: Columns to leave out.
        every: Read one row of this many.
        window: Read rows between these times [s] since the first.
        max_rows: More are refused.
        numbered: Whether joints that nobody names are joint1, joint2 ... in the log's order.
        **how: What only some kinds of logs have: `rate` [Hz] where none has times; `topic` and
            `command_topic` of a bag, `demo` and `group` of HDF5, `env`, `episode`.

    Raises:
        LoadError: It cannot be read, has no times or no joints, or names are not clear; messages
            name keys as a study has them: `rate:` is the argument `rate`.
        TypeError: No kind of log has such an argument.
    """
    path = Path(path).expanduser()
    name = name or path.name
    known_keys = ("rate", *entry_keys())
    for key in how:
        if key not in known_keys:
            near = nearest(key, known_keys) or f"; there are {', '.join(known_keys)}"
            raise TypeError(f"read_log has no argument {key!r}{near}")
    if robot is not None and not isinstance(robot, RobotDescription):
        robot = RobotDescription.of(robot)
    facts = None if robot is None else robot.facts
    for joint in joints or ():
        if facts is not None and joint not in facts.joints:
            near = nearest(joint, facts.joints)
            raise LoadError(f"{name}: joints: the robot has no joint {joint!r} that moves{near}")
    if not isinstance(columns, ColumnsKey):
        columns = columns_key(columns, f"{name}: columns")
    known = Known(
        joints=None if joints is None else tuple(joints),
        others=() if facts is None else tuple(facts.joints),
        arm=() if facts is None else facts.arm,
        key=columns,
        ignore=tuple(ignore),
        order=mujoco_order(robot),
        numbered=numbered and joints is None and facts is None,
    )
    said = units if isinstance(units, Units) else units_from(units, name)
    part = Part(every=every, window=window, max_rows=max_rows)
    table = read_table(path, name, known, part, said, how)
    there = tuple(joints) if joints is not None else _joints(table)
    names = there if facts is None else tuple(each for each in there if each in facts.joints)
    others = ", ".join(each for each in there if each not in names)
    return RobotLog(
        table=table,
        names=names or there,
        said=said.with_written(table.units),
        robot=robot if names else None,
        left_out=(f"not joints of the robot: {others}",) if others else (),
    )


def _joints(table: Table) -> tuple[str, ...]:
    """Joints that have positions, in the log's order, else those that have anything."""
    pairs = (channel_of(column) for column in table.columns)
    return joints_of(table.columns) or tuple(dict.fromkeys(pair[1] for pair in pairs if pair))
