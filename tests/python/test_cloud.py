"""Cloud: points taken in once, updated, filtered, refused."""

from __future__ import annotations

import pickle
import threading

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
