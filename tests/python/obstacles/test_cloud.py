"""Cloud: points taken in once, updated, filtered, refused."""

from __future__ import annotations

import pickle
import threading
import time
from contextlib import suppress

import numpy as np
import pytest

import pdoik

ROBOT = pdoik.Robot.builtin("panda")


def cloud_of(count: int, seed: int = 0, dtype: type = np.float64) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return (rng.uniform(-1.0, 1.0, (count, 3)) + np.array([0.0, 0.0, 1.6])).astype(dtype)


@pytest.mark.parametrize("count", [50, 20_000])
def test_a_solve_among_a_cloud_is_one_among_its_points(count: int) -> None:
    points = cloud_of(count)
    solver = pdoik.Solver(ROBOT, pdoik.Options(max_time=10.0, max_restarts=3))
    rng = np.random.default_rng(1)
    cloud = pdoik.Cloud(points)
    for _ in range(5):
        T = ROBOT.fk(rng.uniform(ROBOT.lower, ROBOT.upper))
        mine, shared = solver.solve(T, obstacles=points), solver.solve(T, obstacles=cloud)
        assert mine.status == shared.status
        assert np.array_equal(mine.q, shared.q)
        assert mine.clearance == pytest.approx(shared.clearance, abs=1e-12)


def test_float32_and_wide_rows_are_taken_and_a_leaf_thins_them() -> None:
    wide = np.zeros((3000, 8), dtype=np.float32)
    wide[:, :3] = cloud_of(3000, dtype=np.float32)
    cloud = pdoik.Cloud(wide[:, :3])
    assert len(cloud) == 3000
    assert np.array_equal(np.sort(cloud.points[:, 0]), np.sort(wide[:, 0].astype(np.float64)))
    thin = pdoik.Cloud(wide[:, :3], leaf=0.2, radii=True)
    assert len(thin) < 1500
    assert thin.points[:, 3].max() > 0.01
    assert "Cloud of 3000 points" in repr(cloud)
    assert cloud.nbytes / len(cloud) < 80


def test_a_region_is_replaced_and_removed_and_ids_go_on() -> None:
    points = cloud_of(30_000)
    cloud = pdoik.Cloud(points)
    region = np.array([[-0.2, -0.2, 1.0], [0.3, 0.3, 2.0]])
    inside = ((points >= region[0]) & (points <= region[1])).all(axis=1)
    new = np.full((7, 3), [0.0, 0.0, 1.5])
    assert cloud.update(new, region) == inside.sum()
    assert len(cloud) == len(points) - inside.sum() + 7
    assert sorted(cloud.ids)[-7:] == list(range(30_000, 30_007))
    expected = np.vstack([points[~inside], new])
    order = np.lexsort(cloud.points[:, :3].T)
    assert np.array_equal(cloud.points[order, :3], expected[np.lexsort(expected.T)])
    assert cloud.remove(region) == 7


def test_the_robots_own_surface_is_taken_out_of_clouds_and_arrays() -> None:
    q = ROBOT.mid_configuration()
    on_arm = np.array([ROBOT.fk(q, link)[:3, 3] for link in ("panda_link4", "panda_link6")])
    points = np.vstack([cloud_of(2000) + np.array([0, 0, 3]), on_arm])
    cloud = pdoik.Cloud(points)
    assert ROBOT.self_filter(cloud, q) == 2
    assert np.array_equal(ROBOT.self_filter(points, q), points[:2000])
    assert sorted(cloud.ids) == list(range(2000))


def test_what_makes_no_sense_is_refused_by_name() -> None:
    good = cloud_of(10)
    cloud = pdoik.Cloud(good)
    bad = good.copy()
    bad[3, 1] = np.nan
    for make, words in [
        (lambda: pdoik.Cloud(bad), "NaN or infinity in row 3"),
        (lambda: pdoik.Cloud(bad.astype(np.float32)), "NaN or infinity in row 3"),
        (lambda: pdoik.Cloud(np.c_[good, -np.ones(10)]), "negative radius in row 0"),
        (lambda: pdoik.Cloud(good * 1e8), "beyond 1e6"),
        (lambda: pdoik.Cloud(np.zeros((4, 2))), r"shape \(4, 2\)"),
        (lambda: pdoik.Cloud(good, radii=True), "no leaf"),
        (lambda: pdoik.Cloud(good, leaf=-1.0), "leaf"),
        (lambda: cloud.update(good, [[0, 0, 0], [1, 1, 1]]), "outside of the region"),
        (lambda: cloud.remove([[0, 0, 1], [1, 1, 0]]), "along z"),
        (lambda: cloud.remove([0, 1]), r"expected \(2, 3\)"),
        (lambda: ROBOT.self_filter(cloud, np.zeros(3)), "q has shape"),
    ]:
        with pytest.raises(ValueError, match=words):
            make()
    assert len(cloud) == 10
    assert len(pdoik.Cloud(np.zeros((0, 3)))) == 0
    assert len(pdoik.Cloud(bad, leaf=0.01)) == 9  # which leaves such rows out


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_camera_that_saw_nothing_is_no_empty_scene(dtype: type) -> None:
    blind = np.full((6, 3), np.nan, dtype=dtype)
    blind[2] = np.inf
    everywhere = [[-9, -9, -9], [9, 9, 9]]
    for how in ({}, {"radii": True}, {"solid": True}):
        with pytest.raises(ValueError, match="points has 6 rows, each with NaN or infinity"):
            pdoik.Cloud(blind, leaf=0.01, **how)
        cloud = pdoik.Cloud(cloud_of(50), leaf=0.01, **how)
        count = len(cloud)
        with pytest.raises(ValueError, match="each with NaN or infinity"):
            cloud.update(blind, everywhere)
        assert len(cloud) == count
        assert cloud.update(blind[:0], everywhere) == count  # no rows say that nothing is there
        assert len(cloud) == 0


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_what_another_thread_writes_into_points_meanwhile_is_refused_or_taken_whole(
    dtype: type,
) -> None:
    good = cloud_of(60_000, dtype=dtype)
    points, ends = good.copy(), threading.Event()

    def scribble() -> None:
        while not ends.is_set():
            points[::7] = np.nan
            points[::5] = 1e30
            points[:] = good

    writer = threading.Thread(target=scribble)
    writer.start()
    solver = pdoik.Solver(ROBOT, pdoik.Options(max_time=0.002, max_obstacles=len(good)))
    tracker = pdoik.Tracker(solver)
    T, q = ROBOT.fk(ROBOT.mid_configuration()), ROBOT.mid_configuration()
    lattice = np.sort(good.astype(np.float64).ravel())
    refused = taken = 0
    until = time.monotonic() + 3.0
    try:
        while time.monotonic() < until:
            for use in (
                lambda: solver.solve(T, obstacles=points),
                lambda: solver.judge(T, q, obstacles=points),
                lambda: tracker.step(T, points),
                lambda: pdoik.Cloud(points, leaf=0.05, radii=True),
            ):
                with suppress(ValueError):
                    use()
            try:
                left = pdoik.Cloud(points).points[:, :3].ravel()
                assert np.isin(left, lattice).all()  # each is one that was written
                taken += 1
            except ValueError:
                refused += 1
    finally:
        ends.set()
        writer.join()
    assert refused > 0


def test_arrays_of_more_rows_than_can_be_numbered_are_refused_unread() -> None:
    rows = 2**25 + 1
    many = np.lib.stride_tricks.as_strided(np.zeros(rows + 2), (rows, 3), (8, 8))
    solver = pdoik.Solver(ROBOT)
    T, q = np.eye(4), ROBOT.mid_configuration()
    for use in (
        lambda: solver.solve(T, obstacles=many),
        lambda: solver.judge(T, q, obstacles=many),
        lambda: solver.clearances(q, obstacles=many),
        lambda: solver.solve_batch(np.array([T]), obstacles=many),
        lambda: pdoik.Cloud(many),
    ):
        with pytest.raises(ValueError, match="has 33554433 rows, expected at most 33554432"):
            use()
    step = pdoik.Tracker(solver).step(T, many)
    assert step.tracking == "invalid_input"
    assert "33554433 rows" in step.complaint


MILLIMETRES = 1e3 * (cloud_of(500) * [0.5, 0.5, 1.0])


def given_as(kind: str, points: np.ndarray) -> object:
    if kind == "scene":
        return pdoik.Scene(cloud=points)
    return pdoik.Cloud(points) if kind == "cloud" else points.astype(kind)


@pytest.mark.parametrize("kind", ["float64", "float32", "cloud", "scene"])
def test_points_in_millimetres_are_warned_of_once_by_who_takes_them(kind: str) -> None:
    T, q = ROBOT.fk(ROBOT.mid_configuration()), ROBOT.mid_configuration()
    obstacles = given_as(kind, MILLIMETRES)
    for use in (
        lambda solver: solver.solve(T, obstacles=obstacles),
        lambda solver: solver.judge(T, q, obstacles=obstacles),
        lambda solver: solver.clearances(q, obstacles=obstacles),
        lambda solver: solver.solve_batch(np.array([T]), obstacles=obstacles),
        lambda solver: pdoik.Tracker(solver).step(T, obstacles),
    ):
        solver = pdoik.Solver(ROBOT)
        with pytest.warns(pdoik.ObstacleWarning, match="are they in millimetres") as told:
            use(solver)
        assert len(told) == 1
    solver = pdoik.Solver(ROBOT)
    with pytest.warns(pdoik.ObstacleWarning):
        solver.solve(T, obstacles=obstacles)
    for _ in range(3):
        solver.solve(T, obstacles=obstacles)  # a warning is an error in tests


def test_points_that_are_far_in_metres_are_not_warned_of() -> None:
    T = ROBOT.fk(ROBOT.mid_configuration())
    hall = cloud_of(500) * 30.0
    some = np.vstack([cloud_of(300), MILLIMETRES[:200]])
    for obstacles in (None, hall, some, pdoik.Cloud(hall), np.zeros((0, 3)), [[0.5, 0.5, 0.5]]):
        pdoik.Solver(ROBOT).solve(T, obstacles=obstacles)
    row = pdoik.DhRow(a=100.0, lower=-1.0, upper=1.0)  # an arm of some hundred metres
    balls = np.c_[MILLIMETRES, np.full(len(MILLIMETRES), 1e4)]  # that reach as far as the robot
    pdoik.Solver(ROBOT).solve(T, obstacles=balls)
    crane = pdoik.Robot.from_dh([row, row])
    ignoring = pdoik.Options(goal="position", ignore_obstacles_without_hulls=True)
    pdoik.Solver(crane, ignoring).solve(crane.fk([0.1, 0.1]), obstacles=MILLIMETRES)
    endless = pdoik.Robot.from_dh([pdoik.DhRow(prismatic=True), row])
    pdoik.Solver(endless, ignoring).solve(np.eye(4), obstacles=MILLIMETRES)


def test_threads_solve_among_a_cloud_while_another_updates_it() -> None:
    points = cloud_of(20_000)
    cloud = pdoik.Cloud(points)
    region = [[-1.0, -1.0, 1.0], [0.0, 0.0, 2.0]]
    inside = points[((points >= region[0]) & (points <= region[1])).all(axis=1)]
    finished: list[int] = []

    def solve() -> None:
        solver = pdoik.Solver(ROBOT, pdoik.Options(max_restarts=2))
        rng = np.random.default_rng(5)
        for _ in range(30):
            q = rng.uniform(ROBOT.lower, ROBOT.upper)
            assert np.isfinite(solver.solve(ROBOT.fk(q), obstacles=cloud).q).all()
        finished.append(1)

    threads = [threading.Thread(target=solve) for _ in range(3)]
    for thread in threads:
        thread.start()
    for _ in range(20):
        cloud.remove(region)
        cloud.update(inside, region)
    for thread in threads:
        thread.join()
    assert len(finished) == 3
    assert len(cloud) == len(points)


def test_a_tracker_follows_a_clouds_updates() -> None:
    q = ROBOT.mid_configuration()
    cloud = pdoik.Cloud(np.zeros((0, 3)))
    tracker = pdoik.Tracker(pdoik.Solver(ROBOT))
    tracker.reset(q)
    assert tracker.step(ROBOT.fk(q), obstacles=cloud).tracking == "tracking"
    at = ROBOT.fk(q, "panda_link4")[:3, 3]
    cloud.update([at], [at, at])
    assert tracker.step(ROBOT.fk(q)).tracking != "tracking"


def test_a_robot_goes_through_pickle_whole() -> None:
    for name in pdoik.Robot.builtin_names():
        robot = pdoik.Robot.builtin(name)
        again = pickle.loads(pickle.dumps(robot))
        q = np.random.default_rng(2).uniform(-0.5, 0.5, robot.dof)
        for link in robot.tip_links:
            assert np.array_equal(robot.fk(q, link), again.fk(q, link))
        assert again.occupancy == robot.occupancy
        assert again.joint_names == robot.joint_names
        assert again.tip_links == robot.tip_links
        assert np.array_equal(again.upper, robot.upper)
