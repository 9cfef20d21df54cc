"""Answers are off themselves, as MuJoCo confirms; pairs that may touch."""

import re
from pathlib import Path

import numpy as np
import pytest

import pdoik
from conftest import ROBOTS
from samples import random_configuration
from trees import H1_XML, LEFT, PATIENT, TIPS, by_name, confirm_limits, crouch


@pytest.fixture(scope="module")
def h1() -> pdoik.Robot:
    return pdoik.Robot.builtin("h1")


def joined(robot: pdoik.Robot) -> set[frozenset[str]]:
    pairs = re.findall(r'<parent link="(\w+)"/>\s*<child link="(\w+)"/>', H1_XML)
    assert len(pairs) == len(robot.link_names) - 1
    return {frozenset(pair) for pair in [*pairs, *robot.ignored_pairs]}


def test_answers_off_themselves_are_so_in_mujoco(h1: pdoik.Robot, rng: np.random.Generator) -> None:
    mujoco = pytest.importorskip("mujoco", reason="needs the Python package mujoco")
    from bench.humanoid.world.model import build_world
    from bench.humanoid.world.robot import FREE

    world = build_world(FREE)
    model, order = world.model, pdoik.Robot.builtin("h1", base_link=LEFT).joint_names
    geoms = {i: model.body(model.geom_bodyid[i]).name for i in world.robot_geoms}
    free = joined(h1)
    pairs = [
        (i, j)
        for i, one in geoms.items()
        for j, two in geoms.items()
        if i < j and one != two and frozenset((one, two)) not in free
    ]
    assert len(pairs) > 300

    def distance(q: np.ndarray) -> float:
        positions = by_name(h1, q)
        data = world.standing_data(np.array([positions[name] for name in order]))
        return min(mujoco.mj_geomDistance(model, data, i, j, 1.0, None) for i, j in pairs)

    careful = pdoik.Solver(
        h1, pdoik.Options(goal="position", **{**PATIENT, "self_collision": True})
    )
    careless = pdoik.Solver(h1, pdoik.Options(goal="position", **PATIENT))
    arms = TIPS[2:]
    solved, least = 0, {careful: np.inf, careless: np.inf}
    for _ in range(30):
        q = random_configuration(h1, rng)
        goals = {tip: h1.fk(q, tip) for tip in arms}
        for solver in least:
            result = solver.solve(goals, q0=random_configuration(h1, rng))
            confirm_limits(h1, result)
            if not result.success:
                continue
            gap = distance(result.q)
            least[solver] = min(least[solver], gap)
            if solver is careful:
                solved += 1
                assert gap >= -1e-6
                assert result.self_distance <= gap + 1e-6  # hulls hold the shapes
    assert solved >= 10
    assert least[careless] < 0.0  # so it does matter


def test_ignored_pairs_may_touch(h1: pdoik.Robot) -> None:
    robot = pdoik.Robot.builtin("h1")
    q = crouch(robot)
    goals = {LEFT: robot.fk(q, LEFT)}
    options = pdoik.Options(self_collision=True)
    assert pdoik.Solver(robot, options).judge(goals, q).success
    robot.ignored_pairs = []
    result = pdoik.Solver(robot, options).judge(goals, q)
    assert not result.success
    assert result.self_distance < 0.0
    assert re.fullmatch(
        r"clearance of \w+ \(capsule \d+\) to \w+ \(capsule \d+\)", result.worst_constraint
    )
    for pair in pdoik.pairs_touching_at(robot, q):
        assert frozenset(pair) in joined(h1)


def test_an_srdf_s_pairs_are_read_and_kept(tmp_path: Path) -> None:
    pairs = [("left_hip_yaw_link", "left_hip_pitch_link"), ("torso_link", "left_elbow_link")]
    lines = [f'<disable_collisions link1="{a}" link2="{b}" reason="Never"/>' for a, b in pairs]
    text = f'<?xml version="1.0"?><robot name="h1">{"".join(lines)}</robot>'
    path = tmp_path / "h1.srdf"
    path.write_text(text)
    assert pdoik.load_srdf_pairs(path) == pdoik.load_srdf_pairs(text) == pairs
    robot = pdoik.Robot.builtin("h1")
    robot.ignored_pairs = pdoik.load_srdf_pairs(path)
    assert robot.ignored_pairs == pairs
    with pytest.raises(ValueError, match="no_link"):
        robot.ignored_pairs = [("torso_link", "no_link")]
    assert robot.ignored_pairs == pairs
    path.write_text(text.replace('link2="left_elbow_link"', ""))
    with pytest.raises(pdoik.LoadError, match=r"(?s)h1\.srdf.*link2"):
        pdoik.load_srdf_pairs(path)
    with pytest.raises(pdoik.LoadError, match=r"none\.srdf"):
        pdoik.load_srdf_pairs(tmp_path / "none.srdf")
    shipped = pdoik.load_srdf_pairs(ROBOTS / "h1.srdf")
    assert {frozenset(p) for p in shipped} == {
        frozenset(p) for p in pdoik.Robot.builtin("h1").ignored_pairs
    }


def test_pairs_that_always_touch_are_found_and_no_others() -> None:
    rows = [pdoik.DhRow(a=0.1, lower=-0.1, upper=0.1) for _ in range(4)]
    robot = pdoik.Robot.from_dh(rows)
    robot.occupancy = pdoik.Occupancy(
        spheres=[("link1", (0, 0, 0), 0.12), ("link3", (0, 0, 0), 0.12), ("tool", (0, 0, 0), 0.01)]
    )
    # 1 and 3 are 0.2 m apart and 0.24 m wide; the tool, which is joined to link4, is off both.
    assert pdoik.pairs_always_touching(robot, 200) == [("link1", "link3")]
    assert pdoik.pairs_touching_at(robot, np.zeros(4)) == [("link1", "link3")]
    for arguments, message in [
        ({"samples": 0}, "samples is 0"),
        ({"share": 0.0}, "share is 0"),
        ({"share": 1.5}, "share is 1.5"),
    ]:
        with pytest.raises(ValueError, match=message):
            pdoik.pairs_always_touching(robot, **arguments)


def test_it_is_on_where_pairs_and_close_hulls_are_known() -> None:
    robot = pdoik.Robot.builtin("panda")
    unset, on, off = (pdoik.Options(self_collision=word) for word in (None, True, False))
    assert unset.keeps_off_itself(robot)
    assert not off.keeps_off_itself(robot)
    assert not pdoik.Options(method="paper").keeps_off_itself(robot)
    assert pdoik.Options(method="paper", self_collision=True).keeps_off_itself(robot)
    pairs, hulls = robot.ignored_pairs, robot.occupancy
    robot.ignored_pairs = []
    assert not unset.keeps_off_itself(robot)
    assert on.keeps_off_itself(robot)
    robot.ignored_pairs = pairs
    robot.occupancy = pdoik.Occupancy(spheres=hulls.spheres, spheroids=hulls.spheroids)
    assert not unset.keeps_off_itself(robot)


def test_solves_keep_a_shipped_arm_off_itself_unless_told_otherwise(
    rng: np.random.Generator,
) -> None:
    robot = pdoik.Robot.builtin("ur10")
    touching = 0
    for _ in range(40):
        q = random_configuration(robot, rng)
        T = robot.fk(q)
        free = pdoik.Solver(robot, pdoik.Options(self_collision=False)).judge(T, q)
        kept = pdoik.Solver(robot).judge(T, q)
        assert free.success
        assert kept.success == (kept.self_distance >= -1e-6)
        ignored = {frozenset(pair) for pair in robot.ignored_pairs}
        meet = {frozenset(pair) for pair in pdoik.pairs_touching_at(robot, q)} - ignored
        assert kept.success == (not meet)
        touching += not kept.success
        answer = pdoik.Solver(robot, pdoik.Options(max_time=0.1)).solve(T)
        assert not answer.success or answer.self_distance >= -1e-6
    assert touching > 3


def test_an_srdf_of_a_larger_robot_serves_a_part_of_it(tmp_path: Path) -> None:
    pairs = [("panda_link5", "panda_link7"), ("panda_link7", "panda_finger")]
    lines = "".join(f'<disable_collisions link1="{a}" link2="{b}"/>' for a, b in pairs)
    path = tmp_path / "panda.srdf"
    path.write_text(f'<robot name="panda">{lines}</robot>')
    urdf = ROBOTS / "panda.urdf"
    robot = pdoik.Robot.from_urdf(urdf, srdf=path)
    assert robot.ignored_pairs == pairs[:1]
    assert pdoik.load_srdf_pairs(path, robot) == pairs[:1]
    assert pdoik.load_srdf_pairs(path) == pairs
    assert pdoik.Robot.from_urdf(urdf).ignored_pairs == []
    with pytest.raises(pdoik.LoadError, match=r"none\.srdf"):
        pdoik.Robot.from_urdf(urdf, srdf=tmp_path / "none.srdf")
