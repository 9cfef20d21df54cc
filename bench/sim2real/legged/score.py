"""A world's truth and what was said of it, and what a campaign came to."""

import json
import math
from collections.abc import Sequence
from typing import Any

import pandas as pd

from bench.common.markdown import markdown_table
from bench.sim2real.frame.score import Content, agrees, as_diagnosis, confidence
from bench.sim2real.legged.machine import FRICTION
from bench.sim2real.legged.spec import GROUND_KINDS, HEALTHY, IMU_KINDS

CLAIMED = 0.75  # confidence from which a finding is a claim
SIZED = 0.34  # relative error of a figure that is right without its interval
OF_DENSE = (
    *("coulomb_friction", "viscous_friction", "torque_gain", "torque_offset", "rotor_inertia"),
    *("link_inertial_error", *IMU_KINDS),
)
"""What every dense machine has anyway, everywhere: neither right nor false."""

LIGHT = 0.06  # of the machine's mass: a load that the links' own errors come to


def score(name: str, truth: Content, said: Content) -> dict[str, Any]:
    """One row: all that the tables need."""
    spec, diagnosis = truth["spec"], as_diagnosis(said)
    claimed = [f for f in diagnosis["findings"] if confidence(f) >= CLAIMED]
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
        "found": json.dumps([[f["effect"], round(confidence(f), 2), *_place(f)] for f in claimed]),
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
    return agrees(finding["parameters"][largest], both[largest], SIZED)


def figures_of(hidden: Content) -> dict[str, float]:
    """What is hidden in the words of findings: slopes, compliance, a change of friction."""
    figures = dict(hidden["parameters"])
    if hidden["effect"] == "ground_slope":  # turned about x and y
        return {"slope_x": -math.tan(figures["tilt_y"]), "slope_y": math.tan(figures["tilt_x"])}
    if hidden["effect"] == "foot_softness":
        return {"compliance": 1.0 / figures["stiffness"]}
    if hidden["effect"] == "foot_friction":
        return {"change": figures["friction"] - FRICTION}
    return figures


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


KEYS = {"named": "named", "and sized": "sized", "or listed": "listed", "or suspected": "suspected"}
RATE = "false findings in a world"
SORT = ["robot", "background"]


def all_tables(made: pd.DataFrame, not_made: Sequence[str] = ()) -> str:
    """Tables by sort of world, of healthy worlds, and by kind.

    Args:
        made: a row per world.
        not_made: names of worlds whose robot fell whatever was drawn.
    """
    hidden = made[made.kind != HEALTHY]
    took, crashed = made.seconds, int(made.crash.sum())
    parts = [
        _by_sort(hidden),
        _healthy(made[made.kind == HEALTHY]),
        _by_kind(hidden),
        f"A diagnosis takes {took.median():.0f} s, at most {took.max():.0f} s;"
        f" {crashed} of {len(made)} studies were not diagnosed.",
    ]
    if not_made:
        parts.append(f"Not made, for the robot always fell: {', '.join(not_made)}.")
    return "\n\n".join(part.rstrip() for part in parts) + "\n"


def _by_sort(hidden: pd.DataFrame) -> str:
    lines = [(*sort, len(group), *_counts(group)) for sort, group in hidden.groupby(SORT)]
    return markdown_table(
        (*SORT, "worlds", *KEYS, RATE), [*lines, ("all", "", len(hidden), *_counts(hidden))]
    )


def _healthy(healthy: pd.DataFrame) -> str:
    lines = [
        (*sort, len(group), int(group.alarm.astype(bool).sum()), int(group["false"].sum()))
        for sort, group in healthy.groupby(SORT)
    ]
    return markdown_table((*SORT, "healthy worlds", "with a false alarm", "false findings"), lines)


def _by_kind(hidden: pd.DataFrame) -> str:
    lines = [(kind, len(group), *_counts(group)) for kind, group in hidden.groupby("kind")]
    return markdown_table(("kind", "worlds", *KEYS, RATE), lines)


def _counts(group: pd.DataFrame) -> tuple[str, ...]:
    """Counts of the columns of KEYS, and the rate of false findings."""
    rate = f"{group['false'].mean():.2f}" if len(group) else "-"
    return (*(str(int(group[key].sum())) for key in KEYS.values()), rate)
