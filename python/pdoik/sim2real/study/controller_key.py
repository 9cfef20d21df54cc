"""The study's `controller:`: what its user knows of it, which may be little."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast, get_args

import numpy as np

from pdoik.errors import LoadError
from pdoik.recordings import FloatArray

from .controller import GAINS, Controller, GivenController, LawType
from .key_tables import LAW, TABLE, VOLTAGE
from .keys import checked, number, per_joint, vector


def given_controller(content: Any, joints: tuple[str, ...]) -> GivenController | None:
    """The study's `controller`; None without one.

    Raises:
        LoadError: a type or key that is not known, gains of the wrong length or sign.
    """
    if content is None:
        return None
    kind = content.get("type", "pd") if isinstance(content, dict) else "pd"
    if kind not in get_args(LawType):
        raise LoadError(
            f"controller: type: expected one of {', '.join(get_args(LawType))}, got {kind!r}"
        )
    kind = cast(LawType, kind)
    own = {"voltage": VOLTAGE, "table": TABLE}.get(kind, {})
    mapping = checked(content, (*LAW, *GAINS[kind], *own), "controller")
    gravity = mapping.get("gravity_compensation")
    if gravity is not None and not isinstance(gravity, bool):
        raise LoadError(
            f"controller: gravity_compensation: expected true or false, got {gravity!r}"
        )
    unit = _optional(mapping, "unit", joints, positive=True)
    gains = {
        name: _partly(mapping.get(name), f"controller: {name}", joints) for name in GAINS[kind]
    }
    return GivenController(
        type=kind,
        gains={name: each * (1.0 if unit is None else unit) for name, each in gains.items()},
        gravity_compensation=gravity,
        torque_limit=_optional(mapping, "torque_limit", joints, positive=True),
        period=_positive(mapping, "period"),
        volts=_positive(mapping, "volts"),
        duty_limit=_optional(mapping, "duty_limit", joints, positive=True),
        torque_per_volt=_optional(mapping, "torque_per_volt", joints, positive=True),
        back_emf=_optional(mapping, "back_emf", joints),
        supply_loss=_optional(mapping, "supply_loss", joints),
        table=_table(mapping.get("table")),
    )


def known_controller(given: GivenController | None) -> Controller | None:
    """The law by which torques can be worked out before anything is estimated; None without one."""
    if given is None or given.type != "pd":
        return None
    kp, kd = given.gains["kp"], given.gains["kd"]
    if not (np.isfinite(kp).all() and np.isfinite(kd).all()):
        return None
    return Controller(
        kp=kp,
        kd=kd,
        gravity_compensation=bool(given.gravity_compensation),
        torque_limit=given.torque_limit,
        period=given.period,
    )


def _optional(
    mapping: Mapping[str, Any], key: str, joints: tuple[str, ...], positive: bool = False
) -> FloatArray | None:
    content = mapping.get(key)
    return None if content is None else per_joint(content, f"controller: {key}", joints, positive)


def _positive(mapping: Mapping[str, Any], key: str) -> float | None:
    content = mapping.get(key)
    least = float(np.nextafter(0.0, 1.0))
    return None if content is None else number(content, f"controller: {key}", least=least)


def _partly(content: Any, source: str, joints: tuple[str, ...]) -> FloatArray:
    """A gain for each joint, NaN where it is null or absent, (n,)."""
    if content is None:
        return np.full(len(joints), np.nan)
    if isinstance(content, dict):
        checked(content, joints, source)
        content = [content.get(joint) for joint in joints]
    if not isinstance(content, list) or None not in content:
        return per_joint(content, source, joints)
    filled = per_joint([0.0 if each is None else each for each in content], source, joints)
    return np.where([each is None for each in content], np.nan, filled)


def _table(content: Any) -> FloatArray | None:
    if content is None:
        return None
    if not isinstance(content, list) or len(content) < 2:
        raise LoadError("controller: table: expected two pairs [error, effort] or more")
    table = np.stack([vector(pair, "controller: table", 2) for pair in content])
    if (np.diff(table[:, 0]) <= 0.0).any():
        raise LoadError("controller: table: expected errors that rise from pair to pair")
    return table
