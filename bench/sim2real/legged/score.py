"""A world's truth beside what was said of it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from bench.sim2real.legged.machine import FRICTION
from bench.sim2real.legged.spec import GROUND_KINDS, HEALTHY, IMU_KINDS

Content = Mapping[str, Any]  # of JSON

CLAIMED = 0.75  # confidence from which a finding is a claim
SIZED = 0.34  # relative error of a figure that is right without its interval
OF_JOINTS = (
    "coulomb_friction",
    "viscous_friction",
    "torque_gain",
    "torque_offset",
    "rotor_inertia",
)
OF_BODIES = ("link_inertial_error",)
OF_DENSE = (*OF_JOINTS, *OF_BODIES, *IMU_KINDS)
"""What every dense machine has anyway, everywhere: neither right nor false."""

LIGHT = 0.06  # of the machine's mass: a load that the links' own errors come to


def score(name: str, truth: Content, said: Content) -> dict[str, Any]:
    """One row: all that the tables need."""
    spec, diagnosis = truth["spec"], _diagnosis(said)
    claimed = [f for f in diagnosis["findings"] if f.get("confidence", 1.0) >= CLAIMED]
    hidden = truth["effects"][0] if truth["effects"] else None
    right = [f for f in claimed if hidden is not None and is_right(f, hidden)]
    false = [f for f in claimed if f not in right and not in_background(f, truth)]
    named = hidden is not None and _covers(right, hidden)
    return {
        "name": name,
        **{key: spec[key] for key in ("robot", "background", "kind", "seed")},
        "place": "" if hidden is None else " ".join(_place(hidden)),
        "verdict": diagnosis["verdict"],
        "crash": "error" in said,
        "named": named,
        "sized": named and any(is_sized(f, hidden) for f in right),
        "listed": named or any(_listed(f, hidden) for f in claimed),
        "suspected": any(
            hidden is not None and is_right(f, hidden)
            for f in (*diagnosis.get("suspected", []), *diagnosis["findings"])
        ),
        "claimed": len(claimed),
        "false": len(false),
        "alarm": spec["kind"] == HEALTHY and bool(false),
        "false_findings": json.dumps([[f["effect"], *_place(f)] for f in false]),
        "found": json.dumps(
            [[f["effect"], round(f.get("confidence", 1.0), 2), *_place(f)] for f in claimed]
        ),
        "seconds": float(said["seconds"]),
    }


def is_right(finding: Content, hidden: Content) -> bool:
    """Whether it has the true name and says a true place, or part of it."""
    if finding["effect"] != hidden["effect"]:
        return False
    if hidden["joints"]:
        return list(finding["joints"]) == list(hidden["joints"])
    if hidden["effect"] in GROUND_KINDS:
        return set(_feet(finding)) <= set(hidden["feet"])
    return hidden["effect"] in IMU_KINDS or set(_place(finding)) == set(hidden["links"])


def _covers(right: list[Content], hidden: Content) -> bool:
    """Whether the right findings say all of the place: those of a foot each may share it."""
    if not right or not hidden["feet"] or not hidden["effect"].startswith("foot_"):
        return bool(right)
    every = any(not _feet(f) for f in right) and len(hidden["feet"]) > 1
    return every or {foot for f in right for foot in _feet(f)} == set(hidden["feet"])


def is_sized(finding: Content, hidden: Content | None) -> bool:
    """Whether the figures that both have agree: the largest is as true as its interval says."""
    both = {
        key: value
        for key, value in ({} if hidden is None else figures_of(hidden)).items()
        if key in finding["parameters"]
    }
    if not both:
        return False
    largest = max(both, key=lambda key: abs(both[key]))
    said, true = finding["parameters"][largest], both[largest]
    low, high = said["interval95"]
    return bool(low <= true <= high or abs(said["value"] - true) <= SIZED * abs(true))


def figures_of(hidden: Content) -> dict[str, float]:
    """What is hidden in the words of findings: slopes, compliance, a change of friction."""
    told = dict(hidden["parameters"])
    if hidden["effect"] == "ground_slope":  # turned about x and y
        return {"slope_x": -math.tan(told["tilt_y"]), "slope_y": math.tan(told["tilt_x"])}
    if hidden["effect"] == "foot_softness":
        return {"compliance": 1.0 / told["stiffness"]}
    if hidden["effect"] == "foot_friction":
        return {"change": told["friction"] - FRICTION}
    return told


def in_background(finding: Content, truth: Content) -> bool:
    """Whether a dense machine has it anyway."""
    if truth["spec"]["background"] != "dense":
        return False
    if finding["effect"] == "payload":
        mass = finding["parameters"].get("mass", {"value": float("inf")})["value"]
        return bool(abs(mass) <= LIGHT * truth["mass"])
    return finding["effect"] in OF_DENSE


def _listed(finding: Content, hidden: Content | None) -> bool:
    """Whether the true cause stands among what would explain the same."""
    if hidden is None:
        return False
    return any(
        is_right({"links": (), "joints": (), "parameters": {}, **each}, hidden)
        for each in finding.get("equivalents", [])
    )


def _feet(finding: Content) -> list[str]:
    return list(finding.get("feet") or finding.get("links") or [])


def _place(finding: Content) -> list[str]:
    return [*finding["joints"], *(finding["links"] or finding.get("feet") or [])]


def _diagnosis(said: Content) -> dict[str, Any]:
    if "diagnosis" in said:
        return dict(said["diagnosis"])
    return {"verdict": f"error: {said['error']}", "findings": [], "suspected": []}
