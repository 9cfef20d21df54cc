"""Parts of a model as plain data, and back."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import parts_of_finding
from ..findings import Diagnosis, Finding
from ..study import Controller, VoltageDrive

_DRIVE = ("torque_per_volt", "back_emf", "supply_loss", "volts", "duty_limit")


def findings_of(content: list[Any]) -> tuple[Finding, ...]:
    """Findings of plain data.

    Raises:
        ValueError: a parameter is missing.
    """
    whole = {
        "schema": "pdoik.diagnosis/1",
        "verdict": "mismatch_explained",
        "findings": content,
        "joints": {},
    }
    findings = Diagnosis.from_json(json.dumps(whole)).findings
    for finding in findings:
        parts_of_finding(finding)  # raises ValueError where a parameter is missing
    return findings


def controller_content(controller: Controller | None) -> dict[str, Any] | None:
    """A controller as plain data."""
    if controller is None:
        return None
    content: dict[str, Any] = {
        "type": controller.type,
        "kp": listed(controller.kp),
        "kd": listed(controller.kd),
        "gravity_compensation": controller.gravity_compensation,
        "torque_limit": listed(controller.torque_limit),
        "period": controller.period,
    }
    if controller.gravity_factor is not None:
        content["gravity_factor"] = listed(controller.gravity_factor)
    if controller.drive is not None:
        content["kp_duty"] = listed(controller.kp_duty)
        content["kd_duty"] = listed(controller.kd_duty)
        content["drive"] = {name: listed(getattr(controller.drive, name)) for name in _DRIVE}
    return content


def controller_of(content: dict[str, Any] | None, n: int) -> Controller | None:
    """The controller of plain data, for n joints.

    Raises:
        KeyError, ValueError: it is none.
    """
    if content is None:
        return None
    if content["type"] not in ("pd", "voltage"):
        raise ValueError(f"type: expected 'pd' or 'voltage', got {content['type']!r}")
    voltage: dict[str, Any] = {}
    if content["type"] == "voltage":
        drive = content["drive"]
        voltage = {
            "type": "voltage",
            "kp_duty": required(array_of(content["kp_duty"], n)),
            "kd_duty": required(array_of(content["kd_duty"], n)),
            "drive": VoltageDrive(**{name: required(array_of(drive[name], n)) for name in _DRIVE}),
        }
    return Controller(
        kp=required(array_of(content["kp"], n)),
        kd=required(array_of(content["kd"], n)),
        gravity_compensation=bool(content["gravity_compensation"]),
        torque_limit=array_of(content["torque_limit"], n),
        period=content["period"],
        gravity_factor=array_of(content.get("gravity_factor"), n),
        **voltage,
    )


def listed(values: FloatArray | None) -> list[float] | None:
    """Numbers as a list."""
    return None if values is None else np.asarray(values, dtype=float).tolist()


def array_of(values: list[float] | None, n: int) -> FloatArray | None:
    """An array (n,) of a list.

    Raises:
        ValueError: it is not as long.
    """
    if values is None:
        return None
    array = np.array(values, dtype=float)
    if array.shape != (n,):
        raise ValueError(f"expected {n} numbers, got shape {array.shape}")
    return array


def required(array: FloatArray | None) -> FloatArray:
    """The array, if there is one.

    Raises:
        ValueError: there is none.
    """
    if array is None:
        raise ValueError("expected numbers, got null")
    return array
