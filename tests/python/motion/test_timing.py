"""Trajectories keep limits, by finite differences, and paths; they begin and end at rest."""

from __future__ import annotations

import doctest
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import pdoik
import pdoik.timing
from pdoik import _core

pytest.importorskip("scipy", reason="pip install 'pdoik[timing]'")
yaml = pytest.importorskip("yaml", reason="pip install 'pdoik[files]'")

Array = NDArray[np.float64]

STARTS = {
    "panda": [0.3, 0.4, 0.0, -1.8, 0.0, 2.2, 0.8],
    "iiwa14": [0.3, 0.6, 0.1, -1.3, 0.2, 0.9, 0.2],
    "ur10": [0.2, -1.2, 1.8, -2.1, -1.57, 0.3],
}
RATE = 1000.0  # [Hz]
ACCELERATION = 6.0
JERK = 120.0
_circles: dict[tuple[str, float], Array] = {}


def circle(name: str, radius: float = 0.1) -> tuple[pdoik.Robot, Array]:
    """A robot, and rows along a level circle of its tip, each solved from the one before."""
    robot = pdoik.Robot.builtin(name)
    if (name, radius) not in _circles:
        solver = pdoik.Solver(robot, pdoik.Options(max_time=60.0))
        rows = [np.array(STARTS[name])]
        target = robot.fk(rows[0])
        center = target[:3, 3] - [radius, 0.0, 0.0]
        for angle in np.linspace(0.0, 2 * np.pi, 301)[1:]:
            target[:3, 3] = center + radius * np.array([np.cos(angle), np.sin(angle), 0.0])
            result = solver.solve(target, q0=rows[-1])
            assert result.success
            rows.append(result.q)
        _circles[name, radius] = np.array(rows)
        assert np.abs(np.diff(_circles[name, radius], axis=0)).max() < 0.03
    return robot, _circles[name, radius].copy()


def differences(trajectory: pdoik.Trajectory) -> list[Array]:
    """Speed, acceleration and jerk between even samples, with the rest before and after."""
    period = trajectory.time[1]
    q = np.pad(trajectory.q, ((4, 4), (0, 0)), mode="edge")
    return [np.diff(q, order, axis=0) / period**order for order in (1, 2, 3)]


def tool_speeds(robot: pdoik.Robot, trajectory: pdoik.Trajectory, tool: Array) -> Array:
    """Between samples, by forward kinematics."""
    points = np.array([(robot.fk(q) @ tool)[:3, 3] for q in trajectory.q])
    speeds: Array = np.linalg.norm(np.diff(points, axis=0), axis=1) / np.diff(trajectory.time)
    return speeds


def middle(trajectory: pdoik.Trajectory) -> Array:
    """Times between samples."""
    times: Array = (trajectory.time[1:] + trajectory.time[:-1]) / 2
    return times


def single(distance: float) -> tuple[pdoik.Robot, Array]:
    """A straight move of one joint."""
    rows = np.zeros((2, 6))
    rows[1, 2] = distance
    return pdoik.Robot.builtin("ur10"), rows


# --- Limits -------------------------------------------------------------------------------------


@pytest.mark.parametrize("jerk", [None, JERK])
@pytest.mark.parametrize("name", sorted(STARTS))
def test_limits_hold_by_finite_differences_of_positions(name: str, jerk: float | None) -> None:
    robot, rows = circle(name)
    done = pdoik.time_path(
        robot, rows, max_acceleration=ACCELERATION, max_jerk=jerk, rate=RATE, max_speed=1.0
    )
    speed, acceleration, jerks = differences(done)
    limits = np.minimum(robot.velocity, 1.0)
    assert (np.abs(speed) <= limits * (1 + 1e-9)).all()
    assert (np.abs(acceleration) <= ACCELERATION * 1.001).all()
    assert np.abs(acceleration).max() > 0.9 * ACCELERATION  # it is not slow either
    assert (np.abs(done.dq) <= limits * (1 + 1e-9)).all()
    assert (np.abs(done.ddq) <= ACCELERATION * (1 + 1e-9)).all()
    if jerk is not None:
        assert np.abs(jerks).max() <= jerk * 1.01
        assert np.abs(jerks).max() > 0.8 * jerk
    np.testing.assert_allclose(
        np.diff(done.q, axis=0) * RATE, done.dq[1:], atol=ACCELERATION / RATE
    )
    np.testing.assert_allclose(done.q[[0, -1]], rows[[0, -1]], rtol=0, atol=1e-12)
    assert (done.dq[[0, -1]] == 0.0).all()


def test_rates_are_those_that_toppra_finds(
    rng: np.random.Generator,
) -> None:
    toppra = pytest.importorskip("toppra")
    for _ in range(10):
        way = rng.uniform(-1.0, 1.0, (6, 7))
        path = toppra.SplineInterpolator(np.linspace(0.0, 1.0, 6), way)
        most_a, most_v = rng.uniform(1.0, 5.0, 7), rng.uniform(0.5, 2.0, 7)
        s = np.linspace(0.0, 1.0, 301)
        limits = [
            toppra.constraint.JointVelocityConstraint(np.stack([-most_v, most_v], axis=1)),
            toppra.constraint.JointAccelerationConstraint(
                np.stack([-most_a, most_a], axis=1),
                discretization_scheme=toppra.constraint.DiscretizationType.Interpolation,
            ),
        ]
        theirs = toppra.algorithm.TOPPRA(limits, path, gridpoints=s)
        _, rate, _ = theirs.compute_parameterization(0.0, 0.0)
        a, b = path(s, 1) / most_a, path(s, 2) / most_a
        most = np.min((most_v / np.maximum(np.abs(path(s, 1)), 1e-9)) ** 2, axis=1)
        ours = np.sqrt(_core.fastest_squares(s, a, b, most))
        np.testing.assert_allclose(ours, rate, rtol=1e-5, atol=1e-5)


def test_limits_of_each_joint_are_its_own() -> None:
    robot, rows = circle("ur10")
    speed = np.array([0.05, np.inf, 0.4, 9.0, 9.0, 9.0])
    acceleration = np.array([0.5, 1.0, 2.0, 3.0, 4.0, 5.0])
    done = pdoik.time_path(robot, rows, max_speed=speed, max_acceleration=acceleration, rate=RATE)
    first, second, _ = differences(done)
    used = np.abs(first).max(axis=0) / np.minimum(speed, robot.velocity)
    assert used.max() <= 1 + 1e-9
    assert used[0] > 0.99
    assert (np.abs(second).max(axis=0) <= acceleration * 1.001).all()


@pytest.mark.parametrize(
    ("distance", "speed", "acceleration", "jerk", "least"),
    [
        (1.0, 1.0, 2.0, None, 1.5),  # speeds up, goes on, brakes
        (0.1, 1.0, 2.0, None, 2 * np.sqrt(0.05)),  # never at full speed
        (1.0, 1.0, 2.0, 10.0, 1.7),  # all seven phases of an S
        (0.01, 1.0, 2.0, 10.0, 4 * np.cbrt(0.01 / 20)),  # jerk alone
        (1.0, 1.0, 200.0, 0.1, 4 * np.cbrt(1 / 0.2)),
    ],
)
def test_a_straight_move_takes_what_theory_says(
    distance: float, speed: float, acceleration: float, jerk: float | None, least: float
) -> None:
    robot, rows = single(distance)
    done = pdoik.time_motion(
        robot, rows, max_speed=speed, max_acceleration=acceleration, max_jerk=jerk
    )
    assert least * (1 - 1e-9) <= done.duration <= least * (1.001 if jerk is None else 1.03)
    assert done.deviation < 1e-12


@pytest.mark.parametrize("seed", range(4))
def test_a_move_with_corners_keeps_limits_and_is_no_faster_than_can_be(
    seed: int, rng: np.random.Generator
) -> None:
    robot = pdoik.Robot.builtin("panda")
    rows = robot.mid_configuration() + rng.uniform(-1.0, 1.0, (5, 7))
    done = pdoik.time_motion(robot, rows, max_acceleration=5.0, rate=RATE)
    smooth = pdoik.time_motion(robot, rows, max_acceleration=5.0, max_jerk=60.0, rate=RATE)
    by_speed = np.abs(np.diff(rows, axis=0) / robot.velocity).max(axis=1).sum()
    assert 0.9 * by_speed <= done.duration <= smooth.duration <= 1.4 * done.duration
    for each in (done, smooth):
        speed, acceleration, jerk = differences(each)
        assert (np.abs(speed) <= robot.velocity * (1 + 1e-9)).all()
        assert np.abs(acceleration).max() <= 5.0 * 1.001
    assert np.abs(jerk).max() <= 60.0 * 1.01


# --- The tool -----------------------------------------------------------------------------------


@pytest.mark.parametrize("jerk", [None, JERK])
@pytest.mark.parametrize("lever", [0.0, 0.15])
@pytest.mark.parametrize("name", sorted(STARTS))
def test_the_tool_goes_at_its_speed_and_never_faster(
    name: str, lever: float, jerk: float | None
) -> None:
    robot, rows = circle(name)
    tool = np.eye(4)
    tool[:3, 3] = 0.0, lever, lever
    done = pdoik.time_path(
        robot,
        rows,
        tool_speed=0.08,
        T_tip_tool=tool,
        max_acceleration=ACCELERATION,
        max_jerk=jerk,
        rate=RATE,
    )
    assert done.dips == ()
    speeds, times = tool_speeds(robot, done, tool), middle(done)
    assert speeds.max() <= 0.08 * (1 + 1e-6)
    inside = (times > 0.2) & (times < done.duration - 0.2)
    assert speeds[inside].min() >= 0.08 * 0.99
    assert done.duration == pytest.approx(2 * np.pi * 0.1 / 0.08, rel=0.05)


def test_a_joint_that_is_too_slow_makes_a_dip_that_names_it() -> None:
    robot, rows = circle("ur10")
    free = pdoik.time_path(robot, rows, tool_speed=0.2, max_acceleration=ACCELERATION, rate=RATE)
    assert free.dips == ()
    fastest = np.abs(free.dq).max(axis=0)
    limits = np.full(6, np.inf)
    limits[2] = 0.7 * fastest[2]
    done = pdoik.time_path(
        robot,
        rows,
        tool_speed=0.2,
        max_speed=limits,
        max_acceleration=ACCELERATION,
        rate=RATE,
        at=np.linspace(0.0, 30.0, len(rows)),
    )
    assert done.duration > free.duration
    assert done.dips
    assert {dip.limit for dip in done.dips} == {"speed"}
    assert {dip.joint for dip in done.dips} == {"elbow_joint"}
    speeds, times = tool_speeds(robot, done, np.eye(4)), middle(done)
    outside = (times > 0.2) & (times < done.duration - 0.2)
    for dip in done.dips:
        within = (times >= dip.start) & (times <= dip.end)
        assert speeds[within].min() == pytest.approx(dip.speed, rel=0.01)
        assert dip.speed < 0.2 * 0.8
        np.testing.assert_allclose(
            np.interp([dip.start, dip.end], done.time, done.at),
            [dip.start_at, dip.end_at],
            atol=0.02,
        )
        outside &= ~within
    assert speeds[outside].min() >= 0.2 * 0.985
    assert speeds.max() <= 0.2 * (1 + 1e-6)


def test_a_corner_of_the_tools_path_makes_a_dip_of_acceleration() -> None:
    robot = pdoik.Robot.builtin("panda")
    solver = pdoik.Solver(robot, pdoik.Options(max_time=60.0))
    rows = [np.array(STARTS["panda"])]
    target = robot.fk(rows[0])
    for direction in ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]):
        for _ in range(60):
            target[:3, 3] += 0.002 * np.array(direction)
            result = solver.solve(target, q0=rows[-1])
            assert result.success
            rows.append(result.q)
    done = pdoik.time_path(robot, rows, tool_speed=0.1, max_acceleration=ACCELERATION)
    (dip,) = done.dips
    assert dip.limit == "acceleration"
    assert dip.joint in robot.joint_names
    assert dip.start_at < 60.0 < dip.end_at
    assert dip.speed < 0.05
    rounder = pdoik.time_path(
        robot, rows, tool_speed=0.1, max_acceleration=ACCELERATION, deviation=2e-3
    )
    assert rounder.dips[0].speed > 1.5 * dip.speed


@pytest.mark.parametrize("jerk", [None, JERK])
@pytest.mark.parametrize("speed", [0.01, 0.1])
def test_ways_back_make_short_dips_and_cost_nothing_elsewhere(
    speed: float, jerk: float | None
) -> None:
    robot = pdoik.Robot.builtin("panda")
    there = np.array(STARTS["panda"])
    back = there + np.array([0.6, -0.4, 0.3, 0.5, -0.2, 0.4, 0.1])
    done = pdoik.time_path(
        robot,
        [there, back, there],
        tool_speed=speed,
        max_acceleration=ACCELERATION,
        max_jerk=jerk,
        deviation=1e-3,
    )
    line = there + np.linspace(0.0, 1.0, 2001)[:, None] * (back - there)
    points = np.array([robot.fk(q)[:3, 3] for q in line])
    length = 2 * np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert length / speed * 0.995 <= done.duration <= length / speed + 1.0
    assert done.dips
    assert all(0.98 < dip.start_at < dip.end_at < 1.02 for dip in done.dips)
    times = np.linspace(0.3, done.duration - 0.3, 2001)
    q, dq, _ = done.sample(times)
    speeds = np.array(
        [np.linalg.norm(robot.jacobian(a)[:3] @ b) for a, b in zip(q, dq, strict=True)]
    )
    outside = np.ones(len(times), dtype=bool)
    for dip in done.dips:
        outside &= (times < dip.start - 0.01) | (times > dip.end + 0.01)
    assert np.percentile(speeds[outside], 1) >= 0.985 * speed


def test_a_tool_that_turns_keeps_to_its_rate() -> None:
    robot = pdoik.Robot.builtin("panda")
    rows = np.tile(STARTS["panda"], (41, 1))
    rows[:, 6] += np.linspace(0.0, 1.0, 41)  # about its own axis, so the tip stands
    rows[:, 0] += np.linspace(0.0, 0.2, 41)
    done = pdoik.time_path(
        robot, rows, tool_speed=1.0, tool_turn=0.3, max_acceleration=ACCELERATION, rate=RATE
    )
    turned = [robot.fk(a)[:3, :3].T @ robot.fk(b)[:3, :3] for a, b in pairwise(done.q)]
    angles = [np.arcsin(np.clip(np.linalg.norm(R - R.T) / np.sqrt(8), 0.0, 1.0)) for R in turned]
    assert np.max(angles) * RATE <= 0.3 * (1 + 1e-6)
    assert np.median(angles) * RATE == pytest.approx(0.3, rel=0.01)
    (dip,) = done.dips
    assert (dip.limit, dip.joint) == ("turn", "")


# --- Where it goes ------------------------------------------------------------------------------


@pytest.mark.parametrize("deviation", [1e-5, 1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize("corners", [False, True])
def test_it_keeps_as_near_to_the_straight_lines_as_it_is_told(
    deviation: float, corners: bool, rng: np.random.Generator
) -> None:
    robot, rows = circle("panda")
    if corners:
        rows = robot.mid_configuration() + rng.uniform(-1.0, 1.0, (6, 7))
    done = pdoik.time_path(
        robot, rows, max_acceleration=ACCELERATION, deviation=deviation, rate=RATE
    )
    numbers = np.arange(len(rows))
    straight = np.stack([np.interp(done.at, numbers, column) for column in rows.T], axis=1)
    off = np.abs(done.q - straight).max()
    assert off <= done.deviation * (1 + 1e-6) + 1e-12
    assert 0.2 * deviation < done.deviation <= deviation
    assert (np.diff(done.at) >= 0.0).all()
    assert (done.q <= rows.max(axis=0) + 1e-12).all()  # so joint limits hold as they did
    assert (done.q >= rows.min(axis=0) - 1e-12).all()


def test_coarser_corners_are_faster(rng: np.random.Generator) -> None:
    robot = pdoik.Robot.builtin("panda")
    rows = robot.mid_configuration() + rng.uniform(-1.0, 1.0, (6, 7))
    times = [
        pdoik.time_motion(robot, rows, max_acceleration=5.0, deviation=deviation).duration
        for deviation in (0.0, 1e-3, 1e-2, 1e-1)
    ]
    assert times == sorted(times, reverse=True)


def test_it_rests_where_it_is_told_and_meets_these_rows() -> None:
    robot, rows = circle("panda")
    done = pdoik.time_path(
        robot,
        rows,
        tool_speed=0.1,
        max_acceleration=ACCELERATION,
        max_jerk=JERK,
        rest_at=[100, 0, 220, 100],
    )
    assert done.dips == ()  # a rest is none
    for row in (0, 100, 220, 300):
        (k,) = np.flatnonzero(np.abs(done.at - row) < 1e-9)
        np.testing.assert_allclose(done.q[k], rows[row], rtol=0, atol=1e-9)
        np.testing.assert_allclose(done.dq[k], 0.0, atol=1e-9)
    assert (np.abs(done.dq).max(axis=1) < 1e-9).sum() == 4


def test_no_deviation_is_resting_at_every_corner(rng: np.random.Generator) -> None:
    robot = pdoik.Robot.builtin("ur10")
    corners = rng.uniform(-1.0, 1.0, (4, 6))
    rows = np.concatenate([np.linspace(a, b, 10) for a, b in pairwise(corners)])
    done = pdoik.time_motion(robot, rows, max_acceleration=3.0, deviation=0.0)
    still = np.abs(done.dq).max(axis=1) == 0.0
    np.testing.assert_allclose(done.q[still], corners, rtol=0, atol=1e-12)
    least = 0.0
    for move in np.abs(np.diff(corners, axis=0)):
        apart = [pdoik.time_motion(robot, [0 * move, move], max_acceleration=3.0).duration]
        least += apart[0]
    assert done.duration == pytest.approx(least, rel=1e-3)


def test_rows_that_are_repeated_are_one() -> None:
    robot, rows = circle("iiwa14")
    once = pdoik.time_path(robot, rows, max_acceleration=ACCELERATION)
    twice = pdoik.time_path(robot, np.repeat(rows, 2, axis=0), max_acceleration=ACCELERATION)
    np.testing.assert_allclose(twice.q, once.q, rtol=0, atol=1e-12)
    np.testing.assert_allclose(twice.time, once.time, rtol=0, atol=1e-12)


def test_noise_of_a_solver_in_rows_costs_little(rng: np.random.Generator) -> None:
    robot, rows = circle("panda")
    noisy = rows + 1e-5 * rng.standard_normal(rows.shape)
    clean = pdoik.time_path(robot, rows, max_acceleration=ACCELERATION).duration
    assert pdoik.time_path(robot, noisy, max_acceleration=ACCELERATION).duration < 1.1 * clean


@pytest.mark.parametrize("size", [1e-8, 1e-4])
def test_short_moves_and_ways_back_are_timed(size: float) -> None:
    robot = pdoik.Robot.builtin("h1")
    rows = size * np.array([[0.0], [1.0], [0.2], [1.0]]) * np.linspace(-1.0, 1.0, robot.dof)
    done = pdoik.time_motion(robot, rows, max_acceleration=10.0, deviation=0.0)
    assert np.isfinite(done.q).all()
    assert np.abs(done.ddq).max() <= 10.0 * (1 + 1e-9)
    least = sum(2 * np.sqrt(length * size / 10.0) for length in (1.0, 0.8, 0.8))
    assert done.duration == pytest.approx(least, rel=0.01)


# --- Samples and files --------------------------------------------------------------------------


def test_samples_are_even_at_a_rate_and_end_at_rest_within_a_period() -> None:
    robot, rows = circle("ur10")
    own = pdoik.time_path(robot, rows, max_acceleration=ACCELERATION)
    even = pdoik.time_path(robot, rows, max_acceleration=ACCELERATION, rate=125.0)
    np.testing.assert_allclose(even.time, np.arange(len(even.time)) / 125.0, atol=1e-12)
    assert 0.0 <= even.duration - own.duration < 1 / 125.0
    np.testing.assert_array_equal(even.q[-1], own.q[-1])


def test_a_trajectory_is_sampled_between_and_beyond_its_own_times() -> None:
    robot, rows = circle("panda")
    done = pdoik.time_path(robot, rows, max_acceleration=ACCELERATION)
    q, dq, ddq = done.sample(done.time[:-1])
    np.testing.assert_allclose(q, done.q[:-1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(dq, done.dq[:-1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(ddq, done.ddq[:-1], rtol=0, atol=1e-9)
    fine = pdoik.time_path(robot, rows, max_acceleration=ACCELERATION, rate=RATE)
    q, dq, _ = done.sample(fine.time)
    np.testing.assert_allclose(q, fine.q, rtol=0, atol=1e-6)
    np.testing.assert_allclose(dq, fine.dq, rtol=0, atol=1e-3)
    for time, end in ((-1.0, 0), (done.duration + 1.0, -1)):
        q, dq, ddq = done.sample(time)
        np.testing.assert_array_equal(q, done.q[end])
        assert not dq.any()
        assert not ddq.any()
    assert done.sample(np.zeros((2, 3)))[0].shape == (2, 3, 7)


def test_a_csv_file_holds_every_number(tmp_path: Path) -> None:
    robot, rows = circle("ur10")
    done = pdoik.time_path(robot, rows, max_acceleration=ACCELERATION, rate=100.0)
    done.to_csv(tmp_path / "move.csv")
    header = (tmp_path / "move.csv").read_text().splitlines()[0].split(",")
    assert header[:3] == ["time", "at", "q.shoulder_pan_joint"]
    assert header[8] == "dq.shoulder_pan_joint"
    assert header[-1] == "ddq.wrist_3_joint"
    back = pdoik.Trajectory.from_csv(tmp_path / "move.csv")
    assert back.joint_names == tuple(robot.joint_names)
    for name in ("time", "at", "q", "dq", "ddq"):
        np.testing.assert_array_equal(getattr(back, name), getattr(done, name))
    assert sorted(file.name for file in tmp_path.iterdir()) == ["move.csv"]


def test_a_yaml_file_is_a_joint_trajectory_as_pyyaml_reads_it(tmp_path: Path) -> None:
    robot, rows = circle("panda")
    done = pdoik.time_path(robot, rows, max_acceleration=ACCELERATION, rate=300.0)
    done.to_yaml(tmp_path / "move.yaml")
    read = yaml.safe_load((tmp_path / "move.yaml").read_text())
    assert read["joint_names"] == robot.joint_names
    points = read["points"]
    for name, wanted in (
        ("positions", done.q),
        ("velocities", done.dq),
        ("accelerations", done.ddq),
    ):
        np.testing.assert_allclose([each[name] for each in points], wanted, rtol=0, atol=1e-11)
    starts = [each["time_from_start"] for each in points]
    assert all(isinstance(part, int) for start in starts for part in start.values())
    assert all(0 <= start["nanosec"] < 10**9 for start in starts)
    times = [start["sec"] + 1e-9 * start["nanosec"] for start in starts]
    np.testing.assert_allclose(times, done.time, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "time,at,q.a,dq.a\n0,0,0,0\n1,1,1,0\n",  # a column is missing
        "time,at,q.a,dq.a,ddq.a\n0,0,0,0,0\n1,1,x,0,0\n",
        "time,at,q.a,dq.a,ddq.a\n0,0,0,0,0\n1,1,nan,0,0\n",
        "time,at,q.a,dq.a,ddq.a\n0,0,0,0,0\n0,1,1,0,0\n",  # time stands
        "time,at,q.a,dq.a,ddq.a\n0,0,0,0,0\n",
    ],
)
def test_another_file_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "other.csv").write_text(text)
    with pytest.raises(pdoik.LoadError, match=r"other\.csv: not a trajectory file"):
        pdoik.Trajectory.from_csv(tmp_path / "other.csv")
    with pytest.raises(pdoik.LoadError, match=r"missing\.csv"):
        pdoik.Trajectory.from_csv(tmp_path / "missing.csv")


# --- A second look ------------------------------------------------------------------------------


def test_a_trajectory_is_judged_again_all_along() -> None:
    robot, rows = circle("panda")
    done = pdoik.time_path(robot, rows, max_acceleration=ACCELERATION)
    solver = pdoik.Solver(robot)
    clear = done.recheck(solver)
    assert clear.success
    assert clear.clearance == np.inf
    assert 0.0 < clear.self_distance < 1.0
    assert clear.limit_violation == 0.0
    half = done.sample(done.duration / 2)[0]
    point = (robot.fk(half) @ [0.0, 0.0, -0.03, 1.0])[:3]  # inside the flange
    touched = done.recheck(solver, obstacles=point[None])
    assert not touched.success
    assert touched.clearance < 0.0
    assert touched.time == pytest.approx(done.duration / 2, abs=0.1 * done.duration)
    assert touched.worst.clearance == touched.clearance
    shape = pdoik.Shape.sphere("ball", point, 0.01)
    assert done.recheck(solver, obstacles=[shape]).clearance < touched.clearance


def test_a_trajectory_beyond_a_limit_is_told() -> None:
    robot = pdoik.Robot.builtin("panda")
    rows = np.tile(robot.mid_configuration(), (2, 1))
    rows[1, 3] = robot.upper[3] + 0.1
    found = pdoik.time_motion(robot, rows, max_acceleration=1.0).recheck(pdoik.Solver(robot))
    assert not found.success
    assert found.limit_violation == pytest.approx(0.1)


def test_robots_with_several_tips_are_judged_too() -> None:
    robot = pdoik.Robot.builtin("h1")
    rows = robot.mid_configuration() + np.array([[0.0], [0.1]])
    done = pdoik.time_motion(robot, rows, max_acceleration=10.0)
    assert done.recheck(pdoik.Solver(robot)).self_distance < 1.0
    with pytest.raises(ValueError, match="the solver's robot has joints panda_joint1"):
        done.recheck(pdoik.Solver(pdoik.Robot.builtin("panda")))
    with pytest.raises(ValueError, match="max_step is 0, expected"):
        done.recheck(pdoik.Solver(robot), max_step=0)


# --- Misuse -------------------------------------------------------------------------------------

GOOD = np.array([STARTS["ur10"], np.array(STARTS["ur10"]) + 0.1])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"q": GOOD[:1]}, r"q has shape \(1, 6\), expected \(m, 6\)"),
        ({"q": GOOD[:, :5]}, r"q has shape \(2, 5\)"),
        ({"q": GOOD[0]}, r"q has shape \(6,\)"),
        ({"q": [GOOD[0], GOOD[0]]}, "no two different rows"),
        ({"q": [GOOD[0], np.full(6, np.nan)]}, "row 1 of q holds NaN or infinity"),
        ({"max_acceleration": None}, r"max_acceleration is missing.*shape \(6,\)"),
        ({"max_acceleration": [1.0, 2.0]}, r"max_acceleration has shape \(2,\), expected"),
        ({"max_acceleration": -1.0}, "max_acceleration of 'shoulder_pan_joint' is -1"),
        ({"max_acceleration": np.inf}, "max_acceleration of 'shoulder_pan_joint' is infinite"),
        ({"max_speed": [1, 1, 0, 1, 1, 1]}, "max_speed of 'elbow_joint' is 0"),
        ({"max_jerk": np.nan}, "max_jerk of 'shoulder_pan_joint' is nan"),
        ({"tool_speed": 0.0}, r"tool_speed \[m/s\] is 0.0, expected a positive"),
        ({"tool_turn": np.inf}, r"tool_turn \[rad/s\] is inf"),
        ({"tip": "tool0"}, "no tool_speed or tool_turn"),
        ({"tool_speed": 1.0, "tip": "hand"}, "'hand' is not a link"),
        ({"tool_speed": 1.0, "T_tip_tool": np.eye(3)}, r"T_tip_tool has shape \(3, 3\)"),
        ({"tool_speed": 1.0, "T_tip_tool": 2 * np.eye(4)}, "T_tip_tool is no rigid motion"),
        ({"at": [0.0]}, r"at has shape \(1,\), expected \(2,\)"),
        ({"at": [1.0, 0.0]}, "at does not rise"),
        ({"rest_at": [2]}, "rest_at has 2, and q has 2 rows"),
        ({"rest_at": [-1]}, "rest_at has -1"),
        ({"deviation": -1e-3}, "deviation is -0.001, expected 0 or more"),
        ({"rate": 0.0}, "rate is 0.0, expected a positive number"),
    ],
)
def test_misuse_is_told_by_name(arguments: dict, said: str) -> None:
    robot = pdoik.Robot.builtin("ur10")
    with pytest.raises(ValueError, match=said):
        pdoik.time_path(robot, **{"q": GOOD, "max_acceleration": 1.0, **arguments})


def test_a_tool_of_a_robot_with_several_tips_has_to_be_named() -> None:
    robot = pdoik.Robot.builtin("h1")
    rows = robot.mid_configuration() + np.array([[0.0], [0.1]])
    with pytest.raises(ValueError, match="tip is not given and the robot has several"):
        pdoik.time_path(robot, rows, max_acceleration=1.0, tool_speed=0.1)
    pdoik.time_path(robot, rows, max_acceleration=1.0, tool_speed=0.1, tip=robot.tip_links[2])


def test_joints_without_a_speed_limit_need_one_if_they_move() -> None:
    robot = pdoik.Robot.from_dh([pdoik.DhRow(a=0.3), pdoik.DhRow(a=0.3)])
    rows = [[0.0, 0.0], [0.0, 1.0]]
    with pytest.raises(ValueError, match=r"'joint2' moves .* has no speed limit: give max_speed"):
        pdoik.time_motion(robot, rows, max_acceleration=1.0)
    done = pdoik.time_motion(robot, rows, max_acceleration=1.0, max_speed=[np.inf, 0.5])
    assert done.duration == pytest.approx(2.5, rel=1e-3)


def test_a_joint_that_may_not_move_is_told() -> None:
    text = """<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="revolute">
    <parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="0" effort="1"/></joint></robot>"""
    robot = pdoik.Robot.from_urdf(text)
    with pytest.raises(ValueError, match="'j' moves along the path and may not move"):
        pdoik.time_motion(robot, [[0.0], [0.5]], max_acceleration=1.0)


def test_what_is_missing_is_asked_for_by_its_extra_and_files_need_none(tmp_path: Path) -> None:
    program = f"""
import sys
for name in ("scipy", "matplotlib", "yaml"): sys.modules[name] = None
import numpy as np, pdoik
line = np.linspace(0.0, 1.0, 3)
moved = pdoik.Trajectory(joint_names=("j",), time=line, q=line[:, None], dq=0 * line[:, None],
                         ddq=0 * line[:, None], at=line)
moved.to_csv({str(tmp_path / "m.csv")!r})
moved.to_yaml({str(tmp_path / "m.yaml")!r})
print(pdoik.Trajectory.from_csv({str(tmp_path / "m.csv")!r}))
robot = pdoik.Robot.builtin("panda")
pdoik.time_motion(robot, [robot.mid_configuration(), robot.mid_configuration() + 0.1],
                  max_acceleration=1.0)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout == "<Trajectory of 1 joints, 1 s, 3 samples>\n", done.stderr
    assert done.stderr.splitlines()[-1].endswith("is not installed: pip install 'pdoik[timing]'")


def test_shapes_of_a_trajectory_belong_together() -> None:
    line = np.linspace(0.0, 1.0, 3)
    arrays = {"time": line, "q": line[:, None], "dq": line[:, None], "ddq": line[:, None]}
    pdoik.Trajectory(joint_names=("j",), at=line, **arrays)
    with pytest.raises(ValueError, match=r"dq has shape \(2, 1\), expected \(3, 1\)"):
        pdoik.Trajectory(joint_names=("j",), at=line, **{**arrays, "dq": line[:2, None]})
    with pytest.raises(ValueError, match=r"at has shape \(2,\)"):
        pdoik.Trajectory(joint_names=("j",), at=line[:2], **arrays)
    with pytest.raises(ValueError, match="time does not rise"):
        pdoik.Trajectory(joint_names=("j",), at=line, **{**arrays, "time": 0 * line})


def test_the_docstrings_example_is_true() -> None:
    outcome = doctest.testmod(pdoik.timing)
    assert outcome.attempted > 0
    assert outcome.failed == 0
