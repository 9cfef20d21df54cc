"""Long logs: a diagnosis looks at minutes that are spread over all of them, and says so."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.recordings import Recording
from pdoik.sim2real import Thresholds
from pdoik.sim2real.study import Study, excerpted
from sim2real_channels import study as small_arm


def logged(folder: Path) -> Study:
    """Twice twenty seconds to learn from, and once to judge."""
    study = small_arm(folder, (0.0,) * 3, (1.0,) * 3)
    (first,) = study.recordings
    others = (replace(first, name="second"), replace(first, name="third", role="validate"))
    return replace(study, recordings=(first, *others))


def lengths(recordings: tuple[Recording, ...]) -> list[float]:
    return [float(each.time[-1] - each.time[0]) for each in recordings]


def test_a_study_that_is_short_enough_is_left_as_it_is(tmp_path: Path) -> None:
    study = logged(tmp_path)
    assert excerpted(study) is study


@pytest.mark.parametrize("most", [4.0, 9.0])
def test_excerpts_are_spread_over_all_of_a_long_log(tmp_path: Path, most: float) -> None:
    study = logged(tmp_path)
    numbers = {"noise.longest": most}
    limited = replace(study, thresholds=Thresholds().changed(numbers))
    some = excerpted(limited)
    assert sum(lengths(some.fit)) == pytest.approx(most, rel=0.05)
    whole = {each.name: each for each in study.recordings}
    for piece in some.recordings:
        source = whole[piece.file]
        first = int(np.searchsorted(source.time, piece.start - source.start - 1e-9))
        assert np.array_equal(piece.q, source.q[first : first + len(piece.time)])
        assert piece.time[0] == 0.0
        assert piece.role == source.role
    halves = [0.5 * length for length in lengths(some.fit)]
    middles = [piece.start + half for piece, half in zip(some.fit, halves, strict=True)]
    centre = np.mean([r.start + 0.5 * (r.time[-1] - r.time[0]) for r in study.fit])
    assert np.mean(middles) == pytest.approx(centre, rel=0.05, abs=0.2)
    assert any("minutes of recordings" in note for note in some.notes)
    assert sum(lengths(some.recordings)) == pytest.approx(1.5 * most, rel=0.05)


def test_as_much_is_kept_as_the_rows_of_all_joints_allow(tmp_path: Path) -> None:
    """What is logged twice as quickly, or has twice the joints, says as much in half the time."""
    study = logged(tmp_path)
    noise = study.thresholds.noise
    cutoff = min(noise.highest_cutoff, noise.cutoff_of_rate / study.recordings[0].period)
    rows = 3.0 * cutoff * len(study.joints)
    numbers = {"noise.most_rows": round(rows * 10.0), "noise.shortest": 5.0}
    limited = replace(study, thresholds=Thresholds().changed(numbers))
    assert sum(lengths(excerpted(limited).fit)) == pytest.approx(10.0, rel=0.05)
    fewer = replace(study, thresholds=Thresholds().changed({**numbers, "noise.most_rows": 1}))
    assert sum(lengths(excerpted(fewer).fit)) == pytest.approx(5.0, rel=0.05)
