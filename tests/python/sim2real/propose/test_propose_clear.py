"""Motions clear of obstacles and of the robot itself, judged once more by coal on Pinocchio."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin
import pytest

import pdoik
from pdoik.sim2real.propose import (
    STEP,
    Clear,
    Frame,
    Limits,
    Proposal,
    Wishes,
    motion_of,
    path_of,
    propose,
    random_recipe,
)
from pdoik.sim2real.propose import Path as Motion
from propose_reports import friction, write_report, write_study
from studies import JOINTS

RADIUS = 0.05  # of the points that stand in the way [m]
GAP = 0.01  # wanted [m]


class Judge:
    """A robot's capsules where Pinocchio has its links, and their distances by coal."""

    def __init__(self, robot: pdoik.Robot, urdf: Path | str) -> None:
        text = urdf.read_text() if isinstance(urdf, Path) else urdf
        self.model = pin.buildModelFromXML(text)
        self.data = self.model.createData()
        self.capsules = [
            (link, np.array(a), np.array(b), radius)
            for link, a, b, radius, *_ in robot.occupancy.capsules
        ]
        self.free = {frozenset(pair) for pair in robot.ignored_pairs}
        self.names = list(robot.joint_names)

    def placed(self, q: np.ndarray) -> list[tuple[str, coal.CollisionGeometry, coal.Transform3s]]:
        whole = pin.neutral(self.model)
        for name, value in zip(self.names, q, strict=True):
            whole[self.model.joints[self.model.getJointId(name)].idx_q] = value
        pin.framesForwardKinematics(self.model, self.data, whole)
        found = []
        for link, a, b, radius in self.capsules:
            T = self.data.oMf[self.model.getFrameId(link)]
            first, last = T.act(a), T.act(b)
            length = float(np.linalg.norm(last - first))
            z = (last - first) / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
            R = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), z).matrix()
            pose = coal.Transform3s(R, 0.5 * (first + last))
            found.append((link, coal.Capsule(radius, length), pose))
        return found

    def to_points(self, q: np.ndarray, points: np.ndarray) -> float:
        """Least distance of a capsule to balls."""
        return min(
            _distance(shape, pose, coal.Sphere(RADIUS), coal.Transform3s(np.eye(3), point))
            for _, shape, pose in self.placed(q)
            for point in points
        )

    def to_itself(self, q: np.ndarray) -> float:
        """Least distance of capsules of links that may not touch."""
        return min(
            _distance(one, here, other, there)
            for (a, one, here), (b, other, there) in combinations(self.placed(q), 2)
            if a != b and frozenset((a, b)) not in self.free
        )


def _distance(one, here, other, there) -> float:
    result = coal.DistanceResult()
    return float(coal.distance(one, here, other, there, coal.DistanceRequest(), result))


@pytest.fixture(scope="module")
def panda() -> pdoik.Robot:
    return pdoik.Robot.builtin("panda")


START = np.array([0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
POINTS = np.array([[0.45, 0.25, 0.45], [0.55, -0.25, 0.35], [0.1, 0.5, 0.6]])


@pytest.fixture(scope="module")
def clear(panda: pdoik.Robot) -> Clear:
    cloud = np.column_stack([POINTS, np.full(len(POINTS), RADIUS)])
    options = pdoik.Options(clearance=GAP, base_collision=False)
    return Clear(panda, panda.joint_names, cloud, options)


def swing(robot: pdoik.Robot, seed: int) -> Motion:
    """One of the search's own motions of the whole arm."""
    limits = Limits(
        lower=robot.lower,
        upper=robot.upper,
        speed=robot.velocity,
        acceleration=np.full(robot.dof, 5.0),
        torque=robot.effort,
    )
    within = limits.within(0.4, acceleration=3.0)
    frame = Frame(limits=within, start=START, duration=8.0, stuck=np.zeros(robot.dof))
    return motion_of(random_recipe(np.random.default_rng(seed)), frame)


def test_the_study_has_the_start_clear(clear: Clear) -> None:
    assert clear.keeps_off_itself
    assert not clear.at(START).short()


@pytest.mark.parametrize("seed", [3, 5])
def test_a_motion_is_led_around_or_shrunk_until_coal_finds_it_clear(
    seed: int, clear: Clear, panda: pdoik.Robot
) -> None:
    urdf = Path(pdoik.__file__).parent / "robots" / "panda.urdf"
    judge, before = Judge(panda, urdf), swing(panda, seed)
    path = clear.fitted(before, START)
    rows = path.q[:: round(0.2 / STEP)]
    assert min(judge.to_points(q, POINTS) for q in rows) > 0.0
    assert min(judge.to_itself(q) for q in rows[::4]) > 0.0
    assert np.allclose(path.q[[0, -1]], START, atol=1e-9)
    assert np.ptp(path.q, axis=0).max() > 0.0


def test_some_of_these_motions_were_not_clear_before(clear: Clear, panda: pdoik.Robot) -> None:
    urdf = Path(pdoik.__file__).parent / "robots" / "panda.urdf"
    judge = Judge(panda, urdf)
    nearest = [
        min(judge.to_points(q, POINTS) for q in swing(panda, seed).q[::20]) for seed in (3, 5)
    ]
    assert min(nearest) < 0.0


def test_a_tracker_leads_a_straight_way_around_a_point() -> None:
    """Of two joints that swing through a ball, one of which may give way."""
    robot = pdoik.Robot.builtin("panda")
    q = np.tile(START, (500, 1))
    ramp = np.clip((np.arange(500) - 100) / 300, 0.0, 1.0)
    q[:, 0] += 0.9 * np.sin(np.pi * ramp) ** 2
    path = path_of(q)
    tip = robot.fk(path.q[250], robot.tip_links[0])[:3, 3]
    away = robot.fk(START, robot.tip_links[0])[:3, 3]
    ball = tip + 0.1 * (tip - away) / np.linalg.norm(tip - away)
    cloud = np.array([[*ball, RADIUS]])
    clear = Clear(robot, robot.joint_names, cloud, pdoik.Options(clearance=GAP))
    assert clear.along(path, 0.02).clearance < GAP
    led = clear.fitted(path, START)
    verdict = clear.along(led, 0.005)
    assert not verdict.short()
    judge = Judge(robot, Path(pdoik.__file__).parent / "robots" / "panda.urdf")
    assert min(judge.to_points(row, ball[None]) for row in led.q[::10]) > 0.0


@pytest.fixture(scope="module")
def among_points(tmp_path_factory: pytest.TempPathFactory) -> tuple[pdoik.Robot, str, Proposal]:
    """A whole proposal for an arm with hulls, a ball over its elbow."""
    folder = tmp_path_factory.mktemp("among")
    report = write_report(folder, write_study(folder), friction("presliding_hysteresis"))
    made: dict[str, object] = {}

    def clear(joints: tuple[str, ...], text: str, tip: str | None) -> Clear:
        robot = pdoik.Robot.from_urdf(text)
        robot.occupancy = pdoik.Occupancy(
            capsules=[
                ("upper", (0.0, 0.0, 0.0), (0.35, 0.0, 0.0), 0.05),
                ("fore", (0.05, 0.0, 0.0), (0.3, 0.0, 0.0), 0.04),
            ]
        )
        made.update(robot=robot, text=text)
        cloud = np.column_stack([BALLS, np.full(len(BALLS), RADIUS)])
        return Clear(robot, joints, cloud, pdoik.Options(clearance=GAP, base_collision=False))

    wishes = Wishes(seconds=10.0, effort=25, search=15.0, acceleration=6.0, clear=clear)
    proposal = propose(report, wishes)
    return made["robot"], str(made["text"]), proposal  # type: ignore[return-value]


BALLS = np.array([[0.75, 0.0, 0.25], [0.55, 0.0, -0.55]])


def test_a_whole_proposal_is_clear_by_coal(
    among_points: tuple[pdoik.Robot, str, Proposal],
) -> None:
    robot, text, proposal = among_points
    judge = Judge(robot, text)
    order = [JOINTS.index(name) for name in robot.joint_names]
    nearest = min(judge.to_points(q[order], BALLS) for q in proposal.q)
    assert nearest > 0.9 * GAP
    assert proposal.verdict is not None
    assert proposal.verdict.clearance == pytest.approx(nearest, abs=2e-3)
    assert np.ptp(proposal.q, axis=0).max() > 0.02


def test_hulls_are_asked_for(tmp_path: Path) -> None:
    robot = pdoik.Robot.builtin("panda")
    robot.occupancy = pdoik.Occupancy()
    with pytest.raises(ValueError, match="no hulls"):
        Clear(robot, robot.joint_names)
    with pytest.raises(ValueError, match="no joint elbow"):
        Clear(pdoik.Robot.builtin("panda"), ("elbow",))


def test_a_start_within_an_obstacle_is_refused(tmp_path: Path) -> None:
    report = write_report(tmp_path, write_study(tmp_path), friction("presliding_hysteresis"))

    def clear(joints: tuple[str, ...], text: str, tip: str | None) -> Clear:
        robot = pdoik.Robot.from_urdf(text)
        robot.occupancy = pdoik.Occupancy(
            capsules=[("upper", (0.0, 0.0, 0.0), (0.35, 0.0, 0.0), 0.05)]
        )
        there = np.array([[0.2, 0.0, 0.0, 0.2]])
        return Clear(robot, joints, there, pdoik.Options(base_collision=False))

    with pytest.raises(ValueError, match="the start is not clear"):
        propose(report, replace(Wishes(), clear=clear))
