"""Solids as obstacles from Python, judged by coal."""

import pickle
from collections.abc import Callable, Iterable

import coal
import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

import pdoik
from bench.ik.judges.triangles import tree_of
from pdoik.solids import nearest_points, part_surface, shape_mesh

FloatArray = NDArray[np.float64]


def random_pose(rng: np.random.Generator, extent: float = 0.5) -> FloatArray:
    R, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    T = np.eye(4)
    T[:3, :3] = R * np.linalg.det(R)
    T[:3, 3] = rng.uniform(-extent, extent, 3)
    return T


def random_shapes(rng: np.random.Generator) -> list[pdoik.Shape]:
    def lengths(count: int) -> FloatArray:
        return rng.uniform(0.05, 0.4, count)

    corners = rng.uniform(-0.2, 0.2, (12, 3))
    ring = trimesh.creation.torus(0.25, 0.04, major_sections=16, minor_sections=8)
    low = rng.uniform(-0.4, 0.4, (5, 3))
    return [
        pdoik.Shape.sphere("ball", rng.uniform(-0.6, 0.6, 3), *lengths(1)),
        pdoik.Shape.box("box", lengths(3), random_pose(rng)),
        pdoik.Shape.cylinder("can", *lengths(2), random_pose(rng)),
        pdoik.Shape.capsule("pill", *lengths(2), random_pose(rng)),
        pdoik.Shape.half_space("floor", rng.normal(size=3), rng.uniform(-1, 1, 3)),
        pdoik.Shape.convex_mesh("rock", corners, random_pose(rng)),
        pdoik.Shape.mesh("ring", ring.vertices, ring.faces, random_pose(rng)),
        pdoik.Shape.boxes("crumbs", low, low + rng.uniform(0.01, 0.06, (5, 3)), random_pose(rng)),
    ]


def coal_geometry(shape: pdoik.Shape) -> object:
    if shape.kind == "sphere":
        return coal.Sphere(*shape.size)
    if shape.kind == "box":
        return coal.Box(*shape.size)
    if shape.kind == "cylinder":
        return coal.Cylinder(*shape.size)
    if shape.kind == "capsule":
        return coal.Capsule(*shape.size)
    if shape.kind == "half_space":
        return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
    if shape.kind in ("mesh", "boxes"):  # thinner than any capsule, none of which fits inside
        mesh, _ = shape_mesh(shape)
        return tree_of(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    points = coal.StdVec_Vec3s()
    points.extend(list(shape.vertices))
    triangles = coal.StdVec_Triangle()
    triangles.extend([coal.Triangle(*map(int, each)) for each in shape.triangles])
    return coal.Convex(points, triangles)


def coal_distance(one: object, T_one: FloatArray, other: object, T_other: FloatArray) -> float:
    poses = [coal.Transform3s(T[:3, :3], T[:3, 3]) for T in (T_one, T_other)]
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    return float(coal.distance(one, poses[0], other, poses[1], request, result))


@pytest.mark.parametrize("seed", range(3))
def test_the_nearest_points_of_convex_shapes_are_as_far_apart_as_coal_says(
    rng: np.random.Generator, seed: int
) -> None:
    apart = 0
    for _ in range(15):
        one, other = (
            [each for each in random_shapes(rng) if each.kind not in ("mesh", "boxes")]
            for _ in range(2)
        )
        a, b = one[int(rng.integers(6))], other[int(rng.integers(6))]
        if a.kind == b.kind == "half_space":
            continue
        distance = coal_distance(coal_geometry(a), a.T_base_shape, coal_geometry(b), b.T_base_shape)
        line = nearest_points(a, b)
        assert line is not None
        if distance < 1e-3:
            continue
        assert np.linalg.norm(line[1] - line[0]) == pytest.approx(distance, abs=2e-4)
        for shape, end in zip((a, b), line, strict=True):
            assert part_surface(shape)(end)[0] == pytest.approx(0, abs=1e-6)
        apart += 1
    assert apart > 2


def capsule_between(a: FloatArray, b: FloatArray, radius: float) -> tuple[object, FloatArray]:
    """A capsule of coal's and where it is."""
    along = b - a
    length = float(np.linalg.norm(along))
    T = np.eye(4)
    T[:3, 3] = (a + b) / 2
    if length < 1e-12:
        return coal.Sphere(radius), T
    z = along / length
    x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
    x /= np.linalg.norm(x)
    T[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    return coal.Capsule(radius, length), T


def capsules_of(robot: pdoik.Robot, q: FloatArray) -> Iterable[tuple[object, FloatArray]]:
    for link, a, b, radius, _ in robot.occupancy.capsules:
        T = robot.fk(q, link)
        yield capsule_between(T[:3, :3] @ a + T[:3, 3], T[:3, :3] @ b + T[:3, 3], radius)


def arm_of_capsules(name: str) -> pdoik.Robot:
    """A rod from each link's origin to the next one's, and nothing else."""
    robot = pdoik.Robot.builtin(name)
    q = robot.mid_configuration()
    capsules = []
    for link, following in zip(robot.link_names, robot.link_names[1:], strict=False):
        end = np.linalg.inv(robot.fk(q, link)) @ robot.fk(q, following)[:, 3]
        capsules.append((link, (0.0, 0.0, 0.0), tuple(end[:3]), 0.03))
    robot.occupancy = pdoik.Occupancy(capsules=capsules)
    robot.ignored_pairs = []  # the shipped ones are of the shipped hulls
    return robot


@pytest.mark.parametrize("name", ["panda", "ur10", "iiwa14"])
def test_clearances_of_capsules_are_coals(name: str) -> None:
    robot = arm_of_capsules(name)
    solver = pdoik.Solver(robot, pdoik.Options(base_collision=True))
    rng = np.random.default_rng(7)
    clear = 0
    for _ in range(60):
        shapes = random_shapes(rng)
        q = rng.uniform(robot.lower, robot.upper)
        placed = list(capsules_of(robot, q))
        for shape in shapes:
            expected = min(
                coal_distance(body, T, coal_geometry(shape), np.asarray(shape.T_base_shape))
                for body, T in placed
            )
            found = solver.judge(robot.fk(q), q, obstacles=[shape])
            if expected > 0:
                clear += 1
                assert found.clearance == pytest.approx(expected, abs=2e-5)
            else:
                assert found.clearance < 1e-6
                assert not found.success or found.clearance > -1e-6
        scene = solver.judge(robot.fk(q), q, obstacles=shapes)
        each = [solver.judge(robot.fk(q), q, obstacles=[shape]).clearance for shape in shapes]
        assert scene.clearance == min(each)
        if not scene.success:
            assert scene.worst_constraint.endswith(f"to {shapes[int(np.argmin(each))].name}")
    assert clear > 60


def test_what_is_solved_is_clear_by_coal() -> None:
    robot = arm_of_capsules("panda")
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.5))
    rng = np.random.default_rng(3)
    solved = 0
    for _ in range(40):
        q = rng.uniform(robot.lower, robot.upper)
        shapes = [
            shape
            for shape in random_shapes(rng)
            if solver.judge(robot.fk(q), q, obstacles=[shape]).clearance > 0.01
        ]
        scene = pdoik.Scene(shapes, cloud=robot.fk(q)[:3, 3] + rng.normal(size=(20, 3)) + [0, 0, 3])
        result = solver.solve(robot.fk(q), obstacles=scene)
        if not result.success:
            continue
        solved += 1
        for body, T in capsules_of(robot, result.q):
            for shape in shapes:
                at = np.asarray(shape.T_base_shape)
                assert coal_distance(body, T, coal_geometry(shape), at) > -1e-5
    assert solved >= 38


def test_points_and_shapes_count_together_and_none_is_none() -> None:
    robot = arm_of_capsules("ur10")
    solver = pdoik.Solver(robot)
    q = np.array([0.3, -1.0, 0.8, 0.2, 0.4, 0.1])
    ball = pdoik.Shape.sphere("ball", robot.fk(q)[:3, 3] + [0, 0, 0.3], 0.1)
    point = robot.fk(q)[:3, 3] + [0, 0, 0.1]

    def clearance(obstacles: object) -> float:
        return solver.judge(robot.fk(q), q, obstacles=obstacles).clearance

    by_shape, by_point = clearance([ball]), clearance(point[None])
    assert by_point < by_shape
    assert clearance(pdoik.Scene([ball], cloud=point[None])) == by_point
    assert clearance(pdoik.Scene([ball], cloud=pdoik.Cloud(point[None]))) == by_point
    assert clearance(pdoik.Scene([ball])) == by_shape
    assert clearance(None) == np.inf
    assert clearance(pdoik.Scene()) == np.inf


def test_contact_is_allowed_by_name() -> None:
    robot = pdoik.Robot.builtin("panda")
    table = pdoik.Shape.box("table", (2, 2, 0.1), np.eye(4))
    T = robot.fk([0.3, 0.2, 0.0, -1.8, 0.0, 2.2, 0.8])
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    refused = solver.solve(T, obstacles=[table])
    assert refused.status == "base_collision"
    assert "to table" in refused.worst_constraint
    scene = pdoik.Scene([table], allowed=[("panda_link0", "table"), ("panda_link1", "table")])
    assert solver.solve(T, obstacles=scene).success
    with pytest.raises(ValueError, match="'nobody'"):
        solver.solve(T, obstacles=pdoik.Scene([table], allowed=[("nobody", "table")]))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: pdoik.Shape.box("table", (1, 0, 1)), "shape 'table'"),
        (lambda: pdoik.Shape.box("table", (1, 1)), "size"),
        (lambda: pdoik.Shape.sphere("ball", (0, 0, np.nan), 1), "center|'ball'"),
        (lambda: pdoik.Shape.cylinder("can", -1, 1), "shape 'can': radius"),
        (lambda: pdoik.Shape.half_space("floor", (0, 0, 0), (0, 0, 0)), "no direction"),
        (lambda: pdoik.Shape.box("table", (1, 1, 1), np.diag([2, 1, 1, 1])), "'table'"),
        (lambda: pdoik.Shape.convex_mesh("rock", np.zeros((5, 3))), "one plane"),
        (
            lambda: pdoik.Shape.convex_mesh(
                "rock",
                [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
                None,
                [[0, 2, 1], [0, 1, 3], [0, 3, 2], [0, 1, 2]],
            ),
            "has a hole",
        ),
        (lambda: pdoik.Scene([pdoik.Shape.sphere("a", (0, 0, 0), 1)] * 2), "two shapes"),
        (lambda: pdoik.Scene([], allowed=[("hand", "mug", -1.0)]), "'mug' may touch"),
    ],
)
def test_nonsense_is_refused_by_name(make: Callable[[], object], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        make()


def test_shapes_tell_what_they_are_and_go_through_pickle() -> None:
    rng = np.random.default_rng(1)
    for shape in random_shapes(rng):
        again = pickle.loads(pickle.dumps(shape))
        assert (again.name, again.kind, again.size) == (shape.name, shape.kind, shape.size)
        np.testing.assert_array_equal(again.T_base_shape, shape.T_base_shape)
        np.testing.assert_array_equal(again.vertices, shape.vertices)
        np.testing.assert_array_equal(again.triangles, shape.triangles)
        moved = shape.moved(np.eye(4))
        np.testing.assert_array_equal(moved.T_base_shape, np.eye(4))
        assert moved.kind == shape.kind


def test_trackers_and_batches_take_shapes() -> None:
    robot = arm_of_capsules("iiwa14")
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.2))
    wall = pdoik.Shape.box("wall", (0.02, 2, 2), np.array(np.eye(4)) + 0.4 * np.eye(4, 4, 3))
    start = np.array([0.0, 0.4, 0.0, -1.8, 0.0, 0.8, 0.0])
    reached = solver.judge(robot.fk(start), start, obstacles=[wall])
    results = solver.solve_batch(np.array([robot.fk(start)] * 5), obstacles=[wall])
    assert results.success.shape == (5,)
    if not reached.success:
        assert "wall" in reached.worst_constraint
    tracker = pdoik.Tracker(solver, period=0.002)
    tracker.reset(solver.solve(robot.fk(start)).q)
    step = tracker.step(robot.fk(start), obstacles=[wall])
    assert step.clearance <= 0.5
