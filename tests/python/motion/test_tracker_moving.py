"""A Tracker that is told how fast obstacles move is clear of where they will be."""

from __future__ import annotations

import numpy as np
import pytest

import pdoik

PERIOD, CLEARANCE, SPEED = 0.01, 0.02, 0.4  # [s], [m], [m/s]
WAY = SPEED * PERIOD


def capsules(robot: pdoik.Robot, q: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """Ends and radii in the base frame."""
    made = []
    for each in robot.occupancy.capsules:
        link, a, b, radius, _ = each
        T = robot.fk(q, link)
        a, b = (T[:3, :3] @ np.array(end) + T[:3, 3] for end in (a, b))
        made.append((a, b, radius))
    return made


def clearance(robot: pdoik.Robot, q: np.ndarray, balls: np.ndarray) -> float:
    """Least distance of balls from the capsules, by NumPy."""
    least = np.inf
    for a, b, radius in capsules(robot, q):
        along = b - a
        t = ((balls[:, :3] - a) @ along / max(float(along @ along), 1e-300)).clip(0.0, 1.0)
        off = np.linalg.norm(balls[:, :3] - a - t[:, None] * along, axis=1)
        least = min(least, float((off - balls[:, 3]).min()) - radius)
    return least


def run(*, told: bool, as_shape: bool) -> tuple[float, float]:
    """Least clearance after steps, and as the next ones find it."""
    robot = pdoik.Robot.builtin("panda")
    options = pdoik.Options(clearance=CLEARANCE, base_collision=False, exact_contact=False)
    tracker = pdoik.Tracker(pdoik.Solver(robot, options), PERIOD, max_time=1.0)
    q = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
    tracker.reset(q)
    T = robot.fk(q)
    after, found = np.inf, np.inf
    for k in range(100):
        ball = np.array([[0.3, -0.30 + WAY * k, 0.62, 0.05]])
        given = [pdoik.Shape.sphere("ball", ball[0, :3], ball[0, 3])] if as_shape else ball
        velocity = np.array([0.0, SPEED, 0.0]) if told else None
        step = tracker.step(T, given, obstacle_velocity=velocity)
        later = ball + np.array([0.0, WAY, 0.0, 0.0])
        after = min(after, clearance(robot, step.q, ball))
        found = min(found, clearance(robot, step.q, later))
    return after, found


@pytest.mark.parametrize("as_shape", [False, True])
def test_the_next_step_finds_what_was_asked_where_speeds_are_told(as_shape: bool) -> None:
    after, found = run(told=False, as_shape=as_shape)
    assert after > CLEARANCE - 2e-4
    assert found < CLEARANCE - 0.5 * WAY  # it comes nearer before the next step looks
    after, found = run(told=True, as_shape=as_shape)
    assert found > CLEARANCE - 2e-4
    assert after > CLEARANCE - 2e-4


def test_velocities_that_make_no_sense_are_refused_and_steps_hold() -> None:
    robot = pdoik.Robot.builtin("panda")
    tracker = pdoik.Tracker(pdoik.Solver(robot, pdoik.Options()), PERIOD, max_time=1.0)
    T = robot.fk(tracker.q)
    points = np.array([[0.8, 0.0, 0.5], [0.8, 0.1, 0.5]])
    for velocity in (np.zeros((3, 3)), [np.nan, 0.0, 0.0], np.zeros(2), "fast"):
        step = tracker.step(T, points, obstacle_velocity=velocity)
        assert step.tracking == "invalid_input"
        assert "obstacle_velocity" in step.complaint
    step = tracker.step(T, pdoik.Cloud(points), obstacle_velocity=[0.1, 0.0, 0.0])
    assert "obstacle_velocity" in step.complaint
    assert tracker.step(T, points, obstacle_velocity=np.zeros((2, 3))).tracking == "tracking"


def test_what_is_named_is_the_point_itself_not_where_it_will_be() -> None:
    robot = pdoik.Robot.builtin("panda")
    tracker = pdoik.Tracker(pdoik.Solver(robot, pdoik.Options()), PERIOD, max_time=1.0)
    hand = robot.fk(tracker.q)[:3, 3]
    points = np.array([[2.0, 0.0, 0.5, 0.01], [*(hand + np.array([WAY, 0.0, 0.0])), 0.15]])
    step = tracker.step(
        robot.fk(tracker.q), points, obstacle_velocity=[[0.0, 0.0, 0.0], [-SPEED, 0.0, 0.0]]
    )
    assert step.worst_constraint.endswith("obstacle 1")
