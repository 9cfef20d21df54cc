"""Data sets of LeRobot, version 2 and 3: a folder, of which one episode is read."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pyarrow as pa
import pyarrow.parquet

from pdoik.errors import LoadError

from ..key import Key, Keys
from ..recording import FloatArray
from .arrow_numbers import number_column
from .kinds import register
from .log import Column, Log

_CHANNELS = {"observation.state": "q", "action": "q_des"}  # where their names say nothing else
_INFO = Path("meta") / "info.json"


@register
class LeRobot(Log):
    """observation.state is positions and action commanded ones, of the joints in info.json."""

    kind = "a LeRobot data set"
    keys: ClassVar[Keys] = {
        "episode": Key("a whole number", "which episode of a LeRobot folder", "3", "the only one")
    }

    @classmethod
    def is_folder(cls, path: Path) -> bool:
        return (path / _INFO).is_file()

    def __init__(self, path: Path, name: str, given: Mapping[str, Any]) -> None:
        self.notes = []
        self._path, self._name = path, name
        try:
            info = json.loads((path / _INFO).read_text())
            self._fps = float(info["fps"])
            features = dict(info["features"])
            self._pattern = str(info["data_path"])
            self._chunk = int(info.get("chunks_size", 1000))
            count = int(info["total_episodes"])
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise LoadError(
                f"{name}: meta/info.json: expected fps, features, data_path and total_episodes of"
                f" LeRobot's version 2 or 3: {type(error).__name__}: {error}"
            ) from error
        if not self._fps > 0:
            raise LoadError(f"{name}: meta/info.json: expected fps above 0, got {self._fps:g}")
        self._episode = self._checked(given.get("episode"), count)
        columns = [Column(name="time", unit="s", converted=True)]
        for feature, content in features.items():
            columns += _columns(feature, content)
        self.columns = tuple(columns)
        self._places = {each.name: (each.array or each.name, each.index) for each in columns}
        self._counts = {each.array: each.count for each in columns if each.array}
        self.notes.append(f"episode {self._episode} of {count}")

    def _checked(self, episode: Any, count: int) -> int:
        if episode is None and count == 1:
            return 0
        whole = isinstance(episode, int) and not isinstance(episode, bool)
        if not whole or not 0 <= episode < count:
            came = "none was said" if episode is None else f"got {episode!r}"
            raise LoadError(
                f"{self._name}: episode: expected one of 0 to {count - 1}"
                f" as in 'episode: 0', {came}"
            )
        return int(episode)

    def _files(self) -> list[Path]:
        """Those that may hold the episode."""
        if "{episode_index" in self._pattern:
            try:
                file = self._pattern.format(
                    episode_chunk=self._episode // self._chunk, episode_index=self._episode
                )
            except (KeyError, IndexError, ValueError) as error:
                raise LoadError(
                    f"{self._name}: meta/info.json: data_path {self._pattern!r} is not understood"
                ) from error
            return [self._path / file]
        return sorted((self._path / "data").rglob("*.parquet"))

    def pieces(self, columns: Sequence[str]) -> Iterator[FloatArray]:
        places = [self._places[each] for each in columns]
        read = dict.fromkeys(f for f, _ in places if f != "time")
        wanted = [*read, "frame_index", "episode_index"]
        seen = 0
        for path in self._files():
            try:
                with pa.parquet.ParquetFile(path) as file:
                    lost = [each for each in wanted if each not in file.schema_arrow.names]
                    if lost:
                        raise LoadError(f"{self._name}: {path.name}: no column {lost[0]!r}")
                    groups = _groups(file, self._episode)
                    for batch in file.iter_batches(row_groups=groups, columns=wanted):
                        piece = self._piece(batch, places)
                        seen += len(piece)
                        yield piece
            except (pa.ArrowInvalid, OSError) as error:
                raise LoadError(f"{self._name}: {path.name}: cannot be read: {error}") from error
        if not seen:
            raise LoadError(f"{self._name}: no frame of episode {self._episode} in data/")

    def _piece(self, batch: Any, places: Sequence[tuple[str, int | None]]) -> FloatArray:
        """Numbers (R, c) of the frames of the episode."""
        mine = number_column(batch.column("episode_index"), "episode_index", self._name)
        at = np.flatnonzero(mine == self._episode)
        piece = np.empty((len(at), len(places)))
        cells: dict[str, FloatArray] = {}
        for k, (feature, index) in enumerate(places):
            if feature not in cells:
                name = "frame_index" if feature == "time" else feature
                cells[feature] = self._cells(batch.column(name), name)
            values = cells[feature][at]
            if feature == "time":
                values = values / self._fps
            piece[:, k] = values if index is None else values[:, index]
        return piece

    def _cells(self, values: Any, feature: str) -> FloatArray:
        """A feature's numbers, (R,) or (R, n)."""
        count = self._counts.get(feature)
        if count is None:
            return number_column(values, feature, self._name)
        if not (pa.types.is_list(values.type) or pa.types.is_fixed_size_list(values.type)):
            raise LoadError(
                f"{self._name}: {feature!r} holds {values.type}, expected lists of {count}"
            )
        flat = number_column(values.flatten(), feature, self._name)
        if len(flat) != count * len(values):
            raise LoadError(
                f"{self._name}: {feature!r} has {len(flat)} numbers in {len(values)} frames,"
                f" expected {count} in each"
            )
        return flat.reshape(len(values), count)


def _groups(file: Any, episode: int) -> list[int]:
    """Row groups that may hold the episode, by their statistics."""
    about = file.metadata
    if not about.num_row_groups:
        return []
    leaves = [about.row_group(0).column(k).path_in_schema for k in range(about.num_columns)]
    leaf = leaves.index("episode_index")
    found = []
    for k in range(about.num_row_groups):
        known = about.row_group(k).column(leaf).statistics
        if known is None or not known.has_min_max or known.min <= episode <= known.max:
            found.append(k)
    return found


def _columns(feature: str, content: Any) -> Iterator[Column]:
    shape = content.get("shape") if isinstance(content, dict) else None
    if not isinstance(shape, list) or len(shape) != 1 or not isinstance(shape[0], int):
        return
    if not str(content.get("dtype", "")).startswith("float"):
        return
    if feature == "timestamp":
        return
    names, count = content.get("names"), int(shape[0])
    if isinstance(names, dict):  # {"motors": [...]}
        names = next((each for each in names.values() if isinstance(each, list)), None)
    labels = names if isinstance(names, list) and len(names) == count else [""] * count
    for k, label in enumerate(labels):
        yield Column(
            name=f"{feature}[{k}]",
            array=feature,
            index=k,
            count=count,
            label=str(label),
            channel=_CHANNELS.get(feature, ""),
        )
