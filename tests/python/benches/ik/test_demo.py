"""The demo: its second opinion is sound, and it runs."""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

import pdoik
from bench.ik import demo
from bench.ik.goals.peers.body import by_capsules
from bench.ik.judges import recheck
from references import PinocchioRobot

REPOSITORY = Path(__file__).parents[4]


@pytest.fixture
def chain(robot: pdoik.Robot) -> object:
    urdf = Path(pdoik.__file__).parent / "robots" / f"{robot.name}.urdf"
    return recheck.UrdfChain(urdf, robot.joint_names)


def test_its_kinematics_and_limits_are_pinocchios(
    robot: pdoik.Robot, chain: object, pinocchio: PinocchioRobot, rng: np.random.Generator
) -> None:
    np.testing.assert_allclose(chain.limits, np.column_stack([robot.lower, robot.upper]))
    for _ in range(20):
        q = rng.uniform(robot.lower, robot.upper)
        pinocchio.set(dict(zip(robot.joint_names, q, strict=True)))
        for link in robot.link_names:
            T_base_link = pinocchio.pose(robot.base_link, link)
            np.testing.assert_allclose(chain.fk(q, link), T_base_link, atol=1e-12)


@pytest.mark.parametrize("goal", ["pose", "axis", "position"])
def test_its_verdict_is_the_judges(
    robot: pdoik.Robot, chain: object, rng: np.random.Generator, goal: str
) -> None:
    options = pdoik.Options(goal=goal, goal_axis="x")
    solver = pdoik.Solver(robot, options)
    for _ in range(50):
        q, q_target = rng.uniform(robot.lower, robot.upper, (2, robot.dof))
        points = rng.uniform(-1, 1, (30, 3))
        T_base_tip = robot.fk(q_target)
        judged = solver.judge(T_base_tip, q, obstacles=points)
        verdict = recheck.recheck(chain, robot, solver.options, T_base_tip, q, points)
        assert verdict.position_error == pytest.approx(judged.position_error, abs=1e-12)
        assert verdict.rotation_error == pytest.approx(judged.rotation_error, abs=1e-7)
        assert np.sign(verdict.clearance) == np.sign(judged.clearance)
        assert not verdict.confirms(solver.options)


def test_it_confirms_solutions_and_nothing_near_them(robot: pdoik.Robot, chain: object) -> None:
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    q_target = robot.mid_configuration() + 0.2
    T_base_tip = robot.fk(q_target)
    result = solver.solve(T_base_tip)
    assert result.success

    def confirms(q: np.ndarray, points: np.ndarray) -> bool:
        verdict = recheck.recheck(chain, robot, solver.options, T_base_tip, q, points)
        return bool(verdict.confirms(solver.options))

    far, inside = np.full((1, 3), 9.0), robot.fk(result.q, robot.link_names[2])[:3, 3][None]
    assert confirms(result.q, far)
    assert not confirms(result.q + 1e-3, far)
    assert confirms(result.q, inside) == solver.judge(T_base_tip, result.q, inside).success


def touches(robot: pdoik.Robot, q: np.ndarray, scan: np.ndarray) -> bool:
    """Whether a point of the scan lies in a hull, by SciPy's tree and the hulls' definition."""
    tree, slack = cKDTree(scan), 1e-9

    def place(link: str, local: tuple[float, float, float]) -> np.ndarray:
        return (robot.fk(q, link) @ [*local, 1.0])[:3]

    for link, local_a, local_b, radius, _ in robot.occupancy.capsules:
        a, along = place(link, local_a), place(link, local_b) - place(link, local_a)
        length = np.linalg.norm(along)
        near = scan[tree.query_ball_point(a + along / 2, length / 2 + radius)]
        t = np.clip((near - a) @ along / max(length**2, 1e-300), 0, 1)
        gaps = np.linalg.norm(near - a - t[:, None] * along, axis=1)
        if (gaps < radius - slack).any():
            return True
    closer = {capsule[0] for capsule in robot.occupancy.capsules}  # whose wide hulls do not count
    for link, center, radius in robot.occupancy.spheres:
        if link in closer:
            continue
        if tree.query(place(link, center))[0] < radius - slack:
            return True
    for link_a, focus_a, link_b, focus_b, semi_major in robot.occupancy.spheroids:
        if closer & {link_a, link_b}:
            continue
        a, b = place(link_a, focus_a), place(link_b, focus_b)
        near = scan[tree.query_ball_point((a + b) / 2, semi_major)]
        sums = np.linalg.norm(near - a, axis=1) + np.linalg.norm(near - b, axis=1)
        if (sums < 2 * (semi_major - slack)).any():
            return True
    return False


@pytest.mark.parametrize("leaf", [None, 0.1])
def test_nothing_it_calls_solved_touches_the_scan(
    robot: pdoik.Robot, chain: object, rng: np.random.Generator, leaf: float | None
) -> None:
    robot = by_capsules(robot.name)  # which `touches` knows
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    models = demo.primitive_models()
    rows = [demo.solve_one(solver, chain, models, 9, leaf, rng) for _ in range(20)]
    solved = [row for row in rows if row.solved]
    assert len(solved) > len(rows) / 2
    assert not any(touches(robot, row.result.q, row.scene.points) for row in solved)
    assert all(row.confirmed for row in rows if row.result.success)

    def thinned_touches(row: object) -> bool:
        result = solver.solve(row.T_base_tip, obstacles=row.scene.cloud(0.1))
        return bool(result.success) and touches(robot, result.q, row.scene.points)

    assert any(map(thinned_touches, rows)), "these scenes would show no fault"


def test_it_runs_draws_and_leaves_nothing_in_the_checkout(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("PDOIK_SHARED", raising=False)  # it would find scans there
    checkout = tmp_path / "checkout"
    shutil.copytree(
        REPOSITORY / "bench",
        checkout / "bench",
        ignore=shutil.ignore_patterns("*.png", "__pycache__"),
    )
    before = set(checkout.rglob("*"))
    command = [sys.executable, "-B", "-m", "bench.ik.demo", "--targets", "4", "--max-objects", "4"]
    outcome = subprocess.run(
        [*command, "--max-time", "2"], cwd=checkout, capture_output=True, text=True, check=False
    )
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    assert "shapes made from primitives" in outcome.stdout
    solved = next(line for line in outcome.stdout.splitlines() if "clear of the whole scan" in line)
    assert solved.split()[-9:] == ["4", "/", "4"] * 3
    picture = checkout / "build" / "bench" / "demo.png"  # where Git looks at nothing
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert set(checkout.rglob("*")) - before == {picture, *picture.parents[:2]}


def test_a_folder_without_scans_is_misuse(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "bench.ik.demo", "--ycb", str(tmp_path)]
    outcome = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert outcome.returncode == 2
    assert outcome.stderr.startswith("error:")
    assert "cloud_vertices" in outcome.stderr
    assert list(tmp_path.iterdir()) == []
