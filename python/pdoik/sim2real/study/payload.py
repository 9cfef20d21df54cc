"""A body that a recording's robot is known to hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Payload:
    """Fixed to a link, in the link's frame. Equal figures are the same body."""

    link: str
    mass: float  # [kg]
    com: tuple[float, float, float]  # [m]
    inertia: tuple[float, float, float, float, float, float] = (0.0,) * 6
    """About its own centre: xx xy yy xz yz zz [kg m^2]; all zero for a point."""

    @property
    def label(self) -> str:
        """Name that distinguishes it from other bodies."""
        x, y, z = (f"{each:g}" for each in self.com)
        return f"{self.mass:g} kg at {self.link} ({x}, {y}, {z})"

    @property
    def inertia_matrix(self) -> FloatArray:
        """About its own centre, (3, 3) [kg m^2]."""
        xx, xy, yy, xz, yz, zz = self.inertia
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    @property
    def is_body(self) -> bool:
        """Whether some distribution of mass has this inertia: A + B >= C for its moments."""
        I = self.inertia_matrix  # noqa: E741
        second = 0.5 * np.trace(I) * np.eye(3) - I
        scale = max(float(np.abs(I).max()), 1e-12)
        return self.mass > 0.0 and float(np.linalg.eigvalsh(second)[0]) >= -1e-9 * scale
