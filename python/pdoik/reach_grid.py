"""Grids of poses that a robot is asked to reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Grid:
    """Poses to be asked for: each orientation at each position.

    Args:
        positions: Shape (P, 3), in the base frame [m].
        orientations: Rotations base to tip, shape (R, 3, 3).
    """

    positions: FloatArray
    orientations: FloatArray

    @classmethod
    def box(
        cls,
        low: npt.ArrayLike,
        high: npt.ArrayLike,
        step: float,
        orientations: int | npt.ArrayLike = 1,
    ) -> Grid:
        """Positions in a box, a step apart along each axis, both ends included.

        Args:
            low: The box's lowest x, y, z [m].
            high: Its highest [m].
            step: Between neighbours [m].
            orientations: That many, spread evenly over all rotations; or rotations, (R, 3, 3).

        Raises:
            ValueError: A box inside out, a step that is not positive, no orientation.
        """
        a, b = (np.asarray(corner, dtype=np.float64) for corner in (low, high))
        if a.shape != (3,) or b.shape != (3,) or not (np.isfinite([a, b]).all() and (a <= b).all()):
            raise ValueError(f"the box goes from {a} to {b}, expected finite x, y, z in order")
        if not (np.isfinite(step) and step > 0):
            raise ValueError(f"step is {step}, expected a positive length [m]")
        axes = [np.arange(np.floor((top - bottom) / step + 1e-9) + 1) * step + bottom
                for bottom, top in zip(a, b, strict=True)]  # fmt: skip
        positions = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        if isinstance(orientations, int):
            return cls(positions, even_rotations(orientations))
        return cls(positions, np.asarray(orientations, dtype=np.float64))

    def __post_init__(self) -> None:
        shapes = self.positions.shape, self.orientations.shape
        if (
            self.positions.ndim != 2
            or shapes[0][1:] != (3,)
            or self.orientations.ndim != 3
            or shapes[1][1:] != (3, 3)
            or 0 in (len(self.positions), len(self.orientations))
        ):
            raise ValueError(
                f"positions and orientations have shapes {shapes[0]} and {shapes[1]}, "
                "expected (P, 3) and (R, 3, 3), none empty"
            )
        if not (np.isfinite(self.positions).all() and np.isfinite(self.orientations).all()):
            raise ValueError("positions or orientations have NaN or infinity, expected numbers")

    def __len__(self) -> int:
        return len(self.positions) * len(self.orientations)

    def poses(self, begin: int, end: int) -> FloatArray:
        """Those from `begin` to before `end`, shape (B, 4, 4); position by position."""
        position, orientation = np.divmod(np.arange(begin, end), len(self.orientations))
        poses = np.zeros((end - begin, 4, 4))
        poses[:, :3, :3] = self.orientations[orientation]
        poses[:, :3, 3] = self.positions[position]
        poses[:, 3, 3] = 1.0
        return poses


def even_rotations(count: int) -> FloatArray:
    """Rotations spread evenly, shape (count, 3, 3): Alexa's super-Fibonacci spiral (CVPR 2022).

    Raises:
        ValueError: count is below 1.
    """
    if count < 1:
        raise ValueError(f"orientations is {count}, expected at least 1")
    if count == 1:
        return np.eye(3)[None]
    phi, psi = np.sqrt(2.0), 1.533751168755204288118041
    s = np.arange(count) + 0.5
    r, big_r = np.sqrt(s / count), np.sqrt(1.0 - s / count)
    alpha, beta = 2 * np.pi * s / phi, 2 * np.pi * s / psi
    x, y, z, w = r * np.sin(alpha), r * np.cos(alpha), big_r * np.sin(beta), big_r * np.cos(beta)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)
