"""What a solver claims, Pinocchio and NumPy confirm; what it promises, it keeps."""

import dataclasses
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import pdoik
from conftest import ROBOTS
from random_urdf import random_urdf
from references import PinocchioRobot, clearance, rotation_angle
from samples import box_of_points, random_configuration, reachable_targets

AXES = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}
# The budget of restarts ends it, on any machine; random targets may have no answer off itself.
PATIENT = {"max_time": 60.0, "max_restarts": 8, "self_collision": False}


def confirm(
    result: pdoik.Result,
    solver: pdoik.Solver,
    reference: PinocchioRobot,
    T_base_tip: np.ndarray,
    obstacles: np.ndarray | None = None,
) -> None:
    """Everything the result says is so, by Pinocchio's kinematics and NumPy's distances."""
    robot, options = solver.robot, solver.options
    assert np.isfinite(result.q).all()
    assert (robot.lower <= result.q).all()
    assert (result.q <= robot.upper).all()
    assert result.limit_violation == 0.0

    reference.set(dict(zip(robot.joint_names, result.q.tolist(), strict=True)))
    poses = {link: reference.pose(robot.base_link, link) for link in robot.link_names}
    T = poses[robot.tip_links[0]]
    position_error = np.linalg.norm(T[:3, 3] - T_base_tip[:3, 3])
    assert result.position_error == pytest.approx(position_error, abs=1e-11)
    rotation_error = 0.0
    if options.goal == "pose":
        rotation_error = rotation_angle(T_base_tip[:3, :3].T @ T[:3, :3])
    elif options.goal == "axis":
        axis = np.array(AXES.get(options.goal_axis, options.goal_axis), dtype=float)
        axis /= np.linalg.norm(axis)
        is_, wanted = T[:3, :3] @ axis, T_base_tip[:3, :3] @ axis
        rotation_error = np.arctan2(np.linalg.norm(np.cross(is_, wanted)), is_ @ wanted)
    assert result.rotation_error == pytest.approx(rotation_error, abs=1e-9)
    points = np.zeros((0, 3)) if obstacles is None else obstacles
    least, most = clearance(robot.occupancy, poses, points, options.clearance)
    assert least - 1e-8 <= result.clearance <= most + 1e-8

    holds = (
        result.position_error <= options.position_tolerance
        and result.rotation_error <= options.rotation_tolerance
        and result.clearance >= options.clearance - options.clearance_tolerance
    )
    if options.keeps_off_itself(robot):
        holds = holds and result.self_distance >= -options.clearance_tolerance
    assert result.success == holds == (result.status == "solved") == (result.worst_violation <= 0)


METHODS = [{}, {"inner": "lbfgs"}, {"method": "paper"}]


@pytest.mark.parametrize("method", METHODS, ids=["default", "lbfgs", "paper"])
@pytest.mark.parametrize(
    "goal",
    [
        {"goal": "pose"},
        {"goal": "axis", "goal_axis": "x"},
        {"goal": "axis", "goal_axis": (1.0, -2.0, 0.5)},
        {"goal": "position"},
    ],
    ids=["pose", "x axis", "slanted axis", "position"],
)
@pytest.mark.parametrize("cloud", ["none", "points", "balls", "wide berth"])
def test_claims_are_confirmed_by_other_libraries(
    robot: pdoik.Robot,
    pinocchio: PinocchioRobot,
    goal: dict,
    method: dict,
    cloud: str,
    rng: np.random.Generator,
) -> None:
    margin = {"clearance": 0.03} if cloud == "wide berth" else {}
    solver = pdoik.Solver(robot, pdoik.Options(**goal, **method, **margin, **PATIENT))
    targets = reachable_targets(robot, rng, 6)
    solved = 0
    for i, target in enumerate(targets):
        obstacles = None
        if cloud != "none":
            obstacles = box_of_points(rng, 8, columns=4 if cloud == "balls" else 3)
        q0 = random_configuration(robot, rng) if i % 2 else None
        result = solver.solve(target, q0=q0, obstacles=obstacles)
        confirm(result, solver, pinocchio, target, obstacles)
        judged = solver.judge(target, result.q, obstacles)
        assert judged.position_error == result.position_error
        assert judged.rotation_error == result.rotation_error
        assert judged.clearance == result.clearance
        assert judged.success == result.success
        solved += result.success
    if cloud == "none" and method != {"method": "paper"}:
        assert solved == len(targets)
    elif method != {"method": "paper"}:
        assert solved > 0


@pytest.mark.parametrize("seed", range(12))
def test_claims_hold_on_random_trees_too(seed: int, rng: np.random.Generator) -> None:
    urdf = random_urdf(rng, links=9)
    base, tip = urdf.links[0], urdf.links[-1]
    robot = pdoik.Robot.from_urdf(urdf.xml, base_link=base, tip_link=tip)
    robot.occupancy = pdoik.Occupancy(
        spheres=[(link, rng.uniform(-0.1, 0.1, 3), 0.04) for link in urdf.links[3:]],
        spheroids=[
            (link, rng.uniform(-0.1, 0.0, 3), link, rng.uniform(0.0, 0.1, 3), 0.2)
            for link in urdf.links[3:]
        ],
    )
    reference = PinocchioRobot.from_xml(urdf.xml)
    for goal in ("pose", "axis", "position"):
        solver = pdoik.Solver(robot, pdoik.Options(goal=goal, **PATIENT))
        target = reachable_targets(robot, rng, 1)[0]
        obstacles = rng.uniform(-1, 1, (5, 3))
        confirm(solver.solve(target), solver, reference, target)
        confirm(solver.solve(target, obstacles=obstacles), solver, reference, target, obstacles)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("method", METHODS, ids=["default", "lbfgs", "paper"])
def test_continuous_joints_stay_within_half_a_turn_of_the_start(
    seed: int, method: dict, rng: np.random.Generator
) -> None:
    urdf = random_urdf(rng, links=7, types=("continuous",))
    robot = pdoik.Robot.from_urdf(urdf.xml, tip_link=urdf.links[-1])
    solver = pdoik.Solver(robot, pdoik.Options(**method, **PATIENT))
    for target in reachable_targets(robot, rng, 4):
        q0 = rng.uniform(-30, 30, robot.dof)
        result = solver.solve(target, q0=q0)
        assert (np.abs(result.q - q0) <= np.pi + 1e-12).all()
        assert (np.abs(solver.solve(target).q) <= np.pi + 1e-12).all()


@pytest.mark.parametrize("method", METHODS, ids=["default", "lbfgs", "paper"])
def test_a_start_that_solves_is_not_left(
    robot: pdoik.Robot, method: dict, rng: np.random.Generator
) -> None:
    solver = pdoik.Solver(robot, pdoik.Options(**method, **PATIENT))
    for _ in range(5):
        q0 = robot.lower + rng.uniform(0.1, 0.9, robot.dof) * (robot.upper - robot.lower)
        result = solver.solve(robot.fk(q0), q0=q0)
        assert result.success
        assert result.restarts == 0
        np.testing.assert_allclose(result.q, q0, rtol=0, atol=1e-3)


def test_starts_outside_the_limits_are_moved_inside(robot: pdoik.Robot) -> None:
    solver = pdoik.Solver(robot, pdoik.Options(max_restarts=0, max_time=60.0))
    for q0 in (robot.lower - 100.0, robot.upper + 100.0):
        with pytest.warns(pdoik.GoalWarning, match="q0 has .* beyond its limit"):
            result = solver.solve(robot.fk(robot.mid_configuration()), q0=q0)
        assert (robot.lower <= result.q).all()
        assert (result.q <= robot.upper).all()


@pytest.mark.parametrize("method", METHODS, ids=["default", "lbfgs", "paper"])
def test_a_deadline_that_strikes_leaves_a_valid_configuration(
    robot: pdoik.Robot, pinocchio: PinocchioRobot, method: dict, rng: np.random.Generator
) -> None:
    solver = pdoik.Solver(robot, pdoik.Options(**method, max_time=1e-12, max_restarts=10**9))
    obstacles = box_of_points(rng, 50)
    for target in reachable_targets(robot, rng, 5):
        result = solver.solve(target, q0=random_configuration(robot, rng), obstacles=obstacles)
        assert result.status == "time_limit"
        confirm(result, solver, pinocchio, target, obstacles)


@pytest.mark.parametrize("method", METHODS, ids=["default", "lbfgs", "paper"])
@pytest.mark.parametrize("distance", [3.0, 1e3, 1e9])
def test_a_target_beyond_the_links_is_out_of_reach(
    robot: pdoik.Robot, pinocchio: PinocchioRobot, method: dict, distance: float
) -> None:
    solver = pdoik.Solver(robot, pdoik.Options(**method, goal="position", **PATIENT))
    target = np.eye(4)
    target[:3, 3] = distance * np.array([0.6, 0.0, 0.8])
    result = solver.solve(target)
    assert result.status == "out_of_reach"
    assert result.worst_constraint == "position"
    if distance < 1e6:
        confirm(result, solver, pinocchio, target)


def test_the_option_s_old_name_still_works_and_says_its_new_one() -> None:
    with pytest.warns(DeprecationWarning, match="base_collision"):
        options = pdoik.Options(heed_fixed_hulls=False)
    assert options == pdoik.Options(base_collision=False)
    assert dataclasses.replace(options, seed=3).base_collision is False


def test_an_obstacle_in_the_foot_is_a_base_collision(
    robot: pdoik.Robot, pinocchio: PinocchioRobot, rng: np.random.Generator
) -> None:
    robot.occupancy = pdoik.Occupancy(
        spheres=[(robot.base_link, (0, 0, 0.05), 1.0), *robot.occupancy.spheres],
        spheroids=robot.occupancy.spheroids,
    )
    solver = pdoik.Solver(robot, pdoik.Options(**PATIENT))
    obstacles = np.array([[5.0, 0.0, 0.0], [0.0, 0.0, 0.06]])
    for target in reachable_targets(robot, rng, 3):
        result = solver.solve(target, obstacles=obstacles)
        assert result.status == "base_collision"
        assert result.worst_constraint == f"clearance of {robot.base_link} (sphere 0) to obstacle 1"
        confirm(result, solver, pinocchio, target, obstacles)


def test_an_obstacle_in_the_foot_may_be_let_pass(
    robot: pdoik.Robot, pinocchio: PinocchioRobot, rng: np.random.Generator
) -> None:
    q = rng.uniform(robot.lower, robot.upper)
    moves = {
        link: not np.allclose(robot.fk(q, link), robot.fk(robot.mid_configuration(), link))
        for link in robot.link_names
    }
    moving = pdoik.Occupancy(
        spheres=[hull for hull in robot.occupancy.spheres if moves[hull[0]]],
        spheroids=[hull for hull in robot.occupancy.spheroids if moves[hull[0]] or moves[hull[2]]],
    )
    robot.occupancy = pdoik.Occupancy(
        spheres=[(robot.base_link, (0, 0, 0.05), 1.0), *robot.occupancy.spheres],
        spheroids=robot.occupancy.spheroids,
    )
    solver = pdoik.Solver(robot, pdoik.Options(**PATIENT, base_collision=False))
    obstacles = np.array([[5.0, 0.0, 0.0], [0.9, 0.0, 0.06]])
    solved = 0
    for target in reachable_targets(robot, rng, 10):
        result = solver.solve(target, obstacles=obstacles)
        assert result.status != "base_collision"
        if result.success:
            robot.occupancy = moving
            confirm(result, pdoik.Solver(robot, solver.options), pinocchio, target, obstacles)
            solved += 1
    assert solved > 5


@pytest.mark.parametrize(
    "empty", [None, [], np.zeros((0, 3)), np.zeros((0, 4)), np.zeros((0, 3), dtype=np.float32)]
)
def test_no_obstacles_are_as_good_as_none(robot: pdoik.Robot, empty: np.ndarray | None) -> None:
    solver = pdoik.Solver(robot, pdoik.Options(**PATIENT))
    target = robot.fk(robot.mid_configuration())
    solver.solve(target, obstacles=[[0.4, 0.0, 0.4]])  # what one call had, the next has not
    result = solver.solve(target, obstacles=empty)
    assert result.success
    assert result.clearance == np.inf


def test_a_robot_without_hulls_touches_nothing(robot: pdoik.Robot) -> None:
    robot.occupancy = pdoik.Occupancy()
    options = pdoik.Options(**PATIENT, ignore_obstacles_without_hulls=True)
    solver = pdoik.Solver(robot, options)
    result = solver.solve(robot.fk(robot.mid_configuration()), obstacles=[[0, 0, 0.1]])
    assert result.success
    assert result.clearance == np.inf


def test_clouds_of_any_layout_give_the_same_answer(
    robot: pdoik.Robot, rng: np.random.Generator
) -> None:
    points = box_of_points(rng, 100, columns=4).astype(np.float32).astype(np.float64)
    wide = np.zeros((2 * len(points), 8))
    wide[::2, ::2] = points
    target = reachable_targets(robot, rng, 1)[0]
    solver = pdoik.Solver(robot, pdoik.Options(**PATIENT))
    expected = solver.solve(target, obstacles=points)
    for same in (
        points.tolist(),
        points.astype(np.float32),
        wide[::2, ::2],
        np.asfortranarray(points),
    ):
        result = solver.solve(target, obstacles=same)
        np.testing.assert_array_equal(result.q, expected.q)
        assert result.clearance == expected.clearance
    flat = np.hstack([points[:, :3], np.zeros((len(points), 1))])
    np.testing.assert_array_equal(
        solver.solve(target, obstacles=flat).q, solver.solve(target, obstacles=points[:, :3]).q
    )


def test_the_same_seed_gives_the_same_answer_and_the_past_does_not_matter(
    robot: pdoik.Robot, rng: np.random.Generator
) -> None:
    targets = reachable_targets(robot, rng, 10)
    clouds = [box_of_points(rng, 30) for _ in targets]
    options = pdoik.Options(seed=7, **PATIENT)
    solver = pdoik.Solver(robot, options)
    first = [solver.solve(T, obstacles=cloud) for T, cloud in zip(targets, clouds, strict=True)]
    for T, cloud, result in reversed(list(zip(targets, clouds, first, strict=True))):
        for again in (solver, pdoik.Solver(robot, options)):
            other = again.solve(T, obstacles=cloud)
            np.testing.assert_array_equal(other.q, result.q)
            assert (other.status, other.restarts) == (result.status, result.restarts)
            assert (other.iterations, other.evaluations) == (result.iterations, result.evaluations)


def test_another_seed_gives_other_restarts(robot: pdoik.Robot, rng: np.random.Generator) -> None:
    solvers = [pdoik.Solver(robot, pdoik.Options(seed=seed, **PATIENT)) for seed in (1, 2)]
    cloud = box_of_points(rng, 30)
    differ = restarted = 0
    for target in reachable_targets(robot, rng, 30):
        one, two = (solver.solve(target, obstacles=cloud) for solver in solvers)
        if one.restarts == 0:
            np.testing.assert_array_equal(one.q, two.q)
        else:
            restarted += 1
            differ += not np.array_equal(one.q, two.q)
    assert restarted > 0
    assert differ > 0


def test_threads_may_share_a_solver(robot: pdoik.Robot, rng: np.random.Generator) -> None:
    options = pdoik.Options(**PATIENT)
    jobs = [
        (T, box_of_points(rng, int(rng.integers(0, 200))))
        for T in reachable_targets(robot, rng, 60)
    ]
    own = [pdoik.Solver(robot, options).solve(T, obstacles=cloud) for T, cloud in jobs]
    shared = pdoik.Solver(robot, options)
    with ThreadPoolExecutor(8) as pool:
        results = list(pool.map(lambda job: shared.solve(job[0], obstacles=job[1]), jobs))
    for result, expected in zip(results, own, strict=True):
        np.testing.assert_array_equal(result.q, expected.q)
        assert result.clearance == expected.clearance


def test_other_python_threads_run_during_a_solve(robot: pdoik.Robot) -> None:
    options = pdoik.Options(max_time=0.5, max_restarts=10**9, position_tolerance=1e-300)
    solver = pdoik.Solver(robot, options)  # no rounding is that fine: the clock ends it
    target = robot.fk(robot.mid_configuration())
    turns = 0
    with ThreadPoolExecutor(1) as pool:
        solving = pool.submit(solver.solve, target)
        while not solving.done():
            turns += 1
    assert solving.result().time >= 0.4
    assert turns > 1000


def test_a_solver_keeps_the_robot_it_was_made_for() -> None:
    robot = pdoik.Robot.builtin("panda")
    hulls = robot.occupancy
    solver = pdoik.Solver(robot)
    robot.occupancy = pdoik.Occupancy()
    solver.robot.occupancy = pdoik.Occupancy()
    assert solver.robot.occupancy == hulls
    assert "panda" in repr(solver)


@pytest.mark.parametrize("goal", ["axis", "position"])
def test_what_a_goal_leaves_free_is_not_judged(goal: str, robot: pdoik.Robot) -> None:
    q = robot.mid_configuration()
    turn = np.eye(4)
    turn[:2, :2] = [[0.0, -1.0], [1.0, 0.0]]  # about the tip's z
    options = pdoik.Options(goal=goal, goal_axis="z")
    assert pdoik.Solver(robot, options).judge(robot.fk(q) @ turn, q).success
    assert not pdoik.Solver(robot).judge(robot.fk(q) @ turn, q).success


def test_judging_names_what_is_wrong(robot: pdoik.Robot) -> None:
    solver = pdoik.Solver(robot, pdoik.Options(self_collision=False))
    q = robot.mid_configuration()
    T = robot.fk(q)
    result = solver.judge(T, q)
    assert (result.success, result.status) == (True, "solved")
    outside = q.copy()
    outside[2] = robot.upper[2] + 0.5
    result = solver.judge(robot.fk(outside), outside)
    assert not result.success
    assert result.limit_violation == pytest.approx(0.5)
    assert result.worst_constraint == f"limit of {robot.joint_names[2]}"
    assert result.worst_violation == pytest.approx(0.5)
    in_flange = T @ [0.0, 0.0, -0.05, 1.0]  # deeper than its capsules stand beyond it
    hit = solver.judge(T, q, obstacles=in_flange[None, :3])
    assert hit.clearance < 0


def test_xml_and_builtin_give_one_solver() -> None:
    target = pdoik.Robot.builtin("ur10").fk(np.full(6, 0.3))
    robots = [pdoik.Robot.builtin("ur10"), pdoik.Robot.from_urdf(ROBOTS / "ur10.urdf")]
    answers = [pdoik.Solver(robot, pdoik.Options(**PATIENT)).solve(target).q for robot in robots]
    np.testing.assert_array_equal(answers[0], answers[1])
