"""The rows of bench.ik.goals: their judges see what is wrong, and the command makes its table."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="needs the extra bench")
pytest.importorskip("dask.distributed", reason="needs the extra bench")

import pandas as pd
import typer

import pdoik
from bench.ik.goals import __main__ as goals
from bench.ik.goals import derivatives, grasps, hands, peers, regions, solutions, world
from bench.ik.goals.peers.body import Body, by_capsules
from bench.ik.goals.peers.judge import Judge
from bench_command import tables_of


def test_each_kind_of_region_is_met_by_what_it_allows_and_by_nothing_else() -> None:
    T = np.eye(4)
    T[:3, :3] = [[0, 1, 0], [1, 0, 0], [0, 0, -1]]
    T[:3, 3] = 0.4, 0.1, 0.3

    def moved(
        shift: tuple[float, float, float], turn: float = 0.0, tilt: float = 0.0
    ) -> np.ndarray:
        step = np.eye(4)
        step[:3, :3] = world.Rotation.from_euler("zx", [turn, tilt]).as_matrix()
        step[:3, 3] = shift
        return T @ step

    assert regions.is_met("free axis", T, moved((0, 0, 0), turn=2.0))
    assert not regions.is_met("free axis", T, moved((0, 0, 0), tilt=1e-3))
    assert regions.is_met("tilt of 5 degrees", T, moved((0, 0, 0), 1.0, 0.99 * regions.TILT))
    assert not regions.is_met("tilt of 5 degrees", T, moved((0, 0, 0), 1.0, 1.01 * regions.TILT))
    assert regions.is_met("line", T, moved((0.29, 0, 0)))
    assert not regions.is_met("line", T, moved((0.31, 0, 0)))
    assert not regions.is_met("line", T, moved((0, 1e-4, 0)))
    assert regions.is_met("plane", T, moved((3.0, -2.0, 0)))
    assert not regions.is_met("plane", T, moved((0, 0, 1e-4)))
    assert regions.is_met("look", T, moved((0, 0, 0.1), turn=1.0))
    assert not regions.is_met("look", T, moved((0.1, 0, 0)))
    assert not regions.is_met("look", T, moved((0, 0, 0.5)))  # it is behind


def test_what_a_row_measures_is_what_a_user_gets(tmp_path: Path) -> None:
    rows = derivatives.run_job({"index": 0, "seed": 0, "robot": "ur10"})
    assert len(rows) == derivatives.TARGETS
    assert not any(row["wrong"] for row in rows)
    rows = hands.run_job({"index": 0, "seed": 0, "robot": "H1"})
    assert sum(row["solved"] for row in rows) >= 0.95 * len(rows)
    assert not any(row["wrong"] for row in rows)
    assert max(row["idle"] for row in rows) == 0.0


def test_a_grip_that_slips_is_seen() -> None:
    robot, urdf, (one, other), _ = hands.humanoid()
    kinematics = world.Kinematics(urdf, robot.joint_names)
    q = robot.mid_configuration()
    kinematics.place(q)
    T, held = kinematics.link(one).copy(), kinematics.link(other).copy()
    grip, zero = np.linalg.inv(T) @ held, np.zeros(3)
    said = kinematics, q, one, other
    assert not hands.is_wrong(*said, grip, T, zero, zero)
    slipped = grip.copy()
    slipped[0, 3] += 3e-6
    assert hands.is_wrong(*said, slipped, T, zero, zero)
    aside = T.copy()
    aside[:3, 3] += 1e-3
    assert hands.is_wrong(*said, grip, aside, zero, zero)


@pytest.mark.skipif(find_spec("eaik") is None, reason="needs eaik")
def test_eaik_s_solutions_are_those_that_pinocchio_confirms() -> None:
    robot = pdoik.Robot.builtin("ur10")
    kinematics = world.Kinematics(world.shipped("ur10"), robot.joint_names)
    analytic = solutions.Analytic(robot, kinematics)
    q = np.array([0.3, -1.2, 1.5, 0.4, 0.7, -0.5])
    kinematics.place(q)
    T = kinematics.link(robot.tip_links[0]).copy()
    found = analytic(T)
    assert len(found) == 8
    assert solutions._among(q, found)
    for each in found:
        kinematics.place(each)
        np.testing.assert_allclose(kinematics.link(robot.tip_links[0]), T, atol=1e-9)


def test_the_command_makes_its_table_and_goes_on_where_it_was(tmp_path: Path) -> None:
    text = tables_of("bench.ik.goals", "derivatives", 2, tmp_path / "goals")
    assert "| derivatives | panda: dq_dT" in text


def test_a_row_that_does_not_exist_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(typer.BadParameter, match="no row nothing; there are grasps, solutions"):
        goals.main(out=tmp_path, only=["nothing"])


@pytest.mark.parametrize(("name", "module"), [("mink", "mink"), ("Drake", "pydrake")])
def test_a_peer_solves_what_its_row_asks(
    name: str, module: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip(module, reason="needs the extra peers")
    monkeypatch.setattr(peers, "SOLVERS", {name: peers.SOLVERS[name]})
    rows = peers.run_job(peers.jobs(1, 0)["000-regions"] | {"count": 2})
    assert len(rows) == 2 * len(regions.KINDS[1:])
    assert not any(row["wrong"] for row in rows)
    assert sum(row["solved"] for row in rows) >= 0.8 * len(rows)


def test_a_peer_that_is_missing_is_named_and_the_rest_is_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def missing(body: Body) -> peers.Peer:
        raise ImportError("no such package")

    monkeypatch.setattr(peers, "SOLVERS", {"pdoik": peers.SOLVERS["pdoik"], "other": missing})
    rows = peers.run_job(peers.jobs(1, 0)["000-regions"] | {"count": 1})
    assert {row["solver"] for row in rows} == {"pdoik"}
    assert all(row["solved"] and not row["wrong"] for row in rows)
    lines = peers.lines(pd.DataFrame(rows))
    assert lines[0].what == "other is not installed"
    assert len(lines) == 1 + len(regions.KINDS[1:])


def test_the_judge_of_peers_sees_what_touches() -> None:
    robot = by_capsules("panda")
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.8, 0.8, (20, 3))
    text = world.shipped("panda").read_text()
    tips = tuple(robot.tip_links)
    judge = Judge(Body(robot=robot, urdf=text, tips=tips, self_collision=True, points=points))
    solver = pdoik.Solver(robot, pdoik.Options(self_collision=True))
    touching = 0
    for _ in range(20):
        q = world.random_in(robot, rng)
        said = solver.judge(robot.fk(q), q, obstacles=points)
        least = min(said.clearance, said.self_distance)
        assert judge.holds(q) == (least >= 0)
        assert judge.clearance() == pytest.approx(least, abs=1e-9)
        touching += least < 0
    assert 0 < touching < 20
    assert not judge.holds(robot.upper + 1e-3)


def test_grasps_about_one_object_are_poses_that_face_it() -> None:
    centre = np.array([0.5, 0.1, 0.4])
    poses = grasps._about(centre, np.random.default_rng(0))
    off = poses[:, :3, 3] + 0.1 * poses[:, :3, 2] - centre
    assert np.linalg.norm(off, axis=1).max() < 0.1
