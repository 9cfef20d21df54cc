"""Fields of signed distances as obstacles: judged by coal of the solids they are fields of."""

import itertools
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

import pdoik
from pdoik._distance_fields import zero_level
from pdoik.view.drawing.shape_scene import shape_mesh
from test_shapes import (
    FloatArray,
    arm_of_capsules,
    capsules_of,
    coal_distance,
    coal_geometry,
    random_pose,
)

CELL, COUNTS = 0.025, (80, 80, 72)
LOW = np.array([-1.0, -1.0, -0.5])  # of the grid, in its frame [m]
OFF = 0.5 * math.sqrt(3) * CELL  # what an interpolation may be off by


def at(*xyz: float) -> FloatArray:
    T = np.eye(4)
    T[:3, 3] = xyz
    return T


def middles(counts: tuple[int, ...] = COUNTS, cell: float = CELL) -> FloatArray:
    """Of cells, in the frame of the grid, (X, Y, Z, 3)."""
    each = [cell * (np.arange(n) + 0.5) for n in counts]
    return np.stack(np.meshgrid(*each, indexing="ij"), axis=-1)


def to_box(points: FloatArray, box: pdoik.Shape) -> FloatArray:
    """Signed distances of points of the base frame, (...)."""
    T = np.linalg.inv(box.T_base_shape)
    over = np.abs(points @ T[:3, :3].T + T[:3, 3]) - np.array(box.size) / 2
    outside = np.linalg.norm(np.maximum(over, 0), axis=-1)
    return np.asarray(outside + np.minimum(over.max(axis=-1), 0))


def boxes_of(rng: np.random.Generator, count: int = 10) -> list[pdoik.Shape]:
    """Around the base, none at it."""
    boxes: list[pdoik.Shape] = []
    while len(boxes) < count:
        T = random_pose(rng, 0.8)
        T[2, 3] = rng.uniform(0.0, 0.9)
        if np.linalg.norm(T[:2, 3]) > 0.35:
            boxes.append(pdoik.Shape.box(f"box {len(boxes)}", rng.uniform(0.05, 0.25, 3), T))
    return boxes


def field_of(boxes: list[pdoik.Shape], T: FloatArray, **options: Any) -> pdoik.Shape:
    """Of boxes, in a frame that T takes to the base."""
    points = middles() + LOW
    points = points @ T[:3, :3].T + T[:3, 3]
    values = np.min([to_box(points, box) for box in boxes], axis=0).astype(np.float32)
    return pdoik.Shape.distance_field("field", values, CELL, T @ at(*LOW), **options)


def turned(angle: float) -> FloatArray:
    T = np.eye(4)
    T[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return T


def nearest_by_coal(robot: pdoik.Robot, q: FloatArray, boxes: list[pdoik.Shape]) -> float:
    return min(
        coal_distance(body, T, coal_geometry(box), np.asarray(box.T_base_shape))
        for body, T in capsules_of(robot, q)
        for box in boxes
    )


@pytest.mark.parametrize("name", ["panda", "ur10"])
def test_clearances_are_coals_of_the_boxes_within_the_interpolation(name: str) -> None:
    robot = arm_of_capsules(name)
    solver = pdoik.Solver(robot)
    rng = np.random.default_rng(1)
    near = touching = 0
    for turn in (0.0, 0.4):
        boxes = boxes_of(rng)
        field = field_of(boxes, turned(turn))
        for _ in range(120):
            q = rng.uniform(robot.lower, robot.upper)
            expected = nearest_by_coal(robot, q, boxes)
            found = solver.judge(robot.fk(q), q, obstacles=[field])
            told = solver.clearances(q, [field])
            assert [each.obstacle for each in told] == ["field"]
            assert told[0].distance == pytest.approx(found.clearance, abs=2e-6)
            if expected > 0:
                assert found.clearance == pytest.approx(expected, abs=OFF)
                near += expected < 0.05
            else:
                assert found.clearance < OFF
                touching += 1
            if not found.success:
                assert found.worst_constraint.endswith("to field")
    assert near > 10
    assert touching > 5


@pytest.mark.parametrize("name", ["panda", "iiwa14"])
def test_what_is_solved_in_a_field_is_clear_by_coal(name: str) -> None:
    robot = arm_of_capsules(name)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    careful = pdoik.Solver(robot, pdoik.Options(max_time=1.0, clearance=OFF))
    rng = np.random.default_rng(2)
    solved = by_boxes = 0
    for turn in (0.0, 0.7):
        boxes = boxes_of(rng, 14)
        field = pdoik.Scene([field_of(boxes, turned(turn))])
        for _ in range(20):
            q = rng.uniform(robot.lower, robot.upper)
            if solver.judge(robot.fk(q), q, obstacles=boxes).clearance < 2 * OFF:
                continue
            T = robot.fk(q)
            by_boxes += solver.solve(T, obstacles=boxes).success
            result = solver.solve(T, obstacles=field)
            solved += result.success
            if result.success:
                assert nearest_by_coal(robot, np.asarray(result.q), boxes) > -OFF
            sure = careful.solve(T, obstacles=field)
            if sure.success:
                assert nearest_by_coal(robot, np.asarray(sure.q), boxes) > -1e-5
    assert by_boxes > 10
    assert solved >= 0.95 * by_boxes


def signed_edt(taken: np.ndarray, cell: float) -> np.ndarray:
    """Of cells by SciPy: from the border of the nearest cell of the other sort, about."""
    outside, inside = distance_transform_edt(~taken), distance_transform_edt(taken)
    return np.where(taken, 0.5 - inside, outside - 0.5).astype(np.float32) * cell


def test_the_field_of_an_occupancy_grid_is_about_as_far_as_the_grid() -> None:
    rng = np.random.default_rng(3)
    robot = arm_of_capsules("panda")
    solver = pdoik.Solver(robot)
    cell, taken = 0.04, np.zeros((50, 50, 40), bool)
    for low in rng.integers(0, [44, 44, 34], (12, 3)):
        taken[tuple(slice(n, n + 6) for n in low)] = True
    T = at(-1.0, -1.0, -0.2)
    field = pdoik.Shape.distance_field("map", signed_edt(taken, cell), cell, T)
    grid = pdoik.Shape.grid("map", taken, cell, T)
    apart = 0
    for _ in range(60):
        q = rng.uniform(robot.lower, robot.upper)
        by_field = solver.judge(robot.fk(q), q, obstacles=[field]).clearance
        by_grid = solver.judge(robot.fk(q), q, obstacles=[grid]).clearance
        if by_grid > 0:
            apart += 1
            assert by_field == pytest.approx(by_grid, abs=math.sqrt(3) * cell)
        else:
            assert by_field < math.sqrt(3) * cell
    assert apart > 20


def test_truncated_fields_keep_thick_links_off_as_whole_ones_do() -> None:
    robot = arm_of_capsules("panda")
    solver = pdoik.Solver(robot)
    rng = np.random.default_rng(4)
    boxes = boxes_of(rng)
    T = turned(0.2)
    whole = field_of(boxes, T)
    truncation = 0.02  # thinner than a link
    values = np.clip(whole.values, -truncation, truncation)
    told = pdoik.Shape.distance_field(
        "field", values, CELL, whole.T_base_shape, truncation=truncation
    )
    found = pdoik.Shape.distance_field("field", values, CELL, whole.T_base_shape)
    np.testing.assert_array_equal(told.values, found.values)
    near = 0
    for _ in range(60):
        q = rng.uniform(robot.lower, robot.upper)
        expected = solver.judge(robot.fk(q), q, obstacles=[whole]).clearance
        clearance = solver.judge(robot.fk(q), q, obstacles=[found]).clearance
        if expected > 0:
            near += 1
            assert expected - 1e-5 <= clearance <= expected + CELL
        else:
            assert clearance < CELL
    assert near > 20


def test_what_was_not_seen_is_free_or_solid() -> None:
    robot = arm_of_capsules("panda")
    solver = pdoik.Solver(robot)
    q = robot.mid_configuration()
    tip = robot.fk(q)[:3, 3]
    values = np.full((20, 20, 20), 1.0, np.float32)
    values[10:] = np.nan
    T = at(*(tip - 0.1 * CELL - 15 * CELL))  # the tip is where nothing was seen
    far = pdoik.Shape.distance_field("map", values, CELL, T)
    solid = pdoik.Shape.distance_field("map", values, CELL, T, unknown="occupied")
    assert solver.judge(robot.fk(q), q, obstacles=[far]).clearance > 0
    assert solver.judge(robot.fk(q), q, obstacles=[solid]).clearance < -CELL
    values[10:] = 1000.0  # as nvblox has it
    also = pdoik.Shape.distance_field("map", values, CELL, T, unknown="occupied")
    np.testing.assert_array_equal(also.values, solid.values)


def held_things(rng: np.random.Generator) -> list[pdoik.Shape]:
    T = random_pose(rng, 0.05)
    T[2, 3] += 0.15
    corners = rng.uniform(-0.08, 0.08, (10, 3))
    return [
        pdoik.Shape.box("held", (0.12, 0.06, 0.09), T),
        pdoik.Shape.cylinder("held", 0.04, 0.15, T),
        pdoik.Shape.capsule("held", 0.03, 0.12, T),
        pdoik.Shape.sphere("held", T[:3, 3], 0.05),
        pdoik.Shape.convex_mesh("held", corners, T),
    ]


def test_what_is_held_keeps_off_a_field() -> None:
    robot = arm_of_capsules("panda")
    hand = robot.link_names[-1]
    rng = np.random.default_rng(5)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    boxes = boxes_of(rng)
    scene = pdoik.Scene([field_of(boxes, turned(0.1))])
    binding = solved = 0
    for k in range(50):
        held = held_things(rng)[k % 5]
        solver.attach(hand, [held])
        q = rng.uniform(robot.lower, robot.upper)

        def by_coal(q: FloatArray, held: pdoik.Shape = held) -> float:
            T_held = robot.fk(q, hand) @ held.T_base_shape
            return min(
                coal_distance(coal_geometry(held), T_held, coal_geometry(box), box.T_base_shape)
                for box in boxes
            )

        (told,) = solver.clearances(q, scene)
        binding += told.part == "held"
        expected = min(by_coal(q), nearest_by_coal(robot, q, boxes))
        if expected > 0:
            assert told.distance == pytest.approx(expected, abs=OFF)
        else:
            assert told.distance < OFF
        result = solver.solve(robot.fk(q), obstacles=scene)
        if result.success:
            solved += 1
            assert by_coal(np.asarray(result.q)) > -OFF
        solver.detach()
    assert binding > 5
    assert solved > 10
    with pytest.raises(ValueError, match="'field' is not convex"):
        solver.attach(hand, scene.shapes)


def test_a_tracker_pushed_into_a_field_stops_at_it() -> None:
    robot = arm_of_capsules("panda")
    rng = np.random.default_rng(6)
    held = 0
    for _ in range(6):
        q = rng.uniform(0.7 * robot.lower, 0.7 * robot.upper)
        way = rng.normal(size=3)
        way /= np.linalg.norm(way)
        goal = np.array(robot.fk(q))
        wall = pdoik.Shape.box("wall", (0.15, 0.15, 0.15), at(*(goal[:3, 3] + 0.2 * way)))
        field = pdoik.Scene([field_of([wall], turned(0.3))])
        tracker = pdoik.Tracker(pdoik.Solver(robot), period=0.002, max_time=1.0)
        if pdoik.Solver(robot).judge(goal, q, obstacles=field).clearance < 0.01:
            continue
        tracker.reset(q)
        least = np.inf
        for k in range(200):
            target = goal.copy()
            target[:3, 3] += min(0.001 * k, 0.2) * way
            step = tracker.step(target, obstacles=field)
            least = min(least, step.clearance)
            if k % 20 == 19:
                assert nearest_by_coal(robot, np.asarray(step.q), [wall]) > -OFF
        assert least > -1e-5
        held += least < 0.002
    assert held >= 2


def test_moves_go_around_what_is_in_a_field() -> None:
    robot = arm_of_capsules("panda")
    wall = pdoik.Shape.box("wall", (0.5, 0.06, 0.7), at(0.5, 0.0, 0.35))
    scene = pdoik.Scene([field_of([wall], np.eye(4))])
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    q = np.array([-0.9, 0.4, 0.0, -1.6, 0.0, 2.0, 0.8])
    other = np.array([0.9, 0.4, 0.0, -1.6, 0.0, 2.0, 0.8])
    plan = solver.plan_motion(q, q_to=other, obstacles=scene, max_time=20.0)
    assert plan.status == "solved"
    way = np.asarray(plan.q)
    assert nearest_by_coal(robot, 0.5 * (q + other), [wall]) < 0  # the straight way is shut
    for a, b in itertools.pairwise(way):
        for share in np.linspace(0, 1, 12):
            assert nearest_by_coal(robot, a + share * (b - a), [wall]) > -OFF


def test_batches_and_copies_share_one_field() -> None:
    robot = arm_of_capsules("panda")
    boxes = boxes_of(np.random.default_rng(8), 5)
    field = field_of(boxes, np.eye(4))
    moved = field.moved(at(0.1, 0, 0) @ field.T_base_shape)
    scene = pdoik.Scene([field])
    place = field.values.ctypes.data
    assert {each.values.ctypes.data for each in (moved, *scene.shapes)} == {place}
    assert not field.values.flags.writeable
    assert field.values.dtype == np.float32
    solver = pdoik.Solver(robot, pdoik.Options(max_time=np.inf, max_restarts=20))
    T = np.array([robot.fk(robot.mid_configuration() + 0.05 * k) for k in range(6)])
    at_once = solver.solve_batch(T, robot.mid_configuration(), scene)
    for one, target in zip(at_once, T, strict=True):
        assert one.status == solver.solve(target, robot.mid_configuration(), scene).status
    again = pickle.loads(pickle.dumps(field))
    np.testing.assert_array_equal(again.values, field.values)
    assert (again.cell, again.kind, again.name) == (CELL, "distance_field", "field")
    box = pdoik.Shape.box("box", (1, 1, 1))
    assert (box.cell, box.values.shape) == (None, (0, 0, 0))


GOOD = np.linspace(-0.2, 0.2, 21, dtype=np.float32)[:, None, None] * np.ones((1, 5, 5), np.float32)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"values": GOOD[0]}, r"shape \(5, 5\).*floats of shape \(X, Y, Z\)"),
        ({"values": GOOD < 0}, r"bool.*make a Shape.grid"),
        ({"values": (100 * GOOD).astype(int)}, "int64, expected signed distances in metres"),
        ({"values": GOOD[:1]}, "at least 2 cells along each axis"),
        ({"values": np.full_like(GOOD, np.nan)}, "nothing is known of any cell"),
        ({"cell": 0.0}, "cell is 0, expected a positive length"),
        ({"cell": -0.02}, "cell is -0.02"),
        ({"cell": math.nan}, "cell is -?nan"),
        ({"values": GOOD / 0.02}, "counted in cells, in millimetres"),
        ({"values": 1000 * GOOD}, "in millimetres"),
        ({"cell": 20.0}, "is cell in millimetres"),
        ({"truncation": 0.0}, "truncation is 0"),
        ({"truncation": -1.0}, "truncation is -1"),
        ({"truncation": math.nan}, "truncation is -?nan"),
        ({"unknown": "maybe"}, "unknown is 'maybe', expected one of 'free', 'occupied'"),
        ({"name": ""}, "no name"),
        ({"T_base_shape": np.diag([2.0, 1, 1, 1])}, "'map': T_base_shape"),
    ],
)
def test_fields_that_make_no_sense_are_refused(change: dict[str, Any], says: str) -> None:
    given: dict[str, Any] = {"name": "map", "values": GOOD, "cell": 0.02, **change}
    with pytest.raises(ValueError, match=says):
        pdoik.Shape.distance_field(**given)


def test_what_is_taken_is_any_array_of_floats() -> None:
    expected = pdoik.Shape.distance_field("map", GOOD, 0.02).values
    for values in (GOOD.astype(np.float64), GOOD.tolist(), np.asfortranarray(GOOD)):
        found = pdoik.Shape.distance_field("map", values, 0.02).values
        np.testing.assert_array_equal(found, expected)
    half = pdoik.Shape.distance_field("map", GOOD.astype(np.float16), 0.02).values
    np.testing.assert_allclose(half, expected, atol=1e-3)
    pdoik.Shape.distance_field("nothing", np.full((4, 4, 4), 2.0), 0.02)  # an empty map


def test_fields_come_back_from_a_scene_file(tmp_path: Path) -> None:
    T = random_pose(np.random.default_rng(1))
    shapes = [
        pdoik.Shape.distance_field("a map", np.clip(GOOD, -0.04, 0.04), 0.02, T),
        pdoik.Shape.distance_field("a/map", GOOD, 0.02),
    ]
    path = tmp_path / "scene.yaml"
    pdoik.save_scene(pdoik.Scene(shapes), path)
    assert len(list(tmp_path.glob("scene.*.npz"))) == 2
    for before, after in zip(shapes, pdoik.load_scene(path).shapes, strict=True):
        assert (before.name, before.kind, before.cell) == (after.name, after.kind, after.cell)
        np.testing.assert_array_equal(before.values, after.values)
        np.testing.assert_allclose(before.T_base_shape, after.T_base_shape, atol=1e-12)
    np.save(tmp_path / "map.npy", np.clip(GOOD, -0.04, 0.04))
    path.write_text(
        "shapes: [{name: it, distance_field: {file: map.npy, cell: 0.02, truncation: 0.04,"
        " unknown: occupied}, position: [0.1, 0, 0]}]"
    )
    (read,) = pdoik.load_scene(path).shapes
    np.testing.assert_array_equal(read.values, shapes[0].values)


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ("{file: gone.npy, cell: 0.02}", "distance field 'gone.npy'"),
        ("{file: map.npy}", "neither the scene nor map.npy says what cell is"),
        ("{file: map.npy, cell: wide}", "cell"),
        ("{file: map.npy, cell: 0.02, unknown: what}", "'what', expected one of"),
        ("{file: text.npy, cell: 0.02}", "cannot read"),
        ("{file: other.npz, cell: 0.02}", "no array called values"),
        ("{file: map.npy, cell: 20.0}", "in millimetres"),
        ("{values: [1], cell: 0.02}", "expected {file}"),
    ],
)
def test_entries_of_scenes_that_make_no_sense_are_named(
    entry: str, says: str, tmp_path: Path
) -> None:
    np.save(tmp_path / "map.npy", GOOD)
    np.savez(tmp_path / "other.npz", sdf=GOOD)
    (tmp_path / "text.npy").write_text("no array")
    path = tmp_path / "scene.yaml"
    path.write_text(f"shapes: [{{name: it, distance_field: {entry}}}]")
    with pytest.raises(pdoik.LoadError, match=says) as error:
        pdoik.load_scene(path)
    assert "(it)" in str(error.value)


def test_reports_keep_fields_to_the_bit_and_judge_them_by_themselves(tmp_path: Path) -> None:
    robot = pdoik.Robot.builtin("panda")
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    boxes = boxes_of(np.random.default_rng(9), 6)
    scene = pdoik.Scene([field_of(boxes, turned(0.5))], allowed=[("panda_link0", "field")])
    T = robot.fk([0.3, 0.4, 0.0, -1.8, 0.0, 2.2, 0.8])
    case = tmp_path / "case.json"
    pdoik.write_report(case, solver, T, obstacles=scene)
    assert case.stat().st_size < scene.shapes[0].values.nbytes
    replay = pdoik.replay_report(case)
    assert replay.same, replay.differences
    assert replay.faults == []
    judged = [each.clearance for each in replay.judged if each.clearance is not None]
    answer = replay.answers[0]
    assert answer["success"]
    assert min(judged) == pytest.approx(answer["clearance"], abs=2e-6)
    broken = case.read_text().replace('"float32": "', '"float32": "!')
    case.write_text(broken)
    with pytest.raises(pdoik.LoadError, match="cannot be unpacked"):
        pdoik.replay_report(case)


@pytest.mark.parametrize("level", [0.0, 0.1])
def test_what_is_drawn_is_where_a_field_is_zero(level: float) -> None:
    points = middles((60, 60, 60), CELL) - 30 * CELL
    ball = np.linalg.norm(points, axis=-1) - (0.4 + level)
    shape = pdoik.Shape.distance_field("ball", ball.astype(np.float32), CELL)
    mesh, _ = shape_mesh(shape)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * (0.4 + level) ** 3, rel=0.01)
    out = np.linalg.norm(mesh.vertices - 30 * CELL, axis=1)
    np.testing.assert_allclose(out, 0.4 + level, atol=0.05 * CELL)
    vertices, faces = zero_level(np.ones((4, 4, 4), np.float32), CELL)
    assert (len(vertices), len(faces)) == (0, 0)
