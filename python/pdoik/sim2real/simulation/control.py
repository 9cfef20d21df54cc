"""The recorded machine's controller, as it would run on the simulated one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from pdoik.recordings import FloatArray

from ..study import Controller, VoltageDrive
from .parts import Part, Vector
from .plant import STANDARD_GRAVITY, build_plant

_LIGHT = 0.3  # numerics: of what a law asks of an inertia, from which a joint is light
_UNSTABLE = 1.2  # numerics: the largest eigenvalue of a loop that is left
FINEST_CONTROL_STEP = 2.5e-4  # of a controller whose period is not known [s]
Control = Callable[[list[float], list[float], list[float], list[float]], list[float]]
"""Commanded torques of desired positions and speeds and of measured ones."""


class GravityModel:
    """What the user's own model needs to stand still: controllers know no findings."""

    def __init__(
        self,
        robot: str | Path,
        joints: tuple[str, ...],
        gravity: Vector = STANDARD_GRAVITY,
        parts: Iterable[Part] = (),
    ) -> None:
        rotors = np.zeros(len(joints))
        plant = build_plant(robot, joints, parts, rotor_inertia=rotors, gravity=gravity)
        self._model: Any = plant.model
        self._data: Any = mujoco.MjData(self._model)
        self._qpos = self._data.qpos
        self._torque = np.zeros(self._model.nv)
        order = list(plant.dof)
        # A slice is read and written several times as fast as a list of places.
        self._dof: Any = slice(None) if order == sorted(order) else order

    def __call__(self, q: list[float]) -> list[float]:
        """Torques (n,) that hold the links at q [N m]."""
        model, data = self._model, self._data
        self._qpos[self._dof] = q
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_rne(model, data, 0, self._torque)
        torque: list[float] = self._torque[self._dof].tolist()
        return torque


def control_law(controller: Controller, gravity: GravityModel | None) -> Control:
    """The law kp (q_des - q) + kd (dq_des - dq) + g(q), limited; or that of a voltage drive.

    A desired position that is NaN is none: the drive has let go.
    """
    if controller.drive is not None:
        return _voltage_law(controller, controller.drive)
    factor = None
    if controller.gravity_factor is not None:
        factor = np.asarray(controller.gravity_factor, dtype=float).tolist()
    kp: list[float] = np.asarray(controller.kp, dtype=float).tolist()
    kd: list[float] = np.asarray(controller.kd, dtype=float).tolist()
    limit: list[float] | None = None
    if controller.torque_limit is not None:
        limit = np.asarray(controller.torque_limit, dtype=float).tolist()

    def law(
        q_des: list[float], dq_des: list[float], q: list[float], dq: list[float]
    ) -> list[float]:
        tau = [
            p * (x_des - x) + d * (v_des - v)
            for p, d, x_des, v_des, x, v in zip(kp, kd, q_des, dq_des, q, dq, strict=True)
        ]
        if gravity is not None:
            weight = gravity(q)
            if factor is not None:
                weight = [f * g for f, g in zip(factor, weight, strict=True)]
            tau = [u + g for u, g in zip(tau, weight, strict=True)]
        if limit is not None:
            tau = [-m if u < -m else m if u > m else u for u, m in zip(tau, limit, strict=True)]
        return [0.0 if u != u else u for u in tau]

    return law


def _voltage_law(controller: Controller, drive: VoltageDrive) -> Control:
    """Torques of motors that are given a share of their supply: see `VoltageDrive`."""
    assert controller.kp_duty is not None
    assert controller.kd_duty is not None
    rows = np.stack(
        [
            controller.kp_duty,
            controller.kd_duty,
            drive.duty_limit,
            drive.torque_per_volt * drive.volts,
            drive.supply_loss,
            drive.back_emf,
        ],
        axis=1,
    ).tolist()

    def law(
        q_des: list[float], dq_des: list[float], q: list[float], dq: list[float]
    ) -> list[float]:
        tau = []
        for (kp, kd, most, k, loss, emf), x_des, v_des, x, v in zip(
            rows, q_des, dq_des, q, dq, strict=True
        ):
            u = kp * (x_des - x) + kd * (v_des - v)
            u = -most if u < -most else most if u > most else u
            tau.append(0.0 if u != u else k * u * (1.0 - loss * abs(u)) - emf * v)
        return tau

    return law


def longest_control_step(
    controller: Controller, inverse_inertia: FloatArray, longest: float
) -> float:
    """Steps in which a controller of no known period is as good as continuous [s].

    Args:
        controller: Whose gains count.
        inverse_inertia: Of the mass matrix with rotors, (n, n).
        longest: [s].
    """
    own = np.diag(inverse_inertia)
    stiff = float(np.sqrt(np.max(np.abs(controller.kp) * own)))
    damped = float(np.max(np.abs(controller.kd) * own))
    needed = min(0.5 / max(stiff, 1e-9), 0.5 / max(damped, 1e-9))
    return max(min(longest, needed), min(FINEST_CONTROL_STEP, longest))


def missing_rotor_inertia(
    controller: Controller, inverse_inertia: FloatArray, period: float
) -> FloatArray:
    """What must be added at the joints for torques held over a period to be stable, (n,) [kg m^2].

    A real machine with such a controller stands; so where its model would not, inertia is missing,
    most often the rotors'. With rotors of kd T the matrix M^-1 K_d T, whose eigenvalues must stay
    below 2, has none above 1; kp T^2 does the same for stiffness.
    """
    need = np.maximum(np.abs(controller.kd) * period, np.abs(controller.kp) * period**2)
    if np.linalg.eigvals(inverse_inertia * need).real.max() <= 1.0:
        return np.zeros(len(need))
    light = np.diag(inverse_inertia) * need > _LIGHT
    mass = np.linalg.inv(inverse_inertia) + np.diag(need * light)
    if np.linalg.eigvals(np.linalg.inv(mass) * need).real.max() > _UNSTABLE:
        light[:] = True
    return np.asarray(need * light)
