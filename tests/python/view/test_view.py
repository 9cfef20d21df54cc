"""pdoik view without a browser: wishes, obstacles, logs, and what is drawn."""

import signal
import socket
import subprocess
import sys
import threading
import urllib.request
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import pdoik
from command_line import misuse, run
from pdoik._hulls import PlacedHull, PlacedSpheroid, placed_hulls
from pdoik.solids import binding
from pdoik.view import Log, Obstacles, Session, Shown, Worker, load_log
from pdoik.view.drawing.shapes import pose_of, spheroid_instances, turns_of_x, wxyz_of
from pdoik.view.h1_shapes import FEET, JOINT_NAMES, SOLE_HEIGHT
from pdoik.view.humanoid import balance_over_feet, floor_height, object_frame, support_polygon
from pdoik.view.model import deepest_tip, read_robot
from pdoik.view.player import Player
from pdoik.view.status import Meter, margin_text, status_html
from pdoik.view.visuals import load_visuals
from samples import with_capsules

TIP = "panda_link8"
REACHED = [0.3, 0.4, 0.0, -1.8, 0.0, 2.2, 0.8]
PATIENT = pdoik.Options(max_time=5.0)


@pytest.fixture
def session() -> Session:
    """A Panda that has been shown once."""
    session = Session(pdoik.Robot.builtin("panda"), PATIENT)
    assert session.solve_once() is not None
    return session


# Wishes.


def test_at_first_the_middle_of_the_ranges_is_shown_with_the_target_at_the_tip() -> None:
    robot = pdoik.Robot.builtin("panda")
    session = Session(robot, PATIENT)
    shown = session.solve_once()
    assert shown is not None
    assert shown.origin == "joints"
    np.testing.assert_array_equal(shown.q, robot.mid_configuration())
    np.testing.assert_array_equal(shown.targets[TIP], robot.fk(shown.q))
    assert session.solve_once() is None


def test_shapes_are_kept_off_named_and_drawn_where_they_are(session: Session) -> None:
    session.set_posture(REACHED)
    beside = session.robot.fk(REACHED, "panda_link4")[:3, 3] + np.array([0.0, 0.1, 0.0])
    ball = pdoik.Shape.sphere("ball", beside, 0.08)
    floor = pdoik.Shape.half_space("floor", (0, 0, 1), (3, 0, -0.5))
    contacts = [pdoik.ContactRule("panda_link0", "floor")]
    session.set_shapes([ball, floor], contacts)
    session.set_posture(REACHED)
    shown = session.solve_once()
    assert shown is not None
    assert not shown.result.success
    found = binding(shown.result, shown.robot, ["ball", "floor"])
    assert (found.shape, found.obstacle) == ("ball", None)
    (hull,) = found.hulls
    assert placed_hulls(shown.robot, shown.q)[hull].name in shown.result.worst_constraint
    assert "mm to 2 shapes" in status_html(shown, Meter())

    session.set_target(TIP, session.robot.fk(REACHED))
    shown = session.solve_once()
    assert shown is not None
    assert shown.result.success, shown.result.worst_constraint
    assert np.abs(shown.q - REACHED).max() > 0.01
    session.set_ball([3.0, 0.0, 0.0], 0.1)
    shown = session.solve_once()
    assert shown is not None
    assert "mm to 1 point and 2 shapes" in status_html(shown, Meter())
    with pytest.raises(ValueError, match="'nobody'"):
        session.set_shapes([ball], [pdoik.ContactRule("nobody", "ball")])


def test_the_robot_follows_its_target_by_small_steps(session: Session) -> None:
    start, q = session.targets[TIP], session.q
    for i in range(1, 41):
        T = start.copy()
        T[1, 3] += 0.005 * i
        session.set_target(TIP, T)
        shown = session.solve_once()
        assert shown is not None
        assert shown.origin == "target"
        assert shown.result.success
        np.testing.assert_allclose(session.robot.fk(shown.q)[:3, 3], T[:3, 3], atol=2e-5)
        assert np.abs(shown.q - q).max() < 0.1  # no jump
        q = shown.q


def test_only_the_latest_of_several_targets_is_solved(session: Session) -> None:
    stale, latest = session.robot.fk(np.zeros(7)), session.robot.fk(REACHED)
    session.set_target(TIP, stale)
    session.set_target(TIP, latest)
    shown = session.solve_once()
    assert shown is not None
    np.testing.assert_array_equal(shown.targets[TIP], latest)
    assert session.solve_once() is None


def test_a_slider_moves_its_joint_alone_and_the_target_jumps_to_the_tip(session: Session) -> None:
    q = session.q
    session.set_joint(2, 0.7)
    session.set_joint(4, -0.3)  # before the first was shown
    shown = session.solve_once()
    assert shown is not None
    assert shown.origin == "joints"
    q[2], q[4] = 0.7, -0.3
    np.testing.assert_array_equal(shown.q, q)
    np.testing.assert_array_equal(session.targets[TIP], session.robot.fk(q))


def test_a_posture_wished_for_while_a_target_is_solved_is_not_overruled(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    class SlowSolver:
        options = session.options

        def solve(self, *_: Any) -> Any:
            session.set_posture(REACHED)
            return SimpleNamespace(q=np.zeros(7), success=True), None, 0

        def clearances(self, *_: Any) -> Any:
            return []

    monkeypatch.setattr(session, "_solver", SlowSolver())
    session.set_target(TIP, session.robot.fk(np.zeros(7)))
    session.solve_once()
    np.testing.assert_array_equal(session.q, REACHED)


def test_a_target_out_of_reach_says_so_and_the_next_one_is_followed(session: Session) -> None:
    T = session.targets[TIP]
    far = T.copy()
    far[0, 3] = 3.0
    session.set_target(TIP, far)
    shown = session.solve_once()
    assert shown is not None
    assert shown.result.status == "out_of_reach"
    session.set_target(TIP, T)
    shown = session.solve_once()
    assert shown is not None
    assert shown.result.success


def test_the_arm_gives_way_to_the_ball(session: Session) -> None:
    session.set_posture(REACHED)
    session.solve_once()
    beside_elbow = session.robot.fk(REACHED, "panda_link4")[:3, 3] + np.array([0.0, 0.1, 0.0])
    session.set_ball(beside_elbow, 0.08)
    shown = session.solve_once()
    assert shown is not None
    assert shown.result.success, shown.result.worst_constraint
    assert shown.result.clearance >= 0
    assert np.abs(shown.q - REACHED).max() > 0.01
    np.testing.assert_array_equal(shown.obstacles[-1, :3], beside_elbow)
    session.set_ball(None)
    shown = session.solve_once()
    assert shown is not None
    assert len(shown.obstacles) == 0


def test_moving_the_cloud_is_moving_its_points(rng: np.random.Generator) -> None:
    points = rng.uniform(-0.1, 0.1, (500, 3))
    T = pose_of([np.cos(0.3), 0, 0, np.sin(0.3)], [0.5, 0.1, 0.4])
    moved, fixed = (Session(pdoik.Robot.builtin("panda"), PATIENT) for _ in range(2))
    moved.set_thinning(0.0, True)
    moved.set_cloud(points)
    moved.set_cloud_pose(T)
    fixed.set_thinning(0.0, True)
    fixed.set_cloud(points @ T[:3, :3].T + T[:3, 3])
    a, b = moved.solve_once(), fixed.solve_once()
    assert a is not None
    assert b is not None
    np.testing.assert_allclose(a.obstacles, b.obstacles, atol=1e-12)
    assert a.result.clearance == pytest.approx(b.result.clearance, abs=1e-9)


def test_a_cloud_is_thinned_to_balls_that_hold_it(
    session: Session, rng: np.random.Generator
) -> None:
    points = rng.uniform([0.4, -0.3, 0.0], [0.7, 0.3, 0.3], (2000, 3))
    session.set_cloud(points)
    session.set_thinning(0.06, True)
    shown = session.solve_once()
    assert shown is not None
    assert shown.obstacles.shape[1] == 4
    assert len(shown.obstacles) < len(points)
    outside = np.linalg.norm(points[:, None] - shown.obstacles[None, :, :3], axis=2)
    assert (outside - shown.obstacles[:, 3]).min(axis=1).max() <= 1e-6


def test_the_robot_follows_its_target_while_a_large_cloud_is_thinned(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    session.set_cloud([[1.5, 0.0, 0.2]])
    session.solve_once()
    thinned, begun, go_on = Obstacles.thinned, threading.Event(), threading.Event()

    def slowly(obstacles: Obstacles) -> np.ndarray:
        begun.set()
        assert go_on.wait(60.0)
        return thinned(obstacles)

    monkeypatch.setattr(Obstacles, "thinned", slowly)
    cloud = np.random.default_rng(0).uniform([1.0, 0.0, 0.0], [1.5, 0.5, 0.5], (1000, 3))
    kept: list[int] = []
    hand = threading.Thread(target=lambda: kept.append(session.set_cloud_once_thinned(cloud)))
    hand.start()
    assert begun.wait(60.0)
    shown = pull(session, TIP, [0.0, 0.0, 0.02], 2)  # thins nothing, and does not wait
    assert shown.result.success
    assert len(shown.obstacles) == 1
    go_on.set()
    hand.join()
    monkeypatch.setattr(Obstacles, "thinned", None)  # it is not thinned again
    after = session.solve_once()
    assert after is not None
    assert kept == [len(after.obstacles)]
    assert 1 < kept[0] < 1000


def test_a_leaf_that_cannot_be_is_refused_once_and_the_session_goes_on(session: Session) -> None:
    session.set_cloud([[0.0, 0.0, 0.0], [5e4, 5e4, 5e4]])
    session.set_thinning(1e-3, False)
    with pytest.raises(ValueError, match="cells"):
        session.solve_once()
    assert session.solve_once() is None
    session.set_cloud(None)
    assert session.solve_once() is not None


def test_options_change_what_counts(session: Session) -> None:
    T = session.targets[TIP]
    T[:3, :3] = T[:3, :3] @ pose_of([np.cos(0.4), np.sin(0.4), 0, 0], np.zeros(3))[:3, :3]
    session.set_options(goal="position")
    session.set_target(TIP, T)
    shown = session.solve_once()
    assert shown is not None
    assert shown.result.success
    assert shown.result.rotation_error == 0
    np.testing.assert_allclose(session.robot.fk(shown.q)[:3, 3], T[:3, 3], atol=2e-5)
    with pytest.raises(ValueError, match="goal"):
        session.set_options(goal="somewhere")
    assert session.options.goal == "position"


@pytest.mark.parametrize(
    ("wish", "words"),
    [
        (lambda session: session.set_target("hand", np.eye(4)), "panda_link8"),
        (lambda session: session.set_target(TIP, np.full((4, 4), np.nan)), "finite"),
        (lambda session: session.set_posture([0.0] * 6), "7 finite numbers"),
        (lambda session: session.set_cloud(np.zeros((3, 4))), r"\(N, 3\)"),
    ],
)
def test_wishes_that_make_no_sense_are_refused(
    session: Session, wish: Callable[[Session], None], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        wish(session)
    assert session.solve_once() is None


# Several tips.

LEFT, RIGHT = "left_ankle_link", "right_ankle_link"
LEFT_ARM, RIGHT_ARM = "left_elbow_link", "right_elbow_link"


def h1(*tips: str, base: str = LEFT, **options: Any) -> Session:
    """The H1 in its stance, seen from a foot, shown once."""
    robot = pdoik.Robot.builtin("h1", base, tips or None)
    session = Session(robot, pdoik.Options(max_time=1.0, **options))
    assert session.solve_once() is not None
    return session


def pull(session: Session, tip: str, way: list[float], steps: int) -> Shown:
    """Drag a tip along `way` [m], base frame, by equal steps."""
    start = session.targets[tip]
    for share in np.linspace(0, 1, steps + 1)[1:]:
        T = start.copy()
        T[:3, 3] += share * np.array(way)
        session.set_target(tip, T)
        shown = session.solve_once()
        assert shown is not None
    return shown


def test_the_h1_stands_on_the_floor_balanced_and_clear_of_itself() -> None:
    for base in ("pelvis", LEFT, RIGHT):
        session = h1(base=base)
        session.set_options(self_collision=True, balance=balance_over_feet())
        session.set_posture(session.q)
        shown = session.solve_once()
        assert shown is not None
        assert shown.result.success, shown.result.worst_constraint
        assert shown.result.balance_violation == 0
        assert shown.result.self_distance >= 0
        heights = [session.robot.fk(shown.q, foot)[2, 3] for foot in FEET]
        np.testing.assert_allclose(heights, floor_height(session.robot) + SOLE_HEIGHT, atol=1e-9)


def test_what_is_asked_of_a_tip_at_first_is_what_its_joints_can_do() -> None:
    assert set(h1(base="pelvis").goals.values()) == {"position"}
    assert h1(RIGHT, LEFT_ARM).goals == {RIGHT: "pose", LEFT_ARM: "position"}
    assert Session(pdoik.Robot.builtin("panda")).goals == {TIP: "pose"}


def test_one_tip_is_dragged_while_the_others_hold_and_nothing_drifts() -> None:
    session = h1(RIGHT, LEFT_ARM, self_collision=True)
    q, foot = session.q, session.targets[RIGHT]
    shown = pull(session, LEFT_ARM, [0.2, 0.1, 0.15], 40)
    assert shown.result.success, shown.result.worst_constraint
    np.testing.assert_allclose(session.robot.fk(shown.q, RIGHT), foot, atol=5e-5)
    T = session.targets[LEFT_ARM]
    np.testing.assert_allclose(session.robot.fk(shown.q, LEFT_ARM)[:3, 3], T[:3, 3], atol=5e-5)
    assert np.abs(shown.q - q).max() > 0.1
    free = session.robot.joint_names.index("right_elbow_joint")
    assert shown.q[free] == pytest.approx(q[free], abs=0.02)  # no tip needs it
    back = pull(session, LEFT_ARM, [-0.2, -0.1, -0.15], 40)
    np.testing.assert_allclose(back.q, q, atol=0.1)


def test_a_tip_without_a_goal_is_free_and_holds_again_where_it_is() -> None:
    session = h1(RIGHT, LEFT_ARM)
    foot = session.targets[RIGHT]
    session.set_goal(RIGHT, "free")
    shown = pull(session, LEFT_ARM, [0.3, 0.0, 0.3], 10)
    moved = session.robot.fk(shown.q, RIGHT)
    assert np.linalg.norm(moved[:3, 3] - foot[:3, 3]) > 0.01
    np.testing.assert_array_equal(session.targets[RIGHT], moved)
    session.set_goal(RIGHT, "pose")
    shown = pull(session, LEFT_ARM, [0.0, 0.0, -0.1], 10)
    assert shown.result.success
    np.testing.assert_allclose(session.robot.fk(shown.q, RIGHT), moved, atol=5e-5)


def test_all_tips_may_be_free() -> None:
    session = h1(RIGHT, LEFT_ARM)
    q = session.q
    for tip in (RIGHT, LEFT_ARM):
        session.set_goal(tip, "free")
    shown = session.solve_once()
    assert shown is not None
    assert shown.result.success
    np.testing.assert_allclose(shown.q, q, atol=1e-9)


def test_goals_that_make_no_sense_are_refused(session: Session) -> None:
    with pytest.raises(ValueError, match="panda_link8"):
        session.set_goal("hand", "pose")
    with pytest.raises(ValueError, match="axis"):
        session.set_goal(TIP, "somewhere")  # type: ignore[arg-type]
    assert session.solve_once() is None


def test_where_not_all_can_be_had_the_dragged_tip_gives_way_without_a_jump() -> None:
    session = h1(RIGHT, LEFT_ARM)
    foot, q = session.targets[RIGHT], session.q
    start = session.targets[LEFT_ARM]
    session.set_options(max_time=0.02)
    for share in np.linspace(0, 1, 31)[1:]:
        T = start.copy()
        T[2, 3] += 1.5 * share  # far above its reach
        session.set_target(LEFT_ARM, T)
        shown = session.solve_once()
        assert shown is not None
        assert np.abs(shown.q - q).max() < 1.0
        q = shown.q
    assert not shown.result.success
    np.testing.assert_allclose(session.robot.fk(q, RIGHT)[:3, 3], foot[:3, 3], atol=0.05)
    assert shown.result.position_error > 0.3


def test_balance_keeps_the_centre_of_mass_over_the_soles_where_it_would_leave_them() -> None:
    inside = []
    for options in ({}, {"balance": balance_over_feet()}):
        session = h1(RIGHT, LEFT_ARM, **options)
        shown = pull(session, LEFT_ARM, [0.4, 0.1, -0.25], 40)
        assert shown.result.success, shown.result.worst_constraint
        com = session.robot.center_of_mass(shown.q)
        corners = support_polygon(session.robot, shown.q, balance_over_feet())
        edges = np.roll(corners, -1, axis=0) - corners
        to_com = com - corners
        inside.append((edges[:, 0] * to_com[:, 1] > edges[:, 1] * to_com[:, 0]).all())
        assert ("balance" in status_html(shown, Meter())) == bool(options)
    assert inside == [False, True]


def test_hulls_in_collision_with_each_other_are_both_named() -> None:
    session = h1(base="pelvis", self_collision=True)
    q = session.q
    q[session.robot.joint_names.index("left_shoulder_roll_joint")] = -0.3  # the arm in the chest
    q[session.robot.joint_names.index("left_shoulder_yaw_joint")] = -1.0
    session.set_posture(q)
    shown = session.solve_once()
    assert shown is not None
    assert not shown.result.success
    found = binding(shown.result, shown.robot)
    assert found.obstacle is None
    names = [placed_hulls(shown.robot, q)[hull].name for hull in found.hulls]
    assert len(names) == 2
    assert all(name in shown.result.worst_constraint for name in names)
    text = status_html(shown, Meter())
    assert "self-collision" in text
    assert all(name in text for name in names)


def test_a_log_of_the_h1_poses_it_from_any_base(tmp_path: Path) -> None:
    stance = h1(RIGHT)
    time = np.array([0.0, 0.002])
    shift = np.arange(19) / 1e3
    names = [f"{signal}.{joint}" for signal in ("q_des", "q", "dq", "tau") for joint in JOINT_NAMES]
    rows = np.column_stack([time, *4 * [np.stack([stance.q, stance.q + shift])]])
    path = tmp_path / "h1.csv"
    np.savetxt(path, rows, "%.9g", delimiter=",", header=",".join(["time", *names]), comments="")
    for base in ("pelvis", LEFT):
        session = h1(base=base)
        log = read_log(path, session.robot)
        session.set_posture(log.at(0.002, "q"), origin="log")
        shown = session.solve_once()
        assert shown is not None
        by_name = dict(zip(session.robot.joint_names, shown.q, strict=True))
        wanted = dict(zip(JOINT_NAMES, stance.q + shift, strict=True))
        assert by_name == pytest.approx(wanted, abs=1e-8)
        T_base_pelvis = object_frame(session.robot, shown.q)
        np.testing.assert_array_equal(T_base_pelvis, session.robot.fk(shown.q, "pelvis"))


def test_a_worker_skips_what_came_between_and_survives_errors() -> None:
    started, go, finished = threading.Event(), threading.Event(), threading.Event()
    steps: list[int] = []
    errors: list[Exception] = []

    def step() -> None:
        steps.append(1)
        if len(steps) == 1:
            started.set()
            assert go.wait(30)
            raise ValueError("first")
        finished.set()

    worker = Worker(step, errors.append)
    worker.wake()
    assert started.wait(30)
    for _ in range(100):
        worker.wake()
    go.set()
    assert finished.wait(30)
    worker.stop()
    assert len(steps) == 2
    assert [str(error) for error in errors] == ["first"]


# Logs.


def write_log(path: Path, robot: pdoik.Robot, **columns: list[float]) -> Path:
    """Rows at 0, 0.1 and 0.3 s; joint i is at i + t, wanted at i."""
    time = np.array([0.0, 0.1, 0.3])
    table: dict[str, Any] = {"comment": ["a", "b", "c"], "q.other": [9, 9, 9]}
    for i, joint in reversed(list(enumerate(robot.joint_names))):
        table[f"q.{joint}"] = i + time
        table[f"q_des.{joint}"] = np.full(3, float(i))
        table[f"tau.{joint}"] = np.zeros(3)
    table["time"] = time + 100.0
    table |= columns
    lines = [",".join(table), *(",".join(map(str, row)) for row in zip(*table.values()))]  # noqa: B905
    path.write_text("\n".join(lines) + "\n")
    return path


def read_log(path: Path, robot: pdoik.Robot) -> Log:
    return load_log(path, robot.joint_names)


OBJECT = {
    "object.x": [1.0, 2.0, 3.0],
    "object.y": [0.0, 0.0, 0.0],
    "object.z": [0.5, 0.5, 0.5],
    "object.qw": [1.0, 0.6, 0.0],
    "object.qx": [0.0, 0.0, 0.0],
    "object.qy": [0.0, 0.0, 0.0],
    "object.qz": [0.0, 0.8, 1.0],
}


def test_a_log_is_read_by_its_names_and_interpolated(tmp_path: Path) -> None:
    robot = pdoik.Robot.builtin("panda")
    log = read_log(write_log(tmp_path / "log.csv", robot, **OBJECT), robot)
    assert log.duration == pytest.approx(0.3)
    assert log.postures == ["q", "q_des"]
    assert set(log.signals) == {"q", "q_des", "tau"}
    np.testing.assert_allclose(log.at(0.2, "q"), np.arange(7) + 0.2)
    np.testing.assert_allclose(log.at(9.0, "q"), np.arange(7) + 0.3)
    np.testing.assert_allclose(log.at(0.2, "q_des"), np.arange(7))
    assert [log.row(t) for t in (-1, 0, 0.09, 0.11, 0.29, 5)] == [0, 0, 0, 1, 1, 2]
    assert log.object_pose is not None
    turns = ([1, 0, 0, 0], [0.6, 0, 0, 0.8], [0, 0, 0, 1])
    for T, wxyz in zip(log.object_pose, turns, strict=True):
        np.testing.assert_allclose(T, pose_of(wxyz, T[:3, 3]), atol=1e-12)
    np.testing.assert_allclose(log.object_pose[:, 0, 3], [1, 2, 3])


def test_a_log_without_an_object_has_none(tmp_path: Path) -> None:
    robot = pdoik.Robot.builtin("panda")
    assert read_log(write_log(tmp_path / "log.csv", robot), robot).object_pose is None


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda text: "", ["0 rows"]),
        (lambda text: text.splitlines()[0], ["1 rows"]),
        (lambda text: text.replace("time", "when"), ["no column 'time'"]),
        (lambda text: text.replace("q.panda_joint3", "q.elbow"), ["'q.panda_joint3'"]),
        (lambda text: text.replace("panda_joint", "arm_joint"), ["q.<joint>", "panda_joint1"]),
        (lambda text: text.replace("q.other", "time"), ["'time'", "2 times"]),
        (lambda text: text.replace("4.1,", "four,"), ["row 3", "'q.panda_joint5'", "'four'"]),
        (lambda text: text.replace("4.1,", "nan,"), ["row 3", "'q.panda_joint5'", "'nan'"]),
        (lambda text: text.replace("4.1,", ","), ["row 3", "'q.panda_joint5'", "''"]),
        (lambda text: text.replace("100.3", "100.1"), ["row 4", "'time'", "100.1"]),
        (lambda text: text + "1,2,3\n", ["row 5", "3 cells"]),
        (lambda text: text.replace("object.qy", "object.q"), ["'object.qy'"]),
        (lambda text: text.replace("0.8", "0.7"), ["row 3", "object.qw", "norm"]),
        (lambda text: text.replace("comment", '"comment'), ["CSV"]),
        (lambda text: "\udcff\udcfe" + text, ["CSV"]),
    ],
)
def test_a_bad_log_is_refused_by_file_row_and_column(
    tmp_path: Path, spoil: Callable[[str], str], words: list[str]
) -> None:
    robot = pdoik.Robot.builtin("panda")
    path = write_log(tmp_path / "log.csv", robot, **OBJECT)
    path.write_bytes(spoil(path.read_text()).encode(errors="surrogateescape"))
    with pytest.raises(pdoik.LoadError) as caught:
        read_log(path, robot)
    for word in [str(path), *words]:
        assert word in str(caught.value)


@pytest.mark.parametrize("name", ["missing.csv", "."])
def test_a_log_that_is_not_there_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(pdoik.LoadError, match=r"no such file|folder"):
        load_log(tmp_path / name, ["a"])


def test_the_player_keeps_time_and_stops_at_the_end() -> None:
    at_the_end = threading.Event()
    player = Player(lambda elapsed: elapsed >= 0.2 and at_the_end.set())
    player.load(10.0)
    assert player.advance(1.5) == pytest.approx(1.5)
    player.set_speed(2.0)
    assert player.advance(1.0) == pytest.approx(3.5)
    player.seek(99.0)
    assert player.elapsed == 10.0
    player.load(0.2)
    player.play()
    assert at_the_end.wait(30)
    player.stop()
    assert player.elapsed == 0.2


# What is drawn.


def test_the_drawn_hulls_are_the_solvers(robot: pdoik.Robot, rng: np.random.Generator) -> None:
    hulls = [
        hull
        for hull in placed_hulls(robot, rng.uniform(-1, 1, robot.dof))
        if isinstance(hull, PlacedSpheroid)
    ]
    u = rng.normal(size=(50, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    for hull, wxyz, center, axes in zip(hulls, *spheroid_instances(hulls), strict=True):
        T = pose_of(wxyz, center)
        np.testing.assert_allclose(hull.gap(u * axes @ T[:3, :3].T + center), 0, atol=1e-9)


def shown_with_a_point_in(
    session: Session, hulls: list[PlacedHull], k: int, rng: np.random.Generator
) -> tuple[Shown, int]:
    """What is shown of a cloud with one point in hull k, and the hull that binds."""
    points = rng.uniform(2, 3, (5, 3))
    points[3] = hulls[k].ends.mean(axis=0)
    session.set_thinning(0.0, False)
    session.set_cloud(points)
    session.set_posture(REACHED)
    shown = session.solve_once()
    assert shown is not None
    found = binding(shown.result, shown.robot)
    assert found.obstacle == 3
    (hull,) = found.hulls
    assert hulls[hull].gap(points[3:4])[0] < 0
    return shown, hull


def test_the_binding_capsule_is_found(rng: np.random.Generator) -> None:
    robot = with_capsules(pdoik.Robot.builtin("panda"))
    session = Session(robot, PATIENT)
    hulls = placed_hulls(robot, np.array(REACHED))
    for k in range(len(hulls) - len(robot.occupancy.capsules), len(hulls)):
        shown, hull = shown_with_a_point_in(session, hulls, k, rng)
        assert f"{hulls[hull].name} (capsule" in shown.result.worst_constraint


def test_turns_of_x_turn_x(rng: np.random.Generator) -> None:
    directions = np.concatenate([rng.normal(size=(20, 3)), np.eye(3), -np.eye(3)])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for wxyz, direction in zip(turns_of_x(directions), directions, strict=True):
        np.testing.assert_allclose(pose_of(wxyz, np.zeros(3))[:3, 0], direction, atol=1e-9)


def test_quaternions_come_back(robot: pdoik.Robot) -> None:
    T = robot.fk(robot.mid_configuration())
    np.testing.assert_allclose(pose_of(wxyz_of(T[:3, :3]), T[:3, 3]), T, atol=1e-12)


def test_the_binding_hull_and_point_are_found(session: Session, rng: np.random.Generator) -> None:
    hulls = placed_hulls(session.robot, np.array(REACHED))
    for k in (0, 7, len(hulls) - 1):
        shown, hull = shown_with_a_point_in(session, hulls, k, rng)
        assert hulls[hull].name in shown.result.worst_constraint
        assert margin_text(shown.result, shown.robot).startswith("missed by ")


def test_a_link_is_drawn_by_what_geometry_can_be_had(tmp_path: Path) -> None:
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(TREE)
    visuals, missing = load_visuals(urdf)
    assert set(visuals) == {"base", "left"}
    assert all(glb.startswith(b"glTF") for glb in visuals.values())
    assert len(missing) == 1
    assert "right" in missing[0]
    assert "gone.stl" in missing[0]


def test_the_deepest_tip_is_the_one_that_most_joints_move(tmp_path: Path) -> None:
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(TREE)
    assert deepest_tip(read_robot(urdf)) == "right"


# The command.


def test_without_viser_the_command_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)
    misuse(run("view", "panda", "--no-open"), "pip install 'pdoik[view]'")


def test_misuse_of_the_command_is_told_in_a_line(tmp_path: Path) -> None:
    pytest.importorskip("viser", reason="pip install 'pdoik[view]'")
    log = tmp_path / "log.csv"
    log.write_text("time,q.a\n0,1\n")
    misuse(run("view", "panda", "--no-open", "--replay", log), "log.csv", "panda_joint1")
    misuse(run("view", "robot.urdf", "--no-open"), "robot.urdf")
    scene = tmp_path / "scene.yaml"
    scene.write_text("shapes: [{name: ball, sphere: 1}]\nallowed: [[nobody, ball]]\n")
    misuse(run("view", "panda", "--no-open", "--scene", scene), "scene.yaml", "'nobody'")
    misuse(run("view", "panda", "--no-open", "--q0", "1 2 3"), "7 numbers")
    misuse(run("view", "h1", "--no-open", "--base-link", "tail"), "tail")
    misuse(run("view", "h1", "--no-open", "--tip-link", "tail"), "tail")
    misuse(run("view", "panda", "--no-open", "--host", "192.0.2.1"), "192.0.2.1")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        misuse(run("view", "panda", "--no-open", "--port", port), port, "in use")


@pytest.mark.parametrize(
    ("robot", "links"),
    [("panda", []), ("h1", ["--base-link", LEFT, "--tip-link", RIGHT, "--tip-link", LEFT_ARM])],
)
def test_the_command_serves_on_loopback_until_ctrl_c(
    tmp_path: Path, robot: str, links: list[str]
) -> None:
    pytest.importorskip("viser", reason="pip install 'pdoik[view]'")
    log = write_log(tmp_path / "log.csv", pdoik.Robot.builtin(robot), **OBJECT)
    command = [sys.executable, "-m", "pdoik.cli", "view", robot, *links, "--no-open", "--port=0"]
    with subprocess.Popen(
        [*command, "--replay", log], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        url = process.stdout.readline().split()[0]
        assert url.startswith("http://127.0.0.1:")
        with urllib.request.urlopen(url) as page:
            assert page.status == 200
        process.send_signal(signal.SIGINT)
        rest, complaints = process.communicate(timeout=60)
    assert (process.returncode, rest, complaints) == (0, "", "")


TREE = """<robot name="tree">
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="base">
    <visual><geometry><box size="0.1 0.1 0.1"/></geometry><material name="blue"/></visual>
  </link>
  <link name="left">
    <visual><geometry><mesh filename="package://x/gone.dae"/></geometry></visual>
    <collision>
      <origin xyz="0 0 0.1"/><geometry><cylinder radius="0.02" length="0.2"/></geometry>
    </collision>
  </link>
  <link name="middle"/>
  <link name="right"><visual><geometry><mesh filename="gone.stl"/></geometry></visual></link>
  <joint name="a" type="revolute"><parent link="base"/><child link="left"/><axis xyz="0 0 1"/>
    <origin xyz="0.2 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="b" type="revolute"><parent link="base"/><child link="middle"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="c" type="continuous"><parent link="middle"/><child link="right"/><axis xyz="1 0 0"/>
    <origin xyz="0 0.3 0.1"/></joint>
</robot>"""
