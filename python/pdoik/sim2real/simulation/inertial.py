"""Inertial parameters of a link in its own frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray

_NO_MASS = 1e-12  # [kg]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inertial:
    """Mass, first moment and inertia of a link, which add up where bodies are joined."""

    mass: float  # [kg]
    first_moment: FloatArray  # (3,) mass times centre of mass [kg m]
    inertia: FloatArray  # (3, 3) about the frame's origin [kg m^2]

    @classmethod
    def nothing(cls) -> Inertial:
        """A link without mass."""
        return cls(mass=0.0, first_moment=np.zeros(3), inertia=np.zeros((3, 3)))

    @classmethod
    def about_com(cls, mass: float, com: FloatArray, inertia: FloatArray) -> Inertial:
        """Made from the inertia (3, 3) about the centre of mass, axes parallel to the frame's."""
        com = np.asarray(com, dtype=float)
        return cls(mass=mass, first_moment=mass * com, inertia=inertia + mass * _steiner(com))

    @classmethod
    def from_ten(cls, ten: Sequence[float] | FloatArray) -> Inertial:
        """Made from mass, first moments x y z, inertias xx xy yy xz yz zz about the origin."""
        mass, x, y, z, xx, xy, yy, xz, yz, zz = (float(each) for each in ten)
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        return cls(mass=mass, first_moment=np.array([x, y, z]), inertia=inertia)

    def ten(self) -> FloatArray:
        """The ten parameters as `from_ten` takes them (Pinocchio's order), (10,)."""
        I = self.inertia  # noqa: E741
        inertia = (I[0, 0], I[0, 1], I[1, 1], I[0, 2], I[1, 2], I[2, 2])
        return np.array([self.mass, *self.first_moment, *inertia])

    def __add__(self, other: Inertial) -> Inertial:
        return Inertial(
            mass=self.mass + other.mass,
            first_moment=self.first_moment + other.first_moment,
            inertia=self.inertia + other.inertia,
        )

    @property
    def com(self) -> FloatArray:
        """Centre of mass (3,) [m]; the origin for a link without mass."""
        return self.first_moment / self.mass if abs(self.mass) > _NO_MASS else np.zeros(3)

    @property
    def inertia_about_com(self) -> FloatArray:
        """Inertia about the centre of mass, axes parallel to the frame's, (3, 3) [kg m^2]."""
        return np.asarray(self.inertia - self.mass * _steiner(self.com))

    @property
    def is_body(self) -> bool:
        """Whether some distribution of mass has these figures.

        The 4x4 matrix of second moments [[S, h], [h', m]] with I = trace(S) - S is that of a
        density, so it has no negative eigenvalue (Wensing, Kim and Slotine, RA-L 3(1), 2018).
        """
        values, _, _ = self._second_moments()
        return bool(values[0] >= -1e-9 * max(float(np.abs(values).max()), 1e-9))

    def nearest_body(self) -> Inertial:
        """These figures if they are a body's, else those of one near them.

        Eigenvalues of its second moments are kept from being negative (see `is_body`).
        """
        if self.is_body:
            return self
        values, vectors, back = self._second_moments()
        least = 1e-6 * max(float(np.abs(values).max()), 1e-12)
        whole = back @ (vectors * np.maximum(values, least)) @ vectors.T @ back
        S = whole[:3, :3]
        return Inertial(
            mass=float(whole[3, 3]),
            first_moment=whole[:3, 3],
            inertia=np.asarray(np.trace(S) * np.eye(3) - S),
        )

    def _second_moments(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Eigenvalues and vectors of the 4x4 matrix, lengths in units of the link's own.

        The last is what turns these units into metres.
        """
        S = 0.5 * np.trace(self.inertia) * np.eye(3) - self.inertia
        scale = max(abs(self.mass), 1e-6)
        length = np.sqrt(max(float(np.abs(S).max()), 1e-9) / scale)
        unit, back = np.diag([1.0 / length] * 3 + [1.0]), np.diag([length] * 3 + [1.0])
        whole = np.block([[S, self.first_moment[:, None]], [self.first_moment[None], self.mass]])
        values, vectors = np.linalg.eigh(unit @ whole @ unit)
        return values, vectors, back

    def principal(self, link: str) -> tuple[FloatArray, FloatArray]:
        """Moments (3,) about the centre of mass and axes (3, 3), a rotation.

        Raises:
            ValueError: no body has such parameters; the message names `link`.
        """
        moments, axes = np.linalg.eigh(self.inertia_about_com)
        scale = max(float(np.abs(self.inertia).max()), 1e-9)
        if self.mass < 0 or moments[0] < -1e-9 * scale:
            raise ValueError(
                f"link {link}: no body has mass {self.mass:.4g} kg and moments of inertia "
                f"{', '.join(f'{each:.4g}' for each in moments)} kg m^2 about its centre of mass"
            )
        if np.linalg.det(axes) < 0:
            axes = axes * [1.0, 1.0, -1.0]
        return np.maximum(moments, 0.0), np.asarray(axes)


def _steiner(r: FloatArray) -> FloatArray:
    return np.asarray(np.dot(r, r) * np.eye(3) - np.outer(r, r))
