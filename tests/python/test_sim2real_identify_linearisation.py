"""Rows that say the same, and rows of rollouts, against theory and SciPy's least squares."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy import integrate, optimize, signal

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.identify.hypothesis import ordinary
from pdoik.sim2real.identify.linearisation import Linearisation, Series
from pdoik.sim2real.identify.model import Model
from pdoik.sim2real.motion.place import Place
from pdoik.sim2real.regression.fit import Term
from sim2real_evidence_rows import stacked, weights

LEAST = 1.5


def series(values: np.ndarray, *parts: slice, least: float = LEAST) -> Series:
    rows = np.arange(len(values))
    return Series(rows=rows, target=values, floor=1e-9, parts=parts, least_repeats=least)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("a", [0.4, 0.7, 0.9])
def test_rows_of_first_order_noise_repeat_as_often_as_theory_says(a: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    runs = [signal.lfilter([1.0], [1.0, -a], rng.standard_normal(n)) for n in (9000, 4000, 14000)]
    ends = np.cumsum([0, 9000, 0, 4000, 14000])  # one recording has no row that counts
    parts = [slice(int(i), int(j)) for i, j in pairwise(ends)]
    values = np.concatenate(runs)
    assert series(values, *parts).repeats(values) == pytest.approx((1 + a) / (1 - a), rel=0.15)


@pytest.mark.parametrize("seed", range(3))
def test_rows_of_white_noise_or_of_none_repeat_as_little_as_can_be(seed: int) -> None:
    white = np.random.default_rng(seed).standard_normal(20_000)
    each = series(white, slice(0, 20_000))
    assert each.repeats(white) == LEAST
    assert each.repeats(np.diff(white, append=0.0)) == LEAST
    assert each.repeats(np.zeros(20_000)) == LEAST
    assert each.independent == pytest.approx(20_000 / LEAST)


@pytest.mark.parametrize("length", [2, 5, 40])
def test_recordings_that_stand_still_say_one_thing_each(length: int) -> None:
    levels = np.random.default_rng(length).standard_normal(30)
    values = np.repeat(levels, length)
    parts = [slice(k * length, (k + 1) * length) for k in range(30)]
    assert series(values, *parts).repeats(values) == pytest.approx(length)


PENDULUM = np.array([0.30, 0.12, 2.0])  # inertia, damping, moment of gravity
AT = np.linspace(0.0, 4.0, 200)


def swung(figures: np.ndarray, start: float) -> np.ndarray:
    """Positions and speeds of a pendulum that is pushed now and then, (2, T)."""
    inertia, damping, moment = figures

    def change(t: float, x: np.ndarray) -> list[float]:
        return [x[1], (np.sin(3.0 * t) - moment * np.sin(x[0]) - damping * x[1]) / inertia]

    run = integrate.solve_ivp(change, (0.0, 4.0), [start, 0.0], t_eval=AT, rtol=1e-10, atol=1e-12)
    return np.asarray(run.y)


def test_models_of_rollouts_step_to_where_scipys_least_squares_ends() -> None:
    rng, starts = np.random.default_rng(0), (0.8, -1.9)
    floor = {("servo", 0): 2e-3, ("velocity", 0): 2e-2}
    sizes = np.array([list(floor.values())]).T
    measured = [swung(PENDULUM, s) + sizes * rng.standard_normal((2, 200)) for s in starts]

    def left(figures: np.ndarray) -> np.ndarray:
        """Measured less simulated, (2, recordings T)."""
        return np.hstack([m - swung(figures, s) for m, s in zip(measured, starts, strict=True)])

    best = optimize.least_squares(lambda x: (left(x) / sizes).ravel(), PENDULUM * 1.1).x
    now, parts = PENDULUM * [1.2, 0.6, 0.9], [slice(0, 200), slice(200, 400)]
    for turn in range(6):
        differences = [
            (left(now - h) - left(now + h)) / 2e-5 for h in 1e-5 * np.eye(3)
        ]  # of what is simulated
        columns = {key: np.stack([d[i] for d in differences], 1) for i, key in enumerate(floor)}
        made = Term(effect="rollout", place=Place(), shape=(), columns=columns, prior=np.zeros(3))
        figures = ordinary(made, 1e3)
        rest = dict(zip(floor, left(now), strict=True))
        data = Linearisation.of_rollouts(rest, floor, dict.fromkeys(floor, parts))
        model = Model(data, [figures])
        assert all(model.noise[key] >= floor[key] ** 2 for key in floor)
        if turn == 0:
            design, target = stacked(data, [figures], weights(model))
            assert model.beta == pytest.approx(np.linalg.lstsq(design, target)[0], rel=1e-6)
            assert data.series["servo", 0].repeats(rest["servo", 0]) > 5.0
        now = now + model.beta
    assert now == pytest.approx(best, rel=2e-3)  # sizes of noise are the model's own
    deviations = np.sqrt(model.variances)
    assert np.abs(now - PENDULUM).max() < 0.05
    assert (np.abs(now - PENDULUM) < 4.0 * deviations).all()
    assert (deviations < 0.05 * PENDULUM).all()


def test_a_channel_without_rows_is_no_series() -> None:
    key = ("servo", 0)
    data = Linearisation.of_rollouts({key: np.zeros(0)}, {key: 1.0}, {key: []})
    assert data.series == {}
    assert Model(data, []).log_evidence == 0.0
