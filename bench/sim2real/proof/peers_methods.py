"""Methods that are compared: least squares, sparse regression, black boxes, and the diagnosis."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bench.sim2real.frame.tracks import (
    REST,
    Array,
    Believed,
    Track,
    joint_columns,
    smooth,
    stacked,
)
from pdoik.sim2real import Model, Study, examine, model_of, predict

STEP = 0.02  # between rows that enter a fit [s]
CUTS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 1e-4)  # of singular values, relative
THRESHOLDS = (0.003, 0.01, 0.03, 0.1, 0.3, 1.0)  # of terms, in units of the residual's size
RIDGE = 0.02  # per row, of terms with unit spread: a library holds near twins
SPARE = 1.05  # times the least mean square is good enough for fewer terms

Predictor = Callable[[Track], Array]


def error_of(predict: Predictor, tracks: list[Track], scale: Array) -> float:
    """Mean square of what is left on tracks, joints with equal weights."""
    left = [
        ((smooth(predict(track), track.period) - track.tau) / scale)[track.inner]
        for track in tracks
    ]
    return float(np.mean(np.concatenate(left) ** 2))


def least_squares(study: Study, fit: list[Track], choose: list[Track]) -> Predictor:
    """Weighted least squares of all inertial and friction parameters about the model's own.

    Ten parameters per link, then per joint rotor inertia, viscous and Coulomb friction and an
    offset. Directions the motion hardly excites (base parameters by singular values) stay at the
    URDF's figures; of a few cut-offs of singular values, the one best on the tracks to choose by.
    """
    believed = Believed(study.robot, study.joints, study.rotor_inertia)

    def columns(track: Track, rows: slice) -> Array:
        q, dq, ddq = track.q[rows], track.dq[rows], track.ddq[rows]
        own = joint_columns(dq, ddq)
        return np.concatenate([believed.regressor(q, dq, ddq), own], axis=2)

    Y = np.concatenate([columns(track, track.every(STEP)) for track in fit])  # (T, n, p)
    r = stacked(fit, "residual", STEP)
    weight = 1.0 / np.std(r, axis=0)
    for _ in range(2):  # the second time by what the first leaves of each joint
        A = (Y * weight[:, None]).reshape(-1, Y.shape[2])
        size = np.maximum(np.linalg.norm(A, axis=0), 1e-9)
        U, s, Vt = np.linalg.svd(A / size, full_matrices=False)
        b = U.T @ (r * weight).ravel()
        solutions = [(Vt[s > c * s[0]].T @ (b / s)[s > c * s[0]]) / size for c in CUTS]
        weight = 1.0 / np.maximum(np.std(r - Y @ solutions[-1], axis=0), 1e-9)

    def predictor(beta: Array) -> Predictor:
        return lambda track: track.model + columns(track, slice(None)) @ beta

    held = [columns(track, track.inner) for track in choose]
    rest = [track.residual[track.inner] for track in choose]
    left = [
        sum(float(np.sum(((y @ beta - x) * weight) ** 2)) for y, x in zip(held, rest, strict=True))
        for beta in solutions
    ]
    return predictor(solutions[int(np.argmin(left))])


def pysindy(study: Study, fit: list[Track], choose: list[Track]) -> Predictor:
    """Sequentially thresholded least squares of each joint's residual (Brunton et al. 2016).

    Of a few thresholds, the one with fewest terms among the best on the tracks to choose by.
    """
    import pysindy as ps

    chosen: list[Array] = []
    for joint in range(len(study.joints)):
        theta = np.concatenate([library(track, joint, track.every(STEP)) for track in fit])
        held = np.concatenate([library(track, joint, track.every(STEP)) for track in choose])
        size = np.maximum(np.std(theta, axis=0), 1e-6 * np.abs(theta).max(axis=0) + 1e-12)
        size[0] = 1.0  # the constant
        target, wanted = (stacked(some, "residual", STEP)[:, joint] for some in (fit, choose))
        scale = np.std(target) + 1e-12
        tried = [(float(np.mean(wanted**2)), np.zeros(theta.shape[1]))]
        for threshold in THRESHOLDS:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # that all terms fell
                optimizer = ps.STLSQ(threshold=threshold, alpha=RIDGE * len(theta))
                optimizer.fit(theta / size, (target / scale)[:, None])
            beta = optimizer.coef_[0] * scale / size
            tried.append((float(np.mean((held @ beta - wanted) ** 2)), beta))
        enough = SPARE * min(left for left, _ in tried)
        fine = [beta for left, beta in tried if left <= enough]
        chosen.append(min(fine, key=np.count_nonzero))

    def predict(track: Track) -> Array:
        added = [library(track, j, slice(None)) @ beta for j, beta in enumerate(chosen)]
        return track.model + np.stack(added, axis=1)

    return predict


def library(track: Track, joint: int, rows: slice) -> Array:
    """Terms (T, k) that may explain a joint's residual."""
    q, dq, ddq, tau = (x[rows] for x in (track.q, track.dq, track.ddq, track.model))
    x, v, load = q[:, joint], dq[:, joint], tau[:, joint]
    sign, soft = np.tanh(v / REST), np.tanh(v / (10 * REST))
    own = [np.ones_like(x), x, x**2, np.sin(x), np.cos(x), np.sin(2 * x), np.cos(2 * x)]
    own += [v, sign, soft, v * np.abs(v), sign * np.exp(-np.abs(v) / 0.1), np.abs(v)]
    own += [load, np.abs(load) * sign, np.abs(load) * v, x * sign, np.sin(x) * sign]
    others = [k for k in range(q.shape[1]) if k != joint]
    shared = [f for k in others for f in (np.sin(q[:, k]), np.cos(q[:, k]), dq[:, k], tau[:, k])]
    shared += [ddq[:, k] for k in range(q.shape[1])]
    shared += [np.sin(x + s * q[:, k]) for k in others for s in (1.0, -1.0)]
    shared += [np.cos(x + s * q[:, k]) for k in others for s in (1.0, -1.0)]
    return np.stack(own + shared, axis=1)


def features(track: Track, rows: slice) -> Array:
    """Positions, speeds, accelerations and the model's torques of all joints, (T, 4 n)."""
    return np.hstack([x[rows] for x in (track.q, track.dq, track.ddq, track.model)])


def boosting(study: Study, fit: list[Track], choose: list[Track]) -> Predictor:
    """One ensemble of trees per joint, stopped where the tracks to choose by say so."""
    from sklearn.ensemble import HistGradientBoostingRegressor

    x, y = _data(fit)
    held, wanted = _data(choose)
    boxes: list[Any] = []
    for joint in range(y.shape[1]):
        box = HistGradientBoostingRegressor(
            learning_rate=0.08,
            max_iter=200,
            max_leaf_nodes=15,
            min_samples_leaf=20,
            l2_regularization=1.0,
            early_stopping=True,
            n_iter_no_change=15,
            random_state=0,
        )
        boxes.append(box.fit(x, y[:, joint], X_val=held, y_val=wanted[:, joint]))

    def predict(track: Track) -> Array:
        x = features(track, slice(None))
        return track.model + np.stack([box.predict(x) for box in boxes], axis=1)

    return predict


def network(study: Study, fit: list[Track], choose: list[Track]) -> Predictor:
    """Two hidden layers for all joints; of two penalties, the one best where it may choose."""
    from sklearn.neural_network import MLPRegressor
    from sklearn.preprocessing import StandardScaler

    x, y = _data(fit)
    held, wanted = _data(choose)
    inputs, outputs = StandardScaler().fit(x), StandardScaler().fit(y)
    best: tuple[float, Any] = (np.inf, None)
    for alpha in (1e-3, 1.0):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that more iterations would fit closer
            box = MLPRegressor(
                hidden_layer_sizes=(48, 48),
                activation="tanh",
                alpha=alpha,
                max_iter=150,
                learning_rate_init=3e-3,
                batch_size=64,
                random_state=0,
                tol=1e-4,
            ).fit(inputs.transform(x), outputs.transform(y))
        guess = box.predict(inputs.transform(held)).reshape(len(held), -1)
        left = float(np.mean((guess - outputs.transform(wanted)) ** 2))
        if left < best[0]:
            best = (left, box)

    def predict(track: Track) -> Array:
        x = inputs.transform(features(track, slice(None)))
        added = best[1].predict(x).reshape(len(x), -1)
        return track.model + outputs.inverse_transform(added)

    return predict


def _data(tracks: list[Track]) -> tuple[Array, Array]:
    x = np.concatenate([features(track, track.every(STEP)) for track in tracks])
    return x, stacked(tracks, "residual", STEP)


def nothing(study: Study, fit: list[Track], choose: list[Track]) -> Predictor:
    return lambda track: track.model


@dataclass(frozen=True, slots=True, kw_only=True)
class Ours:
    """What a diagnosis found, added to the URDF that goes with a recording."""

    model: Model
    said: str  # the verdict and what was found, in words

    def __call__(self, track: Track) -> Array:
        """Torques (T, n) along a recording."""
        given = replace(self.model, robot=track.urdf.read_text(encoding="utf-8"))
        return predict(given, track.recording)


def ours(study: Study, fit: list[Track], choose: list[Track]) -> Predictor:
    """Diagnosed as it is; its validating recordings choose between findings and enter no fit."""
    examination = examine(study)
    diagnosis = examination.diagnosis
    found = [
        f"{each.effect} {' '.join((*each.joints, *each.links))}" for each in diagnosis.findings
    ]
    return Ours(model=model_of(examination), said="; ".join([diagnosis.verdict, *found]))
