"""CUSUM charts: run lengths against Markov chains and Monte Carlo, the same whatever the pieces."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal
from scipy.stats import norm

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.watch import Cusum, average_run_length, threshold_for


def markov_run_length(h: float, drift: float, spread: float, states: int = 250) -> float:
    """Mean steps to an alarm from zero by Brook and Evans, Biometrika 59(3), 1972."""
    width = 2.0 * h / (2 * states - 1)
    centre = width * np.arange(states)
    upper = centre[None, :] + 0.5 * width - centre[:, None]
    below = norm.cdf(upper, -drift, spread)
    chain = np.diff(below, axis=1, prepend=0.0)
    chain[:, 0] = below[:, 0]
    return float(np.linalg.solve(np.eye(states) - chain, np.ones(states))[0])


@pytest.mark.parametrize(("h", "mu"), [(3.0, 5e-3), (5.0, 2e-2), (7.0, 1e-2)])
def test_the_run_length_is_that_of_a_markov_chain_of_small_steps(h: float, mu: float) -> None:
    by_chain = markov_run_length(h, mu, np.sqrt(2 * mu))
    # White noise overshoots the threshold: Siegmund's 0.583 standard deviations at either end.
    overshoot = 2.0 * 0.583 * np.sqrt(2 * mu)
    assert by_chain == pytest.approx(float(average_run_length(h + overshoot, mu)), rel=0.03)
    assert by_chain > float(average_run_length(h, mu))  # without it, it is on the safe side


def test_correlated_noise_alarms_as_seldom_as_white_noise_of_its_density() -> None:
    rng = np.random.default_rng(0)
    step, a, h, change, charts = 0.03, 0.6, 2.5, 0.1, 100
    density = step * (1 + a) / (1 - a)  # of an AR(1) of variance 1 at frequency zero [s]
    mu = change**2 / (2 * density)
    chart = Cusum((charts,))
    first = np.full(charts, np.inf)
    noise = np.zeros((1, charts))
    for at in range(0, 80_000, 1000):
        white = rng.normal(size=(1000, charts)) * np.sqrt(1 - a**2)
        x, noise = signal.lfilter([1.0], [1.0, -a], white, axis=0, zi=noise)
        time = step * (at + np.arange(1000.0))
        increments = (change * x - change**2 / 2) * step / density
        _, path = chart.update(time, increments, np.inf)
        crossed = path >= h
        new = np.isinf(first) & crossed.any(axis=0)
        first[new] = time[crossed.argmax(axis=0)[new]]
        if np.isfinite(first).all():
            break
    error = float(np.std(first) / np.sqrt(charts))
    computed = float(average_run_length(h, mu))
    assert computed - 3 * error < np.mean(first) < 1.3 * computed + 3 * error  # it overshoots


def test_the_threshold_gives_the_rate_that_was_asked_for() -> None:
    information = np.array([0.5, 2.0, 7.0, 7.0])
    h = threshold_for(information, 1.0 / 86400.0)
    rate = np.sum(1.0 / average_run_length(h, information))
    assert rate == pytest.approx(1.0 / 86400.0, rel=1e-9)
    assert threshold_for(np.zeros(0), 1e-5) == np.inf


@pytest.mark.parametrize("piece", [1, 7, 64, 500])
def test_charts_are_pages_recursion_whatever_the_pieces(piece: int) -> None:
    rng = np.random.default_rng(3)
    increments = rng.normal(-0.1, 1.0, (500, 2, 3))
    time = 0.03 * np.arange(500)
    value, since = np.zeros((2, 3)), np.full((2, 3), -np.inf)
    chart = Cusum((2, 3))
    paths = []
    for at in range(0, 500, piece):
        used, path = chart.update(time[at : at + piece], increments[at : at + piece], 1e9)
        assert used == len(path)
        paths.append(path)
    for t, path in enumerate(np.concatenate(paths)):
        value = np.maximum(value + increments[t], 0.0)
        since[value == 0.0] = time[t]
        np.testing.assert_allclose(path, value, atol=1e-9)
    np.testing.assert_allclose(chart.since, since)


def test_rows_after_a_crossing_are_left_for_later() -> None:
    chart = Cusum((2,))
    increments = np.array([[0.5, -1.0], [2.0, 0.5], [3.0, 0.5], [1.0, 9.0]])
    used, path = chart.update(np.arange(4.0), increments, 5.0)
    assert used == 3
    np.testing.assert_allclose(path[-1], [5.5, 1.0])
    np.testing.assert_allclose(chart.since, [-np.inf, 0.0])
    chart.reset()
    assert not chart.value.any()
