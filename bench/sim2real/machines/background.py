"""Whether a finding says what an ordinary machine has anyway, and whether in the right size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Content = Mapping[str, Any]

_FACTOR = 2.0  # within which a size is right


def in_background(finding: Content, truth: Content) -> tuple[bool, bool]:
    """Whether the cause is there, and whether it is there in this size.

    Every joint of these machines rubs, has a rotor and a gear that gives; every link's inertia,
    every torque sensor is a little off. What is said of a joint must hold for all that are named.
    """
    joints = [
        truth["background"][int(name.removeprefix("joint")) - 1] for name in finding["joints"]
    ]
    values = {name: each["value"] for name, each in finding["parameters"].items()}
    judge = _JUDGES.get(finding["effect"])
    if judge is None or finding["window"] is not None or finding.get("positions") is not None:
        return False, False
    if finding["effect"] in ("payload", "link_inertial_error"):
        return True, _inertia(finding, values, truth)
    answers = [judge(values, joint) for joint in joints]
    return bool(answers) and all(a for a, _ in answers), bool(answers) and all(
        b for _, b in answers
    )


def _near(value: float, true: float, factor: float = _FACTOR) -> bool:
    return true > 0.0 and true / factor <= value <= true * factor


def _inertia(finding: Content, values: Mapping[str, float], truth: Content) -> bool:
    """No more than a quarter of the link and those it carries."""
    index = int(finding["links"][0].removeprefix("link")) - 1
    beyond = sum(joint["mass"] for joint in truth["background"][index:])
    return abs(values.get("d_mass", values.get("mass", 0.0))) <= 0.25 * beyond


def _coulomb(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, _near(values["level"], joint["level"])


def _viscous(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, _near(values["coefficient"], joint["slope"])


def _stribeck(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, _near(values["extra"], joint["stiction"], 3.0)


def _asymmetric(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    true = joint["asymmetry"] * joint["coulomb"]
    said = values["level_difference"]
    return abs(joint["asymmetry"]) > 0.03, said * true > 0.0 and _near(abs(said), abs(true), 3.0)


def _load(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    true = joint["load_share"] + 0.5 * (joint["loss_driving"] + joint["loss_driven"])
    said = values.get(
        "coefficient", 0.5 * (values.get("driving_loss", 0.0) + values.get("driven_loss", 0.0))
    )
    return true > 0.01, _near(said, true)


def _presliding(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, _near(values["displacement"], joint["bristle"], 5.0)


def _rotor(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    true = joint["rotor"] - joint["rotor_told"]
    return True, _near(values["inertia"], true) or abs(values["inertia"] - true) < 0.1 * joint[
        "rotor"
    ]


def _gain(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, abs(values["gain"] - joint["torque_gain"]) < 0.1


def _offset(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, abs(values["offset"] - joint["torque_offset"]) < 0.03 * joint["rated"]


def _elastic(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, _near(values["stiffness"], joint["stiffness"], 3.0)


def _backlash(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return joint["gap"] > 0.0, _near(values["gap"], joint["gap"], 3.0)


def _wave(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    right = abs(values["harmonic"] - joint["error_cycles"]) < 1.0
    return joint["error"] > 0.0, right and _near(values["amplitude"], joint["error"], 3.0)


def _ripple(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    right = abs(values["harmonic"] - joint["cogging_cycles"]) < 1.0
    return True, right and _near(values["amplitude"], joint["cogging"], 3.0)


def _lag(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, values["time_constant"] < 0.012


def _drift(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, abs(values["extra"]) < 0.3 * joint["level"]


def _skew(values: Mapping[str, float], joint: Content) -> tuple[bool, bool]:
    return True, abs(values["skew"]) < 0.015


_JUDGES = {
    "coulomb_friction": _coulomb,
    "viscous_friction": _viscous,
    "stribeck_friction": _stribeck,
    "asymmetric_friction": _asymmetric,
    "load_dependent_friction": _load,
    "gear_efficiency": _load,
    "presliding_hysteresis": _presliding,
    "rotor_inertia": _rotor,
    "torque_gain": _gain,
    "torque_offset": _offset,
    "joint_elasticity": _elastic,
    "backlash": _backlash,
    "strain_wave_error": _wave,
    "torque_ripple": _ripple,
    "actuator_lag": _lag,
    "friction_drift": _drift,
    "timestamp_skew": _skew,
    "payload": _coulomb,
    "link_inertial_error": _coulomb,
}
