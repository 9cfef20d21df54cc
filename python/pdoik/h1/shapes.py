"""Collision shapes of the H1: capsules, cylinders and balls.

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

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Point = tuple[float, float, float]

Kind = Literal["capsule", "cylinder", "sphere"]


@dataclass(frozen=True, slots=True)
class Shape:
    """One convex piece of a link, round about its axis."""

    link: str
    kind: Kind
    a: Point  # one end of the axis, a capsule's without its cap, [m]
    b: Point  # the other end; a sphere's are the same, [m]
    radius: float  # [m]

    def distance(self, points: FloatArray) -> FloatArray:
        """Signed distance of points (N, 3) in the link's frame to the surface, (N,) [m]."""
        a, b = np.array(self.a), np.array(self.b)
        if self.kind == "sphere":
            return np.asarray(np.linalg.norm(points - a, axis=1) - self.radius)
        length = float(np.linalg.norm(b - a))
        along = (points - a) @ (b - a) / length
        if self.kind == "capsule":
            foot = a + np.clip(along, 0, length)[:, None] * (b - a) / length
            return np.asarray(np.linalg.norm(points - foot, axis=1) - self.radius)
        off_axis = np.linalg.norm(points - a - along[:, None] * (b - a) / length, axis=1)
        q = np.column_stack([off_axis - self.radius, np.abs(along - length / 2) - length / 2])
        outside = np.linalg.norm(np.maximum(q, 0), axis=1)
        return np.asarray(outside + np.minimum(q.max(axis=1), 0))

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
SOLE_RADIUS = 0.005  # of the six balls that a foot stands on, [m]


def sole_centers() -> FloatArray:
    """Of the six balls under a foot, (6, 3) in the ankle link's frame [m]."""
    heel, toe = SOLE_HEEL + SOLE_RADIUS, SOLE_TOE - SOLE_RADIUS
    width = SOLE_HALF_WIDTH - SOLE_RADIUS
    return np.array(
        [
            (x, y, SOLE_RADIUS - SOLE_HEIGHT)
            for x in (heel, (heel + toe) / 2, toe)
            for y in (-width, width)
        ]
    )
