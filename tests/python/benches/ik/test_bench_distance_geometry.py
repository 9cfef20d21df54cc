"""R-TR and R-CG: derivatives, what the distances say of an arm, and answers judged by fk."""

import numpy as np
import pytest

pytest.importorskip("networkx")
pymanopt = pytest.importorskip("pymanopt")
from pymanopt.manifolds import PSDFixedRank  # noqa: E402

from bench.ik import experiment  # noqa: E402
from bench.ik.methods import distance_geometry as dg  # noqa: E402
from bench.ik.methods import problem as problems  # noqa: E402
from bench.ik.methods.distance_geometry import limits, obstacles, recover, start  # noqa: E402
from bench.ik.methods.distance_geometry import manifold as manifolds  # noqa: E402
from bench.ik.methods.distance_geometry import points as points_module  # noqa: E402

ARMS = ("panda", "ur10", "iiwa14")

Problem, Terms = problems.Problem, problems.Terms


@pytest.fixture(scope="module", params=ARMS)
def arm(request: pytest.FixtureRequest) -> object:
    """Each shipped arm."""
    return experiment.Arm.builtin(request.param)


@pytest.fixture(scope="module")
def iiwa() -> object:
    return experiment.Arm.builtin("iiwa14")


def target(arm: object, q: np.ndarray, points: np.ndarray | None = None) -> object:
    """The problem that q solves, from the zero configuration or the limit nearest to it."""
    q0 = np.clip(np.zeros(arm.robot.dof), arm.robot.lower, arm.robot.upper)
    cloud = np.empty((0, 3)) if points is None else points
    return Problem(T_base_tip=arm.robot.fk(q), q0=q0, points=cloud)


def reaches(arm: object, answer: object, problem: object) -> bool:
    """By the robot's fk, to 0.01 m and 0.01 rad of the tip's z, the limits to 1 % of a range."""
    T, goal = arm.robot.fk(answer.q), problem.T_base_tip
    angle = np.arccos(np.clip(T[:3, 2] @ goal[:3, 2], -1, 1))
    slack = 0.01 * (arm.robot.upper - arm.robot.lower)
    return bool(
        np.linalg.norm(T[:3, 3] - goal[:3, 3]) <= 0.01
        and angle <= 0.01
        and np.all(answer.q >= arm.robot.lower - slack)
        and np.all(answer.q <= arm.robot.upper + slack)
    )


def crowded_cost(arm: object, rng: np.random.Generator) -> tuple[object, np.ndarray]:
    """A cost with all kinds of terms, and points that break many of them."""
    cloud = np.column_stack([rng.uniform(-0.5, 0.9, (60, 3)), rng.uniform(0.1, 0.5, 60)])
    solver = dg.RiemannianTrustRegion(arm, Terms())
    cost = solver.cost(target(arm, arm.random_configuration(rng), cloud))
    Y = points_module.ArmPoints(arm).positions(arm.random_configuration(rng))
    return cost, Y + 0.1 * rng.normal(size=Y.shape)


def test_gradient_is_the_central_difference(arm: object) -> None:
    rng = np.random.default_rng(1)
    cost, Y = crowded_cost(arm, rng)
    gradient, h = cost.gradient(Y), 1e-6
    for _ in range(20):
        Z = rng.normal(size=Y.shape)
        difference = (cost(Y + h * Z) - cost(Y - h * Z)) / (2 * h)
        assert np.vdot(gradient, Z) == pytest.approx(difference, rel=1e-6, abs=1e-6)


def test_hessian_product_is_the_difference_of_gradients(arm: object) -> None:
    rng = np.random.default_rng(2)
    cost, Y = crowded_cost(arm, rng)
    h = 1e-7
    for _ in range(20):
        Z = rng.normal(size=Y.shape)
        difference = (cost.gradient(Y + h * Z) - cost.gradient(Y - h * Z)) / (2 * h)
        np.testing.assert_allclose(
            cost.hessian(Y, Z), difference, atol=1e-6 * np.abs(difference).max()
        )


def test_the_true_points_cost_nothing_within_the_limits(arm: object) -> None:
    rng = np.random.default_rng(3)
    solver, points = dg.RiemannianTrustRegion(arm, Terms()), points_module.ArmPoints(arm)
    for _ in range(50):
        q = arm.random_configuration(rng)
        Y = points.positions(q)
        assert solver.cost(target(arm, q))(Y) < 1e-24
        turned = Y @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
        assert solver.cost(target(arm, q))(turned) < 1e-24


def test_a_violated_limit_costs_unless_its_joint_is_relaxed(arm: object) -> None:
    solver, points = dg.RiemannianTrustRegion(arm, Terms()), points_module.ArmPoints(arm)
    rng = np.random.default_rng(4)
    for k, name in enumerate(arm.robot.joint_names):
        if name in solver.relaxed_joints:
            continue
        for side in (arm.robot.lower[k] - 0.05, arm.robot.upper[k] + 0.05):
            q = arm.random_configuration(rng)
            q[k] = side
            assert solver.cost(target(arm, q))(points.positions(q)) > 1e-12, name


@pytest.mark.parametrize(
    ("name", "expected"),
    [("iiwa14", {7}), ("ur10", {1, 2, 3, 4, 5, 6}), ("panda", {3, 5, 6, 7})],
)
def test_relaxed_joints_are_named(name: str, expected: set[int]) -> None:
    arm = experiment.Arm.builtin(name)
    solver = dg.RiemannianTrustRegion(arm, Terms())
    assert solver.relaxed_joints == tuple(arm.robot.joint_names[k - 1] for k in sorted(expected))


def test_a_distance_keeps_to_the_range_that_sampling_finds() -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        distance = limits.SquaredDistance(
            mean=3.0, amplitude=rng.uniform(0.1, 2), phase=rng.uniform(-np.pi, np.pi)
        )
        lower, upper = np.sort(rng.uniform(-4, 4, 2))
        sampled = distance(np.linspace(lower, upper, 20001))
        low, high = distance.range(lower, upper)
        extreme = 3.0 - distance.amplitude, 3.0 + distance.amplitude
        assert sampled.min() == pytest.approx(max(low, extreme[0]), abs=1e-6)
        assert sampled.max() == pytest.approx(min(high, extreme[1]), abs=1e-6)


def test_angles_come_back_from_points_moved_and_mirrored(arm: object) -> None:
    rng = np.random.default_rng(6)
    points = points_module.ArmPoints(arm)
    base = points.zero[list(points_module.BASE)]
    for _ in range(50):
        q = recover.within_turns(
            arm.random_configuration(rng), np.full(arm.robot.dof, -np.pi), arm.robot.upper
        )
        Q = np.linalg.qr(rng.normal(size=(3, 3)))[0]  # with either sign of the determinant
        found = recover.align(points.positions(q) @ Q + rng.normal(size=3), base)
        again = recover.angles(points, found, q)
        np.testing.assert_allclose(arm.robot.fk(again), arm.robot.fk(q), atol=1e-9)
        np.testing.assert_allclose(np.sin((again - q) / 2), 0, atol=1e-9)


def test_whole_turns_bring_an_angle_inside_where_they_can() -> None:
    theta = np.array([3.0, -3.0, 0.5, 1.0, -0.1])
    lower = np.array([-6.0, 2.0, -np.inf, 2.0, 6.0])
    upper = np.array([-1.0, 4.0, np.inf, 3.0, 13.0])
    expected = [3.0 - 2 * np.pi, 2 * np.pi - 3.0, 0.5, 1.0, 2 * np.pi - 0.1]
    np.testing.assert_allclose(recover.within_turns(theta, lower, upper), expected)


def test_the_projection_is_pymanopts() -> None:
    rng = np.random.default_rng(7)
    ours, theirs = manifolds.GramRank3(16), PSDFixedRank(16, 3)
    for _ in range(10):
        Y, Z = rng.normal(size=(2, 16, 3))
        np.testing.assert_allclose(ours.projection(Y, Z), theirs.projection(Y, Z), atol=1e-12)


@pytest.mark.parametrize("begin", ["bounds", "q0"])
def test_trust_regions_solve_most_targets_and_know_which(iiwa: object, begin: str) -> None:
    rng = np.random.default_rng(8)
    solver = dg.RiemannianTrustRegion(iiwa, Terms(max_time=20.0), start=begin)
    solved = 0
    for _ in range(20):
        problem = target(iiwa, iiwa.random_configuration(rng))
        answer = solver.solve(problem)
        assert answer.claimed == reaches(iiwa, answer, problem)
        solved += answer.claimed
    assert solved >= 14


def test_conjugate_gradients_solve_targets_too() -> None:
    arm, rng = experiment.Arm.builtin("ur10"), np.random.default_rng(9)
    solver = dg.RiemannianConjugateGradient(arm, Terms(max_time=60.0))
    solved = 0
    for _ in range(3):
        problem = target(arm, arm.random_configuration(rng))
        answer = solver.solve(problem)
        assert answer.claimed == reaches(arm, answer, problem)
        assert answer.evaluations >= answer.iterations > 1
        solved += answer.claimed
    assert solved >= 2


def test_joints_keep_out_of_an_obstacle_that_they_would_touch(iiwa: object) -> None:
    rng = np.random.default_rng(10)
    solver, points = dg.RiemannianTrustRegion(iiwa, Terms()), points_module.ArmPoints(iiwa)
    elbow = points.p(3)
    met = avoided = 0
    for _ in range(8):
        free = target(iiwa, iiwa.random_configuration(rng))
        answer = solver.solve(free)
        if not answer.claimed:
            continue
        met += 1
        place = points.positions(answer.q)[elbow]
        ball = np.array([[place[0] + 0.05, place[1], place[2], 0.1]])
        blocked = Problem(T_base_tip=free.T_base_tip, q0=free.q0, points=ball)
        assert solver.cost(blocked)(points.positions(answer.q)) > 1e-6
        around = solver.solve(blocked)
        if around.claimed:
            avoided += 1
            assert reaches(iiwa, around, blocked)
            gap = np.linalg.norm(points.positions(around.q)[elbow] - ball[0, :3])
            assert gap > 0.1
    assert met >= 3
    assert avoided >= 2  # it is a local method: the others end in a minimum that touches


def test_an_obstacle_is_where_its_weights_put_it(arm: object) -> None:
    rng = np.random.default_rng(13)
    points = points_module.ArmPoints(arm)
    spheres = obstacles.JointSpheres(arm.robot, points)
    cloud = np.column_stack([rng.normal(size=(20, 3)), rng.uniform(0.1, 0.3, 20)])
    Y = points.positions(arm.random_configuration(rng))
    weights, least = spheres.bounds(cloud)
    distances = np.linalg.norm(weights @ Y, axis=1)
    expected = np.linalg.norm(Y[spheres.rows][:, None] - cloud[:, :3], axis=-1).ravel()
    np.testing.assert_allclose(distances, expected, atol=1e-9)
    assert spheres.clearance(Y, cloud) == pytest.approx(np.min(distances - np.sqrt(least)))
    assert np.all(spheres.radii > 0)


def test_smoothed_bounds_are_tight_and_hold_the_truth() -> None:
    rng = np.random.default_rng(14)
    X = rng.normal(size=(12, 3))
    true = np.linalg.norm(X[:, None] - X, axis=-1)
    upper, lower = np.where(rng.uniform(size=(12, 12)) < 0.4, true, np.inf), np.zeros((12, 12))
    upper = np.minimum(upper, upper.T)
    np.fill_diagonal(upper, 0.0)
    lower[np.isfinite(upper)] = true[np.isfinite(upper)]
    low, high = start.smoothed(lower, upper)
    assert np.all(low <= true + 1e-12)
    assert np.all(high >= true - 1e-12)
    assert np.all(high[:, None, :] <= high[:, :, None] + high[None, :, :] + 1e-12)
    everything = start.embedded(true, true, np.argwhere(np.triu(true)))
    np.testing.assert_allclose(
        np.linalg.norm(everything[:, None] - everything, axis=-1), true, atol=1e-9
    )


def test_far_obstacles_change_nothing(iiwa: object) -> None:
    q = iiwa.random_configuration(np.random.default_rng(11))
    solver = dg.RiemannianTrustRegion(iiwa, Terms())
    far = target(iiwa, q, np.full((5, 3), 9.0))
    np.testing.assert_allclose(solver.solve(far).q, solver.solve(target(iiwa, q)).q, atol=1e-6)


def test_time_is_kept(iiwa: object) -> None:
    problem = target(iiwa, iiwa.random_configuration(np.random.default_rng(12)))
    answer = dg.RiemannianConjugateGradient(iiwa, Terms(max_time=0.05)).solve(problem)
    assert answer.time < 0.5
    assert np.isfinite(answer.q).all()


def test_a_whole_pose_is_refused(iiwa: object) -> None:
    with pytest.raises(ValueError, match="axis"):
        dg.RiemannianTrustRegion(iiwa, Terms(goal="pose"))
