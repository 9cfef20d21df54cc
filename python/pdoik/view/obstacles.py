"""What the robot keeps off: a cloud that may be moved as a whole, a ball, and shapes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik.scenes import as_optional

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ball:
    """A round obstacle, which is exactly one point with a radius."""

    center: tuple[float, float, float]  # base frame [m]
    radius: float  # [m]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Obstacles:
    """A cloud, how it is thinned and where it is, a ball, and shapes.

    Attributes:
        surface: Points as a sensor gives them, (N, 3) [m].
        leaf: Edge of the cells the cloud is thinned to [m]; 0 keeps every point.
        radii: Whether points that are kept cover those that are not.
        T_base_cloud: Where the cloud's frame is, (4, 4).
        ball: None for none.
        shapes: Solids, in the base frame.
        contacts: Rules of contact; those that speak of links that a robot lacks do not count.
    """

    surface: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    leaf: float = 0.02
    radii: bool = True
    T_base_cloud: FloatArray = field(default_factory=lambda: np.eye(4))
    ball: Ball | None = None
    shapes: tuple[pdoik.Shape, ...] = ()
    contacts: tuple[pdoik.ContactRule, ...] = ()

    @property
    def there(self) -> bool:
        """Whether there is anything."""
        return len(self.surface) > 0 or self.ball is not None or len(self.shapes) > 0

    def scene(self, points: FloatArray) -> pdoik.Scene | FloatArray:
        """`points` and the shapes, for a solver."""
        if not self.shapes and not self.contacts:
            return points
        cloud = points if len(points) else None
        # Whoever is shown them may have chosen another robot since.
        contacts = [as_optional(rule) for rule in self.contacts]
        return pdoik.Scene(self.shapes, cloud=cloud, contacts=contacts)

    def thinned(self) -> FloatArray:
        """The points that are kept and their radii, (K, 4) in the cloud's frame [m].

        Raises:
            ValueError: The cloud has more than 2^31 cells of this size.
        """
        kept = self.surface
        if self.leaf > 0 and len(kept):
            kept = pdoik.voxel_downsample(kept, self.leaf, self.radii)
        if kept.shape[1] == 4:
            return np.ascontiguousarray(kept)
        return np.column_stack([kept, np.zeros(len(kept))])

    def placed(self, thinned: FloatArray) -> FloatArray:
        """`thinned` in the base frame with the ball as last row, (K, 4) or (K + 1, 4) [m]."""
        R, t = self.T_base_cloud[:3, :3], self.T_base_cloud[:3, 3]
        rows = np.column_stack([thinned[:, :3] @ R.T + t, thinned[:, 3]])
        if self.ball is not None:
            rows = np.concatenate([rows, [[*self.ball.center, self.ball.radius]]])
        return np.ascontiguousarray(rows)
