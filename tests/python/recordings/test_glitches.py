"""Readings that jump and come back are left out; what a body may do is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pdoik.recordings import glitches
from pdoik.sim2real.study import load_study
from studies import log, motion, write_study

RNG = np.random.default_rng(4)
TIME = np.arange(0.0, 20.0, 0.01)
STEP = 2.0 * np.pi / 4096  # of a hobby servo's encoder [rad]


def rests(time: np.ndarray) -> np.ndarray:
    """Short moves between long rests."""
    phase = np.clip((time % 4.0 - 1.0) / 0.3, 0.0, 1.0)
    return np.asarray(np.floor(time / 4.0) * 0.5 + 0.5 * phase**2 * (3.0 - 2.0 * phase))


@pytest.mark.parametrize(
    "x",
    [
        np.sin(3.0 * TIME),
        np.rint(np.sin(0.2 * TIME) / STEP) * STEP,
        np.rint((rests(TIME) + 0.3 * STEP * RNG.standard_normal(len(TIME))) / STEP) * STEP,
        rests(TIME) + 1e-4 * RNG.standard_normal(len(TIME)),
        1e-3 * RNG.standard_normal(len(TIME)),
        0.2 * np.sign(np.sin(2.0 * TIME)),
        np.exp(-4.0 * (TIME % 2.0)) * np.sin(90.0 * TIME),  # a structure that was struck
        np.mod(TIME, 2.0 * np.pi),  # an angle that begins anew
        np.full(len(TIME), 0.3),
        np.full(len(TIME), np.nan),
        np.arange(9.0),
    ],
    ids=lambda x: f"{len(x)} {np.nanstd(x) if np.isfinite(x).any() else 0.0:.3g}",
)
def test_motion_has_none(x: np.ndarray) -> None:
    assert not glitches(x).any()


@pytest.mark.parametrize("noise", [0.0, 1e-4, 1e-3])
@pytest.mark.parametrize("moved", [np.sin(3.0 * TIME), rests(TIME)], ids=["waves", "moves"])
def test_every_reading_that_jumps_is_found_and_no_other(moved: np.ndarray, noise: float) -> None:
    x = np.rint((moved + noise * RNG.standard_normal(len(TIME))) / (STEP / 16)) * STEP / 16
    true = np.zeros(len(x), dtype=bool)
    for begin, width in ((150, 1), (160, 2), (401, 4), (900, 3), (1300, 1)):
        x[begin : begin + width] += 0.25 * (-1.0) ** begin
        true[begin : begin + width] = True
    x[700] = np.nan
    assert np.array_equal(glitches(x), true)


def test_a_study_says_what_was_left_out_and_bridges_it(tmp_path: Path) -> None:
    table = log()
    table.loc[[100, 101, 333], "q.elbow"] += 0.19
    study = load_study(write_study(tmp_path, {"a.csv": table, "b.csv": log()}))
    recording = study.fit[0]
    assert np.abs(recording.q - motion(recording.time)).max() < 1e-4
    assert recording.valid.all()
    (said,) = [note for note in recording.notes if "jump" in note]
    assert "3 readings of 'q.elbow' that jump by 0.19" in said
    assert not any("missing" in note for note in recording.notes)
