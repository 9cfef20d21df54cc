"""What kinds of logs that hold arrays share: their columns, joints' names and rates."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pdoik.errors import LoadError

from ..key import Key
from ..recording import FloatArray
from .log import Column

ENV = Key("a whole number", "which of several environments side by side", "0", "the only one")
"""The key of an entry that selects an environment."""

ROWS = 16384
"""Rows of an array read at a time."""

_PERIODS = ("dt", "period", "timestep", "time_step", "sample_time", "sampling_period")
_RATES = (
    *("fps", "rate", "frequency", "freq", "hz", "control_freq", "control_frequency"),
    *("sample_rate", "sampling_rate", "sampling_frequency", "control_rate"),
)
_NAMES = ("joint_names", "joints", "names", "labels")


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where the numbers of a column are."""

    array: str
    index: int | None = None  # of its second axis
    field: str = ""  # of its records
    env: int | None = None  # of its second axis, where the index is of the third


def columns_of(
    array: str,
    shape: Sequence[int],
    fields: Sequence[str] = (),
    labels: Sequence[str] = (),
    unit: str = "",
    aside: str = "",
    env: int | None = None,
) -> dict[Column, Place]:
    """Columns of an array of numbers (T,) or (T, n), or of records (T,); none of any other.

    Of (T, E, n), as of E environments side by side, those of one.
    """
    if len(shape) == 1 and fields:
        return {
            Column(name=f"{array}.{each}", unit=unit, aside=aside): Place(array=array, field=each)
            for each in fields
        }
    if len(shape) == 1 or (len(shape) == 2 and shape[1] == 1 and not labels):
        place = Place(array=array, index=None if len(shape) == 1 else 0)
        return {Column(name=array, unit=unit, aside=aside): place}
    if len(shape) == 3:
        aside = aside or _why_not(shape[1], env)
        env = 0 if env is None or env >= shape[1] else env
    elif len(shape) != 2:
        return {}
    else:
        env = None
    count = shape[-1]
    said = labels if len(labels) == count else [""] * count
    return {
        Column(
            name=f"{array}[{k}]",
            array=array,
            index=k,
            count=count,
            label=said[k],
            unit=unit,
            aside=aside,
        ): Place(array=array, index=k, env=env)
        for k in range(count)
    }


def env_of(name: str, given: Mapping[str, Any]) -> int | None:
    """Which environment a recording's entry says, None if it says none.

    Raises:
        LoadError: it is no such number.
    """
    env = given.get("env")
    if env is not None and (not isinstance(env, int) or isinstance(env, bool) or env < 0):
        raise LoadError(f"{name}: env: expected a number from 0 on, got {env!r}")
    return env


def _why_not(count: int, env: int | None) -> str:
    """Why numbers of several environments are not read, in words."""
    if env is None and count > 1:
        return f"it is of {count} environments; 'env: 0' says which"
    return f"it has no environment {env}, but {count}" if env is not None and env >= count else ""


def names_in(said: Mapping[str, Any]) -> tuple[str, ...]:
    """Names of joints among what is said of an array or a group, () if there are none."""
    for key in _NAMES:
        value = said.get(key)
        if isinstance(value, str | bytes):
            value = [each.strip() for each in _text(value).strip("[]").split(",")]
        if value is not None and np.ndim(value) == 1 and len(value) > 1:
            return tuple(_text(each).strip("'\" ") for each in value)
    return ()


def period_in(name: str, said: Mapping[str, Any]) -> float | None:
    """[s] between rows among what is said of a group or file, None if nothing is.

    Raises:
        LoadError: it is no positive number.
    """
    for key in (*_PERIODS, *_RATES):
        if key not in said:
            continue
        value = _number(said[key])
        if value is None or not value > 0:
            raise LoadError(f"{name}: {key}: expected a number above 0, got {said[key]!r}")
        return value if key in _PERIODS else 1.0 / value
    return _period_of_environment(said.get("env_args"))


def _period_of_environment(content: Any) -> float | None:
    """The period [s] in robomimic's or Isaac Lab's JSON of the environment; None without one."""
    try:
        environment = json.loads(_text(content)) if isinstance(content, str | bytes) else {}
    except ValueError:
        return None
    if not isinstance(environment, dict):
        return None
    robosuite, isaac = environment.get("env_kwargs"), environment.get("sim_args")
    if isinstance(robosuite, dict) and (rate := _number(robosuite.get("control_freq"))):
        return 1.0 / rate
    if isinstance(isaac, dict) and (step := _number(isaac.get("dt"))):
        return step * (_number(isaac.get("decimation")) or 1.0)
    return None


def _number(value: Any) -> float | None:
    try:
        found = float(np.asarray(value).reshape(()))
    except (TypeError, ValueError):
        return None
    return found if np.isfinite(found) else None


def _text(value: Any) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def check_lengths(name: str, lengths: Mapping[str, int]) -> None:
    """Check that arrays which are read together have as many rows.

    Raises:
        LoadError: two have not.
    """
    first = next(iter(lengths))
    for array, rows in lengths.items():
        if rows != lengths[first]:
            raise LoadError(
                f"{name}: {array!r} has {rows} rows, {first!r} has {lengths[first]}; expected as"
                " many in all that are read"
            )


def blocks_of(values: Any) -> Iterator[Any]:
    """Rows of an array or data set at a time."""
    for k in range(0, len(values), ROWS):
        yield values[k : k + ROWS]


def pieces_of(blocks: Mapping[str, Iterator[Any]], places: Sequence[Place]) -> Iterator[FloatArray]:
    """Columns side by side from blocks of rows of each array."""
    arrays = list(blocks)
    for together in zip(*blocks.values(), strict=True):
        block = dict(zip(arrays, together, strict=True))
        piece = np.empty((len(together[0]), len(places)))
        for k, place in enumerate(places):
            values = block[place.array]
            if place.env is not None:
                values = values[:, place.env]
            if place.field:
                values = values[place.field]
            elif place.index is not None:
                values = values[:, place.index]
            piece[:, k] = values
        yield piece
