"""The shipped H1's joints, feet and soles, and its collision shapes: capsules, cylinders, balls.

Figures after two public sets of primitives (collected in the project's shared notes as
h1_collision_primitives.json): MuJoCo Menagerie's unitree_h1, and, for the two cylinders that give
thigh and shin their girth, Unitree's own URDF. Both BSD-3-Clause. Ours are the two capsules of the
chest, 0.15 x 0.24 x 0.47 m in all instead of Menagerie's box of 0.14 x 0.2 x 0.44 m, whose corners
no spheroid can hug, and the head's capsule is 6 cm longer, to be the neck as well. A shape is given
by the ends of its axis, in the link's frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Point = tuple[float, float, float]

Kind = Literal["capsule", "cylinder", "sphere"]

ROOT_LINK = "pelvis"
FEET = ("left_ankle_link", "right_ankle_link")
_LEG = ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle")
_ARM = ("shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow")
JOINT_NAMES: tuple[str, ...] = (
    *(f"left_{part}_joint" for part in reversed(_LEG)),
    *(f"right_{part}_joint" for part in _LEG),
    "torso_joint",
    *(f"left_{part}_joint" for part in _ARM),
    *(f"right_{part}_joint" for part in _ARM),
)
"""Depth first from the left ankle, as a pdoik.Robot with that base has them."""


@dataclass(frozen=True, slots=True)
class Shape:
    """One convex piece of a link, round about its axis."""

    link: str
    kind: Kind
    a: Point  # one end of the axis, a capsule's without its cap, [m]
    b: Point  # the other end; a sphere's are the same, [m]
    radius: float  # [m]

    def mirrored(self) -> Shape:
        """The same piece of the right limb."""
        (ax, ay, az), (bx, by, bz) = self.a, self.b
        link = self.link.replace("left_", "right_")
        return Shape(link, self.kind, (ax, -ay, az), (bx, -by, bz), self.radius)


_MIDDLE = (
    Shape("torso_link", "capsule", (0, 0.1, -0.05), (0, -0.1, -0.05), 0.05),  # the hips' beam
    Shape("torso_link", "capsule", (0, 0.045, 0.08), (0, 0.045, 0.4), 0.075),
    Shape("torso_link", "capsule", (0, -0.045, 0.08), (0, -0.045, 0.4), 0.075),
    Shape("torso_link", "capsule", (0.05, 0, 0.54), (0.05, 0, 0.68), 0.06),
    Shape("torso_link", "sphere", (0.045, 0, 0.68), (0.045, 0, 0.68), 0.073),  # the head
)
_LEFT = (
    Shape("left_hip_yaw_link", "cylinder", (-0.102, 0, 0), (-0.032, 0, 0), 0.06),
    Shape("left_hip_roll_link", "cylinder", (0, 0.01, 0), (0, -0.05, 0), 0.05),
    Shape("left_hip_pitch_link", "cylinder", (0, -0.05, 0), (0, -0.09, 0), 0.05),
    Shape("left_hip_pitch_link", "capsule", (-0.02, 0, 0.02), (0.02, 0, -0.4), 0.03),
    Shape("left_hip_pitch_link", "capsule", (0.02, 0, 0.02), (0.02, 0, -0.4), 0.03),
    Shape("left_hip_pitch_link", "cylinder", (0, 0, -0.1), (0, 0, -0.3), 0.05),
    Shape("left_knee_link", "capsule", (0.02, 0, 0), (0.02, 0, -0.4), 0.025),
    Shape("left_knee_link", "cylinder", (0, 0, -0.1), (0, 0, -0.3), 0.05),
    Shape("left_ankle_link", "capsule", (-0.035, 0, -0.056), (0.02, 0, -0.045), 0.014),
    Shape("left_ankle_link", "capsule", (0.02, 0, -0.045), (0.115, 0, -0.056), 0.014),
    Shape("left_ankle_link", "capsule", (0.14, 0.03, -0.056), (0.14, -0.03, -0.056), 0.014),
    Shape("left_shoulder_roll_link", "capsule", (0, 0.01, 0.008), (0, -0.07, -0.02), 0.04),
    Shape("left_shoulder_yaw_link", "capsule", (0, 0, 0.15), (0, 0, -0.2), 0.03),
    Shape("left_elbow_link", "capsule", (0, 0, 0), (0.28, 0, -0.015), 0.025),
    Shape("left_elbow_link", "sphere", (0.28, 0, -0.015), (0.28, 0, -0.015), 0.033),  # the hand
)
SHAPES: tuple[Shape, ...] = (*_MIDDLE, *_LEFT, *(shape.mirrored() for shape in _LEFT))

SOLE_HEIGHT = 0.07  # of the ankle above the floor, where the feet's capsules end, [m]
SOLE_HEEL, SOLE_TOE, SOLE_HALF_WIDTH = -0.046, 0.17, 0.04  # in the ankle's frame, [m]
