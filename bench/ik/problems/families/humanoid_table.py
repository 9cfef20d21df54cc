"""A humanoid before a table with three things on it: both hands, and its balance on both feet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from bench.ik.problems.families.family import Draft, Family, Placement, Range, vary
from bench.ik.problems.solids import Solid, box, cylinder, pose

FloatArray = npt.NDArray[np.float64]
SOLE = np.array([(x, y, -0.03) for x, w in ((-0.05, 0.025), (0.12, 0.03)) for y in (-w, w)])
FEET = ("left_ankle_roll_link", "right_ankle_roll_link")
GROUND = -0.035  # in the left foot's frame [m]
TOP = 0.72  # of the table above the ground [m]
BEND = (0.05, 0.5)  # of hips and ankles; of the knees twice that [rad]
WAIST = 0.3  # how far it turns and leans [rad]
REST = {"shoulder_pitch": -0.5, "elbow": 0.4}
REACH = {"shoulder_pitch": 1.0, "shoulder_roll": 0.5, "shoulder_yaw": 0.7, "elbow": 0.6}
WRIST = 0.6  # [rad]


def nominal() -> list[Solid]:
    """The scene before anything is varied; the robot looks along x, its left foot at the origin."""
    z = GROUND + TOP
    return [
        Solid("ground", "half_space", (), pose((0, 0, GROUND))),
        box("table_top", (0.6, 1.2, 0.03), pose((0.62, -0.12, z - 0.015))),
        box("parcel", (0.2, 0.15, 0.2), pose((0.6, 0.2, z + 0.1))),
        cylinder("bottle", 0.04, 0.25, pose((0.5, -0.1, z + 0.125))),
        Solid("ball", "sphere", (0.08,), pose((0.6, -0.45, z + 0.08))),
    ]


def posture(rng: np.random.Generator, joint_names: Sequence[str]) -> FloatArray:
    """Both legs bent alike, so that both soles are on the ground; waist and arms anywhere near."""
    bend = rng.uniform(*BEND)
    legs = {"hip_pitch": -bend, "knee": 2 * bend, "ankle_pitch": -bend}
    return np.array([_joint(name, legs, rng) for name in joint_names])


def _joint(name: str, legs: dict[str, float], rng: np.random.Generator) -> float:
    for part, value in legs.items():
        if part in name:
            return value
    if "hip" in name or "ankle" in name:
        return 0.0
    if "waist" in name:
        return float(rng.uniform(-WAIST, WAIST))
    for part, reach in REACH.items():
        if part in name:
            return float(REST.get(part, 0.0) + rng.uniform(-reach, reach))
    return float(rng.uniform(-WRIST, WRIST))


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """Things moved about on the table, which comes nearer or not."""
    solids = vary(nominal(), ("parcel", "bottle", "ball"), Range(position=(0.1, 0.1, 0)), rng)
    T = pose((rng.uniform(-0.05, 0.15), 0, 0))
    solids = [s if s.kind == "half_space" else s.moved(T) for s in solids]
    return Draft(
        solids=tuple(solids),
        grasp=None,
        allowed=frozenset((foot, "ground") for foot in FEET),
        posture=posture,
        contacts=dict.fromkeys(FEET, SOLE),
    )


FAMILY = Family(
    name="humanoid_table",
    about="both hands of a humanoid over a table, in balance",
    robots={"g1": Placement()},
    draw=draw,
)
