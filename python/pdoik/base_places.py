"""Where a base may stand, and how good each place is: a table, its files and its picture."""

from __future__ import annotations

import csv
import io
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from pdoik._extras import asks_for
from pdoik._files import write_whole
from pdoik.errors import LoadError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FloatArray = npt.NDArray[np.float64]

Moves = Literal["base", "part"]

STATUSES = (
    "whole",
    "pieces",
    "impossible",
    "not_found",
    "time_limit",
    "unreached",
    "not_looked_at",
)
FIGURES = ("reached", "followed", "length", "clearance", "limits", "singularity")
FAR = 0.1  # of obstacles and singularities: a score of 1 [m]
MOST = 6.0  # of a score: clearances are measured so far
FAR_FROM_LIMITS = 0.5  # the same of limits [rad] or [m]
_AXES = ("x", "y", "z", "yaw")
_UNREADABLE = (OSError, EOFError, zipfile.BadZipFile, zlib.error, ValueError, TypeError, KeyError)


def places_of(region: Mapping[str, Any] | npt.ArrayLike) -> FloatArray:
    """Candidates as rows x, y, z, yaw, shape (K, 4) [m], [rad].

    Args:
        region: What is tried of each of x, y, z and yaw: one number, or (from, to, step), both ends
            included; what is left out is 0. Or the rows themselves.

    Raises:
        ValueError: Another name or shape, NaN, a range the wrong way round.
    """
    if not isinstance(region, Mapping):
        rows = np.array(region, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != 4 or not len(rows):
            raise ValueError(f"region has shape {rows.shape}, expected (K, 4): x, y, z, yaw")
        if not np.isfinite(rows).all():
            raise ValueError("region holds NaN or infinity")
        return rows
    for name in region:
        if name not in _AXES:
            raise ValueError(f"region has {name!r}, expected only {', '.join(_AXES)}")
    values = [_range(name, region.get(name, 0.0)) for name in _AXES]
    return np.stack(np.meshgrid(*values, indexing="ij"), axis=-1).reshape(-1, 4)


def _range(name: str, given: Any) -> FloatArray:
    numbers = np.atleast_1d(np.asarray(given, dtype=np.float64))
    if numbers.shape not in ((1,), (3,)) or not np.isfinite(numbers).all():
        raise ValueError(f"region has {given!r} for {name}, expected a number or (from, to, step)")
    if len(numbers) == 1:
        return numbers
    low, high, step = numbers
    if not (step > 0 and high >= low):
        raise ValueError(f"region goes from {low:g} to {high:g} by {step:g} in {name}")
    spread: FloatArray = low + step * np.arange(np.floor((high - low) / step + 1e-9) + 1)
    return spread.round(12)


@dataclass(frozen=True, slots=True, kw_only=True)
class BasePlace:
    """A place of a robot's base, and how well paths can be followed from it."""

    index: int
    x: float  # [m]
    y: float  # [m]
    z: float  # [m]
    yaw: float  # [rad]
    status: str  # of STATUSES
    reached: float  # of the stations that were looked at first, the share that can be reached
    followed: float  # the largest share of the stations that one motion meets, of the worst path
    length: float  # of joints' ways along all paths [rad] or [m]; NaN where not all are whole
    clearance: float  # least along all paths; as in PathResult it ends at 0.6 m [m]
    limits: float  # how near a joint comes to a limit [rad] or [m]
    singularity: float  # how near a singularity is, see Result.singular_distance [m]
    score: float

    @property
    def success(self) -> bool:
        """Whether all paths are whole."""
        return self.status == "whole"

    @property
    def T(self) -> FloatArray:
        """Pose of the base in the world, or of the part in the base, (4, 4) [m]."""
        return transform_of(np.array([self.x, self.y, self.z, self.yaw]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BasePlaces:
    """How well paths can be followed from each of some places.

    The score says how much room there is. Of a place from which all paths are whole it is the least
    of three: clearance and distance from singularities over `FAR`, distance from limits over
    `FAR_FROM_LIMITS`. Of others it is below 0: `followed - 1`, or `reached - 2` where that was not
    tried.
    """

    places: FloatArray  # (K, 4): x, y, z [m], yaw [rad]
    statuses: npt.NDArray[np.uint8]  # (K,), places in STATUSES
    figures: FloatArray  # (K, 6): FIGURES
    move: Moves = "base"  # what stands there
    seconds: float = 0.0  # that it took
    ways: tuple[FloatArray, ...] = ()  # where the tool goes, (N, 3) each, in the paths' frame [m]

    def __post_init__(self) -> None:
        """Check shapes.

        Raises:
            ValueError: They do not belong together.
        """
        count = len(self.places)
        shapes = self.places.shape, self.statuses.shape, self.figures.shape
        if shapes != ((count, 4), (count,), (count, len(FIGURES))) or self.move not in (
            "base",
            "part",
        ):
            raise ValueError("its arrays do not belong together")

    def __len__(self) -> int:
        return len(self.places)

    def __getitem__(self, index: int) -> BasePlace:
        k = range(len(self))[index]
        figures = dict(zip(FIGURES, self.figures[k].tolist(), strict=True))
        place = dict(zip(_AXES, self.places[k].tolist(), strict=True))
        status, score = STATUSES[self.statuses[k]], float(self.score[k])
        return BasePlace(index=k, status=status, score=score, **place, **figures)

    @property
    def whole(self) -> npt.NDArray[np.bool_]:
        """Whether all paths are whole from each place, (K,)."""
        return np.asarray(self.statuses == STATUSES.index("whole"))

    @property
    def done(self) -> npt.NDArray[np.bool_]:
        """Which places were looked at, (K,): all, but for one that was interrupted."""
        return np.asarray(self.statuses != STATUSES.index("not_looked_at"))

    @property
    def score(self) -> FloatArray:
        """Shape (K,); see the class."""
        reached, followed, _, clearance, limits, singularity = self.figures.T
        room = np.minimum(np.minimum(clearance, singularity) / FAR, limits / FAR_FROM_LIMITS)
        tried = np.where(
            self.statuses == STATUSES.index("unreached"), reached - 2.0, followed - 1.0
        )
        room = np.clip(room, 0.0, MOST)
        score: FloatArray = np.where(self.whole, room, np.minimum(tried, -1e-9))
        return np.where(self.done, score, -np.inf)

    @property
    def order(self) -> npt.NDArray[np.int64]:
        """Places from the best to the worst; of the same score the shortest motion first, (K,)."""
        length = np.where(np.isfinite(self.figures[:, 2]), self.figures[:, 2], np.inf)
        return np.lexsort((length, -self.score))

    @property
    def best(self) -> BasePlace | None:
        """The one with the most room; None where no place lets all paths be whole."""
        return self[int(self.order[0])] if self.whole.any() else None

    def map(self, path: str | Path | None = None, *, title: str = "") -> Figure:
        """A map of x and y: the best score of all heights and yaws, with an arrow for its yaw.

        Args:
            path: Of a .png file to write, if any.
            title: Above it.

        Raises:
            MissingExtraError: matplotlib is not installed.
        """
        with asks_for("plot"):
            from pdoik.picture import place_map
        return place_map(self, path, title)

    def save(self, path: str | Path) -> None:
        """Write a .csv or .npz file that `load` reads; .csv is without `ways`.

        Replaces a file only when all is written.

        Raises:
            ValueError: The name ends in something else.
        """
        if _suffix(path) == ".csv":
            text = io.StringIO()
            writer = csv.writer(text, lineterminator="\n")
            writer.writerow([*_columns(self.move), "seconds"])
            score = self.score
            for k, status in enumerate(self.statuses):
                row = [*self.places[k].tolist(), STATUSES[status], *self.figures[k].tolist()]
                writer.writerow([*row, float(score[k]), self.seconds])
            write_whole(path, text.getvalue())
            return
        write_whole(path, npz_of(self))

    @classmethod
    def load(cls, path: str | Path) -> BasePlaces:
        """Read what `save` wrote.

        Raises:
            LoadError: The file is missing or is something else.
        """
        try:
            return _from_csv(path) if _suffix(path) == ".csv" else from_npz(Path(path).read_bytes())
        except (*_UNREADABLE, csv.Error, IndexError) as error:
            raise LoadError(f"{path}: not a file of places: {error}") from error

    def __repr__(self) -> str:
        best = self.best
        where = "" if best is None else (
            f", best at x {best.x:.3g}, y {best.y:.3g}, z {best.z:.3g}, yaw {best.yaw:.3g}"
        )  # fmt: skip
        count = int(self.whole.sum())
        return f"<BasePlaces of {len(self)}, whole from {count}{where}, in {self.seconds:.3g} s>"


def transform_of(place: FloatArray) -> FloatArray:
    """Transform of x, y, z, yaw, (4, 4) [m]."""
    x, y, z, yaw = place
    T = np.eye(4)
    T[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    T[:3, 3] = x, y, z
    return T


def npz_of(places: BasePlaces, **more: Any) -> bytes:
    """All of it as an .npz file's content, with other arrays."""
    ends = np.cumsum([len(way) for way in places.ways])
    points = np.concatenate(places.ways) if places.ways else np.empty((0, 3))
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        places=places.places,
        statuses=places.statuses,
        figures=places.figures,
        move=np.array(places.move),
        seconds=places.seconds,
        points=points,
        ends=ends,
        **more,
    )
    return buffer.getvalue()


def from_npz(content: bytes) -> BasePlaces:
    """The same again.

    Raises:
        ValueError: It is something else, like the other errors of NumPy and of zip files.
    """
    with np.load(io.BytesIO(content), allow_pickle=False) as data:
        statuses = data["statuses"]
        if statuses.dtype != np.uint8 or (len(statuses) and statuses.max() >= len(STATUSES)):
            raise ValueError("its statuses are others")
        ways: Sequence[FloatArray] = np.split(data["points"], data["ends"][:-1].astype(int))
        return BasePlaces(
            places=data["places"],
            statuses=statuses,
            figures=data["figures"],
            move=str(data["move"]),  # type: ignore[arg-type]
            seconds=float(data["seconds"]),
            ways=tuple(ways) if len(data["ends"]) else (),
        )


def _columns(move: Moves) -> list[str]:
    return [*(f"{move}_{name}" for name in _AXES), "status", *FIGURES, "score"]


def _from_csv(path: str | Path) -> BasePlaces:
    with Path(path).open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    move: Moves = "part" if header[0].startswith("part") else "base"
    if header != [*_columns(move), "seconds"] or not rows:
        raise ValueError(f"its columns are not {', '.join(_columns(move))}, seconds")
    table = np.array([[*row[:4], *row[5:]] for row in rows], dtype=np.float64)
    return BasePlaces(
        places=table[:, :4],
        statuses=np.array([STATUSES.index(row[4]) for row in rows], dtype=np.uint8),
        figures=table[:, 4 : 4 + len(FIGURES)],
        move=move,
        seconds=float(table[0, -1]),
    )


def _suffix(path: str | Path) -> str:
    suffix = Path(path).suffix.lower()
    if suffix not in (".csv", ".npz"):
        raise ValueError(f"expected a name that ends in .csv or .npz, got {Path(path).name!r}")
    return suffix
