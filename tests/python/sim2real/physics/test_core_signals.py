"""Filters, derivatives and delays of pdoik.sim2real against SciPy and against formulas."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from pdoik.sim2real.motion import derivative, dilated, lagged, noise_density, shifted, zero_phase

PERIOD = 0.004
TIME = PERIOD * np.arange(5001)


@pytest.mark.parametrize("frequency", [0.5, 3.0, 8.0, 10.0, 14.0, 40.0])
def test_a_sine_is_passed_without_delay_by_as_much_as_the_butterworth_filter_squared(
    frequency: float,
) -> None:
    wave = np.sin(2 * np.pi * frequency * TIME + 0.3)
    b, a = signal.butter(4, 10.0, fs=1 / PERIOD)
    _, response = signal.freqz(b, a, [frequency], fs=1 / PERIOD)
    inside = slice(500, -500)
    expected = np.abs(response[0]) ** 2 * wave
    assert zero_phase(wave, 10.0, PERIOD)[inside] == pytest.approx(expected[inside], abs=2e-5)


def test_a_pulse_stays_symmetric_about_its_own_time() -> None:
    pulse = np.zeros((2001, 1))
    pulse[1000] = 1.0
    spread = zero_phase(pulse, 10.0, PERIOD)[:, 0]
    assert np.argmax(spread) == 1000
    assert spread == pytest.approx(spread[::-1], abs=1e-12)
    assert spread.sum() == pytest.approx(1.0, abs=1e-6)  # constants pass
    assert spread[1000] < 0.2


def test_straight_lines_pass_up_to_their_ends() -> None:
    line = np.stack([2.0 * TIME - 1.0, 0.0 * TIME + 4.0], axis=1)
    assert zero_phase(line, 8.0, PERIOD) == pytest.approx(line, abs=1e-4)


def test_each_column_is_filtered_for_itself_and_one_of_nan_stays_nan() -> None:
    rng = np.random.default_rng(0)
    values = rng.standard_normal((800, 2, 2))
    values[:, 1, 0] = np.nan
    filtered = zero_phase(values, 12.0, PERIOD)
    assert np.isnan(filtered[:, 1, 0]).all()
    for i, j in ((0, 0), (0, 1), (1, 1)):
        alone = zero_phase(np.ascontiguousarray(values[:, i, j]), 12.0, PERIOD)
        assert filtered[:, i, j] == pytest.approx(alone, abs=1e-12)
    assert np.nanstd(filtered) < 0.5 * np.nanstd(values)


@pytest.mark.parametrize("cutoff", [112.6, 125.0, 500.0])
def test_a_cut_off_near_the_nyquist_frequency_leaves_everything_as_it_is(cutoff: float) -> None:
    noise = np.random.default_rng(1).standard_normal((300, 2))
    np.testing.assert_array_equal(zero_phase(noise, cutoff, PERIOD), noise)
    assert np.abs(zero_phase(noise, 0.8 * 125.0, PERIOD) - noise).max() > 0.1


@pytest.mark.parametrize("length", [1, 2, 3, 4, 7, 40])
def test_recordings_shorter_than_the_filter_remembers_keep_their_length(length: int) -> None:
    values = np.linspace(1.0, 2.0, length)[:, None]
    for result in (zero_phase(values, 1.0, PERIOD), shifted(values, 0.5, PERIOD)):
        assert result.shape == values.shape
        assert np.isfinite(result).all()


@pytest.mark.parametrize("degree", range(5))
def test_derivatives_of_polynomials_up_to_degree_four_are_exact(degree: int) -> None:
    coefficients = np.array([0.7, -1.3, 0.4, 2.0, -0.9])[: degree + 1]
    time = 0.01 * np.arange(200)
    values = np.stack([np.polyval(c * coefficients, time) for c in (1.0, -2.5)], axis=1)
    exact = np.stack([np.polyval(np.polyder(c * coefficients), time) for c in (1.0, -2.5)], axis=1)
    result = derivative(values, 0.01)
    assert result[2:-2] == pytest.approx(exact[2:-2], abs=1e-10)
    assert result == pytest.approx(exact, abs=0.3)  # one-sided at the ends
    if degree < 2:
        assert result == pytest.approx(exact, abs=1e-10)


@pytest.mark.parametrize("period", [0.02, 0.01, 0.005])
def test_the_error_of_a_sines_derivative_falls_with_the_fourth_power_of_the_period(
    period: float,
) -> None:
    time = np.arange(0.0, 2.0, period)
    omega = 12.0
    error = derivative(np.sin(omega * time), period) - omega * np.cos(omega * time)
    # The five-point rule's next term is omega^5 h^4 / 30.
    largest = omega**5 * period**4 / 30
    assert 0.7 * largest < np.abs(error[2:-2]).max() < 1.01 * largest


@pytest.mark.parametrize("delay", [0.05, 0.0513, -0.02])
def test_a_shifted_ramp_is_the_ramp_of_a_moment_ago(delay: float) -> None:
    ramp = np.stack([3.0 * TIME, -TIME], axis=1)
    late = shifted(ramp, delay, PERIOD)
    when = np.clip(TIME - delay, 0.0, TIME[-1])
    assert late == pytest.approx(np.stack([3.0 * when, -when], axis=1), abs=1e-9)


def test_a_step_shifted_by_whole_samples_is_the_step_later() -> None:
    step = (TIME >= 1.0).astype(float)
    late = shifted(step, 25 * PERIOD, PERIOD)
    # Rounding may leave a trace of the neighbouring sample.
    assert late == pytest.approx((np.arange(len(TIME)) >= 275).astype(float), abs=1e-9)


@pytest.mark.parametrize("constant", [0.0005, 0.002, 0.03, 0.4])
def test_a_lag_is_scipys_simulation_of_the_differential_equation(constant: float) -> None:
    rng = np.random.default_rng(2)
    path = np.cumsum(rng.standard_normal((600, 2)), axis=0)  # in a line between samples
    late = lagged(path, constant, PERIOD)
    for column, found in zip(path.T, late.T, strict=True):
        exact = signal.lsim(([1.0], [constant, 1.0]), column - column[0], TIME[:600])[1]
        assert found == pytest.approx(column[0] + exact, abs=1e-9)


def test_a_lagging_ramp_follows_at_the_time_constant() -> None:
    ramp = np.stack([2.0 * TIME, 5.0 + 0.0 * TIME], axis=1)
    late = lagged(ramp, 0.1, PERIOD)
    assert ramp[2000:, 0] - late[2000:, 0] == pytest.approx(2.0 * 0.1, abs=1e-9)
    assert late[:, 1] == pytest.approx(5.0, abs=1e-12)  # at rest from the start


@pytest.mark.parametrize("seed", range(4))
def test_the_density_of_white_noise_is_found_beside_a_slow_motion(seed: int) -> None:
    rng = np.random.default_rng(seed)
    std = np.array([0.02, 3.0])
    slow = np.stack([np.sin(2 * np.pi * 0.7 * TIME), 40.0 * np.sin(TIME)], axis=1)
    found = noise_density(slow + std * rng.standard_normal((len(TIME), 2)), PERIOD, 15.0)
    assert found == pytest.approx(2.0 * PERIOD * std**2, rel=0.12)


def test_lines_in_the_spectrum_do_not_count_as_noise_and_columns_of_nan_have_none() -> None:
    rng = np.random.default_rng(5)
    noise = 0.1 * rng.standard_normal(len(TIME))
    ringing = noise + np.sin(2 * np.pi * 90.0 * TIME)
    columns = np.stack([ringing, np.full_like(noise, np.nan)], axis=1)
    found = noise_density(columns, PERIOD, 20.0)
    assert found[0] == pytest.approx(2.0 * PERIOD * 0.01, rel=0.2)
    assert np.isnan(found[1])


@pytest.mark.parametrize("by", [0, 1, 3, 50])
def test_a_dilated_mask_is_true_within_so_many_samples(by: int) -> None:
    mask = np.random.default_rng(6).random((60, 3)) < 0.05
    rows = np.arange(60)
    near = np.array([[mask[np.abs(rows - t) <= by, j].any() for j in range(3)] for t in rows])
    np.testing.assert_array_equal(dilated(mask, by), near)
    np.testing.assert_array_equal(dilated(mask[:, 1], by), near[:, 1])
