"""Objects on set paths at the robot: where they are, what cloud they show and will sweep."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import FloatArray, moved
from bench.humanoid.world.objects import LEAF, FlyingObject

DISTANCE = 2.5  # from the start to the point aimed at, [m]
BEYOND = 1.0  # how far a throw goes on behind that point, [m]
SPACING = 0.02  # between a point's places in a swept cloud, at most, [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Throw:
    """An object on a set path that leads through `aim`, tumbling as it goes.

    With s = speed t / DISTANCE, the path's middle is start + s (aim - start) + 4 arc s (1 - s) z: a
    straight line for arc = 0, else a parabola. Path and tumbling are functions of s, so a
    throw that hits hits at every speed.
    """

    object_name: str
    aim: tuple[float, float, float]  # world [m], reached at `arrival`
    start: tuple[float, float, float]  # world [m]
    speed: float  # DISTANCE over the time to `aim`, [m/s]
    arc: float = 0.0  # height of the path over the straight line, half-way, [m]
    attitude: tuple[float, float, float] = (0.0, 0.0, 0.0)  # rotation vector at the start, [rad]
    tumble: tuple[float, float, float] = (0.0, 0.0, 0.0)  # rotation vector from start to aim, [rad]

    @property
    def arrival(self) -> float:
        """When the object's middle would be at `aim`, [s]."""
        return DISTANCE / self.speed

    @property
    def duration(self) -> float:
        """Until it is BEYOND behind `aim`, [s]."""
        return (DISTANCE + BEYOND) / self.speed

    def at_speed(self, speed: float) -> Throw:
        """The same path, faster or slower [m/s]."""
        return replace(self, speed=speed)

    def pose(self, t: float) -> FloatArray:
        """T_world_object at time t [s], (4, 4) [m]."""
        s = t / self.arrival
        start, aim = np.array(self.start), np.array(self.aim)
        R = Rotation.from_rotvec(s * np.array(self.tumble)) * Rotation.from_rotvec(self.attitude)
        T = np.eye(4)
        T[:3, :3] = R.as_matrix()
        T[:3, 3] = start + s * (aim - start) + [0, 0, 4 * self.arc * s * (1 - s)]
        return T

    def cloud(self, thing: FlyingObject, t: float) -> FloatArray:
        """What a camera would see of the object at time t, (K, 3), world [m]."""
        return moved(thing.cloud, self.pose(t))

    def swept_cloud(
        self, thing: FlyingObject, t_begin: float, t_end: float, leaf: float = LEAF
    ) -> FloatArray:
        """What the object passes through between two times, (K, 4): x, y, z, radius, world [m].

        The scan's points at instants so close that none moves more than SPACING from one to the
        next, thinned by PCL's grid; the balls of these radii hold all of them. Half of SPACING is
        on top, so they hold the way between two instants as well.
        """
        n = 1 + int(np.ceil((t_end - t_begin) * self._top_speed(thing) / SPACING))
        points = np.concatenate(
            [moved(thing.surface, self.pose(t)) for t in np.linspace(t_begin, t_end, max(n, 2))]
        )
        balls = pdoik.voxel_downsample(points, leaf, radii=True)
        balls[:, 3] += SPACING / 2
        return balls

    def _top_speed(self, thing: FlyingObject) -> float:
        """Largest speed of the object's points from the start to BEYOND behind the aim [m/s]."""
        chord = np.array(self.aim) - np.array(self.start)
        ends = (0.0, self.duration / self.arrival)
        middle = max(
            float(np.linalg.norm(chord + np.array([0, 0, 4 * self.arc * (1 - 2 * s)])))
            for s in ends
        )
        return (middle + float(np.linalg.norm(self.tumble)) * thing.radius) / self.arrival
