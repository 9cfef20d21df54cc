"""A tracker's steps: never too long, never a jump, and honest about what they could not do.

Nothing here asserts how long a step takes: deadlines are either out of reach or struck at once.
"""

import doctest
import multiprocessing
import threading

import numpy as np
import pytest

import pdoik
import pdoik.tracker
from conftest import ROBOTS
from references import PinocchioRobot, rotation_angle

LEFT, RIGHT = "left_ankle_link", "right_ankle_link"
PERIOD = 0.001
UNHURRIED = {"period": PERIOD, "max_time": 60.0}
STATUSES = {"tracking", "infeasible", "deadline_struck", "invalid_input"}


@pytest.fixture
def panda() -> pdoik.Robot:
    return pdoik.Robot.builtin("panda")


@pytest.fixture
def start(panda: pdoik.Robot) -> np.ndarray:
    return panda.mid_configuration() + 0.2


def tracker_of(
    robot: pdoik.Robot, q: np.ndarray, options: dict | None = None, **arguments: object
) -> pdoik.Tracker:
    solver = pdoik.Solver(robot, pdoik.Options(**(options or {})))
    tracker = pdoik.Tracker(solver, **{**UNHURRIED, **arguments})
    tracker.reset(q)
    return tracker


def steps_are_short(robot: pdoik.Robot, path: list[np.ndarray], share: float = 1.0) -> None:
    moved = np.abs(np.diff(path, axis=0))
    assert (moved <= share * PERIOD * robot.velocity + 1e-12).all()
    assert (robot.lower <= np.array(path)).all()
    assert (np.array(path) <= robot.upper).all()


# --- What it is for -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["panda", "iiwa14"])
def test_an_arm_follows_a_path_within_its_speeds_as_pinocchio_confirms(name: str) -> None:
    robot = pdoik.Robot.builtin(name)
    reference = PinocchioRobot.from_xml((ROBOTS / f"{name}.urdf").read_text())
    q = robot.mid_configuration() + 0.2
    tracker = tracker_of(robot, q)
    path = [q]
    for k in range(500):
        wanted = q + 0.2 * np.sin(2 * PERIOD * k + np.arange(7)) - 0.2 * np.sin(np.arange(7))
        T = robot.fk(wanted)
        step = tracker.step(T)
        assert step.tracking == "tracking"
        assert step.success
        assert step.complaint == ""
        path.append(step.q)
        np.testing.assert_array_equal(tracker.q, step.q)
        reference.set(dict(zip(robot.joint_names, step.q.tolist(), strict=True)))
        reached = reference.pose(robot.base_link, robot.tip_links[0])
        assert np.linalg.norm(reached[:3, 3] - T[:3, 3]) <= 1e-5 + 1e-11
        assert rotation_angle(T[:3, :3].T @ reached[:3, :3]) <= 1e-5 + 1e-9
    steps_are_short(robot, path)
    assert np.linalg.norm(path[-1] - q) > 0.1


def crouch(robot: pdoik.Robot, depth: float) -> np.ndarray:
    angles = {"hip_pitch": -depth, "knee": 2 * depth, "ankle": -depth}
    names = [name.removesuffix("_joint").split("_", 1)[-1] for name in robot.joint_names]
    return np.array([angles.get(name, 0.0) for name in names])


def test_h1_crouches_on_welded_feet_towards_a_posture_and_stays_balanced() -> None:
    robot = pdoik.Robot.builtin("h1", base_link=LEFT, tip_link=RIGHT)
    reference = PinocchioRobot.floating((ROBOTS / "h1.urdf").read_text())
    q = crouch(robot, 0.3)
    T = robot.fk(q)
    com = robot.center_of_mass(q)
    room = np.array([0.03, 0.03, 1.0])
    box = com - room, com + room
    balance = pdoik.Balance(com_lower=box[0], com_upper=box[1])
    tracker = tracker_of(robot, q, {"balance": balance}, posture_weight=1e-2)
    path = [q]
    for k in range(600):
        depth = 0.3 + 0.3 * min(1.0, k / 400)
        tracker.set_posture(crouch(robot, depth))
        step = tracker.step(T)
        assert step.tracking == "tracking", (k, step.worst_constraint, step.worst_violation)
        path.append(step.q)
    steps_are_short(robot, path)
    for at in path[::50]:
        reference.set(dict(zip(robot.joint_names, at.tolist(), strict=True)))
        reached = reference.pose(LEFT, RIGHT)
        assert np.linalg.norm(reached[:3, 3] - T[:3, 3]) <= 1.1e-5
        assert rotation_angle(T[:3, :3].T @ reached[:3, :3]) <= 1.1e-5
        at_com = reference.center_of_mass(LEFT)
        assert (at_com >= box[0] - 1.1e-6).all()
        assert (at_com <= box[1] + 1.1e-6).all()
    np.testing.assert_allclose(tracker.q, crouch(robot, 0.6), rtol=0, atol=0.02)


def test_a_posture_is_returned_to_and_may_be_taken_back(panda: pdoik.Robot) -> None:
    posture = panda.mid_configuration() + 0.1
    target = panda.fk(posture)[:3, 3]
    near = pdoik.Solver(panda, pdoik.Options(goal="position", max_time=60.0))
    off = near.solve(target, q0=posture + np.array([0.3, -0.2, 0.2, 0.1, 0.3, 0.2, 0.3]))
    tracker = tracker_of(panda, off.q, {"goal": "position"}, posture_weight=1e-2)
    before = np.linalg.norm(off.q - posture)
    assert before > 0.1
    tracker.set_posture(posture)
    for _ in range(1500):
        assert tracker.step(target).tracking == "tracking"
    assert np.linalg.norm(tracker.q - posture) < 0.05 * before
    tracker.set_posture(None)
    at = tracker.q
    for _ in range(10):
        tracker.step(target)
    np.testing.assert_allclose(tracker.q, at, rtol=0, atol=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_where_standing_still_solves_no_posture_leads_away_from_a_solution(
    seed: int, rng: np.random.Generator
) -> None:
    robot = pdoik.Robot.builtin("panda")
    options = {"goal": "position", "clearance": 0.02, "self_collision": True}
    solver = pdoik.Solver(robot, pdoik.Options(max_time=60.0, max_restarts=20, **options))
    cloud = rng.uniform([-0.7, -0.7, 0.0], [0.7, 0.7, 1.0], (80, 3))
    cloud = cloud[np.hypot(cloud[:, 0], cloud[:, 1]) > 0.3]
    target = robot.fk(rng.uniform(robot.lower, robot.upper))
    solved = solver.solve(target, obstacles=cloud)
    if not solved.success:
        return
    tracker = tracker_of(robot, solved.q, options, posture_weight=1.0, speed_share=5.0)
    tracker.set_posture(rng.uniform(robot.lower, robot.upper))
    for k in range(300):
        step = tracker.step(target, cloud) if k == 0 else tracker.step(target)
        assert step.tracking == "tracking", (k, step.worst_constraint, step.worst_violation)


# --- Limits of a step ---------------------------------------------------------------------------


@pytest.mark.parametrize("arguments", [{}, {"speed_share": 0.3}, {"max_speed": np.full(7, 0.5)}])
def test_a_target_that_jumps_is_approached_at_the_speed_allowed(
    panda: pdoik.Robot, start: np.ndarray, arguments: dict
) -> None:
    tracker = tracker_of(panda, start, **arguments)
    far = panda.mid_configuration() - 0.3
    T = panda.fk(far)
    path, limited = [start], set()
    for _ in range(3000):
        step = tracker.step(T)
        path.append(step.q)
        if step.tracking == "tracking":
            break
        assert step.tracking == "infeasible"
        assert step.worst_constraint in {"position", "rotation"}
        assert step.worst_violation > 0.0
        limited.add(step.step_limited)
    assert step.tracking == "tracking"
    assert limited - {None} <= set(panda.joint_names)
    assert limited - {None}
    steps_are_short(panda, path, arguments.get("speed_share", 1.0))
    speed = np.abs(np.diff(path, axis=0)).max(axis=0) / PERIOD
    assert (speed <= arguments.get("max_speed", np.inf) + 1e-9).all()


def test_a_goal_is_reached_by_speeding_up_and_braking_no_harder_than_allowed(
    panda: pdoik.Robot, start: np.ndarray
) -> None:
    most = np.full(7, 3.0)
    tracker = tracker_of(panda, start, max_acceleration=most)
    T = panda.fk(panda.mid_configuration() - 0.3)
    before, steps = np.zeros(7), 0
    while not (step := tracker.step(T)).success or np.abs(tracker.velocity).max() > 1e-3:
        assert not step.stopped_hard
        assert (np.abs(tracker.velocity - before) <= PERIOD * most + 1e-9).all()
        before, steps = tracker.velocity, steps + 1
        assert steps < 5000
    assert steps > 100


def test_where_it_moves_already_it_begins_at_its_speed(
    panda: pdoik.Robot, start: np.ndarray
) -> None:
    tracker = tracker_of(panda, start, max_acceleration=np.full(7, 3.0))
    velocity = np.array([0.3, 0.0, -0.2, 0.0, 0.0, 0.0, 0.1])
    tracker.reset(start, velocity)
    step = tracker.step(panda.fk(start))
    assert np.abs((step.q - start) / PERIOD - velocity).max() <= 3.0 * PERIOD + 1e-9
    assert np.abs(step.q - start).max() > 0.0
    tracker.reset(start, velocity)
    refused = tracker.step(np.full((4, 4), np.nan))
    assert refused.tracking == "invalid_input"
    assert refused.stopped_hard
    assert not tracker.velocity.any()
    with pytest.raises(ValueError, match="velocity"):
        tracker.reset(start, np.ones(3))


def test_a_goal_that_stands_is_not_for_joints_that_brake_each_for_itself(
    panda: pdoik.Robot, start: np.ndarray
) -> None:
    goal = pdoik.Goal(panda.fk(start), stands=True)
    assert goal.stands
    step = tracker_of(panda, start, max_acceleration=np.ones(7)).step(goal)
    assert step.tracking == "invalid_input"
    assert "stands" in step.complaint
    assert tracker_of(panda, start).step(goal).tracking == "tracking"


@pytest.mark.parametrize("kind", [pdoik.Solver, pdoik.Tracker])
def test_what_was_not_made_can_be_shown(kind: type) -> None:
    assert repr(kind.__new__(kind)) == f"<{kind.__name__} that was not made>"


def test_no_speed_at_all_is_no_motion(panda: pdoik.Robot, start: np.ndarray) -> None:
    tracker = tracker_of(panda, start, max_speed=np.zeros(7))
    step = tracker.step(panda.fk(panda.mid_configuration()))
    assert step.tracking == "infeasible"
    np.testing.assert_array_equal(step.q, start)


def test_what_cannot_be_had_is_named(panda: pdoik.Robot, start: np.ndarray) -> None:
    T = panda.fk(start)
    com = panda.center_of_mass(start)
    options = {"balance": pdoik.Balance(com_lower=(com[0] + 0.2, -9, -9))}
    step = tracker_of(panda, start, options).step(T)
    assert step.tracking == "infeasible"
    assert step.worst_constraint == "lower x of the centre of mass"
    ball = np.append(panda.fk(start, "panda_link4")[:3, 3], 0.1)[None]
    step = tracker_of(panda, start).step(T, ball)
    assert step.tracking == "infeasible"
    assert step.worst_constraint.startswith("clearance of panda_link")
    assert step.worst_constraint.endswith("to obstacle 0")
    first = np.arange(7) == 0
    at_limit = np.where(first, panda.upper, start)
    beyond = panda.fk(at_limit + 0.2 * first)
    tracker = tracker_of(panda, at_limit)
    for _ in range(5):
        step = tracker.step(beyond)
        assert step.tracking == "infeasible"
        assert step.q[0] <= panda.upper[0]


# --- Input that makes no sense ------------------------------------------------------------------


def test_goals_that_make_no_sense_leave_the_last_answer_standing(
    panda: pdoik.Robot, start: np.ndarray
) -> None:
    T = panda.fk(start)
    tracker = tracker_of(panda, start)
    q = tracker.step(T).q
    bent = T.copy()
    bent[0, 0] += 0.1
    for goal, complaint in [
        (T * np.nan, "T_base_tip holds NaN"),
        (bent, "T_base_tip is not a rigid transform"),
        (T[:3], "T_base_tip has shape (3, 4)"),
        ({}, "there is no goal"),
        ({"nose": T}, "'nose', which is no tip link"),
        ({"panda_link8": T * np.nan}, "T_base_tip['panda_link8'] holds NaN or infinity"),
        (pdoik.Goal(T, rotation_slack=(-1, 0, 0)), "rotation_slack of the goal for 'panda_link8'"),
        (pdoik.Goal(T, weight=np.nan), "weight of the goal for 'panda_link8' is nan"),
    ]:
        before = tracker.latency.count
        step = tracker.step(goal)
        assert step.tracking == "invalid_input"
        assert complaint in step.complaint
        assert not step.success
        assert step.step_limited is None
        np.testing.assert_array_equal(step.q, q)
        np.testing.assert_array_equal(tracker.q, q)
        assert tracker.latency.count == before + 1
        assert tracker.step(T).tracking == "tracking"
    for goal in (None, "up", {1: T}, {"panda_link8": "up"}):
        with pytest.raises(TypeError):
            tracker.step(goal)
    assert tracker.step(T).tracking == "tracking"


@pytest.mark.parametrize(
    ("cloud", "complaint"),
    [
        (np.full((3, 3), np.nan), "obstacles holds NaN or infinity in row 0"),
        (np.full((3, 3), 1e7), "obstacles has a number beyond 1e6 m in row 0"),
        (np.array([[5.0, 5, 5, -0.1]]), "obstacles has a negative radius in row 0"),
        (np.zeros((2, 5)), "obstacles has shape (2, 5), expected (N, 3) or (N, 4)"),
        (np.zeros(3), "obstacles has shape (3,), expected (N, 3) or (N, 4)"),
        (np.zeros((2, 3, 5)), "obstacles has shape (2, 3, 5), expected (N, 3) or (N, 4)"),
        (
            np.full((1_000_000, 3), 5.0),
            "obstacles has 1000000 rows, expected at most max_obstacles",
        ),
    ],
    ids=["nan", "huge numbers", "radius", "columns", "one point", "three axes", "a million"],
)
def test_a_cloud_that_makes_no_sense_is_held_against_until_a_good_one_comes(
    panda: pdoik.Robot, start: np.ndarray, cloud: np.ndarray, complaint: str
) -> None:
    T = panda.fk(start)
    tracker = tracker_of(panda, start)
    q = tracker.step(T).q
    for obstacles in ({"obstacles": cloud}, {}, {}):
        step = tracker.step(panda.fk(start + 0.1), **obstacles)
        assert step.tracking == "invalid_input"
        assert complaint in step.complaint
        np.testing.assert_array_equal(step.q, q)
    assert tracker.step(T, np.zeros((0, 3))).tracking == "tracking"
    assert tracker.step(T).tracking == "tracking"


def test_a_million_points_are_taken_where_there_is_room_and_an_empty_cloud_clears_them(
    panda: pdoik.Robot, start: np.ndarray
) -> None:
    T = panda.fk(start)
    tracker = tracker_of(panda, start, {"max_obstacles": 1_000_000})
    cloud = np.full((1_000_000, 3), 5.0)
    assert tracker.step(T, cloud).tracking == "tracking"
    cloud[-1] = panda.fk(start, "panda_link4")[:3, 3]
    step = tracker.step(T, cloud)
    assert step.tracking == "infeasible"
    assert step.worst_constraint.endswith("to obstacle 999999")
    for empty in ([], np.zeros((0, 3)), np.zeros((0, 4))):
        step = tracker.step(T, empty)
        assert step.clearance == np.inf


def test_none_means_no_obstacles_and_left_out_means_the_last_ones(
    panda: pdoik.Robot, start: np.ndarray
) -> None:
    T, ball = panda.fk(start), pdoik.Shape.sphere("ball", (0.9, 0.9, 0.9), 0.05)
    for obstacles in ([[0.9, 0.9, 0.9]], pdoik.Cloud([[0.9, 0.9, 0.9]]), [ball]):
        tracker = tracker_of(panda, start)
        assert np.isfinite(tracker.step(T, obstacles).clearance)
        assert np.isfinite(tracker.step(T).clearance)
        assert tracker.step(T, None).clearance == np.inf
        assert tracker.step(T).clearance == np.inf
        assert tracker.solver.solve(T, obstacles=None).clearance == np.inf
        assert np.isfinite(tracker.step(T, obstacles=obstacles).clearance)
        assert tracker.step(T, obstacles=None).clearance == np.inf
    refused = tracker.step(T, [[np.nan, 0, 0]])
    assert refused.tracking == tracker.step(T).tracking == "invalid_input"
    assert tracker.step(T, None).tracking == "tracking"  # which is a good one


def test_obstacles_stay_until_new_ones_come(panda: pdoik.Robot, start: np.ndarray) -> None:
    T = panda.fk(start)
    tracker = tracker_of(panda, start)
    with_cloud = tracker.step(T, [[0.9, 0.9, 0.9]]).clearance
    assert np.isfinite(with_cloud)
    assert tracker.step(T).clearance == pytest.approx(with_cloud, abs=1e-4)
    assert tracker.step(T, []).clearance == np.inf


# --- Deadlines ----------------------------------------------------------------------------------


def spin(stop: object) -> None:
    while not stop.is_set():
        sum(range(1000))


@pytest.mark.parametrize("load", ["thread", "process"])
def test_steps_end_and_answers_stay_within_limits_on_a_busy_machine(
    panda: pdoik.Robot, start: np.ndarray, load: str
) -> None:
    context = multiprocessing.get_context("spawn")
    stop = threading.Event() if load == "thread" else context.Event()
    kind = threading.Thread if load == "thread" else context.Process
    busy = [kind(target=spin, args=(stop,)) for _ in range(2)]
    for each in busy:
        each.start()
    try:
        tracker = tracker_of(panda, start, max_time=1e-7)
        path, seen = [start], set()
        for k in range(300):
            step = tracker.step(panda.fk(panda.mid_configuration() - 0.3 * (k % 3)))
            path.append(step.q)
            seen.add(step.tracking)
        steps_are_short(panda, path)
        assert seen <= {"deadline_struck", "tracking", "infeasible"}
        assert "deadline_struck" in seen
        assert tracker.latency.count == 300
    finally:
        stop.set()
        for each in busy:
            each.join()


def test_the_histogram_counts_every_step(panda: pdoik.Robot, start: np.ndarray) -> None:
    tracker = tracker_of(panda, start)
    empty = tracker.latency
    assert (empty.count, empty.max, empty.quantile(0.5)) == (0, 0.0, 0.0)
    assert empty.counts.sum() == 0
    times = [tracker.step(panda.fk(start + 1e-4 * k)).time for k in range(200)]
    latency = tracker.latency
    assert latency.count == latency.counts.sum() == 200
    assert empty.count == 0  # what was asked for before stays as it was
    assert latency.max == max(times)
    assert latency.counts.shape == latency.upper_edges.shape
    assert (np.diff(latency.upper_edges) > 0).all()
    for share in (0.1, 0.5, 0.99):
        exact = np.sort(times)[int(np.ceil(share * 200)) - 1]
        assert 0.999 * max(exact, 1e-7) <= latency.quantile(share)
        assert latency.quantile(share) <= max(1.07 * exact, latency.upper_edges[0])
    assert latency.quantile(1.0) == latency.max
    assert repr(latency).startswith("<LatencyHistogram of 200 steps: median ")
    tracker.clear_latency()
    assert tracker.latency.count == 0


# --- Itself -------------------------------------------------------------------------------------


def test_the_example_runs_as_it_stands() -> None:
    outcome = doctest.testmod(pdoik.tracker)
    assert outcome.attempted >= 6
    assert outcome.failed == 0


def test_the_same_steps_give_the_same_answers(panda: pdoik.Robot, start: np.ndarray) -> None:
    one, two = (tracker_of(panda, start) for _ in range(2))
    for k in range(50):
        T = panda.fk(start + 0.01 * np.sin(0.1 * k))
        np.testing.assert_array_equal(one.step(T).q, two.step(T).q)
    one.reset(start)
    two.reset(start)
    np.testing.assert_array_equal(one.q, start)


def test_a_result_outlives_the_next_step(panda: pdoik.Robot, start: np.ndarray) -> None:
    tracker = tracker_of(panda, start)
    first = tracker.step(panda.fk(start))
    q = first.q.copy()
    bad = tracker.step(np.full((4, 4), np.nan))
    tracker.step(panda.fk(start + 0.01))
    np.testing.assert_array_equal(first.q, q)
    assert "NaN" in bad.complaint
    assert first.tracking == "tracking"


def test_resets_move_inside_the_limits_and_refuse_nonsense(panda: pdoik.Robot) -> None:
    tracker = tracker_of(panda, panda.upper + 1.0)
    np.testing.assert_array_equal(tracker.q, panda.upper)
    for call in (tracker.reset, tracker.set_posture):
        with pytest.raises(ValueError, match=r"has shape \(3,\), expected \(7,\)"):
            call(np.zeros(3))
        with pytest.raises(ValueError, match="holds NaN"):
            call(np.full(7, np.nan))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"period": 0.0}, "period is 0"),
        ({"period": np.inf}, "period is inf"),
        ({"max_time": 0.0}, "max_time is 0"),
        ({"max_time": -1.0}, "max_time is -1"),
        ({"max_time": np.nan}, "max_time is nan"),
        ({"speed_share": 0.0}, "speed_share is 0"),
        ({"max_speed": np.ones(3)}, r"max_speed has shape \(3,\), expected \(7,\)"),
        ({"max_speed": -np.ones(7)}, r"max_speed\[0\] is -1"),
        ({"max_acceleration": np.zeros(7)}, r"max_acceleration\[0\] is 0"),
        ({"posture_weight": -1.0}, "posture_weight is -1"),
        ({"smoothness": np.nan}, "smoothness is nan"),
    ],
)
def test_options_out_of_range_are_named(panda: pdoik.Robot, arguments: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pdoik.Tracker(pdoik.Solver(panda), **{**UNHURRIED, **arguments})


def test_the_paper_s_method_does_not_track(panda: pdoik.Robot) -> None:
    with pytest.raises(ValueError, match="a tracker needs method 'default'"):
        pdoik.Tracker(pdoik.Solver(panda, pdoik.Options(method="paper")))
