"""The rows of bench.ik.paths: their judge sees what is wrong, and the command makes its table."""

from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="needs the extra bench")
pytest.importorskip("coal", reason="needs the extra bench")
pytest.importorskip("dask.distributed", reason="needs the extra bench")

import coal
import pandas as pd
import typer

import pdoik
from bench.common.arrays import z_along
from bench.ik.paths import __main__ as paths
from bench.ik.paths import axis, closed, free, gap, impossible, length, memory, motion, peers
from bench.ik.paths.arms import ARMS, judge_of, robot_of
from bench.ik.paths.cases import move, problem
from bench.ik.paths.contacts import Contacts
from bench.ik.paths.curves import CURVES, stations
from bench.ik.paths.judge import faults_of_move, judged
from bench.ik.paths.problem import Problem
from bench.ik.paths.rooms import ROOMS
from bench.ik.paths.runs import row_of
from bench.ik.paths.sampling import search
from bench.ik.paths.solids import Solid, World, box, cylinder, frame
from bench_command import tables_of

LINE = "free:ur10:square:0:0"


@pytest.fixture(scope="module")
def followed() -> tuple[Problem, np.ndarray, np.ndarray]:
    one = problem(LINE)
    found = search(one, 20.0, np.random.default_rng(0), first=True)
    assert found.Q is not None
    return one, found.Q, np.arange(len(found.Q), dtype=float)


@pytest.mark.parametrize("curve", CURVES)
def test_stations_are_poses_that_are_evenly_spread_and_never_the_same(curve: str) -> None:
    T = stations(CURVES[curve](np.random.default_rng(3), 1.0), 200)
    turns = T[:-1, :3, :3].swapaxes(1, 2) @ T[1:, :3, :3]
    angles = np.arccos(np.clip((np.trace(turns, axis1=1, axis2=2) - 1) / 2, -1, 1))
    gone = np.linalg.norm(np.diff(T[:, :3, 3], axis=0), axis=1) + 0.2 * angles
    assert gone.min() > 0.2 * np.median(gone)  # a corner is cut
    assert gone.max() < 1.05 * np.median(gone)
    assert np.allclose(T[:, :3, :3] @ T[:, :3, :3].swapaxes(1, 2), np.eye(3))


def test_depths_are_those_of_coal() -> None:
    rng = np.random.default_rng(0)
    judge = judge_of("panda")
    solids = [
        box([0.3, 0.2, 0.4], [0.4, 0.1, 0.5], z_along(np.array([0.6, 0.0, 0.8]))),
        cylinder(0.08, 0.7, [0.3, -0.3, 0.5]),
        Solid(kind="half_space", T=frame([0.0, 0.0, 0.1])),
    ]
    shapes = [coal.Box(0.3, 0.2, 0.4), coal.Cylinder(0.08, 0.7), coal.Halfspace(0.0, 0.0, 1.0, 0.0)]
    Q = rng.uniform(judge.kinematics.lower, judge.kinematics.upper, (15, 7))
    a, b = judge.hulls(judge.kinematics.place(Q))
    met = 0
    for solid, shape in zip(solids, shapes, strict=True):
        place = coal.Transform3s(solid.T[:3, :3], solid.T[:3, 3])
        depths, _ = Contacts(judge, World(solids=[solid])).depths(Q)
        for k, depth in enumerate(depths):
            least = 0.0
            for p, q, radius in zip(a[k], b[k], judge.A, strict=True):
                along = np.linalg.norm(q - p)
                R = z_along((q - p) / along) if along > 0 else np.eye(3)
                at = coal.Transform3s(R, 0.5 * (p + q))
                capsule = coal.Capsule(float(radius), float(along))
                result = coal.DistanceResult()
                gap_ = coal.distance(capsule, at, shape, place, coal.DistanceRequest(), result)
                least = min(least, gap_)
            met += least < 0.0
            if least > -0.02:  # deeper, depths along an axis and of a whole solid differ
                assert depth == pytest.approx(-least, abs=1e-5)
            assert (depth > 0.0) == (least < 0.0)
    assert 5 < met < 40


def test_points_of_a_solid_are_on_it_and_touch_as_it_does() -> None:
    rng = np.random.default_rng(1)
    for solid in (box([0.3, 0.2, 0.4], [0.5, 0, 0.4]), cylinder(0.1, 0.5, [0.5, 0, 0.4])):
        points = solid.sample(0.01, rng)
        assert np.abs(solid.distance(points)).max() < 1e-12
        Q = rng.uniform(*(robot_of("panda").lower, robot_of("panda").upper), (20, 7))
        whole, _ = Contacts(judge_of("panda"), World(solids=[solid])).depths(Q)
        some, _ = Contacts(judge_of("panda"), World(points=points)).depths(Q)
        assert (some <= whole + 1e-9).all()
        assert ((whole > 0.01) <= (some > 0.0)).all()


@pytest.mark.parametrize("arm", ARMS)
def test_contacts_of_an_arm_with_itself_are_those_that_a_solver_sees(arm: str) -> None:
    robot, judge = robot_of(arm), judge_of(arm)
    solver = pdoik.Solver(robot, pdoik.Options(self_collision=True))
    rng = np.random.default_rng(0)
    Q = rng.uniform(np.maximum(robot.lower, -3), np.minimum(robot.upper, 3), (400, robot.dof))
    _, own = Contacts(judge, World()).depths(Q)
    said = np.array([solver.judge(robot.fk(q), q).self_distance for q in Q])
    np.testing.assert_allclose(own, np.maximum(-said, 0.0), atol=1e-9)
    assert 0 < (own > 0).sum() < 400


def test_a_motion_that_follows_its_path_has_no_fault_and_its_spoilt_copies_have(
    followed: tuple[Problem, np.ndarray, np.ndarray],
) -> None:
    one, Q, at = followed
    assert judged(one, Q, at).faults == []

    def spoilt(row: int, by: float) -> list[str]:
        changed = Q.copy()
        changed[row, 5] += by
        return judged(one, changed, at).faults

    assert "station_rotation" in spoilt(7, 3e-5)
    assert "way_rotation" in spoilt(7, 3e-3)
    assert "row_step" in spoilt(7, 0.3)
    assert judged(one, Q[:-1], at[:-1]).faults == ["covers"]
    assert judged(one, Q[:-1], at[:-1], part=True).faults == []
    assert (
        "covers" in judged(one, Q[[*range(9), 8, *range(9, len(Q))]], np.insert(at, 9, 7.0)).faults
    )
    apart = judged(one, Q[[0, -1]], at[[0, -1]])
    assert {"way_position", "station_position"} <= set(apart.faults)
    beyond = Q + 7.0 * np.eye(6)[5]
    assert "beyond_limits" in judged(one, beyond, at).faults
    in_way = box([0.05] * 3, one.T[len(Q) // 2, :3, 3] - 0.1 * one.T[0, :3, 2])
    assert "depth" in judged(replace(one, world=World(solids=[in_way])), Q, at).faults
    assert judged(one, np.full_like(Q, np.nan), at).faults


def test_a_free_axis_goes_straight_however_its_frames_are_turned() -> None:
    one = problem("axis:panda:box:0:0")
    rng = np.random.default_rng(0)
    spun = replace(one, T=one.T @ axis._spins(rng, len(one.T)))
    at = rng.uniform(0, one.last, 50)
    position, turn = one.errors(one.wanted(at), spun.wanted(at))
    assert position.max() < 1e-12
    assert turn.max() < 1e-7


def test_moves_that_touch_or_end_elsewhere_are_seen() -> None:
    one = move("motion:box:0:0")
    straight = np.array([one.q_from, one.q_to])
    assert faults_of_move("panda", World(), straight, one.q_from, one.q_to) in ([], ["own_depth"])
    assert "ends" in faults_of_move("panda", World(), straight, one.q_from, one.q_to + 0.1)
    middle = judge_of("panda").kinematics
    _, p = middle.link(middle.place(straight.mean(axis=0)[None]), "panda_link7")
    there = World(solids=[box([0.05] * 3, p[0])])
    assert "depth" in faults_of_move("panda", there, straight, one.q_from, one.q_to)


@pytest.mark.parametrize("kind", ROOMS)
def test_a_room_has_tasks_that_are_clear_of_its_solids(kind: str) -> None:
    for seed in range(5):
        room = ROOMS[kind](np.random.default_rng(seed))
        assert len(room.tasks) >= 2
        for T in room.tasks:
            assert min(solid.distance(T[:3, 3]) for solid in room.solids) > 0.005


def test_what_breaks_is_called_wrong_and_a_case_is_the_same_each_time(
    followed: tuple[Problem, np.ndarray, np.ndarray],
) -> None:
    one, Q, at = followed
    again = problem(LINE)
    np.testing.assert_array_equal(one.T, again.T)

    class Path:
        status, message, ends, pieces, complete = "whole", "", (), [(0, len(Q))], False
        time, success = 0.0, True
        largest_step = float(np.abs(np.diff(Q, axis=0)).max())
        length = float(np.linalg.norm(np.diff(Q, axis=0), axis=1).sum())

    path = Path()
    path.q, path.at = Q, at  # type: ignore[attr-defined]
    assert not row_of(one, path)["wrong"]
    path.length *= 1.01  # type: ignore[misc]
    assert row_of(one, path)["faults"] == "said_length"


@pytest.mark.parametrize(
    ("row", "key"),
    [(free, "000-ur10"), (axis, "000-torso"), (gap, "000-panda"), (closed, "000-ur10")],
)
def test_a_row_of_paths_finds_motions_that_hold(row: ModuleType, key: str) -> None:
    trials = pd.DataFrame(row.run_job(row.jobs(1, 0)[key]))
    assert not trials.wrong.any()
    assert (trials.whole | ~trials.reference).mean() > 0.7
    assert all(line.measured for line in row.lines(trials))


def test_what_cannot_be_is_not_called_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(impossible, "SEARCH", 0.3)
    trials = pd.DataFrame(impossible.run_job(impossible.jobs(1, 0)["000-ur10"]))
    assert not trials.whole.any()
    assert not trials.wrong.any()
    assert trials.says_where.all()
    assert len(impossible.lines(trials)) == len(impossible.KINDS)


def test_moves_and_memory_and_lengths_are_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motion, "MOVES", 2)
    trials = pd.DataFrame(motion.run_job(motion.jobs(1, 0)["000-table_pick"]))
    assert not trials.wrong.any()
    assert trials.solved.any()
    assert motion.lines(trials)[-1].cases == "2"
    trials = pd.DataFrame(memory.run_job(memory.jobs(1, 0)["000-ur10"]))
    assert 0 < trials.grown[0] < memory.ASKED
    trials = pd.DataFrame(length.run_job(length.jobs(1, 0)["000-free-ur10"] | {"search": 1.0}))
    assert not trials.wrong.any()
    assert length.lines(trials)[0].failures == 0


def test_peers_are_judged_as_we_are() -> None:
    trials = pd.DataFrame(peers.run_job(peers.jobs(1, 0)["000-free-ur10"]))
    assert {"pdoik", "chained solves"} < set(trials.method)
    assert trials[trials.method == "pdoik"].whole.all()
    assert len(peers.lines(trials)) == len(trials)


def test_the_command_makes_its_table_and_goes_on_where_it_was(tmp_path: Path) -> None:
    text = tables_of("bench.ik.paths", "memory", 4, tmp_path / "paths", timeout=500)
    assert "| memory | 5,000 stations: growth of the process" in text


def test_a_row_or_a_case_that_does_not_exist_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(typer.BadParameter, match="no row nothing; there are free, axis"):
        paths.main(out=tmp_path, only=["nothing"])
    with pytest.raises(ValueError, match="no row nothing"):
        problem("nothing:0:0")
