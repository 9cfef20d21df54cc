"""Recordings and commands as the command line reads and writes them."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pdoik._files import write_whole

from .messages import fail, tell

if TYPE_CHECKING:
    from pdoik.sim2real.study.columns import Table
    from pdoik.sim2real.study.recording import Recording

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


def read_motion(path: Path, joints: tuple[str, ...], *, commands: bool = False) -> Recording:
    """A file's channels for these joints.

    Args:
        path: A log of any kind that needs nothing told beside.
        joints: Of the model.
        commands: The file may lack positions: the motion then starts where it is commanded to.

    Raises:
        LoadError: Something in the file is not as expected.
    """
    from pdoik.sim2real.study.check_recording import to_recording
    from pdoik.sim2real.study.logs import Part
    from pdoik.sim2real.study.names.check_names import check_names
    from pdoik.sim2real.study.names.known import Known
    from pdoik.sim2real.study.read_log import read_log
    from pdoik.sim2real.study.units import Units

    table = read_log(path, path.name, Known(joints=joints), Part(), Units(), {})
    check_names(table, joints, ())
    for reading in table.readings:
        tell(f"{path.name}: {reading}")
    if commands:
        _with_positions(table, joints)
    return to_recording(table, joints, "validate", Units().with_written(table.units))


def _with_positions(table: Table, joints: tuple[str, ...]) -> None:
    for joint in joints:
        desired = table.columns.get(f"q_des.{joint}")
        if desired is not None:
            table.columns.setdefault(f"q.{joint}", desired)


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
