"""Joint-level logs, as a controller or a simulator writes them."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik.errors import LoadError

from .expected import expected_of

FloatArray = npt.NDArray[np.float64]

SIGNALS = ("q_des", "q", "dq", "tau")
_OBJECT = tuple(f"object.{name}" for name in ("x", "y", "z", "qw", "qx", "qy", "qz"))
_UNIT = 1e-2  # how far a quaternion's norm may be from 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Log:
    """What a robot's joints did, with the joints in the robot's order.

    Attributes:
        name: Of the file.
        time: Increasing, (T,) [s].
        signals: Those of `SIGNALS` that the file has, (T, n) each: positions wanted and measured
            [rad] or [m], speeds, torques [N m] or forces [N].
        object_pose: T_base_object, the H1's T_pelvis_object, (T, 4, 4); None without the object's
            columns.
        expected: Of a proposed motion, what it is expected to settle; of a path, what came of it;
            as Markdown.
        row_notes: What to say of each row instead of its number, () or T of them.
    """

    name: str
    time: FloatArray
    signals: dict[str, FloatArray]
    object_pose: FloatArray | None
    expected: str = ""
    row_notes: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def postures(self) -> list[str]:
        """The signals a robot can be posed by: "q" and "q_des", those that there are."""
        return [name for name in ("q", "q_des") if name in self.signals]

    def at(self, elapsed: float, signal: str) -> FloatArray:
        """A signal `elapsed` seconds after the first row, linear between rows, (n,)."""
        values = self.signals[signal]
        t = self.time[0] + elapsed
        return np.array([np.interp(t, self.time, column) for column in values.T])

    def row(self, elapsed: float) -> int:
        """The last row not after that time."""
        t = self.time[0] + elapsed
        return max(0, int(np.searchsorted(self.time, t, side="right")) - 1)


def load_log(path: str | Path, joint_names: Sequence[str]) -> Log:
    """Read a CSV file with the columns time, q.<joint>, q_des.<joint>, dq.<joint>, tau.<joint>.

    Of q and q_des one is needed, for every joint of the robot; a signal that only some joints have
    is an error, columns of other joints and other columns are passed over. The columns object.x,
    .y, .z, .qw, .qx, .qy, .qz, if there are any, are an object's pose in the base frame; in a log
    of the H1 in the pelvis' frame, as `bench.humanoid` writes it.

    Args:
        path: Of the file. Metres, radians, seconds.
        joint_names: Of the robot.

    Raises:
        LoadError: Names the file and the column or row (the header is row 1) that is wrong.
    """
    path = Path(path)
    rows = _read(path)
    header = [name.strip() for name in rows[0]]
    twice = sorted({name for name in header if header.count(name) > 1})
    if twice:
        raise LoadError(f"{path}: column {twice[0]!r} is there {header.count(twice[0])} times")
    if "time" not in header:
        raise LoadError(f"{path}: no column 'time'; the first row has {_some(header)}")
    wanted = {"time": ["time"]}
    for signal in SIGNALS:
        columns = [f"{signal}.{joint}" for joint in joint_names]
        missing = [name for name in columns if name not in header]
        if missing and len(missing) < len(columns):
            raise LoadError(f"{path}: no column {missing[0]!r}, though other joints have theirs")
        if not missing:
            wanted[signal] = columns
    if "q" not in wanted and "q_des" not in wanted:
        raise LoadError(
            f"{path}: expected columns q.<joint> or q_des.<joint> for"
            f" {', '.join(joint_names)}; got {_some(header)}"
        )
    if any(name in header for name in _OBJECT):
        missing = [name for name in _OBJECT if name not in header]
        if missing:
            raise LoadError(f"{path}: no column {missing[0]!r}, though {_OBJECT[0][:6]} has others")
        wanted["object"] = list(_OBJECT)

    names = [name for columns in wanted.values() for name in columns]
    table = _numbers(path, rows, header, names)
    parts = dict(
        zip(
            wanted,
            np.split(table, np.cumsum([len(columns) for columns in wanted.values()])[:-1], axis=1),
            strict=True,
        )
    )
    time = parts.pop("time")[:, 0]
    back = np.flatnonzero(np.diff(time) <= 0)
    if len(back):
        i = int(back[0])
        raise LoadError(
            f"{path}: row {i + 3}, column 'time': expected more than {time[i]:g}, got"
            f" {time[i + 1]:g}"
        )
    object_table = parts.pop("object", None)
    return Log(
        name=path.name,
        time=time,
        signals=parts,
        object_pose=None if object_table is None else _poses(path, object_table),
        expected=expected_of(path),
    )


def _read(path: Path) -> list[list[str]]:
    """The rows of the file; the first has the names."""
    if not path.is_file():
        raise LoadError(f"{path}: {'is a folder' if path.is_dir() else 'no such file'}")
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = list(csv.reader(file, strict=True))
    except (UnicodeDecodeError, csv.Error) as error:
        raise LoadError(f"{path}: not a CSV file that can be read: {error}") from error
    while rows and not any(cell.strip() for cell in rows[-1]):
        rows.pop()
    if len(rows) < 2:
        raise LoadError(
            f"{path}: expected a row of names and rows of numbers, got {len(rows)} rows"
        )
    for i, row in enumerate(rows):
        if len(row) != len(rows[0]):
            raise LoadError(
                f"{path}: row {i + 1} has {len(row)} cells, the first row has {len(rows[0])}"
            )
    return rows


def _numbers(path: Path, rows: list[list[str]], header: list[str], names: list[str]) -> FloatArray:
    """The named columns, (T, len(names)), all finite."""
    columns = [header.index(name) for name in names]
    table = np.empty((len(rows) - 1, len(names)))
    for k, (name, column) in enumerate(zip(names, columns, strict=True)):
        try:
            table[:, k] = [float(row[column]) for row in rows[1:]]
        except ValueError:
            pass  # found below
        else:
            if np.isfinite(table[:, k]).all():
                continue
        i = next(i for i, row in enumerate(rows[1:]) if not _is_number(row[column]))
        raise LoadError(
            f"{path}: row {i + 2}, column {name!r}: expected a finite number, got"
            f" {rows[i + 1][column][:40]!r}"
        )
    return table


def _is_number(cell: str) -> bool:
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False


def _poses(path: Path, table: FloatArray) -> FloatArray:
    """Poses (T, 4, 4) from rows x y z qw qx qy qz."""
    norms = np.linalg.norm(table[:, 3:], axis=1)
    off = np.flatnonzero(np.abs(norms - 1) > _UNIT)
    if len(off):
        i = int(off[0])
        raise LoadError(
            f"{path}: row {i + 2}, columns object.qw to object.qz: expected a quaternion of norm 1,"
            f" got {norms[i]:.4g}"
        )
    T = np.tile(np.eye(4), (len(table), 1, 1))
    w, x, y, z = (table[:, 3:] / norms[:, None]).T
    T[:, 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], -1)
    T[:, 1, :3] = np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], -1)
    T[:, 2, :3] = np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1)
    T[:, :3, 3] = table[:, :3]
    return T


def _some(names: list[str]) -> str:
    shown = ", ".join(name[:40] for name in names[:6])
    return f"{shown}, ..." if len(names) > 6 else shown
