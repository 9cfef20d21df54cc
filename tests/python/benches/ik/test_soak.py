"""The soak test's judge against known answers, its files, and the soak itself in small."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize, minimize_scalar

import pdoik

pytest.importorskip("dask", reason="pip install 'pdoik[bench]'")
from bench.ik.soak import __main__ as soak
from bench.ik.soak import cases, hulls, motions, robots, scenes, solves, tracking, trees
from bench.ik.soak import judge as judging

REPOSITORY = Path(__file__).parents[4]
CASES = sorted((Path(__file__).parent / "soak_cases").glob("*.json"))
Judge, Goals, Asked = judging.Judge, judging.Goals, judging.Asked


# --- Distances --------------------------------------------------------------------------------


def spheroid_distance(point: np.ndarray, a: np.ndarray, b: np.ndarray, A: float) -> float:
    """By SciPy, over the angle along the half ellipse in the plane of the point and the foci."""
    half = np.linalg.norm(b - a) / 2
    B = np.sqrt(A**2 - half**2)
    axis = (b - a) / (2 * half)
    off = point - (a + b) / 2
    x, y = off @ axis, np.linalg.norm(off - (off @ axis) * axis)

    def gap(t: float) -> float:
        return float(np.hypot(x - A * np.cos(t), y - B * np.sin(t)))

    grid = np.linspace(0.0, np.pi, 2001)
    t = grid[np.argmin([gap(t) for t in grid])]
    found = minimize_scalar(gap, bounds=(t - 0.01, t + 0.01), options={"xatol": 1e-13})
    s = (np.linalg.norm(point - a) + np.linalg.norm(point - b)) / 2
    return float(np.copysign(min(found.fun, gap(t)), s - A))


def test_distances_to_spheroids_are_scipys(rng: np.random.Generator) -> None:
    for _ in range(150):
        a, b = rng.uniform(-0.3, 0.3, (2, 3))
        half = np.linalg.norm(b - a) / 2
        A = half * (1.0 + 10 ** rng.uniform(-3, 0.5))
        point = rng.uniform(-0.6, 0.6, 3)
        if rng.random() < 0.3:  # on the axis, where the nearest point is not one alone
            point = a + rng.uniform(-0.5, 1.5) * (b - a)
        ours = hulls.hull_distance(point[None], a[None], b[None], np.array([A]))[0]
        np.testing.assert_allclose(ours, spheroid_distance(point, a, b, A), rtol=0, atol=2e-8)


def test_distances_to_balls_and_to_hulls_that_hold_nothing() -> None:
    a = np.zeros((3, 3))
    b = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    points = np.array([[0.0, 3.0, 4.0], [0.5, 0.0, 0.0], [0.5, 0.0, 0.0]])
    A = np.array([2.0, 0.5, 1.0])
    found = hulls.hull_distance(points, a, b, A)
    np.testing.assert_allclose(found, [3.0, np.inf, -np.sqrt(0.75)], rtol=1e-14)


@pytest.mark.parametrize("own", [False, True])
def test_clearance_is_the_least_over_every_hull_and_point(
    own: bool, rng: np.random.Generator
) -> None:
    for _ in range(20):
        B, H, N = 4, 5, 40
        a, b = rng.uniform(-0.5, 0.5, (2, B, H, 3))
        b[:, 0] = a[:, 0]  # a ball
        A = rng.uniform(0.1, 0.5, H)  # some hold nothing
        points = rng.uniform(-1, 1, (B, N, 4) if own else (N, 4)) * rng.choice([0.3, 1.0, 5.0])
        points[..., 3] = np.abs(points[..., 3]) * rng.choice([0.0, 0.1])
        found = hulls.clearance(a, b, A, points)
        each = points if own else np.tile(points, (B, 1, 1))
        for k in range(B):
            grid = [
                hulls.hull_distance(each[k, :, :3], *np.tile(ends, (1, N, 1)), np.full(N, A[h]))
                - each[k, :, 3]
                for h, ends in enumerate(np.stack([a[k], b[k]], axis=1)[:, :, None])
            ]
            np.testing.assert_allclose(found[k], np.min(grid), rtol=0, atol=1e-14)


def test_distances_between_segments_are_scipys(rng: np.random.Generator) -> None:
    for kind in np.tile(["any", "parallel", "crossing", "point"], 15):
        p, q, r, s = rng.uniform(-1, 1, (4, 3))
        if kind == "parallel":
            s = r + rng.uniform(-2, 2) * (q - p)
        elif kind == "crossing":
            s = r + 2.0 * ((p + q) / 2 - r)
        elif kind == "point":
            q = p

        def gap(x: np.ndarray, p=p, q=q, r=r, s=s) -> float:
            d = p + x[0] * (q - p) - r - x[1] * (s - r)
            return float(d @ d)

        starts = [(0.0, 0.0), (1.0, 1.0), (0.5, 0.5)]
        best = min(minimize(gap, x, bounds=[(0, 1)] * 2, tol=1e-14).fun for x in starts)
        found = hulls.segment_distance(p[None], q[None], r[None], s[None])[0]
        np.testing.assert_allclose(found, np.sqrt(best), rtol=0, atol=1e-5)


def test_beyond_a_polygon_is_how_far_over_its_edges() -> None:
    corners = np.array(
        [[[0, 0, 3], [2, 0, 1], [2, 1, 0], [0, 1, 0], [1, 0.5, 9], [1, 0, 0]]], float
    )
    points = np.array([[1.0, 0.5, 7.0], [1.0, 1.25, 0.0], [-0.5, 0.5, 0.0], [2.0, 0.5, 0.0]])
    found = judging.beyond_polygon(np.tile(corners, (4, 1, 1)), points, np.array([0.0, 0.0, 5.0]))
    np.testing.assert_allclose(found, [-0.5, 0.25, 0.5, 0.0], atol=1e-15)


# --- Verdicts ---------------------------------------------------------------------------------


@pytest.fixture
def solved() -> tuple[Any, Any, Any]:
    """A judge, a scene of ten poses of a Panda, and the solver's answers to it."""
    spec = robots.builtin_spec("panda")
    robot = spec.make()
    judge = Judge(spec, robot.joint_names)
    Q = judging.random_configurations(judge.kinematics, 10, np.random.default_rng(3))
    options = {"goal": "pose", "max_time": 60.0, "max_restarts": 100}
    scene = scenes.Scene(
        spec=spec,
        options=options,
        goals=scenes.draw_goals(
            judge, Q, options, np.random.default_rng(0), slack=False, astray=False
        ),
        size="none",
        cloud=None,
        q0=Q + 0.1,
        posture=None,
        max_step=None,
        single=False,
    )
    answers = solves.ask(scene, pdoik.Solver(robot, scenes.make_options(options)))
    assert answers.success.all()
    return judge, scene, answers


def faults(judge: Any, scene: Any, answers: Any) -> dict[str, list[int]]:
    verdicts, asked = solves.judged(scene, judge, answers)
    found = solves.faults(scene, judge, answers, verdicts, asked)
    return {name: np.flatnonzero(bad).tolist() for name, bad in found.items() if bad.any()}


def test_honest_answers_have_no_faults(solved: tuple) -> None:
    assert faults(*solved) == {}


@pytest.mark.parametrize("radius", [0.0, 0.02])
def test_a_penetration_by_a_thousandth_of_a_millimetre_is_caught(
    solved: tuple, radius: float
) -> None:
    judge, scene, answers = solved
    a, b = judge.hulls(judge.kinematics.place(answers.q[4:5]))
    across = np.cross(b[0, 5] - a[0, 5], [0.3, 0.5, 0.8])
    across /= np.linalg.norm(across)
    half = np.linalg.norm(b[0, 5] - a[0, 5]) / 2
    waist = np.sqrt(judge.A[5] ** 2 - half**2)
    middle = (a[0, 5] + b[0, 5]) / 2
    ball = np.array([*(middle + (waist + radius - 2.1e-6) * across), radius])
    touched = replace(scene, cloud=ball[None])
    depth = np.maximum(0.0, -judge(scene.goals, answers.q, Asked(), ball[None]).clearance)
    assert depth[4] >= 2.1e-6 - 1e-12
    assert 4 in faults(judge, touched, answers)["wrong"]
    # What the solver says of itself is compared as well: it knew of no obstacle.
    assert 4 in faults(judge, touched, answers)["misreported"]


def test_a_limit_broken_by_the_last_digit_is_caught(solved: tuple) -> None:
    judge, scene, answers = solved
    q = answers.q.copy()
    q[3, 2] = np.nextafter(judge.kinematics.upper[2], np.inf)
    assert 0 < q[3, 2] - judge.kinematics.upper[2] < 1e-15
    assert faults(judge, scene, replace(answers, q=q))["limits"] == [3]
    q[3, 2] = judge.kinematics.upper[2]
    assert "limits" not in faults(judge, scene, replace(answers, q=q))


def test_steps_too_long_numbers_that_are_none_and_false_figures_are_caught(solved: tuple) -> None:
    judge, scene, answers = solved
    moved = np.abs(answers.q - judge.kinematics.into_limits(scene.q0)).max(axis=0)
    assert faults(judge, replace(scene, max_step=moved), answers) == {}
    assert list(faults(judge, replace(scene, max_step=moved - 1e-11), answers)) == ["step"]
    q = answers.q.copy()
    q[7, 0] = np.nan
    found = faults(judge, scene, replace(answers, q=q))
    assert found["not finite"] == found["wrong"] == found["limits"] == [7]
    off = answers.q.copy()
    off[2] += 1e-4  # the pose is missed by about as much
    assert faults(judge, scene, replace(answers, q=off))["wrong"] == [2]
    said = {**answers.said, "position_error": answers.said["position_error"] + 2e-9}
    assert faults(judge, scene, replace(answers, said=said)) == {"misreported": list(range(10))}
    status = np.where(np.arange(10) == 1, "exhausted", answers.status)
    assert faults(judge, scene, replace(answers, status=status)) == {"status": [1]}


def test_a_table_of_rows_and_a_floating_base_are_where_plain_matrices_have_them(
    rng: np.random.Generator,
) -> None:
    def turn(axis: int, angle: float) -> np.ndarray:
        T, (j, k) = np.eye(4), [(axis + 1) % 3, (axis + 2) % 3]
        T[[j, k], [j, k]], T[k, j], T[j, k] = np.cos(angle), np.sin(angle), -np.sin(angle)
        return T

    def shift(x: float, y: float, z: float) -> np.ndarray:
        T = np.eye(4)
        T[:3, 3] = x, y, z
        return T

    spec = trees.random_rows(rng)
    judge = Judge(spec, spec.make().joint_names)
    Q = judging.random_configurations(judge.kinematics, 5, rng)
    R, p = judge.kinematics.link(judge.kinematics.place(Q), "tool")
    for k, q in enumerate(Q):
        T = np.eye(4)
        for row, x in zip(spec.rows, q, strict=True):
            theta, d = row["theta_offset"], row["d"]
            theta, d = (theta, d + x) if row["prismatic"] else (theta + x, d)
            T = T @ turn(0, row["alpha"]) @ shift(row["a"], 0, 0) @ turn(2, theta) @ shift(0, 0, d)
        np.testing.assert_allclose(np.c_[R[k], p[k]], T[:3], atol=1e-13)

    fixed = robots.builtin_spec("iiwa14")
    loose = replace(fixed, floating_base=[[-1.0] * 6, [1.0] * 6])
    one, other = (Judge(s, s.make().joint_names).kinematics for s in (fixed, loose))
    Q = judging.random_configurations(other, 5, rng)
    R_arm, p_arm = one.link(one.place(Q[:, 6:]), "iiwa_link_ee")
    R, p = other.link(other.place(Q), "iiwa_link_ee")
    for k, (x, y, z, yaw, pitch, roll) in enumerate(Q[:, :6]):
        T = shift(x, y, z) @ turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)
        arm = np.vstack([np.c_[R_arm[k], p_arm[k]], [0, 0, 0, 1]])
        np.testing.assert_allclose(np.c_[R[k], p[k]], (T @ arm)[:3], atol=1e-13)


# --- Steps ------------------------------------------------------------------------------------


def turning_arm() -> Any:
    """A ball on a bar half a metre long that turns about z without limits of any kind."""
    rows = [
        {
            **dict.fromkeys(("alpha", "a", "d", "theta_offset"), 0.0),
            "prismatic": False,
            "lower": -np.inf,
            "upper": np.inf,
        }
    ]
    ball = ("link1", (0.5, 0.0, 0.0), 0.05)
    return robots.RobotSpec(rows=rows, tip_links=["tool"], spheres=[ball])


def motion_of(spec: Any, count: int, cloud: np.ndarray | None, **tracker: float) -> Any:
    goals = Goals(tip="tool", T=np.tile(np.eye(4), (count, 1, 1)), type="position")
    step = motions.Step(goals={"tool": np.eye(4)}, cloud=cloud, sound=True, sound_cloud=True)
    return motions.Motion(
        spec=spec,
        speeds="none",
        options={"goal": "position"},
        tracker={"period": 0.001, "speed_share": 1.0, **tracker},
        start=np.zeros(1),
        posture=None,
        goals=[goals],
        steps=[step] * count,
    )


def record_of(judge: Any, motion: Any, path: np.ndarray, status: list[str]) -> Any:
    """As if a tracker had gone along a path (T + 1, n) and told the truth about each step."""
    asked = Asked.of(motion.options)
    clouds, _ = tracking.counted_clouds(motion.steps)
    truth = tracking.verdicts_of(judge, motion.goals, path[1:], asked, clouds)
    zeros = np.zeros(len(status))
    return tracking.Record(
        q=path[1:],
        last=path[:-1],
        status=np.array(status),
        stopped_hard=np.zeros(len(status), bool),
        said={name: getattr(truth, name) for name in solves.FIELDS},
        time=zeros,
        wall=zeros,
        cpu=zeros,
        late_evaluations=zeros,
    )


def step_faults(spec: Any, motion: Any, path: list[float], status: list[str]) -> dict:
    judge = Judge(spec, spec.make().joint_names)
    record = record_of(judge, motion, np.array(path)[:, None], status)
    row, found = tracking.examine(motion, judge, record)
    bad = {name: np.flatnonzero(steps).tolist() for name, steps in found.items() if steps.any()}
    return {**bad, "depth": row["path_depth"]}


def test_a_step_through_an_obstacle_is_caught_and_one_past_it_is_not() -> None:
    spec = turning_arm()
    on_the_way = np.array([[0.0, 0.5, 0.0, 0.01]])  # at a quarter turn
    motion = motion_of(spec, 2, on_the_way)
    found = step_faults(spec, motion, [0.0, 1.0, 2.5], ["tracking"] * 2)
    assert found["passed through"] == [1]
    assert found["depth"] == pytest.approx(0.06, abs=1e-3)  # all of both radii
    past = motion_of(spec, 2, on_the_way + np.array([0.0, 0.07, 0.0, 0.0]))
    assert step_faults(spec, past, [0.0, 1.0, 2.5], ["tracking"] * 2) == {"depth": 0.0}


def test_a_step_over_its_bound_and_a_claim_in_an_obstacle_are_caught() -> None:
    spec = turning_arm()
    motion = motion_of(spec, 3, np.array([[0.5, 0.06, 0.0]]), max_speed=np.array([100.0]))
    path = [-0.2, -0.1, 0.0, 0.1 + 1e-9]  # 0.1 rad a step; from 0 on a ball of 0.05 m is near
    found = step_faults(spec, motion, path, ["tracking"] * 3)
    assert found["step"] == [2]
    assert found["false claim"] == [2]
    assert found["deeper"] == [2]
    honest = step_faults(spec, motion, [*path[:3], 0.1], ["tracking", "tracking", "infeasible"])
    assert honest == {"deeper": [2], "depth": 0.0}  # an excuse for the goal, not for the obstacle
    stays = step_faults(spec, motion, [*path[:3], 0.0], ["tracking", "tracking", "infeasible"])
    assert stays == {"depth": 0.0}


def test_rubbish_that_is_not_refused_or_moves_the_robot_is_caught() -> None:
    spec = turning_arm()
    motion = motion_of(spec, 4, None)
    motion.steps[1] = replace(motion.steps[1], sound=False)
    path = [0.0, 0.0, 0.0, 0.0, 0.0]
    held = ["tracking", "invalid_input", "tracking", "tracking"]
    assert step_faults(spec, motion, path, held) == {"depth": 0.0}
    taken = ["tracking", "tracking", "invalid_input", "tracking"]
    found = step_faults(spec, motion, path, taken)
    assert (found["not held"], found["refused"]) == ([1], [2])
    moved = step_faults(spec, motion, [0.0, 0.0, 1e-16, 1e-16, 1e-16], held)
    assert moved["not held"] == [1]


# --- Files and the command --------------------------------------------------------------------


def test_a_case_is_read_back_digit_by_digit(tmp_path: Path, rng: np.random.Generator) -> None:
    spec = trees.random_tree(rng)
    judge = Judge(spec, spec.make().joint_names)
    motion = motions.draw_motion(judge, "huge", rng, 5)
    T = motion.goals[0].T
    T[1, 0, 0], T[2, 0, 0] = np.nan, -np.inf
    case = {"robot": spec, "goals": motion.goals, "big": rng.normal(size=(40, 4)), "none": None}
    path = tmp_path / "case.json"
    path.write_text(json.dumps(cases.encode(case)))
    back = cases.read_case(path)
    assert back["robot"] == spec
    assert back["none"] is None
    np.testing.assert_array_equal(back["big"], case["big"])
    np.testing.assert_array_equal(back["goals"][0].T, T)
    assert replace(back["goals"][0], T=0) == replace(motion.goals[0], T=0)


@pytest.mark.parametrize("family", trees.FAMILIES)
def test_the_soak_in_small_finds_nothing_wrong_with_solves(family: str) -> None:
    job = {"seed": 0, "key": [0, 0], "family": family, "count": 800, "name": "small"}
    rows = solves.run_job(job)
    assert sum(row["n"] for row in rows) == 800
    assert sum(row["solved"] for row in rows) > 80
    assert {name: sum(row[name] for row in rows) for name in solves.FAULTS} == dict.fromkeys(
        solves.FAULTS, 0
    ), [row["cases"][:2000] for row in rows if row["cases"]]


@pytest.mark.parametrize("family", trees.FAMILIES)
def test_the_soak_in_small_finds_nothing_wrong_with_steps(family: str) -> None:
    job = {"seed": 0, "key": [0, 0], "family": family, "count": 300, "name": "small"}
    rows = tracking.run_job(job)
    assert sum(row["n"] for row in rows) == 300
    names = [f"fault {name}" for name in tracking.FAULTS]
    assert {name: sum(row[name] for row in rows) for name in names} == dict.fromkeys(names, 0), [
        row["cases"][:2000] for row in rows if row["cases"]
    ]


def test_cases_that_once_failed_or_are_known_to_be_hard_have_no_faults() -> None:
    assert len(CASES) >= 3
    assert [path.name for path in CASES if soak.replayed(path)] == []


def test_the_command_makes_its_tables_goes_on_where_it_was_and_replays(tmp_path: Path) -> None:
    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "bench.ik.soak", *arguments]
        return subprocess.run(
            command, cwd=REPOSITORY, capture_output=True, text=True, check=False, timeout=600
        )

    out = ["--out", str(tmp_path / "soak"), "--solves", "300", "--steps", "60", "--seed", "1"]
    first = run(*out)
    assert first.returncode == 0, first.stdout + first.stderr
    text = (tmp_path / "soak" / "soak.md").read_text()
    for family in trees.FAMILIES:
        assert f"| {family} |" in text
    assert ": 0 wrong, 0 other faults." in text
    part = sorted((tmp_path / "soak" / "solve" / "parts").iterdir())[0]
    part.unlink()
    again = run(*out)
    assert again.returncode == 0, again.stdout + again.stderr
    count = len(list(part.parent.iterdir()))
    assert f"{count - 1} of {count} jobs are done already" in again.stdout
    # A case that holds what cannot be met is asked again and has nothing wrong with it.
    scene = _first_scene()
    path = tmp_path / "case.json"
    path.write_text(json.dumps(cases.encode(solves.case_of(scene, 0, ["wrong"]))))
    replay = run("--replay", str(path))
    assert replay.returncode == 0, replay.stdout + replay.stderr
    assert "was wrong; now nothing to complain of" in replay.stdout


def _first_scene() -> Any:
    rng = np.random.default_rng(0)
    spec = trees.draw_robot("random tree", rng)
    judge = Judge(spec, spec.make().joint_names)
    return scenes.draw_scene(judge, rng, 3)
