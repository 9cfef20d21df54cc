"""The balances of a study: what is measured less what the model says, filtered and thinned."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..study import ROWS
from ..thresholds import Thresholds
from .free_rows import free_rows
from .given_sessions import given_sessions
from .motion import Motion
from .motion_noise import imu_noise, inertial_noise
from .place import Balance, Columns, Key, Place, Shape
from .signals import dilated, noise_density, zero_phase

_Name = tuple[str, Place, Shape]  # of a cause, where it acts and its shape
_NOTHING = 1e-100  # numerics:
_RECENT = 150  # numerics: columns that are kept for a while
_PERIODS = 10.0  # of the lowest cut-off that fit into a recording
_OF_FEET: tuple[Balance, ...] = ("foot", "tilt", "grip")


class Cause(Protocol):
    """A cause that may add to balances: an effect."""

    @property
    def id(self) -> str:
        """The effect's name."""

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """What it adds per unit of its coefficients, at the motion's rate, (T, k) by key."""


def _end(motion: Motion, cutoff: float) -> int:
    """Samples at either end that a filter makes too much of."""
    return int(1.0 / (cutoff * motion.period)) + 1


def columns_of(cause: Cause, motion: Motion, place: Place, shape: Shape) -> Columns:
    """The cause's columns, zero outside its place's gate."""
    return _gated(cause.columns(motion, place, shape), motion, place)


def _gated(columns: Columns, motion: Motion, place: Place) -> Columns:
    """Columns, zero outside a place's gate."""
    gate = place.gate
    if gate is None:
        return columns
    weight = gate.weight(axis_of(motion, gate.of, place.joints[0]))[:, None]
    return {key: column * weight for key, column in columns.items()}


def axis_of(motion: Motion, of: str, j: int) -> FloatArray:
    """What a gate is a part of, (T,): times, the study's clock, or joint j's positions."""
    if of == "time":
        return motion.time
    return motion.clock + motion.time if of == "clock" else motion.q[:, j]


class Balances:
    """Rows of every balance of some motions: (N,) per key, recordings one after the other."""

    def __init__(self, motions: Sequence[Motion], thresholds: Thresholds | None = None) -> None:
        """Motions share joints and cut-off; thresholds are the defaults if none are given."""
        self.motions = tuple(motions)
        self.thresholds = Thresholds() if thresholds is None else thresholds
        self.n = motions[0].n
        self._steps = [max(1, int(1.0 / (ROWS * m.cutoff * m.period))) for m in motions]
        counts = [len(range(0, len(m.time), s)) for m, s in zip(motions, self._steps, strict=True)]
        self.starts = np.concatenate([[0], np.cumsum(counts)])
        self.count = int(self.starts[-1])
        self.time = self._stack([m.time for m in motions])
        self.recording = np.repeat(np.arange(len(motions)), counts)
        self.block = self._blocks()
        self.fold = self._folds()
        self.told = given_sessions([m.setup for m in motions])  # (motions,), None without any
        self.excited = np.array([_excited(motions, j, self.thresholds) for j in range(self.n)])
        self.residual: dict[Key, FloatArray] = {}
        self.mask: dict[Key, NDArray[np.bool_]] = {}
        self.floor: dict[Key, float] = {}
        self.sigma: dict[Key, float] = {}
        self._columns: dict[_Name, dict[Key, FloatArray]] = {}
        self._recent: dict[_Name, dict[Key, FloatArray]] = {}  # the latest last
        self._last: tuple[_Name | None, list[Columns]] = None, []
        self._free = [free_rows(motion, self.thresholds.noise) for motion in motions]
        with_pose = all(m.base is not None and m.base.disagreement is not None for m in motions)
        self._imu_noise = [imu_noise(m) for m in motions] if with_pose else []
        self._cutoffs = self._lower_cutoffs()
        for key, values in self._freed(self._raw()).items():
            self._add(key, values)

    @property
    def keys(self) -> tuple[Key, ...]:
        """Balances and channels that these motions have."""
        return tuple(self.residual)

    @property
    def loads_are_inferred(self) -> bool:
        """Whether torques say what feet take."""
        return any(foot.load is not None for m in self.motions for foot in m.feet)

    def thin(self, motion: int, values: FloatArray, cutoff: float | None = None) -> FloatArray:
        """Filter and leave out samples, as every balance is; (T, ...) to (N of the motion, ...)."""
        m = self.motions[motion]
        if cutoff is None:
            smooth = zero_phase(values, m.cutoff, m.period)
        else:  # what was smoothed before is wrong at its ends, and would be spread
            inner = slice(_end(m, m.cutoff), len(values) - _end(m, m.cutoff))
            smooth = np.zeros_like(values)
            smooth[inner] = zero_phase(values[inner], cutoff, m.period, noisy=True)
        thin = smooth[:: self._steps[motion]]
        # What a filter leaves long after is no number to reckon with, and slow to reckon with.
        return np.where(np.abs(thin) < _NOTHING, 0.0, thin)

    def _thinned(self, motion: int, columns: Columns) -> Columns:
        """Columns of the balances that there are, thinned: all at once, which is quicker."""
        result: dict[Key, FloatArray] = {}
        by_cutoff: dict[float | None, dict[Key, FloatArray]] = {}
        for key, values in columns.items():
            if key in self.residual:
                by_cutoff.setdefault(self._cutoffs.get(key), {})[key] = values
        for cutoff, kept in by_cutoff.items():
            thin = self.thin(motion, np.hstack(list(kept.values())), cutoff)
            ends = np.cumsum([values.shape[1] for values in kept.values()])[:-1]
            result |= zip(kept, np.split(thin, ends, axis=1), strict=True)
        return result

    def sampled(self, values: Sequence[FloatArray]) -> FloatArray:
        """Unfiltered values of every motion at the rows, (N, ...)."""
        return self._stack(list(values))

    def columns(self, cause: Cause, place: Place, shape: Shape) -> dict[Key, FloatArray]:
        """What a cause adds per coefficient, (N, k) for each key that it changes."""
        name = (cause.id, place, shape)
        if name not in self._columns:
            self._columns[name] = self.compute(cause, place, shape)
        return self._columns[name]

    def recent(self, cause: Cause, place: Place, shape: Shape) -> dict[Key, FloatArray]:
        """`columns`, kept for a while only: those of shapes that are tried time and again."""
        name = (cause.id, place, shape)
        found = self._recent.pop(name, None)
        self._recent[name] = self.compute(cause, place, shape) if found is None else found
        if len(self._recent) > _RECENT:
            del self._recent[next(iter(self._recent))]
        return self._recent[name]

    def compute(self, cause: Cause, place: Place, shape: Shape) -> dict[Key, FloatArray]:
        """`columns`, computed anew."""
        parts: dict[Key, dict[int, FloatArray]] = {}
        for i, columns in enumerate(self._everywhere(cause, replace(place, gate=None), shape)):
            gated = _gated(columns, self.motions[i], place)
            for key, values in self._thinned(i, gated).items():
                parts.setdefault(key, {})[i] = values
        result: dict[Key, FloatArray] = {}
        for key, by_motion in parts.items():
            width = next(iter(by_motion.values())).shape[1]
            column = np.zeros((self.count, width))
            for i, values in by_motion.items():
                column[self.starts[i] : self.starts[i + 1]] = values
            if np.any(column):
                result[key] = column
        return result

    def _everywhere(self, cause: Cause, place: Place, shape: Shape) -> list[Columns]:
        """Columns of a place without a gate, by motion; the last ones are kept: gates move."""
        name = (cause.id, place, shape)
        if self._last[0] != name:
            self._last = (
                name,
                [
                    self.freed(i, _where_judged(cause.columns(motion, place, shape), motion))
                    for i, motion in enumerate(self.motions)
                ],
            )
        return self._last[1]

    def pulled_by(self, gravity: FloatArray) -> Balances:
        """The same, with unknown bodies under this gravity, (3,) in the base's frame [m/s^2]."""
        other = copy(self)
        other.motions = tuple(motion.pulled_by(gravity) for motion in self.motions)
        kept = {name: each for name, each in self._columns.items() if name[1].link is None}
        other._columns, other._recent, other._last = kept, {}, (None, [])
        return other

    def with_noise(self, sigma: Mapping[Key, float]) -> Balances:
        """The same with other standard deviations of some balances."""
        other = copy(self)
        other.sigma = {**self.sigma, **sigma}
        return other

    def with_residual(self, residual: Mapping[Key, FloatArray]) -> Balances:
        """The same with something else to explain in some balances."""
        other = copy(self)
        other.residual = {**self.residual, **residual}
        return other

    def rms(self, key: Key, values: FloatArray | None = None) -> float:
        """Root mean square over the rows that count."""
        picked = (self.residual[key] if values is None else values)[self.mask[key]]
        return float(np.sqrt(np.mean(picked**2))) if len(picked) else 0.0

    def _raw(self) -> dict[Key, list[FloatArray]]:
        """Measured less modelled values by key, (T,) of each motion at its rate."""
        raw: dict[Key, list[FloatArray]] = {}
        first = self.motions[0]
        for j in range(self.n):
            if first.body is not None and first.torque is not None and self._known("torque", j):
                raw["torque", j] = [_column(m.torque, j) - m.tau[:, j] for m in self.motions]
            if first.command is not None and first.torque is not None and self._known("command", j):
                raw["drive", j] = [
                    _column(m.torque, j) - _column(m.command, j) for m in self.motions
                ]
            if first.has_law(j) and self._known("law", j) and self._known("torque", j):
                raw["law", j] = [m.given(j) - _column(m.law, j) for m in self.motions]
            if first.measured_dq is not None and self._known("measured_dq", j):
                raw["velocity", j] = [_column(m.measured_dq, j) - m.dq[:, j] for m in self.motions]
            if first.source == "" and first.q_des is not None and self._known("q_des", j):
                raw["servo", j] = [m.q[:, j] - _column(m.q_des, j) for m in self.motions]
        for axis in range(first.rows - self.n):
            raw["base", axis] = [-m.tau[:, self.n + axis] for m in self.motions]
        for axis in range(6 if self._imu_noise else 0):
            raw["imu", axis] = [_column(m.base.disagreement, axis) for m in self.motions]  # type: ignore[union-attr]
        for k in range(len(first.feet)):
            raw |= _of_foot(self.motions, k)
        if all(m.tip_error is not None for m in self.motions):
            for axis in range(6):
                raw["tip", axis] = [_column(m.tip_error, axis) for m in self.motions]
        return raw

    def _lower_cutoffs(self) -> dict[Key, float]:
        """Cut-offs [Hz] of balances whose own is lower than the motions'."""
        if not self._imu_noise:
            return {}
        least = max(_PERIODS / (len(m.time) * m.period) for m in self.motions)
        band = np.median([each.band() for each in self._imu_noise], axis=0)
        most = self.motions[0].cutoff
        return {("imu", k): float(min(max(each, least), most)) for k, each in enumerate(band)}

    def freed(self, motion: int, columns: Columns) -> Columns:
        """Columns at a motion's rate without what forces of unknown size may do."""
        free = self._free[motion]
        return columns if free is None else free.of(columns)

    def _freed(self, raw: dict[Key, list[FloatArray]]) -> dict[Key, list[FloatArray]]:
        """The same of what is measured less what the model says."""
        found = {key: list(values) for key, values in raw.items()}
        for i, free in enumerate(self._free):
            if free is not None:
                columns = {key: values[i][:, None] for key, values in raw.items()}
                for key, column in free.of(columns).items():
                    if key in found:
                        found[key][i] = column[:, 0]
        return found

    def _known(self, name: str, j: int) -> bool:
        arrays = [getattr(m, name) for m in self.motions]
        return all(array is not None and np.isfinite(array[:, j]).all() for array in arrays)

    def _add(self, key: Key, values: list[FloatArray]) -> None:
        balance, channel = key
        lower = self._cutoffs.get(key)
        self.residual[key] = np.concatenate([self.thin(i, v, lower) for i, v in enumerate(values)])
        masks = []
        for i, m in enumerate(self.motions):
            good = m.valid.copy()
            cutoff = lower or m.cutoff
            edge = _end(m, cutoff) + (0 if lower is None else _end(m, m.cutoff))
            good[:edge] = good[-edge:] = False
            free = self._free[i]
            if free is not None and balance in ("torque", "base"):
                good &= free.judged(key)
            if balance in _OF_FEET:
                good &= m.judged(key)
            if balance == "torque":
                # At rest dry friction takes whatever value holds the joint: nothing to learn.
                around = int(0.3 / (m.cutoff * m.period))
                good &= ~dilated(m.still[:, channel], around)
            rows = good[:: self._steps[i]]
            rows[np.arange(len(rows)) % max(1, int(m.cutoff / cutoff)) > 0] = False
            masks.append(rows)
        mask = np.concatenate(masks)
        if balance in ("torque", "velocity", "servo") and not self.excited[channel]:
            mask = np.zeros_like(mask)
        self.mask[key] = mask
        self.floor[key] = self._noise(key, values)
        size, noise = 0.0, self.thresholds.noise
        if balance in ("torque", "drive", "law", "base"):
            row = self.n * (balance == "base") + channel
            tau = np.concatenate([m.tau[:, row] for m in self.motions])
            size = noise.model_error * float(np.sqrt(np.mean(tau**2)))
        elif balance == "velocity":
            speeds = np.concatenate([m.dq[:, channel] for m in self.motions])
            size = noise.model_error * float(np.sqrt(np.mean(speeds**2)))
        elif balance == "foot":
            size = self.thresholds.feet.height
        elif balance == "tilt":
            size = self.thresholds.feet.tilt
        elif balance == "grip":
            size = self.thresholds.feet.friction * _usual_load(self.motions, key)
        size = float(np.hypot(size, noise.fit_error * self.rms(key)))
        self.sigma[key] = float(np.hypot(self.floor[key], size)) or 1e-9

    def _noise(self, key: Key, values: list[FloatArray]) -> float:
        """Standard deviation that white noise of the channels leaves after filtering."""
        balance, channel = key
        if balance == "imu":
            of_each = [each.variance(self._cutoffs[key])[channel] for each in self._imu_noise]
            return float(np.sqrt(np.mean(of_each)))
        variances = []
        for m, each, free in zip(self.motions, values, self._free, strict=True):
            if free is not None and balance in ("torque", "base"):
                variances.append(free.noise(key))
                continue
            density = float(noise_density(each[:, None], m.period, 1.5 * m.cutoff)[0])
            variance = density * m.cutoff
            if balance == "torque":
                variance += float(inertial_noise(m)[channel])
            elif balance == "velocity":
                q_noise = noise_density(m.recording.q, m.period)[channel]
                variance += q_noise * (2 * np.pi) ** 2 * m.cutoff**3 / 3
            variances.append(variance)
        return float(np.sqrt(np.mean(variances)))

    def _blocks(self) -> NDArray[np.intp]:
        blocks, first = [], 0
        for i in range(len(self.motions)):
            time = self.time[self.starts[i] : self.starts[i + 1]]
            number = np.floor(time / self.thresholds.noise.block).astype(np.intp)
            blocks.append(first + number)
            first += int(number[-1]) + 1
        return np.concatenate(blocks)

    def _folds(self) -> NDArray[np.intp]:
        """Recordings, or halves or quarters of them, so that about four are left out in turn."""
        wanted = self.thresholds.noise.folds
        parts = -(-wanted // len(self.motions))
        folds = np.empty(self.count, dtype=np.intp)
        for i in range(len(self.motions)):
            span = slice(int(self.starts[i]), int(self.starts[i + 1]))
            place = np.arange(span.stop - span.start)
            folds[span] = i * parts + np.minimum(place * parts // len(place), parts - 1)
        return folds if len(self.motions) * parts <= 2 * wanted else folds % wanted

    def _stack(self, values: list[FloatArray]) -> FloatArray:
        parts = [v[::s] for v, s in zip(values, self._steps, strict=True)]
        return np.concatenate(parts)


def _of_foot(motions: Sequence[Motion], k: int) -> dict[Key, list[FloatArray]]:
    """What foot k shows of the ground, by balance; 0 where it shows nothing."""
    raw: dict[Key, list[FloatArray]] = {}
    for balance in _OF_FEET:
        each = [m.feet[k].of(balance) for m in motions]
        width = max((values.shape[1] for values in each if values is not None), default=0)
        for channel in range(width):
            key = (balance, width * k + channel)
            raw[key] = [
                np.zeros(len(m.time))
                if values is None
                else np.where(m.judged(key), values[:, channel], 0.0)
                for m, values in zip(motions, each, strict=True)
            ]
    return raw


def _usual_load(motions: Sequence[Motion], key: Key) -> float:
    """Root mean square of the force that presses a foot where it is judged [N]."""
    loads = [m.feet[key[1]].normal for m in motions]
    each = [load[m.judged(key)] for m, load in zip(motions, loads, strict=True) if load is not None]
    there = np.concatenate([np.zeros(0), *each])
    return float(np.sqrt(np.mean(there**2))) if len(there) else 0.0


def _where_judged(columns: Columns, motion: Motion) -> Columns:
    """Columns of feet only where these show something, as their balances are."""
    return {
        key: np.where(motion.judged(key)[:, None], column, 0.0) if key[0] in _OF_FEET else column
        for key, column in columns.items()
    }


def _excited(motions: Sequence[Motion], j: int, thresholds: Thresholds) -> bool:
    span = max(float(np.ptp(m.q[:, j])) for m in motions)
    share = float(np.mean(np.concatenate([~m.still[:, j] for m in motions])))
    return span > thresholds.noise.least_range and share > thresholds.noise.least_moving


def _column(values: FloatArray | None, j: int) -> FloatArray:
    assert values is not None
    return np.ascontiguousarray(values[:, j])
