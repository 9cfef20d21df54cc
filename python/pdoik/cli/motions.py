"""Recordings and commands as the command line reads and writes them."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import numpy.typing as npt
import typer

from pdoik._files import write_whole

from .messages import fail, tell

if TYPE_CHECKING:
    from pdoik.recordings import Reading, Recording

FloatArray = npt.NDArray[np.float64]


def check_files(model: Path, motion: Path, output: Path, robot: Path | None = None) -> None:
    """Leave with status 2 unless all can be read and the output may be written."""
    read = [path for path in (model, motion, robot) if path is not None]
    for path in read:
        if path.is_dir():
            fail(f"{path}: is a folder, expected a file")
        if not path.is_file():
            fail(f"{path}: no such file")
    if output.is_dir():
        fail(f"--out {output}: is a folder, expected a file")
    if not output.parent.is_dir():
        fail(f"--out {output}: no such folder: {output.parent}")
    if output.exists() and any(output.samefile(path) for path in read):
        fail(f"--out {output}: is also read, expected another file")


Columns = Annotated[
    Path | None,
    typer.Option(
        help="A study whose 'columns:', 'units:' and 'ignore:' say how the logs are read; without"
        " it names and units are pdoik's, or as the names say."
    ),
]


def reading_of(columns: Path | None) -> Reading:
    """How logs are read: as a study says, else by pdoik's own names and units.

    Raises:
        LoadError: The study is none.
    """
    from pdoik.recordings import Reading
    from pdoik.sim2real.study import reading_of_study

    return Reading() if columns is None else reading_of_study(columns)


def read_motion(
    path: Path,
    joints: tuple[str, ...],
    reading: Reading | None = None,
    *,
    commands: bool = False,
) -> Recording:
    """A file's channels for these joints.

    Args:
        path: A log of any kind.
        joints: Of the model.
        reading: Names and units of its columns; without it they are pdoik's, or understood.
        commands: The file may lack positions: the motion then starts where it is commanded to.

    Raises:
        LoadError: Something in the file is not as expected.
    """
    from pdoik.recordings import Reading, check_names, read_log

    reading = reading or Reading()
    log = read_log(
        path,
        joints=joints,
        columns=reading.key,
        units=reading.said_units,
        ignore=reading.ignore,
    )
    check_names(log.table, joints, reading.ignore)
    for said in (reading.note, *log.table.readings):
        if said:
            tell(f"{path.name}: {said}")
    if commands:
        _with_positions(log.table.columns, joints)
    return log.recording("validate")


def _with_positions(columns: dict[str, FloatArray], joints: tuple[str, ...]) -> None:
    for joint in joints:
        desired = columns.get(f"q_des.{joint}")
        if desired is not None:
            columns.setdefault(f"q.{joint}", desired)


def write_motion(
    path: Path, joints: tuple[str, ...], time: FloatArray, channels: dict[str, FloatArray]
) -> None:
    """A CSV of time and of each channel's columns, (T, n) each."""
    names = [f"{channel}.{joint}" for channel in channels for joint in joints]
    text = io.StringIO()
    np.savetxt(
        text,
        np.column_stack([time, *channels.values()]),
        fmt="%.9g",
        delimiter=",",
        header=",".join(["time", *names]),
        comments="",
    )
    write_whole(path, text.getvalue())
