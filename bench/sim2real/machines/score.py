"""A world's truth and what was said of it: its fault, its background, and what is neither."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np

from bench.sim2real.frame.score import Content, agrees, alternatives, as_diagnosis, confidence, rank
from bench.sim2real.machines.background import in_background

FEW = 5  # findings that a reader looks at first
SURE = 0.9

RELATIVES = {
    "coulomb_friction": {"friction_drift", "stribeck_friction"},
    "viscous_friction": {"coulomb_friction"},
    "stribeck_friction": {"presliding_hysteresis", "coulomb_friction"},
    "asymmetric_friction": {"torque_offset", "coulomb_friction"},
    "load_dependent_friction": {"gear_efficiency"},
    "gear_efficiency": {"load_dependent_friction"},
    "presliding_hysteresis": {"backlash", "stribeck_friction"},
    "friction_drift": {"coulomb_friction", "viscous_friction"},
    "backlash": {"presliding_hysteresis", "joint_elasticity"},
    "joint_elasticity": {"backlash"},
    "strain_wave_error": {"torque_ripple"},
    "torque_ripple": {"strain_wave_error"},
    "torque_saturation": {"torque_speed_limit"},
    "torque_speed_limit": {"torque_saturation"},
    "command_delay": {"actuator_lag"},
    "actuator_lag": {"command_delay", "timestamp_skew"},
    "payload": {"link_inertial_error"},
    "link_inertial_error": {"payload"},
    "torque_gain": {"sensor_gain"},
    "sensor_gain": {"torque_gain"},
    "joint_offset": {"kinematic_error", "gravity_direction"},
    "kinematic_error": {"joint_offset", "link_inertial_error"},
    "gravity_direction": {"joint_offset", "kinematic_error"},
}
"""Names that a lenient reading takes for one another."""


def score(name: str, truth: Content, said: Content) -> dict[str, Any]:
    """One row: all that the tables need."""
    diagnosis = as_diagnosis(said)
    found, suspected = diagnosis["findings"], diagnosis.get("suspected", [])
    faults = truth["faults"]
    verdicts = [judged(each, truth) for each in found]
    sure = [j for j, each in zip(verdicts, found, strict=True) if confidence(each) >= SURE]
    false = [
        (each["effect"], each["joints"] or each["links"], round(confidence(each), 2))
        for j, each in zip(verdicts, found, strict=True)
        if not j["right"]
    ]
    return {
        "name": name,
        "robot": truth["spec"]["robot"],
        "gear": truth["gear"],
        "controller": truth["controller"],
        "group": _group(faults),
        "verdict": diagnosis["verdict"],
        "crash": "error" in said,
        "findings": len(found),
        "right": sum(j["right"] for j in verdicts),
        "strict": sum(j["strict"] for j in verdicts),
        "sure": len(sure),
        "sure_right": sum(j["right"] for j in sure),
        "sure_strict": sum(j["strict"] for j in sure),
        "alarm": bool(false) or bool(_outstanding(diagnosis["joints"]) and not faults),
        "false": json.dumps(false),
        "faults": json.dumps(
            [
                {
                    **_told(fault, seen, truth, found, suspected, diagnosis["joints"]),
                    "others": len(false),
                }
                for fault, seen in zip(faults, truth["visibility"], strict=True)
            ]
        ),
        "confidences": json.dumps(
            [
                [confidence(each), j["right"], j["strict"]]
                for j, each in zip(verdicts, found, strict=True)
            ]
        ),
        **friction(truth, found),
        "seconds": said["seconds"],
        "peak_gib": said.get("peak_gib", np.nan),
    }


def _outstanding(joints: Content) -> set[str]:
    """Joints that are said to keep what no known effect is."""
    return {
        name
        for name, fit in joints.items()
        if (fit.get("residue") or {}).get("outstanding", 0.0) > 0.0
    }


def _group(faults: list[Content]) -> str:
    if not faults:
        return "none"
    if len(faults) > 1:
        return "two"
    return "outside" if faults[0]["effect"] == "outside" else "one"


def placed(finding: Content, fault: Content, truth: Content) -> bool:
    """Whether it is said where it is.

    One of the joints is enough where all have it. A link stands for those rigidly known with it:
    its neighbours carry the same load through most motions.
    """
    if fault["joints"]:
        at = set(fault["joints"])
        if finding["joints"]:
            return bool(at & set(finding["joints"])) and (
                len(at) > 2 or set(finding["joints"]) <= at or len(finding["joints"]) <= 2
            )
        if finding["links"]:  # a joint's place is its link's
            return any(f"link{j.removeprefix('joint')}" in finding["links"] for j in at)
        return False
    if fault["links"]:
        index = int(fault["links"][0].removeprefix("link"))
        near = {index} if index == len(truth["joints"]) else {index, index + 1}
        return any(int(link.removeprefix("link")) in near for link in finding["links"])
    return True


def _carried(finding: Content, fault: Content, truth: Content) -> bool:
    """Whether an unnamed cause is said where it is felt: of a link's, at joints that carry it."""
    if not fault["links"] or not finding["joints"]:
        return placed(finding, fault, truth)
    index = int(fault["links"][0].removeprefix("link"))
    return all(int(joint.removeprefix("joint")) <= index for joint in finding["joints"])


def _names(fault: Content) -> tuple[set[str], set[str]]:
    strict = {fault["effect"]}
    return strict, strict | RELATIVES.get(fault["effect"], set())


def _sized(finding: Content, fault: Content) -> bool:
    """Whether the first figure that both have agrees: within a third, or within the interval."""
    for name, true in fault["parameters"].items():
        if name in finding["parameters"]:
            return agrees(finding["parameters"][name], true, 0.34)
    return True


def _told(
    fault: Content,
    seen: Content,
    truth: Content,
    found: list[Content],
    suspected: list[Content],
    joints: Content,
) -> dict[str, Any]:
    strict, lenient = _names(fault)

    def here(names: set[str], *, listed: bool = True) -> Callable[[Content], bool]:
        return lambda finding: (
            placed(finding, fault, truth)
            and any(each["effect"] in names for each in alternatives(finding, 3 if listed else 0))
        )

    named = here(strict, listed=False)
    ranks = {
        "named": rank(found, named),
        "listed": rank(found, here(strict)),
        "relative": rank(found, here(lenient)),
        "suspected": int(any(map(named, suspected))),
        "sized": rank(found, lambda each: named(each) and _sized(each, fault)),
        "unknown": rank(
            found, lambda each: each["effect"] == "unknown" and _carried(each, fault, truth)
        ),
    }
    if _outstanding(joints) & set(fault["joints"] or joints):
        ranks["unknown"] = ranks["unknown"] or len(found) + 1
    return {
        "kind": fault["kind"],
        "effect": fault["effect"],
        "most": seen["most"],
        "unexplained": max(seen["unexplained"].values(), default=1.0),
        "begins": fault["begins"] is not None,
        **ranks,
    }


def judged(finding: Content, truth: Content) -> dict[str, bool]:
    """Whether a finding is true: of a fault, or of the background; leniently and strictly."""
    for fault in truth["faults"]:
        strict, lenient = _names(fault)
        outside = fault["effect"] == "outside"
        if outside and finding["effect"] == "unknown" and _carried(finding, fault, truth):
            return {"right": True, "strict": True}
        if not placed(finding, fault, truth):
            continue
        if finding["effect"] in strict:
            return {"right": True, "strict": _sized(finding, fault)}
        if finding["effect"] in lenient:
            return {"right": True, "strict": False}
    there, sized = in_background(finding, truth)
    return {"right": there, "strict": there and sized}


def friction(truth: Content, found: list[Content]) -> dict[str, int | float]:
    """Joints whose friction was found, whose intervals hold it, and the errors of its size.

    The size is level plus slope times the joint's median speed: what is said of the two must hold
    it together.
    """
    joints = [
        (f"joint{k + 1}", own) for k, own in enumerate(truth["background"]) if own["speed"] > 0
    ]
    levels = named = covered = judged = 0
    errors = []
    for name, own in joints:
        at = [f for f in found if f["joints"] == [name]]
        level = next((f for f in at if f["effect"] == "coulomb_friction"), None)
        slope = next((f for f in at if f["effect"] == "viscous_friction"), None)
        levels += 1
        named += level is not None or slope is not None
        if any(
            f["effect"].endswith(("_friction", "_hysteresis", "_drift", "efficiency"))
            and f not in (level, slope)
            for f in at
        ):
            continue
        if level is None and slope is None:
            continue
        true = own["level"] + own["slope"] * own["speed"]
        said = half = 0.0
        for finding, key, factor in ((level, "level", 1.0), (slope, "coefficient", own["speed"])):
            if finding is not None:
                value = finding["parameters"][key]
                said += factor * value["value"]
                half = float(np.hypot(half, 0.5 * factor * np.diff(value["interval95"])[0]))
        judged += 1
        covered += abs(said - true) <= half
        errors.append(abs(said - true) / true)
    return {
        "joints": levels,
        "rubbing": named,
        "sized_joints": judged,
        "covered": covered,
        "friction_error": float(np.median(errors)) if errors else np.nan,
    }
