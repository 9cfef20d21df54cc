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

from ..study.recording import FloatArray
from ..thresholds.noise import NoiseThresholds
from .motion import Motion
from .motion_noise import base_noise, inertial_noise
from .place import Columns, Key
from .signals import dilated, noise_density

_RIDGE = 1e-10  # of the largest direction's square
_COUPLED = 1e-9  # of a torque, that it must leave in another row to be seen there
_LEAST_LEFT = 0.01  # of a row's own variance that must be left for it to be judged


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
    """Of a motion whose base floats; None of another."""
    if motion.base is None:
        return None
    left = projector(unknown_forces(motion), row_noise(motion, limits))
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


def unknown_forces(motion: Motion) -> FloatArray:
    """Directions of forces of unknown size, (T, rows, k), zero where they do not act."""
    count, rows, n = len(motion.time), motion.rows, motion.n
    hung_up = motion.setup.held and motion.recording.contact is None
    feet = () if hung_up else motion.feet
    found = [np.where(foot.may_touch[:, None, None], foot.wrench, 0.0) for foot in feet]
    if motion.setup.held:
        held = np.zeros((count, rows, 6))
        held[:, n:] = np.eye(6)
        found.append(held)
    return np.concatenate([*found, _of_joints(motion)], axis=2)


def _of_joints(motion: Motion) -> FloatArray:
    """Of joints at rest, or whose torque nobody knows, (T, rows, n)."""
    count, rows, n = len(motion.time), motion.rows, motion.n
    around = int(0.3 / (motion.cutoff * motion.period))
    unknown = dilated(motion.still, around)
    if motion.torque is None:
        unknown = np.ones((count, n), dtype=np.bool_)
    else:
        unknown = unknown | ~np.isfinite(motion.torque).all(axis=0)
    directions = np.zeros((count, rows, n))
    directions[:, range(n), range(n)] = unknown
    return directions


def weighted(directions: FloatArray, sigma: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Directions by the rows' noise, (T, rows, k), and their Gram matrices, (T, k, k).

    A direction that does not act is zero; a trace of ridge keeps its matrix regular.
    """
    white = directions / sigma[:, None]
    gram = np.einsum("tri,trj->tij", white, white, optimize=True)
    largest = np.maximum(np.einsum("tii->t", gram), 1e-12)
    return white, gram + (_RIDGE * largest)[:, None, None] * np.eye(gram.shape[1])


def projector(directions: FloatArray, sigma: FloatArray) -> FloatArray:
    """What takes the directions off torques, (T, rows, rows).

    Args:
        directions: (T, rows, k).
        sigma: (rows,) noise of the torques, by which their rows are weighted.
    """
    white, gram = weighted(directions, sigma)
    taken = white @ np.linalg.solve(gram, np.transpose(white, (0, 2, 1)))
    left = np.eye(len(sigma)) - taken
    return np.asarray(left * sigma[:, None] / sigma)
