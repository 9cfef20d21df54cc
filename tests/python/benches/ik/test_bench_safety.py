"""The bench of safe steps in small: its distances, its descents, and the faults it has to see."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import typer

pytest.importorskip("coal")
pytest.importorskip("dask", reason="pip install 'pdoik[bench]'")
from bench.ik.safety import __main__ as safety
from bench.ik.safety import ball, carried, follow, humanoid, joints, steps, unreached, world
from bench.ik.safety.least import REACH, Errand
from bench.ik.soak import tracking
from bench.ik.soak.judge import Judge, random_configurations
from bench_command import tables_of

# --- Distances and descents -------------------------------------------------------------------


def test_gaps_to_a_box_are_those_of_points_along_the_capsule(rng: np.random.Generator) -> None:
    for _ in range(20):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = unreached._facing(rng.normal(size=3)), rng.uniform(-0.2, 0.2, 3)
        T[:3, :3] = np.linalg.qr(T[:3, :3])[0]
        T[:3, :3] *= np.linalg.det(T[:3, :3])
        box = world.Box(size=rng.uniform(0.1, 0.4, 3), T=T)
        p, q = rng.uniform(-0.6, 0.6, (2, 1, 3))
        core = p + np.linspace(0.0, 1.0, 3001)[:, None] * (q - p)
        off = np.abs((core - T[:3, 3]) @ T[:3, :3]) - box.size / 2
        outside = np.linalg.norm(np.maximum(off, 0.0), axis=1).min() - 0.05
        gap = world.to_box(p, q, np.array([0.05]), box)[0][0]
        if outside > -0.04:
            assert gap == pytest.approx(outside, abs=1e-4)
            assert world.box_gap(p, q, np.array([0.05]), box) <= gap + 1e-9
        else:
            assert gap < -0.04


@pytest.mark.parametrize("kind", ["wall", "points", "itself"])
def test_gradients_of_errands_are_central_differences(kind: str, rng: np.random.Generator) -> None:
    judge = world.judge_of("panda")
    start, T, around = unreached.draw(judge, kind, rng)
    errand = Errand(judge, around, T)
    q = errand.creep(start)[1]  # to where it touches
    r, J = errand.goal(q)
    gaps, G = errand.contacts(q, REACH)
    assert len(gaps)
    for i in range(len(q)):
        d = 1e-6 * np.eye(len(q))[i]
        ahead, behind = errand.goal(q + d)[0], errand.goal(q - d)[0]
        np.testing.assert_allclose((ahead - behind) / 2e-6, J[:, i], atol=1e-6)
        ahead, behind = (errand.contacts(q + s * d, REACH)[0] for s in (1, -1))
        if len(ahead) == len(behind) == len(gaps):
            rate = (ahead - behind) / 2e-6
            assert np.mean(np.abs(rate - G[:, i]) < 1e-4) > 0.8  # nearest features change
    assert errand.errors(q[None])[0] == pytest.approx(np.linalg.norm(r), abs=1e-9)


def test_descents_find_a_pose_that_can_be_reached(rng: np.random.Generator) -> None:
    judge = world.judge_of("iiwa14")
    q = random_configurations(judge.kinematics, 1, rng)[0] * 0.5
    errand = Errand(judge, world.World(balls=world.NO_BALLS), world.pose_of(judge, q))
    assert errand.creep(q + 0.05)[0] < 1e-4
    assert errand.least(random_configurations(judge.kinematics, 8, rng))[0] < 1e-4


def test_clearances_from_a_ball_are_the_judges() -> None:
    judge = world.judge_of("panda")
    count = len(ball.centres(0.5))
    Q = np.tile(ball.POSTURE, (count, 1))
    at = ball.centres(0.5)
    for points in (116, 0):
        clear = ball.clearances(judge, Q, points, 0.5, 3)
        ours = ball.ball_of(points, 3) if points else np.array([[0.0, 0.0, 0.0, ball.RADIUS]])
        near = np.flatnonzero(np.isfinite(clear))
        assert 100 < len(near) < count
        a, b = judge.hulls(judge.kinematics.place(ball.POSTURE[None]))
        for k in near[::50]:
            known = judge.clearance(a, b, ours + np.r_[at[k], 0.0], world.KEPT)[0]
            assert clear[k] == pytest.approx(known, abs=1e-12)
        assert clear.min() < -0.02  # an arm that stands still is hit


# --- Faults that it has to see ----------------------------------------------------------------


def test_a_step_into_a_ball_or_into_itself_is_deeper(rng: np.random.Generator) -> None:
    judge = world.judge_of("panda")
    held = carried._in_hand(rng)
    q = carried._start(judge, held, rng)
    T = world.pose_of(judge, q)
    at = np.r_[(T @ held.T)[:3, 3], 0.01]
    far = np.array([9.0, 9.0, 9.0, 0.01])
    moved = q + np.r_[0.2, np.zeros(6)]
    in_hand_then = np.r_[(world.pose_of(judge, moved) @ held.T)[:3, 3], 0.01]
    for balls, is_bad in ((far, False), (at, False), (in_hand_then, True)):
        beyond = carried.deeper(judge, held, np.array([q, moved]), balls[None, None])
        assert (beyond[0] > world.ROUNDING) == is_bad
    folded = judge.kinematics.into_limits(np.array([[0.0, -1.76, 0.0, -3.07, 0.0, -0.01, 0.0]]))
    beyond = carried.deeper(judge, held, np.array([q, folded[0]]), far[None, None])
    assert beyond[0] > 0.01


def test_a_fault_of_one_step_shows_in_the_table() -> None:
    job = {"seed": 0, "key": [0, 0], "family": "panda", "count": 30, "name": "small"}
    rows = steps.run_job(job)
    assert [line.failures for line in steps.lines(pd.DataFrame(rows))] == [0, 0]
    rows[0]["fault deeper"], rows[0]["fault passed through"] = 1, 2
    assert [line.failures for line in steps.lines(pd.DataFrame(rows))] == [1, 2]
    assert tracking.FAULTS


def test_a_robot_that_rests_too_early_is_told_from_one_at_its_least() -> None:
    judge = world.judge_of("ur10")
    start, goal, around = unreached.draw(judge, "beyond reach", np.random.default_rng(5))
    errand = Errand(judge, around, goal)
    least, there = errand.creep(start)
    assert errand.errors(start[None])[0] - least > unreached.WORSE
    assert errand.errors(there[None])[0] - errand.creep(there)[0] < 1e-5


def test_joints_that_swing_reverse_and_those_that_go_on_do_not() -> None:
    k = np.arange(200)[:, None]
    assert unreached.reversals(1e-4 * k * np.ones(3)) == 0.0
    assert unreached.reversals(np.where(k % 2, 1e-4, 0.0) * np.ones(3)) == 1.0


def test_a_humanoid_that_stands_still_short_of_its_goal_could_move() -> None:
    spec, _, bent = world.h1_stance()
    judge = Judge(spec, spec.make().joint_names)
    foot = world.pose_of(judge, bent, humanoid.FOOT)
    hand = world.pose_of(judge, bent, humanoid.HAND)
    hand[2, 3] += 0.1
    row = humanoid.verdict(judge, np.tile(bent, (4, 1)), np.zeros(3, bool), foot, hand, 0)
    assert (row["short"], row["moves"], row["could_unstruck"]) == (3, 0, 3)
    row = humanoid.verdict(judge, np.array([bent, bent + 1e-4]), np.zeros(1, bool), foot, hand, 0)
    assert (row["short"], row["moves"], row["could"]) == (1, 1, 0)


def test_turns_idle_joints_and_singular_wrists() -> None:
    low, high = np.full(2, -6.0), np.full(2, 6.0)
    turned = joints.fewer_turns(np.array([5.0, 5.0]), np.array([-0.5, 3.0]), low, high)
    assert turned.tolist() == [True, False]
    judge = world.judge_of("panda")
    without = joints.idle_joints(judge, "panda_link8", np.random.default_rng(0))
    assert without.tolist() == [False] * 6 + [True]
    robot = joints.six_axes().make()
    own = Judge(joints.six_axes(), robot.joint_names)
    q = np.array([0.3, 0.4, -0.5, 0.6, 0.0, -0.7])
    turned = q + np.array([0.0, 0.0, 0.0, 0.2, 0.0, -0.2])
    poses = world.pose_of(own, q, "tool"), world.pose_of(own, turned, "tool")
    np.testing.assert_allclose(*poses, atol=1e-12)  # axes 4 and 6 are one


def test_a_goal_goes_as_fast_as_it_is_said_to() -> None:
    judge = Judge(
        world.without_hulls(world.builtin_spec("ur10")), world.robot_of("ur10").joint_names
    )
    path = follow.way(judge, np.random.default_rng(0))
    p = judge.kinematics.link(judge.kinematics.place(path), "tool0")[1]
    speed = np.linalg.norm(np.diff(p, axis=0), axis=1) / world.PERIOD
    np.testing.assert_allclose(speed, follow.SPEED, rtol=1e-3)


def test_the_command_makes_its_table_and_goes_on_where_it_was(tmp_path: Path) -> None:
    text = tables_of("bench.ik.safety", "follow", 3, tmp_path / "safety")
    assert "| follow | robots without hulls" in text


def test_a_row_that_does_not_exist_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(typer.BadParameter, match="no row nothing; there are steps, carried"):
        safety.main(out=tmp_path, only=["nothing"])
