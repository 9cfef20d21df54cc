"""Robots that stand on what is in the scene; targets are poses of random configurations."""

from collections.abc import Sequence

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.problems.families.family import Draft, Placement, Range, family, vary
from bench.ik.problems.solids import Solid, box, cylinder, pose

SOLE = np.array([(x, y, -0.03) for x, w in ((-0.05, 0.025), (0.12, 0.03)) for y in (-w, w)])
FEET = ("left_ankle_roll_link", "right_ankle_roll_link")
GROUND = -0.035  # in the left foot's frame [m]
TOP = 0.72  # of the table above the ground [m]
BEND = (0.05, 0.5)  # of hips and ankles; of the knees twice that [rad]
WAIST = 0.3  # how far it turns and leans [rad]
REST = {"shoulder_pitch": -0.5, "elbow": 0.4}
REACH = {"shoulder_pitch": 1.0, "shoulder_roll": 0.5, "shoulder_yaw": 0.7, "elbow": 0.6}
WRIST = 0.6  # [rad]


@family(
    "flat_table",
    "above a table that the robot stands on",
    {"panda": Placement(), "ur5": Placement(), "ur10": Placement()},
)
def flat_table(rng: np.random.Generator, _: Placement) -> Draft:
    """CuRobo's table: a slab of 5 m by 5 m, which the robot's foot may touch."""
    table = box("table", (5.0, 5.0, 0.2), pose((0, 0, -0.1)))
    return Draft([table], None, frozenset({("panda_link0", "table"), ("base_link", "table")}))


@family("humanoid_table", "both hands of a humanoid over a table, in balance", {"g1": Placement()})
def humanoid_table(rng: np.random.Generator, _: Placement) -> Draft:
    """Things moved about on a table, which comes nearer or not.

    The robot looks along x, its left foot at the origin.
    """
    z = GROUND + TOP
    solids = [
        Solid("ground", "half_space", (), pose((0, 0, GROUND))),
        box("table_top", (0.6, 1.2, 0.03), pose((0.62, -0.12, z - 0.015))),
        box("parcel", (0.2, 0.15, 0.2), pose((0.6, 0.2, z + 0.1))),
        cylinder("bottle", 0.04, 0.25, pose((0.5, -0.1, z + 0.125))),
        Solid("ball", "sphere", (0.08,), pose((0.6, -0.45, z + 0.08))),
    ]
    solids = vary(solids, ("parcel", "bottle", "ball"), Range((0.1, 0.1, 0)), rng)
    T = pose((rng.uniform(-0.05, 0.15), 0, 0))
    solids = [s if s.kind == "half_space" else s.moved(T) for s in solids]
    allowed = frozenset((foot, "ground") for foot in FEET)
    return Draft(solids, None, allowed, _posture, dict.fromkeys(FEET, SOLE))


def _posture(rng: np.random.Generator, joint_names: Sequence[str]) -> FloatArray:
    """Both legs bent alike, so that both soles are on the ground; waist and arms anywhere near."""
    bend = rng.uniform(*BEND)
    still = {"hip_pitch": -bend, "knee": 2 * bend, "ankle_pitch": -bend, "hip": 0.0, "ankle": 0.0}
    reaches = {"waist": WAIST, **REACH, "": WRIST}

    def value(name: str) -> float:
        for part, at in still.items():
            if part in name:
                return at
        part, reach = next((part, reach) for part, reach in reaches.items() if part in name)
        return float(REST.get(part, 0.0) + rng.uniform(-reach, reach))

    return np.array([value(name) for name in joint_names])
