"""Poses any one of which will do, as a table: .csv with a row for each.

The columns are x y z [m] and the quaternion qw qx qy qz, its real part first. A first row of
names may put them in another order and add one called cost.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik.scenes import EntryError, read_text

from .target import rotation_of_xyzw

FloatArray = npt.NDArray[np.float64]

COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz")
_COST = "cost"


def read_grasp_file(path: Path) -> tuple[FloatArray, FloatArray | None]:
    """Targets, (N, 4, 4) [m], and their costs, (N,), or None where there is no such column.

    Raises:
        LoadError: Names the file, the line and what was expected.
    """
    reader = csv.reader(read_text(path).splitlines(), skipinitialspace=True)
    rows = [(reader.line_num, [word.strip() for word in row]) for row in reader]
    rows = [row for row in rows if any(row[1]) and not row[1][0].startswith("#")]
    names = list(COLUMNS)
    if rows and not _is_number(rows[0][1][0]):
        names = _names(path, *rows.pop(0))
    if not rows:
        raise EntryError(path, f"expected a row {' '.join(COLUMNS)} for each pose, got none")
    table = np.array([_numbers(path, line, words, names) for line, words in rows])
    column = {name: table[:, k] for k, name in enumerate(names)}
    poses = np.tile(np.eye(4), (len(table), 1, 1))
    poses[:, :3, 3] = np.column_stack([column[name] for name in COLUMNS[:3]])
    for T, wxyz, (line, _) in zip(
        poses, np.column_stack([column[name] for name in COLUMNS[3:]]), rows, strict=True
    ):
        try:
            T[:3, :3] = rotation_of_xyzw(np.roll(wxyz, -1), "qw qx qy qz")
        except ValueError as error:
            raise EntryError(path, str(error), f"line {line}") from error
    return poses, column.get(_COST)


def _names(path: Path, line: int, words: list[str]) -> list[str]:
    names = [word.lower() for word in words]
    expected = f"expected the columns {', '.join(COLUMNS)}, and perhaps {_COST}"
    for name in names:
        if name not in (*COLUMNS, _COST) or names.count(name) > 1:
            raise EntryError(
                path, f"{expected}; got {name!r} {names.count(name)} times", f"line {line}"
            )
    missing = [name for name in COLUMNS if name not in names]
    if missing:
        raise EntryError(path, f"{expected}; there is no {', '.join(missing)}", f"line {line}")
    return names


def _numbers(path: Path, line: int, words: list[str], names: list[str]) -> list[float]:
    try:
        found = [float(word) for word in words]
    except ValueError:
        found = []
    if len(found) != len(names) or not np.isfinite(found).all():
        what = f"expected {len(names)} finite numbers {' '.join(names)}, got {', '.join(words)}"
        raise EntryError(path, what, f"line {line}")
    return found


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
