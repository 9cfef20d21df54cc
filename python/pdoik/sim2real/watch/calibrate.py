"""The floor of each joint's residual, from logs of the machine while nothing is wrong with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from pdoik.recordings import FloatArray, Recording

from ..model import CHARTS, VARIANCE, Healthy, Model
from ..motion import noise_of, thinned
from ..thresholds import WatchThresholds
from .residuals import ResidualRows, Residuals, friction_columns, joined
from .today import OrdinaryToday
from .windows import Rows, Windows

_BLOCK = 10.0  # numerics: over which a column's coefficient is looked at [s]
_SURE = 0.05  # probability that the density is even higher than it is held to be
_MOVED = 0.2  # numerics: share of a block without which it says nothing
_ROUNDS = 2  # numerics: of bodies and floor in turn
_LEAST_VARIANCE = 1e-12  # [(N m)^2]


def calibrated(
    model: Model,
    recordings: Sequence[Recording],
    *,
    held_out: bool = True,
    thresholds: WatchThresholds | None = None,
) -> Model:
    """The model with the floor of these logs.

    Args:
        model: of a diagnosis.
        recordings: of the healthy machine, with torques.
        held_out: whether the findings were not fitted to them.
        thresholds: the defaults if none are given.

    Raises:
        ValueError: the model has no robot, a log no torques or too few rows a second, or no joint
            moves long enough.
    """
    limits = WatchThresholds() if thresholds is None else thresholds
    noise = noise_of([thinned(each) for each in recordings])
    residuals = Residuals(model, noise, limits.slides)
    cut = (_rows_of(residuals, each) for each in recordings)
    runs = [each for each in cut if each is not None]
    names = tuple(each.name for each in recordings)
    if not runs:
        raise ValueError(f"{', '.join(names)}: too short to estimate the residual's floor from")
    rubbing = [residuals.friction(residuals.motion(thinned(each))) for each in recordings]
    friction = np.array([_rms(f) for f in np.concatenate(rubbing).T])
    n = len(noise)
    empty = Healthy(
        logs=names,
        held_out=held_out,
        position_noise=noise,
        seconds=np.zeros(n),
        variance=np.zeros((n, VARIANCE)),
        friction=friction,
        friction_off=np.zeros((n, 2)),
        speed=np.ones(n),
        **{each: np.ones((n, CHARTS)) for each in ("scale", "power", "density", "bias")},
        bodies_off=np.zeros(0),
        bodies_covariance=np.zeros((0, 0)),
    )
    scale = [residuals.body.inertial_scale(k) for k in range(len(residuals.body.links))]
    healthy = _healthy(runs, empty, limits, limits.bodies * np.concatenate(scale))
    if not (healthy.seconds >= limits.least_motion).any():
        longest = float(healthy.seconds.max())
        raise ValueError(
            f"{', '.join(names)}: no joint moves for {limits.least_motion:g} s; the longest motion"
            f" is {longest:.2g} s"
        )
    return replace(model, healthy=healthy)


def rows_of(recording: Recording) -> Rows:
    """A recording's rows that rest on samples.

    Raises:
        ValueError: it has no torque of a joint.
    """
    if recording.tau is None or np.isnan(recording.tau).all(axis=0).any():
        raise ValueError(f"{recording.name}: expected torques, 'tau.<joint>', of every joint")
    kept = recording.valid & np.isfinite(recording.tau).all(axis=1)
    kept &= np.isfinite(recording.q).all(axis=1)
    time = recording.start + recording.time
    return Rows(time=time[kept], q=recording.q[kept], tau=recording.tau[kept])


def variance_of(healthy: Healthy, features: FloatArray) -> FloatArray:
    """Variance of the residual's noise at rows with these features, (N, n) [(N m)^2]."""
    return np.asarray(np.einsum("tjk,jk->tj", features, healthy.variance), dtype=np.float64)


def _rows_of(residuals: Residuals, recording: Recording) -> ResidualRows | None:
    n = recording.q.shape[1]
    windows = Windows(n, residuals.cutoff)
    cut = [*windows.add(rows_of(recording)), *windows.end()]
    parts = [each for each in map(residuals.rows, cut) if len(each.time)]
    return joined(parts) if parts else None


def _healthy(
    runs: list[ResidualRows], empty: Healthy, limits: WatchThresholds, bodies: FloatArray
) -> Healthy:
    """The floor of what friction and bodies, as they were in each log, do not explain.

    How much the logs say of the bodies depends on the floor, and the floor on what is left by the
    bodies: so both are worked out twice.

    Args:
        runs: rows of the logs.
        empty: what is known of the logs before.
        limits: thresholds.
        bodies: (k,) standard deviations of the links' parameters.
    """
    healthy = _floor(runs, empty, limits)
    for _ in range(_ROUNDS):
        known = replace(
            healthy, bodies_off=np.zeros_like(bodies), bodies_covariance=np.diag(bodies**2)
        )
        for run in runs:
            today = OrdinaryToday(known, limits)
            before, _ = today.torque(friction_columns(run), run.bodies)
            made = replace(run, residual=run.residual - before)
            today.learn(made, np.full(len(known.speed), np.inf))
            known = replace(
                known, bodies_off=today.bodies, bodies_covariance=today.bodies_covariance
            )
        left = [replace(run, residual=run.residual - run.bodies @ known.bodies_off) for run in runs]
        healthy = _floor(left, known, limits)
    return healthy


def _floor(runs: list[ResidualRows], known: Healthy, limits: WatchThresholds) -> Healthy:
    """What is left of rows by the friction of each log."""
    n = len(known.friction)
    off = np.stack([_friction_off(run, known.friction) for run in runs])  # (R, n, 2)
    runs = [
        replace(run, residual=run.residual - np.einsum("tjk,jk->tj", friction_columns(run), each))
        for run, each in zip(runs, off, strict=True)
    ]
    speed = np.ones(n)
    seconds = np.zeros(n)
    variance = np.zeros((n, VARIANCE))
    scale, power, density, bias = (np.ones((n, CHARTS)) for _ in range(4))
    for j in range(n):
        seconds[j] = sum(float(np.sum(run.moving[:, j])) * run.step for run in runs)
        if seconds[j] <= 0.0:
            variance[j, 0] = 1.0
            continue
        picked = [run.moving[:, j] for run in runs]
        residual = _all([run.residual[:, j] for run in runs], picked)
        columns = _all([run.columns[:, j] for run in runs], picked)
        features = _all([run.features[:, j] for run in runs], picked)
        speed[j] = max(float(np.sqrt(np.mean(features[:, 1]))), 1e-6)
        variance[j] = _variance(residual, features)
        scale[j] = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-9)
        weight = [1.0 / np.sqrt(run.features[:, j] @ variance[j]) for run in runs]
        for c in range(CHARTS):
            column = [
                run.columns[:, j, c] / scale[j, c] * w * run.moving[:, j]
                for run, w in zip(runs, weight, strict=True)
            ]
            score = [
                x * run.residual[:, j] * w for run, x, w in zip(runs, column, weight, strict=True)
            ]
            power[j, c] = np.sum(np.concatenate(column) ** 2) / len(residual)
            density[j, c] = _density(runs, column, score, limits.memory)
            bias[j, c] = _bias(runs, column, score)
    return replace(
        known,
        seconds=seconds,
        variance=variance,
        friction_off=off.mean(axis=0),
        speed=speed,
        scale=scale,
        power=power,
        density=density,
        bias=bias,
    )


def _friction_off(run: ResidualRows, friction: FloatArray) -> FloatArray:
    """Coulomb and viscous friction of a log less the model's, (n, 2); none where none is known."""
    off = np.zeros((len(friction), 2))
    X = friction_columns(run)
    for j in np.flatnonzero(friction > 0.0):
        moves = run.moving[:, j]
        if moves.any():
            off[j] = np.linalg.lstsq(X[moves, j], run.residual[moves, j], rcond=1e-3)[0]
    return off


def _variance(residual: FloatArray, features: FloatArray) -> FloatArray:
    """Coefficients, (4,), none negative, of the squared residual."""
    size = np.maximum(np.mean(features, axis=0), 1e-12)
    square = residual**2
    mean = max(float(np.mean(square)), _LEAST_VARIANCE)
    try:
        found, _ = optimize.nnls(features / size, square / mean)
    except RuntimeError:  # SciPy's iterations do not end: the same variance everywhere
        found = np.eye(VARIANCE)[0]
    beta = np.asarray(found * mean / size)
    beta[0] = max(beta[0], 0.1 * mean)  # a floor that no regime is free of
    return beta


def _density(
    runs: list[ResidualRows], column: list[FloatArray], score: list[FloatArray], memory: float
) -> float:
    """Spectral density of the noise along a column at frequency zero, an upper bound [s].

    Sums of autocovariances with Bartlett's weights (Newey and West, Econometrica 55, 1987); the
    bound is that of a chi-squared with as many degrees of freedom as there are memories.
    """
    total = squared = seconds = lag = 0.0
    for run, x, y in zip(runs, column, score, strict=True):
        long = min(memory, 0.2 * len(y) * run.step)
        lags = max(1, int(long / run.step))
        total += run.step * _long_run(y, lags)
        squared += float(x @ x)
        seconds += float(np.sum(x != 0.0)) * run.step
        lag = max(lag, lags * run.step)
    if not squared > 0.0:
        return 1.0
    freedom = max(3.0, 1.5 * seconds / lag)
    white = 0.5 * runs[0].step  # no noise that passed the filter is less correlated
    return max(total / squared * freedom / float(stats.chi2.ppf(_SURE, freedom)), white)


def _long_run(y: FloatArray, lags: int) -> float:
    """Sum of autocovariances, not less than none is correlated to half."""
    own = float(y @ y)
    total = own
    for k in range(1, lags + 1):
        total += 2.0 * (1.0 - k / (lags + 1)) * float(y[k:] @ y[:-k])
    return max(total, 0.5 * own)


def _bias(runs: list[ResidualRows], column: list[FloatArray], score: list[FloatArray]) -> float:
    """Root mean square of the column's coefficient over blocks of some seconds [N m]."""
    found = []
    for run, x, y in zip(runs, column, score, strict=True):
        length = max(1, round(_BLOCK / run.step))
        for at in range(0, max(len(x) - length // 2, 1), length):
            part = slice(at, at + length)
            squared = float(x[part] @ x[part])
            if np.count_nonzero(x[part]) * run.step > _MOVED * _BLOCK:
                found.append(float(np.sum(y[part])) / squared)
    return _rms(np.array(found)) if found else 0.0


def _all(values: list[FloatArray], picked: list[NDArray[np.bool_]]) -> FloatArray:
    return np.concatenate([v[p] for v, p in zip(values, picked, strict=True)])


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
