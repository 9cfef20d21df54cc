"""Pictures of solutions among solids: what is drawn, where, and what is marked."""

from __future__ import annotations

from pathlib import Path

import coal
import numpy as np
import pytest
import trimesh
from matplotlib.colors import rgb_to_hsv
from matplotlib.image import imread
from mpl_toolkits.mplot3d import proj3d
from PIL import Image, ImageDraw

import pdoik
from pdoik.picture import (
    Cube,
    DepthBuffer,
    Stage,
    blended,
    contents_of,
    in_pieces,
    mark_of,
    shape_triangles,
)
from pdoik.picture import draw_solution as draw_large

TAN, VIOLET, RED = 38, 266, 358  # hues [deg]
SIZE = 585  # of a picture [px]
DOWN = np.array([[1, 0, 0, 0.45], [0, -1, 0, 0.1], [0, 0, -1, 0.45], [0, 0, 0, 1.0]])


def at(*xyz: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = xyz
    return T


def draw_solution(*what: object, **how: object) -> None:
    """A small picture."""
    draw_large(*what, dpi=65, **how)  # type: ignore[arg-type]


def of_kind(kind: str) -> pdoik.Shape:
    """One beside the arm."""
    T = at(0.45, -0.35, 0.15)
    ring = trimesh.creation.torus(0.14, 0.05, major_sections=24, minor_sections=12)
    corners = [(x, y, 0.0) for x in (-0.15, 0.15) for y in (-0.15, 0.15)] + [(0.0, 0.0, 0.25)]
    taken = np.ones((4, 3, 2), dtype=bool)
    taken[1:3, 1:, 1] = False
    low = np.array([[-0.1, -0.1, -0.1], [0.1, 0.1, 0.1]])
    made = {
        "box": lambda: pdoik.Shape.box("it", (0.2, 0.3, 0.2), T),
        "sphere": lambda: pdoik.Shape.sphere("it", T[:3, 3], 0.15),
        "cylinder": lambda: pdoik.Shape.cylinder("it", 0.12, 0.3, T),
        "capsule": lambda: pdoik.Shape.capsule("it", 0.1, 0.2, T),
        "half_space": lambda: pdoik.Shape.half_space("it", (0.1, 0, 1), (0, 0, -0.1)),
        "convex_mesh": lambda: pdoik.Shape.convex_mesh("it", corners, T),
        "mesh": lambda: pdoik.Shape.mesh("it", ring.vertices, ring.faces, T),
        "boxes": lambda: pdoik.Shape.boxes("it", low, low + 0.12, T),
        "grid": lambda: pdoik.Shape.grid("it", taken, 0.08, T),
    }
    return made[kind]()


KINDS = (
    "box", "sphere", "cylinder", "capsule", "half_space", "convex_mesh", "mesh", "boxes", "grid"
)  # fmt: skip


def asked(**options: object) -> pdoik.Solver:
    options = {"max_time": 2.0, "clearance": 0.01} | options
    return pdoik.Solver(pdoik.Robot.builtin("panda"), pdoik.Options(**options))


def hued(path: Path, hue: float, within: float = 14.0, saturation: float = 0.15) -> np.ndarray:
    """Where a picture has a hue [deg], between its words above and its legend, (H, W)."""
    image = imread(path)[:, :, :3]
    hsv = rgb_to_hsv(image)
    off = np.abs((360 * hsv[..., 0] - hue + 180) % 360 - 180)
    found = (off < within) & (hsv[..., 1] > saturation)
    found[: image.shape[0] // 9] = found[-image.shape[0] // 8 :] = False
    return found


def middle(found: np.ndarray) -> np.ndarray:
    """Of the pixels that are, (row, column), as shares of the picture."""
    return np.argwhere(found).mean(axis=0) / found.shape


@pytest.mark.parametrize("kind", KINDS)
def test_a_shape_of_each_kind_is_drawn(tmp_path: Path, kind: str) -> None:
    solver, shape = asked(), of_kind(kind)
    scene = pdoik.Scene([shape], allowed=[("panda_link0", "it")])
    result = solver.solve(DOWN, obstacles=scene)
    assert result.success
    draw_solution(tmp_path / "with.png", solver, result, DOWN, scene)
    draw_solution(tmp_path / "without.png", solver, result, DOWN)
    tan = [hued(tmp_path / f"{name}.png", TAN).sum() for name in ("without", "with")]
    assert tan[1] > tan[0] + 0.005 * SIZE**2


@pytest.mark.parametrize("kind", ["box", "convex_mesh", "capsule"])
def test_what_is_held_is_drawn_where_the_hand_is(tmp_path: Path, kind: str) -> None:
    solver = asked()
    held = of_kind(kind).moved(at(0.0, 0.0, 0.2))
    solver.attach("panda_link8", [held])
    marks = []
    for name, y in (("left.png", 0.3), ("right.png", -0.3)):
        target = DOWN.copy()
        target[1, 3] = y
        target[2, 3] = 0.7
        result = solver.solve(target)
        assert result.success
        contents = contents_of(solver, result, target, None, None)
        (placed,) = contents.held
        T = solver.robot.fk(result.q, "panda_link8")
        np.testing.assert_allclose(placed.T_base_shape, T @ at(0.0, 0.0, 0.2), atol=1e-12)
        draw_solution(tmp_path / name, solver, result, target)
        violet = hued(tmp_path / name, VIOLET, saturation=0.3)
        assert violet.sum() > 0.002 * violet.size
        marks.append(middle(violet))
    assert np.linalg.norm(marks[1] - marks[0]) > 0.02
    solver.detach()
    draw_solution(tmp_path / "empty.png", solver, result, target)
    assert hued(tmp_path / "empty.png", VIOLET, saturation=0.3).sum() < 25


def test_what_touches_is_red_and_the_numbers_are_the_judges(tmp_path: Path) -> None:
    solver = asked()
    wall = pdoik.Shape.half_space("wall", (-1, 0, 0), (0.5, 0, 0))
    scene = pdoik.Scene([wall])
    clear, touching = DOWN.copy(), DOWN.copy()
    clear[0, 3] = 0.3
    marks = []
    for name, target in (("clear.png", clear), ("touching.png", touching)):
        result = solver.solve(target, obstacles=scene)
        assert result.success == (name == "clear.png")
        mark = mark_of(solver, result, contents_of(solver, result, target, scene, None))
        assert mark is not None
        assert mark.line is not None
        assert mark.fails != result.success
        length = np.linalg.norm(mark.line[1] - mark.line[0])
        assert length == pytest.approx(abs(result.clearance), abs=1e-9)
        assert mark.line[1, 0] == pytest.approx(0.5, abs=1e-9)  # on the wall
        assert f"{1e3 * abs(result.clearance):.1f} mm" in mark.text
        draw_solution(tmp_path / name, solver, result, target, scene)
        marks.append(hued(tmp_path / name, RED, within=8, saturation=0.6).sum())
    assert marks[1] > marks[0] + 100
    assert mark.text.endswith("inside wall")


def test_two_things_with_a_clearance_of_their_own_are_red_by_that_one(tmp_path: Path) -> None:
    """A rule of contact asks for more than the options do, or for less."""
    wall = pdoik.Shape.half_space("wall", (-1, 0, 0), (0.62, 0, 0))
    free = asked().solve(DOWN, obstacles=[wall])
    assert free.success
    assert free.clearance > 0.01
    reds = {}
    for name, clearance in (("more", free.clearance + 0.02), ("less", free.clearance - 0.005)):
        solver = asked(clearance=0.01 if name == "more" else free.clearance + 0.05)
        rule = pdoik.ContactRule("*", "wall", clearance=clearance)
        scene = pdoik.Scene([wall], contacts=[rule])
        result = solver.judge(DOWN, free.q, scene)
        assert result.success == (name == "less")
        mark = mark_of(solver, result, contents_of(solver, result, DOWN, scene, None))
        assert mark is not None
        assert mark.line is not None
        assert mark.fails == (name == "more")
        assert np.linalg.norm(mark.line[1] - mark.line[0]) == pytest.approx(
            free.clearance,
            abs=5e-3,  # of the link itself, where its capsule comes nearer than asked
        )
        if name == "more":
            assert "wall" in mark.names
            assert f"{-1e3 * result.room:.1f} mm less than asked" in mark.text
            assert 0.0 < -result.room <= 0.02 + 1e-6
        draw_solution(tmp_path / f"{name}.png", solver, result, DOWN, scene)
        reds[name] = hued(tmp_path / f"{name}.png", RED, saturation=0.5).sum()
    assert reds["more"] > reds["less"] + 100


def test_two_links_that_touch_are_marked_by_coals_distance() -> None:
    solver = asked(self_collision=True, clearance=0.0)
    robot = solver.robot
    q = robot.mid_configuration()
    q[3], q[5] = -3.0, 0.0
    result = solver.judge(robot.fk(q), q)
    assert not result.success
    mark = mark_of(solver, result, contents_of(solver, result, robot.fk(q), None, None))
    assert mark is not None
    assert mark.line is not None
    placed: list[object] = []
    for number in sorted(mark.hulls):
        *_, capsule = contents_of(solver, result, None, None, None).hulls[: number + 1]
        along = capsule.b - capsule.a
        length = float(np.linalg.norm(along))
        turn = trimesh.geometry.align_vectors([0, 0, 1], along)
        turn[:3, 3] = (capsule.a + capsule.b) / 2
        pose = coal.Transform3s(turn[:3, :3], turn[:3, 3])
        placed += [coal.Capsule(capsule.radius, length), pose]
    request, answer = coal.DistanceRequest(), coal.DistanceResult()
    distance = coal.distance(*placed, request, answer)
    assert distance < 0
    assert np.linalg.norm(mark.line[1] - mark.line[0]) == pytest.approx(-distance, abs=1e-6)
    assert distance - 1e-9 <= result.self_distance < 0  # the links are less deep in each other
    assert f"{-1e3 * result.self_distance:.1f} mm in each other" in mark.text


def test_where_the_base_fails_its_own_place_is_marked_and_not_a_deeper_one() -> None:
    solver = asked()
    block = pdoik.Shape.box("block", (2.0, 2.0, 1.0), at(0.9, 0.0, 0.45))
    result = solver.solve(DOWN, obstacles=[block])
    assert result.status == "base_collision"
    mark = mark_of(solver, result, contents_of(solver, result, DOWN, [block], None))
    assert mark is not None
    assert mark.text.startswith("panda_link0 to block")
    assert f"{1e3 * result.worst_violation:.1f} mm less than asked" in mark.text


def test_obstacles_are_taken_in_each_form_that_a_solve_takes(tmp_path: Path) -> None:
    solver, shape = asked(), of_kind("sphere")
    points = np.random.default_rng(0).uniform([0.3, -0.5, 0.0], [0.6, -0.2, 0.3], (40, 3))
    result = solver.solve(DOWN)
    image = np.full((4, 5, 3), np.nan)
    image[:2] = points[:10].reshape(2, 5, 3)
    forms = {
        "none": (None, 0, 0),
        "nothing": ([], 0, 0),
        "shapes": ([shape], 0, 1),
        "rows": (points, 40, 0),
        "lists": (points.tolist(), 40, 0),
        "radii": (np.column_stack([points, np.full(40, 0.01)]), 40, 0),
        "cloud": (pdoik.Cloud(points), 40, 0),
        "image": (image, 10, 0),
        "scene": (pdoik.Scene([shape], cloud=points), 40, 1),
    }
    for name, (form, n_points, n_shapes) in forms.items():
        contents = contents_of(solver, result, DOWN, form, None)
        assert (len(contents.points), len(contents.shapes)) == (n_points, n_shapes), name
    draw_solution(tmp_path / "all.png", solver, result, DOWN, forms["scene"][0])
    with pytest.raises(TypeError, match=r"expected a pdoik.Solver.* got Robot"):
        draw_solution(tmp_path / "no.png", solver.robot, result, DOWN)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"T_base_tip has shape \(3,\)"):
        draw_solution(tmp_path / "no.png", solver, result, DOWN[:3, 3])
    with pytest.raises(ValueError, match=r"surface has shape \(3, 2\)"):
        draw_solution(tmp_path / "no.png", solver, result, DOWN, surface=np.ones((3, 2)))
    assert not (tmp_path / "no.png").exists()


def test_walls_all_around_are_cut_off_and_seen_through(tmp_path: Path) -> None:
    solver = asked()
    low = [[-3, -0.6, -0.4], [-3, 0.6, -0.4], [-0.6, -0.6, -0.4], [0.9, -0.6, -0.4]]
    high = [[3, -0.5, 3], [3, 0.7, 3], [-0.5, 0.7, 3], [1.0, 0.7, 3]]
    room = pdoik.Shape.boxes("room", low, high)
    result = solver.solve(DOWN, obstacles=[room])
    assert result.success
    contents = contents_of(solver, result, DOWN, [room], None)
    cube = contents.cube()
    assert cube.reach < 1.3
    inside = shape_triangles(room, cube).reshape(-1, 3)
    assert np.abs(inside - cube.center).max() <= cube.reach + 1e-9
    draw_solution(tmp_path / "room.png", solver, result, DOWN, [room])
    assert hued(tmp_path / "room.png", TAN, saturation=0.05).mean() > 0.3
    height, width = hued(tmp_path / "room.png", TAN).shape
    part = np.s_[int(0.3 * height) : int(0.6 * height), int(0.38 * width) : int(0.64 * width)]
    assert imread(tmp_path / "room.png")[part][..., 0].std() > 0.05  # of a wall alone 0.016


def test_a_plane_is_cut_to_the_cube_and_pieces_are_small() -> None:
    cube = Cube(np.array([0.3, -0.2, 0.4]), 0.7)
    rng = np.random.default_rng(0)
    for _ in range(5):
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        on = cube.center + rng.uniform(-0.3, 0.3, 3)
        triangles = shape_triangles(pdoik.Shape.half_space("it", normal, on), cube)
        corners = triangles.reshape(-1, 3)
        np.testing.assert_allclose((corners - on) @ normal, 0, atol=1e-9)
        assert np.abs(corners - cube.center).max() <= cube.reach + 1e-9
        area = trimesh.triangles.area(triangles).sum()
        across = np.linalg.svd(normal[None])[2][1:]
        places = on + rng.uniform(-2, 2, (200_000, 2)) @ across
        assert area == pytest.approx(16 * cube.holds(places).mean(), rel=0.03)

        pieces = in_pieces(triangles, 0.1)
        edges = np.linalg.norm(np.roll(pieces, 1, axis=1) - pieces, axis=2)
        assert edges.max() <= 0.1
        assert trimesh.triangles.area(pieces).sum() == pytest.approx(area)
    assert not len(shape_triangles(pdoik.Shape.half_space("it", (0, 0, 1), (0, 0, 9)), cube))


def test_pixels_of_triangles_are_those_that_pillow_fills() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        triangle = rng.uniform(-20, 120, (1, 3, 2))
        image = Image.new("L", (4 * 100, 4 * 80))
        ImageDraw.Draw(image).polygon([tuple(4 * corner) for corner in triangle[0]], fill=255)
        wanted = np.asarray(image.resize((100, 80), Image.Resampling.BOX)) / 255.0
        buffer = DepthBuffer(100, 80)
        flat = np.dstack([triangle, np.ones((1, 3, 1))])
        buffer.fill(lambda p: (p[..., :2], p[..., 2]), flat, np.zeros((1, 3)))
        filled = np.isfinite(buffer.depth).reshape(80, 100)
        assert (filled[wanted > 0.9]).all()
        assert not (filled[wanted < 0.1]).any()


def test_triangles_side_by_side_leave_no_gap() -> None:
    rng = np.random.default_rng(0)
    points = np.vstack([[[0, 0], [100, 0], [0, 80], [100, 80]], rng.uniform(0, 80, (60, 2))])
    from scipy.spatial import Delaunay

    triangles = points[Delaunay(points).simplices]
    buffer = DepthBuffer(100, 80)
    flat = np.dstack([triangles, np.ones((*triangles.shape[:2], 1))])
    buffer.fill(lambda p: (p[..., :2], p[..., 2]), flat, np.zeros((len(flat), 3)))
    assert np.isfinite(buffer.depth).all()


def test_of_two_planes_that_cross_the_nearer_one_is_seen_in_perspective() -> None:
    cube = Cube(np.zeros(3), 1.0)
    stage = Stage(2.0, 50, cube, 35.0, 20.0)
    walls = [
        np.array([[[x, -1, -1], [x, 1, -1], [-x, 1, 1]], [[x, -1, -1], [-x, 1, 1], [-x, -1, 1]]])
        for x in (0.8, -0.8)
    ]
    buffer = stage.buffer()
    for wall, color in zip(walls, np.eye(3)[:2], strict=True):
        buffer.fill(stage.project, wall.astype(float), np.tile(color, (2, 1)))
    seen = buffer.color.reshape(stage.height, stage.width, 3)
    rng = np.random.default_rng(0)
    eye = np.array([np.cos(np.radians(35)), np.sin(np.radians(35)), np.tan(np.radians(20))])
    checked = 0
    for _ in range(300):
        y, z = rng.uniform(-0.7, 0.7, 2)
        if abs(z) < 0.08:
            continue
        nearest = 0 if z < 0 else 1  # the wall with x > 0 there; the eye is at x > 0
        point = np.array([(-0.8 if nearest == 0 else 0.8) * z, y, z])
        assert point @ eye > -2
        (column, row), _ = stage.project(point)
        assert seen[int(row), int(column)].argmax() == nearest
        checked += 1
    assert checked > 200


def test_the_stage_puts_points_where_matplotlib_does() -> None:
    stage = Stage(4.0, 60, Cube(np.array([0.2, 0.1, 0.5]), 0.6), -40.0, 20.0)
    points = np.random.default_rng(0).uniform([-0.3, -0.4, 0.0], [0.7, 0.6, 1.0], (50, 3))
    pixels, distance = stage.project(points)
    x, y, _ = proj3d.proj_transform(*points.T, stage.axes.get_proj())
    expected = stage.axes.transData.transform(np.column_stack([x, y]))
    np.testing.assert_allclose(pixels[:, 0], expected[:, 0], atol=1e-6)
    np.testing.assert_allclose(stage.height - pixels[:, 1], expected[:, 1], atol=1e-6)
    away = np.array([np.cos(np.radians(-40)), np.sin(np.radians(-40)), np.tan(np.radians(20))])
    assert np.corrcoef(points @ away, distance)[0, 1] < -0.999  # nearer to the eye is less


def test_layers_are_blended_by_their_distance() -> None:
    solid, near, far, behind = (DepthBuffer(2, 1) for _ in range(4))
    for buffer, depth, color in ((solid, 3, 0.2), (near, 1, 0.5), (far, 2, 0.9), (behind, 4, 0.7)):
        buffer.depth[0], buffer.color[0] = depth, color
    near.depth[1], near.color[1] = 1, 0.5  # before nothing
    color, opacity = blended(solid, [(near, 0.5), (behind, 0.9), (far, 0.25)])
    expected = 0.5 * 0.5 + 0.5 * (0.25 * 0.9 + 0.75 * 0.2)
    np.testing.assert_allclose(color[0], expected, atol=1e-6)
    np.testing.assert_allclose(color[1], 0.5, atol=1e-6)
    np.testing.assert_allclose(opacity, [1.0, 0.5], atol=1e-6)
