"""What is believed of a drive's, joint's or link's property before the recordings are looked at."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from .candidates import ParameterId, baseline
from .drive_words import UNLIMITED
from .property import EVERY
from .scales import Scales
from .user_model import UserModel

ORDINARY = (
    "kp",
    "kv",
    "damping",
    "frictionloss",
    "armature",
    "filter",
    "delay",
    "force_limit",
    "ref",
    "mass",
)
"""What every machine has otherwise than its model: always fitted together, link masses within
trust. All else is anomalous: few machines have it."""

Kind = Literal["log", "gap", "line"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One property of one joint, and where it is likely to be.

    Its coordinate x is normal about `start`. The value is scale e^x of a `log`, scale (e^x - 1)
    with x >= 0 of a `gap`, which cannot be negative and may be of any size, scale x of a `line`.
    """

    parameter_id: ParameterId
    kind: Kind
    scale: float
    start: float  # x of the user's value
    std: float

    def value(self, x: float) -> float:
        """The value at a coordinate."""
        if self.kind == "log":
            return float(self.scale * np.exp(x))
        return float(self.scale * np.expm1(x)) if self.kind == "gap" else float(self.scale * x)

    def slope(self, x: float) -> float:
        """Derivative of the value by the coordinate."""
        return float(self.scale if self.kind == "line" else self.scale * np.exp(x))

    def x_of(self, value: float) -> float:
        """Inverse of `value`."""
        share = value / self.scale
        if self.kind == "log":
            return float(np.log(share))
        return float(np.log1p(share)) if self.kind == "gap" else share


def parameters_of(
    user: UserModel, parameter_ids: Iterable[ParameterId], scales: Sequence[Scales]
) -> list[Parameter]:
    """Parameters, by the size of what the recorded motion takes at their joints."""
    return [_parameter(user, parameter_id, scales) for parameter_id in dict.fromkeys(parameter_ids)]


def _parameter(user: UserModel, parameter_id: ParameterId, scales: Sequence[Scales]) -> Parameter:
    name, value = parameter_id.property, baseline(user, parameter_id)
    torque, speed, acceleration, travel = np.max(
        [
            (size.torque, size.speed, size.acceleration, size.travel)
            for k, size in enumerate(scales)
            if parameter_id.index in (EVERY, k)
        ],
        axis=0,
    )
    kind: Kind = "gap"
    match name:
        case "kp":
            kind, scale, std = "log", value, 1.0
        case "kp_factor" | "gain_factor":
            kind, scale, std = "log", 1.0, 1.0
        case "mass":
            kind, scale, std = "log", value, 0.1
        case "force_limit":
            limited = value < UNLIMITED
            kind, scale, std = "log", value if limited else 10.0 * torque, 0.5 if limited else 2.0
        case "kv" | "damping":
            scale, std = 0.1 * torque / speed, 1.5
        case "frictionloss":
            scale, std = 0.1 * torque, 1.5
        case "armature":
            scale, std = 0.1 * torque / acceleration, 1.5
            if value > 0.0:  # without any, light links are hardly to be simulated
                kind, scale = "log", value
        case "stiffness":
            scale, std = 0.1 * torque / travel, 1.5
        case "filter":
            scale, std = 0.01, 1.5
        case "delay":
            scale, std = 0.01, 1.0
        case "spring_torque":
            kind, scale, std = "line", torque, 0.5
        case "ref":
            kind, scale, std = "line", 0.02, 1.0
        case _:  # a coordinate of a centre of mass
            kind, scale, std = "line", 0.05, 1.0
    at = {"log": 0.0, "gap": float(np.log1p(max(value / scale, 0.0))), "line": value / scale}[kind]
    return Parameter(parameter_id=parameter_id, kind=kind, scale=float(scale), start=at, std=std)
