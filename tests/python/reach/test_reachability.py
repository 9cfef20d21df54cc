"""Reachability of grids of poses, checked by Pinocchio's or our own judge pose by pose."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import pdoik
from conftest import ROBOTS
from pdoik.reach_map import even_rotations
from references import PinocchioRobot

ROBOT = pdoik.Robot.builtin("panda")


def test_every_pose_called_reached_is_and_every_known_one_is_called_so() -> None:
    rng = np.random.default_rng(0)
    qs = rng.uniform(ROBOT.lower, ROBOT.upper, (60, ROBOT.dof))
    known = np.array([ROBOT.fk(q) for q in qs])
    grid = pdoik.Grid(known[:, :3, 3].copy(), known[:, :3, :3].copy())
    result = pdoik.reachability(ROBOT, None, grid)
    assert result.reached.shape == (60, 60)
    assert np.diagonal(result.reached).mean() > 0.98
    poses = grid.poses(0, len(grid)).reshape(60, 60, 4, 4)
    for p, r in zip(*np.nonzero(result.reached), strict=True):
        T = ROBOT.fk(result.q[p, r].astype(np.float64))
        assert np.abs(T - poses[p, r]).max() < 2e-3
        assert (result.q[p, r] >= ROBOT.lower - 1e-6).all()
        assert (result.q[p, r] <= ROBOT.upper + 1e-6).all()
    assert np.isnan(result.q[~result.reached]).all()


def test_obstacles_take_poses_away_and_a_cloud_counts_like_its_points() -> None:
    grid = pdoik.Grid.box([0.3, -0.3, 0.2], [0.6, 0.3, 0.5], 0.15, orientations=12)
    free = pdoik.reachability(ROBOT, None, grid)
    wall = np.array([[0.45, y, z] for y in np.arange(-1, 1, 0.04) for z in np.arange(0, 1, 0.04)])
    blocked = pdoik.reachability(ROBOT, wall, grid)
    again = pdoik.reachability(ROBOT, pdoik.Cloud(wall), grid, threads=1)
    assert blocked.reached.sum() < 0.7 * free.reached.sum()
    assert np.array_equal(blocked.statuses, again.statuses)
    assert np.array_equal(blocked.q, again.q, equal_nan=True)
    slab = [pdoik.Shape.box("slab", (0.02, 2.0, 1.0), np.eye(4) + np.eye(4, 4, 3) * 0.45)]
    solid = pdoik.reachability(ROBOT, slab, grid)
    assert solid.reached.sum() < 0.7 * free.reached.sum()
    same = pdoik.reachability(ROBOT, pdoik.Scene(slab), grid)
    assert np.array_equal(solid.statuses, same.statuses)


def around_a_can(count: int) -> np.ndarray:
    """Grasps that come from the side, all around, (N, 4, 4)."""
    grasps = np.tile(np.eye(4), (count, 1, 1))
    for T, angle in zip(grasps, np.linspace(0, 2 * np.pi, count, endpoint=False), strict=True):
        z = np.array([np.cos(angle), np.sin(angle), 0.0])
        T[:3, :3] = np.column_stack([np.cross([0, 0, 1], z), [0, 0, 1], z])
        T[:3, 3] = -0.15 * z
    return grasps


def test_a_position_is_reached_by_any_grasp_that_is_met_at_it() -> None:
    pinocchio = PinocchioRobot.from_xml((ROBOTS / "panda.urdf").read_text())
    grid = pdoik.Grid.box([0.2, -0.4, 0.1], [0.8, 0.4, 0.7], 0.2)
    wall = pdoik.Shape.box("wall", (0.02, 2.0, 0.3), np.eye(4) + np.eye(4, 4, 3) * 0.5)
    grasps = around_a_can(6)
    result = pdoik.reachability(ROBOT, [wall], grid, grasps=grasps)
    assert result.met is not None
    assert np.array_equal(result.reached_somehow, result.reached[:, 0])
    assert np.array_equal(result.reached, result.met >= 0)
    assert set(np.unique(result.met)) >= {-1, 0, 1}
    alone = [pdoik.reachability(ROBOT, [wall], grid, grasps=grasps[k : k + 1]) for k in range(6)]
    each = np.stack([one.reached[:, 0] for one in alone], axis=1)  # (P, N)
    assert np.array_equal(each.any(axis=1), result.reached[:, 0])
    assert np.array_equal(each[result.reached_somehow].argmax(axis=1), result.met[result.met >= 0])
    for p in np.nonzero(result.reached_somehow)[0]:
        pinocchio.set(dict(zip(ROBOT.joint_names, result.q[p, 0].tolist(), strict=True)))
        T = pinocchio.pose(ROBOT.base_link, ROBOT.tip_links[0])
        wanted = grid.poses(p, p + 1)[0] @ grasps[result.met[p, 0]]
        assert np.abs(T - wanted).max() < 2e-3
    chunked = pdoik.reachability(ROBOT, [wall], grid, grasps=grasps, chunk=7, threads=1)
    assert np.array_equal(chunked.q, result.q, equal_nan=True)
    assert np.array_equal(chunked.statuses, result.statuses)


def test_grasps_are_in_the_file_and_what_are_none_is_refused(tmp_path: Path) -> None:
    grid = pdoik.Grid.box([0.4, 0.0, 0.3], [3.4, 0.0, 0.3], 1.5)
    result = pdoik.reachability(ROBOT, None, grid, grasps=around_a_can(3))
    far = pdoik.reach_map.STATUSES.index("out_of_reach")
    assert result.reached[:, 0].tolist() == [True, False, False]
    assert result.statuses[1:, 0].tolist() == [far, far]
    result.save(tmp_path / "map.npz")
    again = pdoik.Reachability.load(tmp_path / "map.npz")
    assert again.grasps is not None
    assert np.array_equal(again.grasps, around_a_can(3))
    assert np.array_equal(again.met, result.met)
    for grasps, words in (
        (np.eye(4), "grasps has shape"),
        (np.zeros((0, 4, 4)), "none empty"),
        (np.stack([np.eye(4), 2 * np.eye(4)]), r"grasps\[1\]"),
        (np.full((1, 4, 4), np.nan), r"grasps\[0\]"),
    ):
        with pytest.raises(ValueError, match=words):
            pdoik.reachability(ROBOT, None, grid, grasps=grasps)


def test_a_file_gives_back_what_was_saved_and_others_are_refused(tmp_path: Path) -> None:
    grid = pdoik.Grid.box([0.3, 0.0, 0.3], [0.9, 0.0, 0.3], 0.3, orientations=4)
    result = pdoik.reachability(ROBOT, None, grid)
    result.save(tmp_path / "map.npz")
    again = pdoik.Reachability.load(tmp_path / "map.npz")
    assert np.array_equal(again.statuses, result.statuses)
    assert np.array_equal(again.grid.positions, grid.positions)
    assert np.array_equal(again.q, result.q, equal_nan=True)
    whole = (tmp_path / "map.npz").read_bytes()
    (tmp_path / "other.npz").write_bytes(b"nothing of the kind")
    (tmp_path / "half.npz").write_bytes(whole[: len(whole) // 2])
    np.save(tmp_path / "array.npy", np.zeros(3))
    np.savez(tmp_path / "others.npz", q=np.zeros(3))
    lost = {**np.load(tmp_path / "map.npz"), "positions": np.full((3, 3), np.nan)}
    np.savez(tmp_path / "nan.npz", **lost)
    flat = {**np.load(tmp_path / "map.npz"), "q": np.zeros((3, 4))}
    np.savez(tmp_path / "flat.npz", **flat)
    for name in ("other.npz", "half.npz", "array.npy", "others.npz", "nan.npz", "flat.npz", "no"):
        with pytest.raises(pdoik.LoadError, match=f"{name}.*not a reachability file"):
            pdoik.Reachability.load(tmp_path / name)


def test_chunks_change_nothing_and_what_progress_raises_ends_the_work() -> None:
    grid = pdoik.Grid.box([0.3, -0.2, 0.2], [0.6, 0.2, 0.5], 0.1, orientations=6)
    told: list[int] = []
    whole = pdoik.reachability(ROBOT, None, grid)
    chunked = pdoik.reachability(ROBOT, None, grid, chunk=50, progress=told.append)
    assert np.array_equal(chunked.q, whole.q, equal_nan=True)
    assert told == [*range(50, len(grid), 50), len(grid)]

    def enough(done: int) -> None:
        if done >= 100:
            raise InterruptedError(done)

    with pytest.raises(InterruptedError, match=r"^100$"):
        pdoik.reachability(ROBOT, None, grid, chunk=50, progress=enough)
    with pytest.raises(ValueError, match="chunk is 0"):
        pdoik.reachability(ROBOT, None, grid, chunk=0)


def test_dask_workers_find_what_one_process_finds() -> None:
    distributed = pytest.importorskip("distributed")
    grid = pdoik.Grid.box([0.3, -0.2, 0.2], [0.6, 0.2, 0.5], 0.1, orientations=6)
    wall = pdoik.Shape.half_space("wall", (-1, 0, 0), (0.5, 0, 0))
    scene = pdoik.Scene([wall], allowed=[("panda_link7", "wall")])
    alone = pdoik.reachability(ROBOT, scene, grid)
    grasped = pdoik.reachability(ROBOT, scene, grid, grasps=around_a_can(3))
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        spread = pdoik.reachability(ROBOT, scene, grid, client=client, threads=1)
        grasps = around_a_can(3)
        there = pdoik.reachability(ROBOT, scene, grid, grasps=grasps, client=client, threads=1)
    assert np.array_equal(spread.statuses, alone.statuses)
    assert np.array_equal(spread.q, alone.q, equal_nan=True)
    assert np.array_equal(there.met, grasped.met)
    assert np.array_equal(there.q, grasped.q, equal_nan=True)


def test_rotations_are_rotations_and_spread() -> None:
    rotations = even_rotations(200)
    assert np.allclose(rotations @ rotations.transpose(0, 2, 1), np.eye(3))
    assert np.allclose(np.linalg.det(rotations), 1.0)
    cosines = (np.einsum("aij,bij->ab", rotations, rotations) - 1.0) / 2.0
    np.fill_diagonal(cosines, -1.0)
    nearest = np.arccos(np.clip(cosines.max(axis=1), -1, 1))
    assert nearest.min() > 0.25
    assert nearest.max() < 0.9


def test_grids_that_make_no_sense_are_refused() -> None:
    for make in (
        lambda: pdoik.Grid.box([0, 0, 1], [1, 1, 0], 0.1),
        lambda: pdoik.Grid.box([0, 0, 0], [1, 1, 1], 0.0),
        lambda: pdoik.Grid.box([0, 0, 0], [1, 1, 1], 0.5, orientations=0),
        lambda: pdoik.Grid(np.zeros((0, 3)), np.eye(3)[None]),
        lambda: pdoik.Grid(np.zeros((4, 2)), np.eye(3)[None]),
        lambda: pdoik.Grid(np.full((4, 3), np.nan), np.eye(3)[None]),
        lambda: pdoik.Grid(np.zeros((4, 3)), np.full((1, 3, 3), np.inf)),
    ):
        with pytest.raises(ValueError, match="expected"):
            make()
