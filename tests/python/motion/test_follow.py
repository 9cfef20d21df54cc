"""A Tracker on a planned path: it keeps to it, dodges what comes, waits, and comes back."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import pdoik

FloatArray = npt.NDArray[np.float64]

PERIOD = 0.01  # [s]
SPEED = 0.1  # of the tool [m/s]
CLEARANCE = 0.01  # [m]
DOWN = np.diag([1.0, -1.0, -1.0, 1.0])
READY = np.array([0.0, -0.4, 0.0, -2.2, 0.0, 1.8, 0.8])


def at(x: float, y: float, z: float) -> FloatArray:
    T = DOWN.copy()
    T[:3, 3] = x, y, z
    return T


@pytest.fixture(scope="module")
def robot() -> pdoik.Robot:
    return pdoik.Robot.builtin("panda")


@pytest.fixture(scope="module")
def line(robot: pdoik.Robot) -> pdoik.PathResult:
    """60 cm across the table."""
    path = pdoik.solve_path(robot, [at(0.5, -0.3, 0.3), at(0.5, 0.3, 0.3)], spacing=0.01)
    assert path.success, path.message
    return path


def tracker_of(robot: pdoik.Robot, **options: object) -> pdoik.Tracker:
    solver = pdoik.Solver(robot, pdoik.Options(clearance=CLEARANCE, **options))
    return pdoik.Tracker(solver, PERIOD, max_time=1.0, posture_weight=1e-2)


def ball(time: float) -> list[pdoik.Shape]:
    """Comes down onto the middle of the path, stays there, and goes up again."""
    height = np.interp(time, [0.0, 1.5, 4.0, 6.0], [0.75, 0.38, 0.38, 0.8])
    return [pdoik.Shape.sphere("ball", (0.5, 0.0, height), 0.06)]


def test_undisturbed_the_robot_is_on_the_path_all_the_time_and_at_its_end(
    robot: pdoik.Robot, line: pdoik.PathResult
) -> None:
    tracker = tracker_of(robot)
    tracker.reset(line.q[0])
    follower = pdoik.PathFollower(tracker, line.q, tool_speed=SPEED)
    assert follower.duration == pytest.approx(0.6 / SPEED, rel=1e-3)
    offsets, heights = [], []
    while not follower.done:
        step = follower.step(None)
        offsets.append(follower.offset)
        heights.append(robot.fk(step.q)[:3, 3] - [0.5, 0.0, 0.3])
    follower.step()
    assert max(offsets) < 2e-4
    assert np.abs(np.array(heights)[:, [0, 2]]).max() < 2e-4  # on the straight line
    assert len(offsets) == pytest.approx(follower.duration / PERIOD, abs=2)
    np.testing.assert_allclose(tracker.q, line.q[-1], atol=1e-3)


@pytest.mark.parametrize("max_offset", [0.02, 0.08])
def test_it_dodges_a_ball_while_the_path_waits_and_comes_back_in_the_configuration_planned(
    robot: pdoik.Robot, line: pdoik.PathResult, max_offset: float
) -> None:
    tracker = tracker_of(robot)
    tracker.reset(line.q[0])
    judge = pdoik.Solver(robot, pdoik.Options(clearance=CLEARANCE))
    follower = pdoik.PathFollower(tracker, line.q, tool_speed=SPEED, max_offset=max_offset)
    nearest, offsets, waits, k = np.inf, [], 0, 0
    while not follower.done:
        before, obstacles = follower.elapsed, ball(PERIOD * k)
        step = follower.step(obstacles)
        waits += follower.elapsed == before
        nearest = min(nearest, judge.judge(robot.fk(step.q), step.q, obstacles).clearance)
        offsets.append(follower.offset)
        assert np.abs(step.q - follower.q).max() < 0.6
        k += 1
        assert k < 3000, follower
    assert nearest > CLEARANCE - 1e-3
    assert max(offsets) > 0.01  # it had to go aside
    assert max(offsets) < max_offset + 0.05
    assert waits > 100 or max_offset > 0.05
    assert k * PERIOD > follower.duration + 0.5
    assert max(offsets[-50:]) < 1e-3
    np.testing.assert_allclose(step.q, line.q[-1], atol=5e-3)


def test_without_the_wait_the_same_ball_would_be_passed_farther_off_than_is_allowed(
    robot: pdoik.Robot, line: pdoik.PathResult
) -> None:
    """So that the wait is worth having."""
    reached = []
    for max_offset in (0.02, 10.0):
        tracker = tracker_of(robot)
        tracker.reset(line.q[0])
        follower = pdoik.PathFollower(tracker, line.q, tool_speed=SPEED, max_offset=max_offset)
        offsets = []
        for k in range(400):
            follower.step(ball(PERIOD * k))
            offsets.append(follower.offset)
        reached.append(max(offsets))
    assert reached[1] > reached[0] + 0.01


def test_a_joint_that_cannot_keep_up_slows_the_path(
    robot: pdoik.Robot, line: pdoik.PathResult
) -> None:
    tracker = tracker_of(robot)
    tracker.reset(line.q[0])
    follower = pdoik.PathFollower(tracker, line.q, tool_speed=100.0)
    rates = np.abs(np.diff(line.q, axis=0)) / np.diff(follower._time)[:, None]
    assert (rates <= robot.velocity + 1e-9).all()
    assert (rates / robot.velocity).max() == pytest.approx(1.0)


def test_with_a_tool_in_the_options_the_tool_is_on_the_path(robot: pdoik.Robot) -> None:
    tool = np.eye(4)
    tool[:3, 3] = 0.1, 0.0, 0.15
    path = pdoik.solve_path(
        robot, [at(0.5, -0.1, 0.3), at(0.5, 0.1, 0.3)], spacing=0.01, T_tip_tool=tool
    )
    assert path.success, path.message
    tracker = tracker_of(robot, T_tip_tool=tool)
    tracker.reset(path.q[0])
    follower = pdoik.PathFollower(tracker, path.q, tool_speed=SPEED)
    while not follower.done:
        step = follower.step()
        assert np.abs((robot.fk(step.q) @ tool)[[0, 2], 3] - [0.5, 0.3]).max() < 2e-4
    assert follower.duration == pytest.approx(0.2 / SPEED, rel=1e-3)


def test_two_tips_are_followed_both() -> None:
    left, right = "left_elbow_link", "right_elbow_link"
    h1 = pdoik.Robot.builtin("h1", "pelvis", [left, right])
    q = np.zeros(h1.dof) + np.linspace(0.0, 0.2, 20)[:, None] * (
        np.array(["shoulder_pitch" in name for name in h1.joint_names])
    )
    tracker = pdoik.Tracker(pdoik.Solver(h1), PERIOD, max_time=1.0)
    tracker.reset(q[0])
    follower = pdoik.PathFollower(tracker, q, tool_speed=SPEED)
    while not follower.done:
        step = follower.step()
        assert follower.offset < 1e-3
    np.testing.assert_allclose(step.q, q[-1], atol=2e-2)


def test_a_trajectory_is_followed_at_its_own_times(
    robot: pdoik.Robot, line: pdoik.PathResult
) -> None:
    pytest.importorskip("scipy", reason="the extra timing is not installed")
    timed = pdoik.time_path(robot, line.q, max_acceleration=3.0, at=line.at)
    tracker = tracker_of(robot)
    tracker.reset(line.q[0])
    follower = pdoik.PathFollower(tracker, timed)
    assert follower.duration == timed.duration
    while not follower.done:
        np.testing.assert_allclose(follower.q, timed.sample(follower.elapsed)[0], atol=2e-3)
        follower.step()
        assert follower.offset < 5e-3
    with pytest.raises(ValueError, match="its own times"):
        pdoik.PathFollower(tracker, timed, tool_speed=0.1)
    other = pdoik.Tracker(pdoik.Solver(pdoik.Robot.builtin("ur10")), PERIOD)
    with pytest.raises(ValueError, match="robot has joints shoulder_pan_joint"):
        pdoik.PathFollower(other, timed)


@pytest.mark.parametrize(
    ("path", "settings", "words"),
    [
        (np.zeros((1, 7)), {"tool_speed": 0.1}, "2 rows or more"),
        (np.zeros((5, 6)), {"tool_speed": 0.1}, r"expected \(m, 7\)"),
        (np.full((5, 7), np.nan), {"tool_speed": 0.1}, "NaN"),
        (np.zeros((5, 7)), {}, "tool_speed is None"),
        (np.zeros((5, 7)), {"tool_speed": 0.0}, "tool_speed is 0"),
        (np.zeros((5, 7)), {"tool_speed": 0.1, "max_offset": np.nan}, "max_offset is nan"),
    ],
)
def test_what_is_no_path_is_refused_by_name(
    robot: pdoik.Robot, path: FloatArray, settings: dict[str, float], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        pdoik.PathFollower(tracker_of(robot), path, **settings)
