"""What the dataclasses of `pdoik.options` have in common: arrays become tuples, and all of C++."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from pdoik import _core
from pdoik._core import Robot

Vector3 = Sequence[float] | NDArray[np.float64]
Axis = Literal["x", "y", "z"]
DEFAULT = _core.Options()
_AXES: dict[Axis, tuple[float, float, float]] = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


def tuples(array: NDArray[np.float64]) -> tuple[Any, ...]:
    """An array of one or two dimensions as tuples, which are hashable and cannot be changed."""
    rows = array.tolist()
    return tuple(map(tuple, rows)) if array.ndim == 2 else tuple(rows)


class NestedOptions:
    """Options that are one field of `Options`."""

    __slots__ = ()
    place: ClassVar[str]  # the field's name

    def __post_init__(self) -> None:
        """Check shapes; copy what could be changed from outside."""
        _settle(self, getattr(DEFAULT, self.place), f"{self.place}.")


class SolverOptions:
    """What `Options` can do."""

    __slots__ = ()

    def __post_init__(self, heed_fixed_hulls: bool | None) -> None:
        """Check types, choices and shapes; copy what could be changed from outside."""
        if heed_fixed_hulls is not None:
            warnings.warn("heed_fixed_hulls is now base_collision", DeprecationWarning, 3)
            object.__setattr__(self, "base_collision", heed_fixed_hulls)
        _settle(self, DEFAULT, "")
        to_core(self)

    def keeps_off_itself(self, robot: Robot) -> bool:
        """What self_collision comes to for a robot."""
        return to_core(self).keeps_off_itself(robot)


def to_core(options: SolverOptions) -> _core.Options:
    """The C++ options with these values."""
    result = _core.Options()
    _copy(options, result)
    return result


def _settle(options: Any, core: Any, prefix: str) -> None:
    """Make tuples of a dataclass's arrays, of the shapes that the C++ struct's have.

    Raises:
        ValueError: Names the first of another shape.
    """
    for each in dataclasses.fields(options):
        value, like = getattr(options, each.name), getattr(core, each.name)
        name = prefix + each.name
        if isinstance(like, np.ndarray) and not isinstance(value, str):
            settled: Any = _to_tuples(value, name, like.shape if like.size else None)
        elif isinstance(like, Mapping):
            settled = {
                key: list(_to_tuples(rows, f"{name}[{key!r}]", ("K", 3)))
                for key, rows in value.items()
            }
        else:
            continue
        object.__setattr__(options, each.name, settled)


def _to_tuples(values: Any, name: str, shape: tuple[int | str, ...] | None) -> tuple[Any, ...]:
    """Numbers as tuples; a letter stands for any size, and no shape for any vector."""
    array = np.asarray(values, dtype=np.float64)
    wanted = ("n",) if shape is None else shape
    is_right = array.ndim == len(wanted) and all(
        isinstance(size, str) or size == its for size, its in zip(wanted, array.shape, strict=True)
    )
    if not is_right:
        text = ", ".join(map(str, wanted)) + "," * (len(wanted) == 1)
        raise ValueError(f"{name} has shape {array.shape}, expected ({text})")
    return tuples(array)


def _copy(source: Any, target: Any) -> None:
    """Set the attributes of a C++ struct to the fields of the dataclass that mirrors it."""
    for each in dataclasses.fields(source):
        value = getattr(source, each.name)
        if each.name == "goal_axis" and isinstance(value, str):
            if value not in _AXES:
                raise ValueError(f"goal_axis is {value!r}, expected 'x', 'y', 'z' or a 3-vector")
            value = _AXES[value]
        if each.name == "T_tip_tool":
            value = np.asarray(value)
        if dataclasses.is_dataclass(each.type) and type(value) is each.type:
            _copy(value, getattr(target, each.name))
            continue
        try:
            setattr(target, each.name, value)
        except TypeError:
            what = f"{type(source).__name__}.{each.name} is {value!r}"
            expected = getattr(each.type, "__name__", each.type)
            raise TypeError(f"{what}, expected {expected}") from None
