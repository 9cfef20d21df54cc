"""The benchmark of clouds in small: its scene, its peers' geometry, its answers, its resuming."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import pdoik

pytest.importorskip("coal")
pytest.importorskip("dask")
from bench.ik.clouds import hulls as cloud_hulls
from bench.ik.clouds import scene as cloud_scene
from bench.ik.clouds import trials as cloud_trials

REPOSITORY = Path(__file__).parents[4]
JOB = {"name": "", "seed": 7, "repeats": 3, "seconds": 0.01, "configurations": 9, "targets": 3}


def rows_of(**job: Any) -> pd.DataFrame:
    return pd.DataFrame(cloud_trials.run_job({**JOB, **job}))


def test_a_table_and_balls_are_the_same_ones_for_every_number_of_points() -> None:
    few, many = cloud_scene.table_and_balls(1_000, 7), cloud_scene.table_and_balls(50_001, 7)
    assert many.shape == (50_001, 3)
    above = few[few[:, 2] > cloud_scene.TABLE_HEIGHT + 1e-9]
    assert len(above) == 500
    nearest = [np.linalg.norm(many - point, axis=1).min() for point in above]
    assert max(nearest) < 0.02


def test_the_box_holds_a_hundredth() -> None:
    points = cloud_scene.table_and_balls(20_000, 7)
    low, high = cloud_scene.hundredth(points)
    assert np.mean(((points >= low) & (points <= high)).all(axis=1)) == pytest.approx(0.01, 0.02)


def test_a_capsule_holds_its_hull_and_is_where_coal_has_it() -> None:
    coal = pytest.importorskip("coal")
    robot = pdoik.Robot.builtin("panda")
    rng = np.random.default_rng(3)
    q = rng.uniform(robot.lower, robot.upper)
    for hull in cloud_hulls.moving_hulls(robot):
        capsule = cloud_hulls.Capsule.about(hull)
        T = robot.fk(q, hull.link)
        directions = rng.normal(size=(50, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        along = directions @ hull.axis
        across = directions - along[:, None] * hull.axis
        surface = (
            hull.center + hull.semi_minor * across + hull.semi_major * along[:, None] * hull.axis
        )
        placed = surface @ T[:3, :3].T + T[:3, 3]
        assert max(capsule.gap(T, point[None]) for point in placed) < 1e-9
        point = rng.uniform(-1, 1, 3)
        distance = coal.distance(
            capsule.shape, capsule.place(T), coal.Sphere(1e-6), coal.Transform3s(np.eye(3), point),
            coal.DistanceRequest(), coal.DistanceResult(),
        )  # fmt: skip
        assert distance == pytest.approx(capsule.gap(T, point[None]), abs=1e-5)


@pytest.mark.parametrize("robot", ["panda", "ur10"])
def test_peers_say_what_we_say_but_for_voxels_and_capsules(robot: str) -> None:
    rows = rows_of(kind="query", robot=robot, points=5_000)
    from bench.ik.clouds import tables

    questions = tables.questions(rows)
    assert set(questions.method) == {tables.OURS, tables.COAL, "SciPy cKDTree"}
    scipy = questions[questions.method == "SciPy cKDTree"]
    assert (scipy.free == scipy.our_free).all()
    assert (~scipy.our_free).sum() == 3
    octree = questions[questions.method == tables.COAL]
    assert not (octree.free & ~octree.our_free).any()
    differ = octree[octree.free != octree.our_free]
    assert (differ.capsule_gap <= tables.DIAGONAL).all()
    both = octree[octree.free & octree.our_free]
    assert (both.clearance <= both.our_clearance + 1e-5).all()


@pytest.mark.long
def test_the_command_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "bench.ik.clouds", "--quick", "--out", str(tmp_path / "c")]
    command += ["--most", "1000", "--configurations", "6", "--targets", "3"]

    def run() -> str:
        done = subprocess.run(
            command, cwd=REPOSITORY, capture_output=True, text=True, check=False, timeout=300
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    run()
    folder = tmp_path / "c-quick"
    trials = pd.read_parquet(folder / "trials.parquet")
    assert {"intake", "memory", "update", "query", "solve"} == set(trials.kind)
    assert trials[trials.kind == "solve"].solved.astype(bool).all()
    assert (folder / "clouds.png").stat().st_size > 20_000
    assert "**A solve, in C++**" in (folder / "clouds.md").read_text()
    next((folder / "parts").glob("solve-*ur10*")).unlink()
    done, total = run().split(" jobs are done already")[0].split()[-3::2]
    assert int(done) == int(total) - 1
