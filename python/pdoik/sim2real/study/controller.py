"""Controllers of joints: laws that are known, and what a study says of one that may not be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from pdoik.recordings import FloatArray

LawType = Literal["unknown", "pd", "pid", "cascade", "voltage", "table"]

GAINS: dict[LawType, tuple[str, ...]] = {
    "unknown": (),
    "pd": ("kp", "kd"),
    "pid": ("kp", "ki", "kd"),
    "cascade": ("kp", "kv", "ki"),
    "voltage": ("kp", "ki", "kd"),
    "table": ("kd",),
}
"""Gains of each type; one that is absent, or null, is not known."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VoltageDrive:
    """Motors that are given a share u of their supply V. Arrays are (n,).

    tau = torque_per_volt V u (1 - supply_loss |u|) - back_emf dq, and zero where they are let go.
    """

    torque_per_volt: FloatArray  # [N m/V]
    back_emf: FloatArray  # [N m s/rad]
    supply_loss: FloatArray  # share of the supply lost at full duty
    volts: FloatArray  # of the supply, where none was logged [V]
    duty_limit: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Controller:
    """Joint controller of the recorded machine.

    tau = kp (q_des - q) + kd (dq_des - dq) + g(q), clipped to the torque limit; dq_des is zero if
    it was not recorded, g(q) is there with gravity compensation only. With a voltage drive kp and
    kd are those of small duties, and duty = kp_duty (q_des - q) + kd_duty (dq_des - dq).
    """

    type: Literal["pd", "voltage"] = "pd"
    kp: FloatArray  # (n,) [N m/rad]
    kd: FloatArray  # (n,) [N m s/rad]
    gravity_compensation: bool = False
    gravity_factor: FloatArray | None = None  # (n,) of the model's gravity in it; None: 1
    torque_limit: FloatArray | None = None  # (n,) [N m]
    period: float | None = None  # [s]
    drive: VoltageDrive | None = None
    kp_duty: FloatArray | None = None  # (n,) [1/rad]
    kd_duty: FloatArray | None = None  # (n,) [s/rad]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GivenController:
    """A controller as the study gives it. Arrays are (n,), NaN where nothing is known of a joint.

    pd: effort = kp (q_des - q) + kd (dq_des - dq); pid: + ki times the error's integral; cascade: a
    position loop kp [1/s] that asks for a speed, held by kv and the integral gain ki; voltage: the
    effort is a duty; table: the effort is one of the position error.
    """

    type: LawType
    gains: Mapping[str, FloatArray] = field(default_factory=dict)  # times `unit`
    gravity_compensation: bool | None = None
    torque_limit: FloatArray | None = None  # [N m]
    period: float | None = None  # [s]
    volts: float | None = None  # of the supply, where none was logged [V]
    duty_limit: FloatArray | None = None
    torque_per_volt: FloatArray | None = None  # [N m/V]
    back_emf: FloatArray | None = None  # torque lost to it per speed [N m s/rad]
    supply_loss: FloatArray | None = None  # share of the supply lost at full duty
    table: FloatArray | None = None  # (k, 2) position error [rad] and effort, rising
