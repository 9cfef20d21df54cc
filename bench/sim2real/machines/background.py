"""Whether a finding says what an ordinary machine has anyway, and whether in the right size."""

from collections.abc import Callable, Mapping
from typing import Any

Content = Mapping[str, Any]
Judge = Callable[[Content, Content], Any]  # of the finding's values and of the joint's figures


def in_background(finding: Content, truth: Content) -> tuple[bool, bool]:
    """Whether the cause is there, and whether it is there in this size.

    Every joint of these machines rubs, has a rotor and a gear that gives; every link's inertia,
    every torque sensor is a little off. What is said of a joint must hold for all that are named.
    """
    effect, own = finding["effect"], truth["background"]
    values = {name: each["value"] for name, each in finding["parameters"].items()}
    if finding["window"] is not None or finding.get("positions") is not None:
        return False, False
    if effect in ("payload", "link_inertial_error"):  # a quarter of the link and those it carries
        beyond = own[int(finding["links"][0].removeprefix("link")) - 1 :]
        most = 0.25 * sum(joint["mass"] for joint in beyond)
        return True, abs(values.get("d_mass", values.get("mass", 0.0))) <= most
    if effect not in _SIZED or not finding["joints"]:
        return False, False
    joints = [own[int(name.removeprefix("joint")) - 1] for name in finding["joints"]]
    there = _THERE.get(effect, lambda joint: True)
    return all(map(there, joints)), all(bool(_SIZED[effect](values, joint)) for joint in joints)


def _near(value: float, true: float, factor: float = 2.0) -> bool:
    return true > 0.0 and true / factor <= value <= true * factor


def _loss(joint: Content) -> float:
    return joint["load_share"] + 0.5 * (joint["loss_driving"] + joint["loss_driven"])


def _lost(values: Content, joint: Content) -> bool:
    both = 0.5 * (values.get("driving_loss", 0.0) + values.get("driven_loss", 0.0))
    return _near(values.get("coefficient", both), _loss(joint))


def _asymmetric(values: Content, joint: Content) -> bool:
    said, true = values["level_difference"], joint["asymmetry"] * joint["coulomb"]
    return said * true > 0.0 and _near(abs(said), abs(true), 3.0)


def _rotor(values: Content, joint: Content) -> bool:
    said, true = values["inertia"], joint["rotor"] - joint["rotor_given"]
    return _near(said, true) or abs(said - true) < 0.1 * joint["rotor"]


def _wave(figure: str) -> Judge:
    def judge(values: Content, joint: Content) -> bool:
        right = abs(values["harmonic"] - joint[f"{figure}_cycles"]) < 1.0
        return right and _near(values["amplitude"], joint[figure], 3.0)

    return judge


_THERE: dict[str, Callable[[Content], bool]] = {  # of what not every joint has
    "asymmetric_friction": lambda joint: abs(joint["asymmetry"]) > 0.03,
    "load_dependent_friction": lambda joint: _loss(joint) > 0.01,
    "gear_efficiency": lambda joint: _loss(joint) > 0.01,
    "backlash": lambda joint: joint["gap"] > 0.0,
    "strain_wave_error": lambda joint: joint["error"] > 0.0,
}
_SIZED: dict[str, Judge] = {
    "coulomb_friction": lambda said, own: _near(said["level"], own["level"]),
    "viscous_friction": lambda said, own: _near(said["coefficient"], own["slope"]),
    "stribeck_friction": lambda said, own: _near(said["extra"], own["stiction"], 3.0),
    "asymmetric_friction": _asymmetric,
    "load_dependent_friction": _lost,
    "gear_efficiency": _lost,
    "presliding_hysteresis": lambda said, own: _near(said["displacement"], own["bristle"], 5.0),
    "rotor_inertia": _rotor,
    "torque_gain": lambda said, own: abs(said["gain"] - own["torque_gain"]) < 0.1,
    "torque_offset": lambda said, own: (
        abs(said["offset"] - own["torque_offset"]) < 0.03 * own["rated"]
    ),
    "joint_elasticity": lambda said, own: _near(said["stiffness"], own["stiffness"], 3.0),
    "backlash": lambda said, own: _near(said["gap"], own["gap"], 3.0),
    "strain_wave_error": _wave("error"),
    "torque_ripple": _wave("cogging"),
    "actuator_lag": lambda said, own: said["time_constant"] < 0.012,
    "friction_drift": lambda said, own: abs(said["extra"]) < 0.3 * own["level"],
    "timestamp_skew": lambda said, own: abs(said["skew"]) < 0.015,
}
