"""What forces of unknown size leave to be judged of a motion's torques.

A foot presses with a force that nobody measured, a stand holds the base, dry friction holds a joint
at rest. Such forces act along known directions. Least squares that leave their sizes open at
every sample are the same as those on the rest, weighted by the rows' noise (Frisch-Waugh-Lovell;
of feet, Mistry, Buchli and Schaal, ICRA 2010).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..thresholds import NoiseThresholds
from .motion import Motion
from .motion_noise import base_noise, inertial_noise
from .place import Columns, Key
from .signals import dilated, noise_density

_FELT = 1e-3  # numerics: [sigma] by which a row must feel a usual force for that to be taken off
_ARM = 0.1  # [m] at which a usual force acts in a sole, as a moment
_COUPLED = 1e-9  # numerics: of a torque, that it must leave in another row to be seen there
_LEAST_LEFT = 0.01  # numerics: of a row's own variance that must be left for it to be judged


@dataclass(frozen=True, kw_only=True, eq=False)
class FreeRows:
    """The torques' rows of one motion, joints' and base's, with unknown forces taken off."""

    keys: tuple[Key, ...]  # of the rows
    left: FloatArray  # (rows, rows, T): what each row keeps of itself and takes of each
    coupled: NDArray[np.bool_]  # (rows, rows) where it ever is more than nothing
    variance: FloatArray  # (rows,) of the rows' noise, after filtering

    def of(self, columns: Columns) -> Columns:
        """Columns, (T, k) each, without what the unknown forces may do; others as they are."""
        there = [i for i, key in enumerate(self.keys) if key in columns]
        if not there:
            return columns
        result = {key: values for key, values in columns.items() if key not in self.keys}
        whole = np.stack([columns[self.keys[j]].T for j in there])  # (there, k, T)
        for i, key in enumerate(self.keys):
            if self.coupled[i, there].any():
                result[key] = np.einsum("jt,jkt->kt", self.left[i, there], whole).T
        return result

    def judged(self, key: Key) -> NDArray[np.bool_]:
        """Samples at which something of a row is left, (T,)."""
        row = self.keys.index(key)
        return np.asarray(self.left[row, row] > _LEAST_LEFT)

    def noise(self, key: Key) -> float:
        """Variance of a row's own noise: what is left is weighted as if it had all of it.

        The squares of what is left, so weighted, are those of as many rows as no force has.
        """
        return float(self.variance[self.keys.index(key)])


def free_rows(motion: Motion, limits: NoiseThresholds) -> FreeRows | None:
    """The free rows of a motion whose base floats; None for a fixed base."""
    if motion.base is None:
        return None
    left = foot_directions(motion, limits).left()
    left = np.ascontiguousarray(np.transpose(left, (1, 2, 0)))
    return FreeRows(
        keys=tuple(motion.row_key(i) for i in range(motion.rows)),
        left=left,
        coupled=np.abs(left).max(axis=2) > _COUPLED,
        variance=_white_noise(motion),
    )


def row_noise(motion: Motion, limits: NoiseThresholds) -> FloatArray:
    """Standard deviation of each row, (rows,): of channels, and of a model never quite right."""
    size = limits.fit_error * np.sqrt(np.mean(motion.tau**2, axis=0))
    return np.asarray(np.sqrt(_white_noise(motion) + size**2 + 1e-18))


def _white_noise(motion: Motion) -> FloatArray:
    """Variance that noise of the channels leaves in each row, (rows,), reckoned once a motion."""
    name = "noise of rows"
    if name not in motion.cache:
        variance = inertial_noise(motion) + base_noise(motion)
        if motion.torque is not None:
            density = noise_density(motion.torque, motion.period, 1.5 * motion.cutoff)
            variance[: motion.n] += np.nan_to_num(density) * motion.cutoff
        motion.cache[name] = variance
    return motion.cache[name]


@dataclass(frozen=True, kw_only=True, eq=False)
class Directions:
    """Directions along which forces of unknown size act on rows, some of them unknown anyway.

    By singular values, not by normal equations: rows may be a million times as sure as others.
    """

    sigma: FloatArray  # (rows,) noise by which rows are weighted
    known: NDArray[np.bool_]  # (T, rows), False where anything may stand there
    usual: FloatArray  # (k,) sizes of the forces
    across: FloatArray  # (T, rows, m) U of the weighted directions of usual forces
    value: FloatArray  # (T, m)
    along: FloatArray  # (T, m, k) V'

    def left(self) -> FloatArray:
        """Projections of torques that leave no force along the directions, (T, rows, rows)."""
        taken = self.across * (self.value > _FELT)[:, None, :]
        left = self.known[:, :, None] * np.eye(len(self.sigma))
        left -= taken @ np.transpose(taken, (0, 2, 1))
        return np.asarray(left * self.sigma[:, None] / self.sigma)

    def sizes(self, torques: FloatArray) -> FloatArray:
        """The likeliest sizes of the forces, (T, k), by torques (T, rows) and usual sizes."""
        white = np.where(self.known, torques / self.sigma, 0.0)
        each = np.einsum("trm,tr->tm", self.across, white)
        each *= self.value / (self.value**2 + 1.0)
        return np.asarray(np.einsum("tmk,tm->tk", self.along, each) * self.usual)


def directions_of(
    forces: FloatArray, usual: FloatArray, known: NDArray[np.bool_], sigma: FloatArray
) -> Directions:
    """The directions of forces, (T, rows, k), zero where one does not act.

    Args:
        forces: torques per unit of each.
        usual: (k,) standard deviations of their sizes.
        known: (T, rows), False of rows of which nothing is known.
        sigma: (rows,) noise of the torques.
    """
    white = np.where(known[:, :, None], forces * usual / sigma[:, None], 0.0)
    across, value, along = np.linalg.svd(white, full_matrices=False)
    return Directions(
        sigma=sigma, known=known, usual=usual, across=across, value=value, along=along
    )


def foot_directions(motion: Motion, limits: NoiseThresholds) -> Directions:
    """Directions of forces on the feet; rows of silent joints and of a held base are unknown."""
    hung_up = motion.setup.held and motion.recording.contact is None
    feet = () if hung_up else motion.feet
    none = np.zeros((len(motion.time), motion.rows, 1))
    forces = [np.where(foot.may_touch[:, None, None], foot.wrench, 0.0) for foot in feet]
    weight = float(np.sqrt(np.mean(np.sum(motion.tau[:, motion.n : motion.n + 3] ** 2, axis=1))))
    each = weight * np.array([1.0, 1.0, 1.0, _ARM, _ARM, _ARM])
    usual = np.concatenate([*(each[: foot.wrench.shape[2]] for foot in feet), [1.0]])
    return directions_of(
        np.concatenate([*forces, none], axis=2), usual, _known(motion), row_noise(motion, limits)
    )


def _known(motion: Motion) -> NDArray[np.bool_]:
    """Rows that are not those of joints at rest, of unknown torques or of a base that is held."""
    around = int(0.3 / (motion.cutoff * motion.period))
    known = np.ones((len(motion.time), motion.rows), dtype=np.bool_)
    known[:, : motion.n] = ~dilated(motion.still, around)
    if motion.torque is None:
        known[:, : motion.n] = False
    else:
        known[:, : motion.n] &= np.isfinite(motion.torque).all(axis=0)
    if motion.setup.held:
        known[:, motion.n :] = False
    return known
