"""Rows that say the same, and rows of rollouts, against theory and SciPy's least squares."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy import signal

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.identify import Series

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
