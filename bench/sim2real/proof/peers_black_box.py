"""Black boxes on the residual: gradient boosting and a small network."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from bench.sim2real.proof.peers_data import Array, Track, stacked
from bench.sim2real.proof.peers_regressions import Predictor
from pdoik.sim2real import Study

STEP = 0.02  # between rows that enter a fit [s]


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
