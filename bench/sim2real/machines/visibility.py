"""How clear a fault is in the log: what it moves, compared with what an ordinary machine leaves."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.signal import butter, sosfiltfilt

from bench.sim2real.frame.arm import Arm, urdf
from bench.sim2real.machines.fault import Fault, Log
from bench.sim2real.machines.figures import Array

_RATE = 100.0  # of the grid that is filtered [Hz]
_CUTOFF = 6.0  # [Hz]
_EVERY = 4  # rows of the grid between those that are fitted


def visibility(
    believed: Arm, faults: Sequence[Fault], logs: list[Log], clean: list[Log]
) -> list[dict[str, Any]]:
    """For each fault: by joint, what is moved over what is left without it.

    `moved` is the root mean square of the torque's or the position's difference to the same machine
    without faults, over what a regression leaves there that knows friction, inertias and offsets.
    `unexplained` is what that regression leaves with the fault, over what it leaves without.
    """
    if not faults:
        return []
    model = pin.buildModelFromXML(urdf(believed))
    with_fault, without = _table(model, logs), _table(model, clean)
    n = model.nq
    result = []
    torques = [(_left(with_fault, j), _left(without, j)) for j in range(n)]
    for fault in faults:
        entry: dict[str, Any] = {"kind": fault.kind, "moved": {}, "unexplained": {}}
        for j in fault.joints or range(n):
            name = f"joint{j + 1}"
            other, own = torques[j]
            change = with_fault["tau"][:, j] - without["tau"][:, j]
            moved = float(np.sqrt(np.mean(change**2)) / own)
            change = with_fault["q"][:, j] - without["q"][:, j]
            moved = max(moved, float(np.sqrt(np.mean(change**2)) / _astray(without, j)))
            if fault.kind == "sensor_gain":
                change = with_fault["dq_read"][:, j] - without["dq_read"][:, j]
                noise = without["dq_read"][:, j] - without["dq"][:, j]
                moved = float(np.sqrt(np.mean(change**2) / np.mean(noise**2)))
            entry["moved"][name] = round(moved, 3)
            entry["unexplained"][name] = round(other / own, 3)
        entry["most"] = max(entry["moved"].values())
        result.append(entry)
    return result


def _astray(table: dict[str, Array], j: int) -> float:
    """What a line through command, speed, acceleration and torque leaves of the position [rad]."""
    v, a = table["dq_des"][:, j], np.gradient(table["dq_des"][:, j])
    own = [v, a, table["tau"][:, j], np.tanh(v / 0.02), np.ones_like(v)]
    A, b = np.column_stack(own), table["q"][:, j] - table["q_des"][:, j]
    x = np.linalg.lstsq(A, b, rcond=None)[0]
    return float(np.sqrt(np.mean((b - A @ x) ** 2)) + 1e-5)


def _table(model: Any, logs: list[Log]) -> dict[str, Array]:
    data = model.createData()
    parts: dict[str, list[Array]] = {
        k: [] for k in ("tau", "dq", "dq_read", "ddq", "q", "q_des", "dq_des", "Y")
    }
    band = butter(2, _CUTOFF, fs=_RATE, output="sos")
    for log in logs:
        time = np.arange(log["time"][0], log["time"][-1], 1.0 / _RATE)
        even = {
            name: sosfiltfilt(
                band,
                np.column_stack([np.interp(time, log["time"], column) for column in log[name].T]),
                axis=0,
            )
            for name in ("q", "dq", "tau", "q_des")
        }
        q = even["q"]
        dq = np.gradient(q, 1.0 / _RATE, axis=0)
        ddq = np.gradient(dq, 1.0 / _RATE, axis=0)
        rows = np.arange(20, len(time) - 20, _EVERY)
        Y = [pin.computeJointTorqueRegressor(model, data, q[r], dq[r], ddq[r]).copy() for r in rows]
        parts["Y"].append(np.array(Y))
        parts["dq_read"].append(even["dq"][rows])
        dq_des = np.gradient(even["q_des"], 1.0 / _RATE, axis=0)
        named = {"tau": even["tau"], "dq": dq, "ddq": ddq, "q": q, "q_des": even["q_des"]}
        for name, values in (named | {"dq_des": dq_des}).items():
            parts[name].append(values[rows])
    return {name: np.concatenate(values) for name, values in parts.items()}


def _left(table: dict[str, Array], j: int) -> float:
    """Residual of one joint's torque, rms, after fitting all that an ordinary machine has [N m]."""
    v = table["dq"][:, j]
    own = [np.tanh(v / 0.02), np.tanh(v / 0.1), v, np.sign(v) * np.sqrt(np.abs(v))]
    A = np.column_stack([*own, np.ones_like(v), table["ddq"][:, j], table["Y"][:, j]])
    scale = np.sqrt(np.mean(A**2, axis=0))
    A = A[:, scale > 1e-9] / scale[scale > 1e-9]
    b = table["tau"][:, j]
    ridge = 1e-4 * np.sqrt(len(b)) * np.eye(A.shape[1])
    x = np.linalg.lstsq(
        np.vstack([A, ridge]), np.concatenate([b, np.zeros(len(ridge))]), rcond=None
    )[0]
    return float(np.sqrt(np.mean((b - A @ x) ** 2)))
