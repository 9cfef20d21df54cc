"""The judge of the problem sets on cases that one can see through."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("coal")
pytest.importorskip("pinocchio")

import trimesh

from bench.ik.problems.judge import Judge
from bench.ik.problems.robots import RobotFiles, robot_files
from bench.ik.problems.sample_ik import configurations
from bench.ik.problems.solids import Solid, box, mesh, pose
from problem_sets import READY

Q = np.array(READY)


@pytest.fixture(scope="module", params=["visual", "collision"])
def judge(request: pytest.FixtureRequest) -> Judge:
    return Judge(robot_files("panda"), request.param)


def at_hand(judge: Judge, ahead: float) -> np.ndarray:
    """So far ahead of the fingers' tips, which end about 9 mm after the tool's frame."""
    return judge.fk(Q, "panda_hand_tcp") @ pose((0, 0, ahead))


def test_nothing_around_is_clear(judge: Judge) -> None:
    assert judge.touching(Q, []) is None


@pytest.mark.parametrize("kind", ["box", "sphere", "cylinder", "capsule", "mesh"])
def test_a_solid_at_the_fingers_touches_and_farther_away_does_not(judge: Judge, kind: str) -> None:
    def solid(T: np.ndarray) -> Solid:
        if kind == "mesh":
            return mesh("thing", trimesh.creation.box((0.1, 0.1, 0.1)), T)
        sizes = {"box": (0.1, 0.1, 0.1), "sphere": (0.05,), "cylinder": (0.05, 0.1)}
        return Solid("thing", kind, sizes.get(kind, (0.05, 0.0001)), T)

    touched = judge.touching(Q, [solid(at_hand(judge, 0.03))])
    assert touched is not None
    assert touched.startswith("panda_")
    assert touched.endswith("finger and thing")
    assert judge.touching(Q, [solid(at_hand(judge, 0.09))]) is None


def test_what_is_wholly_inside_a_link_touches(judge: Judge) -> None:
    inside = judge.fk(Q, "panda_link4") @ pose((-0.08, 0.03, 0))
    crumb = Solid("crumb", "sphere", (1e-3,), inside)
    room = mesh("room", trimesh.creation.icosphere(3, 3.0), np.eye(4))
    assert judge.touching(Q, [crumb]) == "panda_link4 and crumb"
    assert judge.touching(Q, [room]) is not None  # a closed surface round the robot is a solid


def test_a_half_space_is_solid_below_its_plane(judge: Judge) -> None:
    lowest = min(t[..., 2].min() for name, t in judge.link_surfaces(Q) if name != "panda_link0")
    foot = {("panda_link0", "floor")}
    floor = Solid("floor", "half_space", (), pose((0, 0, lowest + 0.002)))
    assert judge.touching(Q, [floor], foot) is not None
    floor = Solid("floor", "half_space", (), pose((0, 0, lowest - 0.002)))
    assert judge.touching(Q, [floor], foot) is None


def test_only_the_pair_that_is_allowed_may_touch(judge: Judge) -> None:
    wall = box("wall", (0.3, 0.3, 0.3), at_hand(judge, 0.1))  # over the fingers and the hand
    fingers = {("panda_leftfinger", "wall"), ("panda_rightfinger", "wall")}
    assert judge.touching(Q, [wall], fingers) == "panda_hand and wall"
    assert judge.touching(Q, [wall], fingers | {("panda_hand", "wall")}) is None
    other = box("other", (0.3, 0.3, 0.3), at_hand(judge, 0.1))
    assert judge.touching(Q, [other], fingers) is not None


def test_an_arm_folded_into_itself_touches_itself(judge: Judge) -> None:
    folded = np.array([0.0, 1.76, 0.0, -3.07, 0.0, 0.5, 0.0])
    assert "and" in (judge.touches_itself(folded) or "")
    assert judge.touches_itself(Q) is None


def test_misses_says_how_far_and_which_limit(judge: Judge) -> None:
    target = {"panda_hand_tcp": judge.fk(Q, "panda_hand_tcp")}
    assert judge.misses(Q, target, 1e-6, 1e-6) is None
    nudged = np.array([1e-3, *READY[1:]])
    assert "panda_hand_tcp misses by" in judge.misses(nudged, target, 1e-6, 1e-6)
    assert "panda_joint4 is 0.1" in judge.misses(np.where(Q[3] == Q, 0.03, Q), target, 9, 9)


def test_configurations_meet_their_target_within_limits(
    judge: Judge, rng: np.random.Generator
) -> None:
    target = {"panda_hand_tcp": judge.fk(Q, "panda_hand_tcp")}
    found = list(configurations(judge, target, rng, 20))
    assert len(found) >= 3
    for q in found:
        assert judge.misses(q, target, 1e-7, 1e-7) is None


def test_the_centre_of_mass_is_that_of_all_links(tmp_path: Path) -> None:
    """The root's, too, which stands still in its own frame and not in a foot's."""
    mass = (
        '<inertial><mass value="{}"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    )
    urdf = tmp_path / "seesaw.urdf"
    urdf.write_text(
        f'<robot name="seesaw"><link name="root">{mass.format(9)}</link>'
        f'<link name="end">{mass.format(1)}</link>'
        '<joint name="j" type="revolute"><parent link="root"/><child link="end"/>'
        '<origin xyz="1 0 0"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
    )
    files = RobotFiles(name="seesaw", urdf=urdf, srdf=None, package_dirs=(), tips=("end",))
    square = 0.01 * np.array([[1, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0.0]])
    off = Judge(files).off_balance(np.zeros(1), {"root": square})
    assert off == pytest.approx(0.1 - 0.01)
    from_end = replace(files, base="end")  # the foot is the other link
    off = Judge(from_end).off_balance(np.zeros(1), {"end": square})
    assert off == pytest.approx(0.9 - 0.01)
