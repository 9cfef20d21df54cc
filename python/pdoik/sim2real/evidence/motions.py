"""motions.npz: how the machine moved, how it was simulated, and what the model left of it.

What `pdoik view REPORT` shows together with the diagnosis (schema pdoik.motions/1).
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pdoik.errors import LoadError
from pdoik.recordings import FloatArray, Recording

from ..report import Replay, ReportData, Traces

SCHEMA = "pdoik.motions/1"
FILE_NAME = "motions.npz"

_RATE = 100.0  # of what is kept, at most [Hz]
_LONGEST = 30_000  # samples of a recording
_ARRAYS = ("time", "q", "before", "after")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """A recording, and the same commands simulated; (T, n) in the order of the joints."""

    name: str
    role: str  # fit or validate
    time: FloatArray  # (T,) [s]
    q: FloatArray  # as recorded [rad] or [m]
    before: FloatArray  # residual of the model as it was, NaN where nothing is known
    after: FloatArray  # residual with the findings
    base: FloatArray | None = None  # (T, 7) x y z qw qx qy qz of a base that floats
    replay: Replay | None = None  # None: not simulated


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motions:
    """Every recording of a study."""

    title: str
    joints: tuple[str, ...]  # (n)
    units: tuple[str, ...]  # (n) of the residuals
    position_units: tuple[str, ...]  # (n) rad or m
    residual_of: str  # what was measured and predicted, in words
    noise_floor: FloatArray  # (n,) in these units
    motions: tuple[Motion, ...]

    @classmethod
    def of(cls, data: ReportData, recordings: Iterable[Recording] = ()) -> Motions:
        """What a report shows, thinned to 100 Hz.

        Args:
            data: of the report.
            recordings: of the study, which know where a base that floats was.
        """
        replays = {replay.recording: replay for replay in data.replays}
        bases = {each.name: each for each in recordings if each.base is not None}
        n = len(data.joints)
        return cls(
            title=data.title,
            joints=data.joints,
            units=data.units,
            position_units=tuple(data.position_unit(j) for j in range(n)),
            residual_of=data.residual_of,
            noise_floor=data.noise_floor,
            motions=tuple(
                _motion(each, replays.get(each.name), bases.get(each.name))
                for each in data.recordings
            ),
        )

    def to_bytes(self) -> bytes:
        """The file's content."""
        arrays: dict[str, FloatArray] = {"noise_floor": self.noise_floor}
        words = {name: np.array(getattr(self, name)) for name in _WORDS}
        words["recordings"] = np.array([each.name for each in self.motions])
        words["roles"] = np.array([each.role for each in self.motions])
        words["hows"] = np.array(["" if m.replay is None else m.replay.how for m in self.motions])
        for i, motion in enumerate(self.motions):
            arrays |= {f"{i}.{name}": getattr(motion, name) for name in _ARRAYS}
            if motion.base is not None:
                arrays[f"{i}.base"] = motion.base
            if motion.replay is not None:
                for name in ("time", "recorded", "before", "after"):
                    arrays[f"{i}.replay.{name}"] = getattr(motion.replay, name)
                if motion.replay.horizon is not None:
                    arrays[f"{i}.replay.horizon"] = np.array(motion.replay.horizon)
        small = {
            name: array if name.endswith(("time", "horizon")) else array.astype(np.float32)
            for name, array in arrays.items()
        }
        file = io.BytesIO()
        np.savez_compressed(file, allow_pickle=False, schema=np.array(SCHEMA), **words, **small)
        return file.getvalue()

    @classmethod
    def load(cls, path: str | Path) -> Motions:
        """The motions of a file, or of the motions.npz in a folder.

        Raises:
            LoadError: there is none, or it is not one.
        """
        path = Path(path)
        path = path / FILE_NAME if path.is_dir() else path
        try:
            with np.load(path, allow_pickle=False) as file:
                content = dict(file)
        except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
            raise LoadError(f"{path}: cannot be read: {error}") from None
        schema = content.get("schema")
        if schema is None or str(schema) != SCHEMA:
            raise LoadError(f"{path}: schema: expected {SCHEMA!r}, got {schema}")
        try:
            return _of_content(content)
        except KeyError as error:
            raise LoadError(f"{path}: {error} is missing") from None
        except (ValueError, IndexError) as error:
            raise LoadError(f"{path}: {error}") from None


_WORDS = ("title", "joints", "units", "position_units", "residual_of")


def _motion(traces: Traces, replay: Replay | None, recording: Recording | None) -> Motion:
    rows = _rows(traces.time)
    base = None
    if recording is not None and recording.base is not None:
        base = _at(traces.time[rows], recording.time, recording.base)
        base[:, 3:] /= np.linalg.norm(base[:, 3:], axis=1, keepdims=True)
    if replay is not None:
        kept = _rows(replay.time)
        replay = Replay(
            recording=replay.recording,
            time=replay.time[kept],
            recorded=replay.recorded[kept],
            before=replay.before[kept],
            after=replay.after[kept],
            how=replay.how,
            horizon=replay.horizon,
        )
    return Motion(
        name=traces.name,
        role=traces.role,
        base=base,
        replay=replay,
        **{name: getattr(traces, name)[rows] for name in _ARRAYS},
    )


def _rows(time: FloatArray) -> slice:
    """Every so many samples."""
    if len(time) < 2:
        return slice(None)
    period = float(time[1] - time[0])
    return slice(None, None, max(1, round(1.0 / (_RATE * period)), -(-len(time) // _LONGEST)))


def _at(time: FloatArray, known: FloatArray, values: FloatArray) -> FloatArray:
    """Columns at other times; quaternions must not jump from one sign to the other."""
    signs = np.ones(len(values))
    signs[1:] = np.cumprod(
        np.where(np.sum(values[1:, 3:] * values[:-1, 3:], axis=1) < 0.0, -1.0, 1.0)
    )
    steady = np.column_stack([values[:, :3], values[:, 3:] * signs[:, None]])
    return np.column_stack([np.interp(time, known, column) for column in steady.T])


def _of_content(content: Mapping[str, FloatArray]) -> Motions:
    joints = tuple(str(each) for each in content["joints"])
    motions = []
    for i, (name, role, how) in enumerate(
        zip(content["recordings"], content["roles"], content["hows"], strict=True)
    ):
        arrays = {each: _wide(content[f"{i}.{each}"]) for each in _ARRAYS}
        shape = (len(arrays["time"]), len(joints))
        for each in _ARRAYS[1:]:
            if arrays[each].shape != shape:
                raise ValueError(
                    f"{i}.{each} has shape {arrays[each].shape}, expected {shape}: another study's"
                )
        replay = None
        if f"{i}.replay.time" in content:
            horizon = content.get(f"{i}.replay.horizon")
            replay = Replay(
                recording=str(name),
                how=str(how),
                horizon=None if horizon is None else float(horizon),
                **{
                    each: _wide(content[f"{i}.replay.{each}"])
                    for each in ("time", "recorded", "before", "after")
                },
            )
        base = content.get(f"{i}.base")
        motions.append(
            Motion(
                name=str(name),
                role=str(role),
                base=None if base is None else _wide(base),
                replay=replay,
                **arrays,
            )
        )
    return Motions(
        title=str(content["title"]),
        joints=joints,
        units=tuple(str(each) for each in content["units"]),
        position_units=tuple(str(each) for each in content["position_units"]),
        residual_of=str(content["residual_of"]),
        noise_floor=_wide(content["noise_floor"]),
        motions=tuple(motions),
    )


def _wide(array: FloatArray) -> FloatArray:
    return np.asarray(array, dtype=np.float64)
