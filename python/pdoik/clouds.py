"""Point clouds from files: .pcd, .ply, .npy, and columns of text (.xyz, .txt, .csv)."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from io import BufferedReader
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik._extras import asks_for
from pdoik._ply import read_ply
from pdoik.errors import LoadError, MissingExtraError

Points = npt.NDArray[np.float64]  # (N, 3), [m]

_PCD_HEADER_LINES = 10  # that pypcd4 reads, without remarks
_MOST_COLUMNS = 10_000  # of a PCD file; the widest descriptors have about two thousand
_MOST_EXPANSION = 100  # what a byte of a file can hold: LZF packs at most 264 into three


def load_cloud(path: str | Path) -> Points:
    """The points of a file, (N, 3) [m], in the file's frame and order.

    Rows with NaN or infinity, which depth cameras write where they saw nothing, are left out.
    Units are the file's own: what was saved in millimetres comes out a thousand times too large.

    Args:
        path: The suffix says what is read: .pcd (ascii, binary, binary_compressed; the fields
            x, y, z), .ply (vertices; faces are ignored), .npy of shape (N, 3) or (H, W, 3), and
            .xyz, .txt, .csv (the columns named x, y, z, or else the first three).

    Raises:
        LoadError: Another suffix; a file that is missing, malformed, cut short, or holds no
            finite point.
        MissingExtraError: .pcd takes the extra files.
    """
    path = Path(path)
    read = _READERS.get(path.suffix.lower())
    if read is None:
        raise LoadError(
            f"{path}: expected a point cloud ({', '.join(_READERS)}), got {path.suffix!r}"
        )
    if not path.is_file():
        raise LoadError(f"{path}: {'is a folder' if path.is_dir() else 'no such file'}")
    try:
        # Whatever is no finite double is left out below, and old headers are as good as new ones.
        with warnings.catch_warnings(), np.errstate(invalid="ignore", over="ignore"):
            warnings.simplefilter("ignore")
            points = np.asarray(read(path), dtype=np.float64)
    except (LoadError, MissingExtraError):
        raise
    except Exception as error:  # the readers raise whatever their parsing stumbles over
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise LoadError(
            f"{path}: not a {path.suffix.lower()} file that can be read: {reason}"
        ) from error
    if points.ndim != 2 or points.shape[1] != 3:
        raise LoadError(f"{path}: expected points of shape (N, 3), got {points.shape}")
    finite = points[np.isfinite(points).all(axis=1)]
    if not len(finite):
        raise LoadError(f"{path}: expected points, got {len(points)} rows, none of them finite")
    return np.ascontiguousarray(finite)


@asks_for("files")
def _read_pcd(path: Path) -> Points:
    from pypcd4.pypcd4 import PointCloud

    with path.open("rb") as file:
        _check_pcd_header(path, file)
        file.seek(0)
        cloud = PointCloud.from_fileobj(file)
    missing = [name for name in "xyz" if name not in cloud.fields]
    if missing:
        raise LoadError(f"{path}: expected fields x, y, z, got {' '.join(cloud.fields)}")
    rows = np.atleast_1d(cloud.pc_data)
    if len(rows) != cloud.points:
        raise LoadError(f"{path}: the header promises {cloud.points} points, got {len(rows)}")
    return np.column_stack([rows[name] for name in "xyz"])


def _check_pcd_header(path: Path, file: BufferedReader) -> None:
    """Refuses what could not be in the file, before memory is taken for it.

    pypcd4 names every column that COUNT claims, and makes room for every point that POINTS does.
    """
    from pypcd4.pypcd4 import MetaData

    lines: list[str] = []
    for raw in file:
        line = raw.decode("utf-8").strip()
        if line and not line.startswith("#"):
            lines.append(line)
        if line.startswith("DATA") or len(lines) >= _PCD_HEADER_LINES:
            break
    header = MetaData.parse_header(lines)
    n_columns = sum(header.count)
    if n_columns > _MOST_COLUMNS:
        raise LoadError(f"{path}: expected at most {_MOST_COLUMNS} columns, got {n_columns}")
    n_bytes = header.points * sum(
        size * count for size, count in zip(header.size, header.count, strict=True)
    )
    held = _MOST_EXPANSION * path.stat().st_size
    if n_bytes > held:
        raise LoadError(
            f"{path}: the header promises {header.points} points, more than a file of this size"
            " can hold"
        )


def _read_ply(path: Path) -> Points:
    return read_ply(path.read_bytes()).vertices


def _read_npy(path: Path) -> Points:
    array = np.load(path, allow_pickle=False)
    if not isinstance(array, np.ndarray):
        raise LoadError(f"{path}: expected one array, got an archive of several")
    if array.dtype.kind not in "fiu":
        raise LoadError(f"{path}: expected numbers, got dtype {array.dtype}")
    if array.ndim == 3:  # an organised cloud, (H, W, 3)
        array = array.reshape(-1, array.shape[-1])
    return np.asarray(array, dtype=np.float64)


def _read_text(path: Path) -> Points:
    lines = [line for line in path.read_text(encoding="utf-8-sig").splitlines() if line.strip()]
    lines = [line for line in lines if not line.lstrip().startswith(("#", "//"))]
    if not lines:
        raise LoadError(f"{path}: expected rows of x y z, got an empty file")
    delimiter = next((mark for mark in ",;" if mark in lines[0]), None)
    columns, n_header_rows = _columns(lines[0].split(delimiter))
    rows = np.loadtxt(
        lines,
        delimiter=delimiter,
        skiprows=n_header_rows,
        usecols=columns,
        ndmin=2,
        dtype=np.float64,
    )
    return np.asarray(rows, dtype=np.float64)


def _columns(first_row: list[str]) -> tuple[list[int], int]:
    """Which columns hold x, y, z, and how many rows (0 or 1) name them."""
    names = [name.strip().strip('"').lower() for name in first_row]
    if all(name in names for name in "xyz"):
        return [names.index(name) for name in "xyz"], 1
    return [0, 1, 2], 0


_READERS: dict[str, Callable[[Path], Points]] = {
    ".pcd": _read_pcd,
    ".ply": _read_ply,
    ".npy": _read_npy,
    ".xyz": _read_text,
    ".txt": _read_text,
    ".csv": _read_text,
}
