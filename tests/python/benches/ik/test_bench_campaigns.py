"""The paper's experiments in small: they run, say what they found, and go on where they stopped."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from bench.common import campaign

REPOSITORY = Path(__file__).parents[4]
SHARED = Path(os.environ.get("PDOIK_SHARED", REPOSITORY.parent / "shared"))
YCB = ["--ycb", str(SHARED / "ycb")] if (SHARED / "ycb").is_dir() else []


def run(command: str, out: Path, *arguments: str) -> str:
    """What a benchmark prints."""
    line = [sys.executable, "-m", f"bench.ik.{command}", "--out", str(out), *arguments]
    done = subprocess.run(
        line, cwd=REPOSITORY, capture_output=True, text=True, check=False, timeout=900
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def is_picture(path: Path) -> bool:
    return path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n" and path.stat().st_size > 20_000


@pytest.mark.long
def test_the_first_experiment_in_small_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    small = ("--scenarios", "5", "--slow-scenarios", "1", "--most-objects", "3", *YCB)
    printed = run("success", folder, *small)
    trials = pd.read_parquet(folder / "trials.parquet")
    assert is_picture(folder / "success.png")
    assert ("YCB scans" in printed) == bool(YCB)
    methods = set(trials.method)
    assert {"PDO-IK", "pdoik", "Angle-LBFGS-B", "Slack-LBFGS", "R-TR", "R-CG"} <= methods
    fast = trials[(trials.axis == "z") & ~trials.method.isin(["R-TR", "R-CG"])]
    assert (fast.groupby(["robot", "n_objects", "method"]).size() == 5).all()
    ours = trials[trials.method == "pdoik"]
    assert not ours.fails_pose.any()
    assert not ours.fails_limits.any()
    assert ours.success.mean() > 0.85  # what is lost are collisions between the points
    for method in ("PDO-IK", "PDO-IK, omega = 0", "Slack-LBFGS"):
        assert not trials[trials.method == method].fails_limits.any()
    # A success is what the four criteria say.
    fails = trials.fails_pose | trials.fails_limits | trials.fails_collision | ~trials.in_time
    assert (trials.success == ~fails).all()
    # Of a job that is missing the answers are as before, and the others' are kept as they are.
    trials_file = folder / "trials.parquet"
    trials_file.unlink()
    part = sorted((folder / "parts").iterdir())[0]
    missing = pd.read_parquet(part)
    part.unlink()
    assert "8 of 9 jobs are done already" in run("success", folder, *small)
    repeated = pd.read_parquet(trials_file)
    same = ["robot", "n_objects", "index", "axis", "method", "iterations", "success", "collision"]
    pd.testing.assert_frame_equal(repeated[same], trials[same])
    of_part = ["robot", "n_objects", "index"]
    kept = ~pd.MultiIndex.from_frame(trials[of_part]).isin(
        pd.MultiIndex.from_frame(missing[of_part])
    )
    assert 0 < kept.sum() < len(trials)
    pd.testing.assert_frame_equal(repeated[kept], trials[kept])  # times too: they did not run again


def test_the_second_experiment_in_small(tmp_path: Path) -> None:
    run("success.precision", tmp_path, "--scenarios", "5", "--slow-scenarios", "1", *YCB)
    trials = pd.read_parquet(tmp_path / "trials.parquet")
    assert is_picture(tmp_path / "precision.png")
    ours = trials[trials.method == "pdoik"]
    assert (ours.position_error < 1e-8).all()
    assert (ours.rotation_error < 1e-8).all()


def test_what_hulls_cover_in_small(tmp_path: Path) -> None:
    run("hulls", tmp_path / "h", "--quick", *YCB)
    trials = pd.read_parquet(tmp_path / "h-quick" / "trials.parquet")
    assert is_picture(tmp_path / "h-quick" / "hulls.png")
    covered = trials[trials.radii & trials.solved]
    assert len(covered) > 100
    assert (covered.collision == "").all()
    lost = trials[~trials.solved]
    assert not lost.known_is_clear.any()  # the solver finds what there is by the hulls


def test_hard_scenes_in_small(tmp_path: Path) -> None:
    arguments = (
        "--problems",
        "2",
        "--slow-problems",
        "0",
        "--build",
        str(REPOSITORY / "build/bench"),
    )
    run("hard", tmp_path, *arguments, *YCB)
    trials = pd.read_parquet(tmp_path / "trials.parquet")
    ours = trials[trials.method == "pdoik"]
    assert len(ours) == 3 * 7 * 2
    assert ours.solved.all()
    assert (trials.claimed <= trials.confirmed).all()


@pytest.mark.long
def test_tracking_in_small(tmp_path: Path) -> None:
    arguments = ("--runs", "1", "--slow-runs", "0", "--build", str(REPOSITORY / "build/bench"))
    run("tracking", tmp_path, *arguments)
    trials = pd.read_parquet(tmp_path / "trials.parquet")
    ours = trials[trials.method == "pdoik, one start"]
    assert len(ours) == 3
    assert (ours.solved == ours.steps).all()
    assert (ours.largest_step < 0.1).all()


def test_other_settings_do_not_mix_with_results_that_are_there(tmp_path: Path) -> None:
    campaign.Campaign(tmp_path, {"seed": 0, "leaf": 0.1})
    campaign.Campaign(tmp_path, {"seed": 0, "leaf": 0.1})
    with pytest.raises(campaign.CampaignError, match=r"other settings \(seed\)"):
        campaign.Campaign(tmp_path, {"seed": 1, "leaf": 0.1})


def test_a_scheduler_that_is_not_there_is_said_so(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "bench.ik.success", "--quick", "--out", str(tmp_path / "x")]
    done = subprocess.run(
        [*command, "--scheduler", "tcp://127.0.0.1:1"],
        cwd=REPOSITORY,
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 1
    assert "no Dask scheduler at tcp://127.0.0.1:1" in done.stderr
    assert "Traceback" not in done.stderr
