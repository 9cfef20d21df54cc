"""Meshes of any form, grids and depth images as obstacles."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

import pdoik
from test_shapes import (
    FloatArray,
    arm_of_capsules,
    capsules_of,
    coal_distance,
    coal_geometry,
)


def at(*xyz: float) -> FloatArray:
    T = np.eye(4)
    T[:3, 3] = xyz
    return T


def bin_walls() -> list[tuple[tuple[float, ...], tuple[float, ...]]]:
    """A bin without a lid: edges and middles of its bottom and its walls [m]."""
    wide, high, thick = 0.5, 0.25, 0.02
    bottom = ((wide, wide, thick), (0.0, 0.0, -thick / 2))
    walls = [
        ((thick, wide, high), (side * (wide - thick) / 2, 0.0, high / 2)) for side in (-1, 1)
    ] + [((wide, thick, high), (0.0, side * (wide - thick) / 2, high / 2)) for side in (-1, 1)]
    return [bottom, *walls]


def bin_mesh() -> trimesh.Trimesh:
    boxes = [trimesh.creation.box(size) for size, _ in bin_walls()]
    for box, (_, middle) in zip(boxes, bin_walls(), strict=True):
        box.apply_translation(middle)
    whole: trimesh.Trimesh = trimesh.util.concatenate(boxes)
    return whole.subdivide().subdivide()


@pytest.mark.parametrize("name", ["panda", "ur10"])
def test_what_is_solved_in_a_bin_is_clear_by_coal(name: str) -> None:
    robot = arm_of_capsules(name)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0, report_clearance=0.5))
    T, mesh = at(0.55, 0.1, 0.0), bin_mesh()
    as_mesh = pdoik.Scene([pdoik.Shape.mesh("bin", mesh.vertices, mesh.faces, T)])
    as_boxes = pdoik.Scene(
        [
            pdoik.Shape.box(f"wall {k}", size, T @ at(*middle))
            for k, (size, middle) in enumerate(bin_walls())
        ]
    )
    tree = coal_geometry(as_mesh.shapes[0])
    rng = np.random.default_rng(2)
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    solved = by_boxes = 0
    for _ in range(40):
        target = T @ at(*rng.uniform([-0.12, -0.12, 0.12], [0.12, 0.12, 0.3])) @ down
        result = solver.solve(target, obstacles=as_mesh)
        boxes = solver.solve(target, obstacles=as_boxes)
        by_boxes += boxes.success
        if boxes.success:
            # Of the same configuration both say the same.
            again = solver.judge(target, boxes.q, obstacles=as_mesh)
            assert again.success
            assert again.clearance == pytest.approx(boxes.clearance, abs=1e-9)
        if not result.success:
            continue
        solved += 1
        least = min(
            coal_distance(body, T_body, tree, T) for body, T_body in capsules_of(robot, result.q)
        )
        assert least > -1e-5
        assert result.clearance == pytest.approx(min(least, 0.5), abs=2e-5)
    assert by_boxes >= 15
    assert solved >= by_boxes - 1


def test_what_is_inside_a_closed_mesh_touches_it() -> None:
    robot = arm_of_capsules("panda")
    solver = pdoik.Solver(robot)
    q = robot.mid_configuration()
    around = trimesh.creation.icosphere(subdivisions=3, radius=3.0)
    hollow = trimesh.util.concatenate(
        [around, trimesh.creation.icosphere(subdivisions=3, radius=2.0)]
    )
    hollow.faces[len(around.faces) :] = hollow.faces[len(around.faces) :, ::-1]
    for mesh, is_clear in ((around, False), (hollow, True)):
        shape = pdoik.Shape.mesh("ball", mesh.vertices, mesh.faces)
        assert (solver.judge(robot.fk(q), q, obstacles=[shape]).clearance > 0) == is_clear


def test_an_open_mesh_is_told_of_and_keeps_off_its_surface() -> None:
    sheet = trimesh.creation.box((1.0, 1.0, 0.2))
    sheet.update_faces(sheet.face_normals[:, 2] > 0.5)
    sheet.remove_unreferenced_vertices()
    with pytest.warns(pdoik.ObstacleWarning, match=r"'table' is not closed: 4 of its edges"):
        table = pdoik.Shape.mesh("table", sheet.vertices, sheet.faces, at(0.6, 0.0, 0.1))
    robot = arm_of_capsules("panda")
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    below, above = at(0.5, 0.0, 0.12), at(0.5, 0.0, 0.45)
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    assert not solver.solve(below @ down, obstacles=[table]).success
    assert solver.solve(above @ down, obstacles=[table]).success


def test_a_grid_is_the_boxes_of_its_cells() -> None:
    rng = np.random.default_rng(4)
    taken = rng.random((9, 7, 5)) < 0.3
    T, edge = at(0.3, -0.4, 0.2), 0.05
    grid = pdoik.Shape.grid("grid", taken, edge, T)
    cells = [
        pdoik.Shape.box(f"cell {i}", [edge] * 3, T @ at(*(edge * (cell + 0.5))))
        for i, cell in enumerate(np.argwhere(taken))
    ]
    assert len(grid.vertices) // 2 < len(cells)
    robot = arm_of_capsules("ur10")
    solver = pdoik.Solver(robot)
    apart = 0
    for _ in range(60):
        q = rng.uniform(robot.lower, robot.upper)
        found = solver.judge(robot.fk(q), q, obstacles=[grid]).clearance
        expected = solver.judge(robot.fk(q), q, obstacles=cells).clearance
        if expected > 0:
            apart += 1
            assert found == pytest.approx(expected, abs=1e-9)
        else:
            assert found <= 1e-9
    assert apart > 10
    with pytest.raises(ValueError, match="no array of bool"):
        pdoik.Shape.grid("grid", taken.astype(float), edge)
    with pytest.raises(ValueError, match="no cell of the grid is taken"):
        pdoik.Shape.grid("grid", np.zeros((2, 2, 2), bool), edge)


def test_shapes_of_many_parts_are_one_obstacle_by_name() -> None:
    robot = arm_of_capsules("panda")
    solver = pdoik.Solver(robot)
    q = robot.mid_configuration()
    tip = robot.fk(q)[:3, 3]
    taken = np.ones((3, 3, 3), bool)
    grid = pdoik.Shape.grid("crate", taken, 0.02, at(*(tip - 0.03)))
    far = pdoik.Shape.sphere("far", tip + 3, 0.1)
    verdict = solver.judge(robot.fk(q), q, obstacles=[far, grid])
    assert not verdict.success
    assert verdict.worst_constraint.endswith("to crate")
    told = {each.obstacle: each.distance for each in solver.clearances(q, [far, grid])}
    assert set(told) == {"far", "crate"}
    assert told["crate"] == pytest.approx(verdict.clearance)
    mesh = trimesh.creation.torus(0.1, 0.02)
    ring = pdoik.Shape.mesh("ring", mesh.vertices, mesh.faces, at(*tip))
    with pytest.raises(ValueError, match="'ring' is not convex"):
        solver.attach(robot.tip_links[0], [ring])
    moved = ring.moved(at(*(tip + 1)))
    assert moved.kind == "mesh"
    assert solver.judge(robot.fk(q), q, obstacles=[moved]).clearance > 0
    scene = pdoik.Scene([grid], allowed=[(link, "crate") for link in robot.link_names])
    assert solver.judge(robot.fk(q), q, obstacles=scene).clearance == np.inf


def test_meshes_and_boxes_come_back_from_a_scene_file(tmp_path: Path) -> None:
    mesh = bin_mesh()
    shapes = [
        pdoik.Shape.mesh("bin", mesh.vertices, mesh.faces, at(0.5, 0.0, 0.0)),
        pdoik.Shape.boxes("bricks", [[0, 0, 0], [1, 0, 0]], [[1, 1, 1], [2, 1, 2]], at(3, 0, 0)),
    ]
    path = tmp_path / "scene.yaml"
    pdoik.save_scene(pdoik.Scene(shapes), path)
    for before, after in zip(shapes, pdoik.load_scene(path).shapes, strict=True):
        assert (before.name, before.kind) == (after.name, after.kind)
        np.testing.assert_array_equal(before.vertices, after.vertices)
        np.testing.assert_array_equal(before.triangles, after.triangles)
        np.testing.assert_allclose(before.T_base_shape, after.T_base_shape)
    mesh.export(tmp_path / "bin.stl")
    path.write_text("shapes: [{name: bin, mesh: {file: bin.stl}, position: [0.5, 0, 0]}]")
    (read,) = pdoik.load_scene(path).shapes
    assert read.kind == "mesh"
    assert len(read.triangles) == len(mesh.faces)


K = np.array([[300.0, 0, 160], [0, 310, 120], [0, 0, 1]])


def tilted_plane(T: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """What a camera at T sees of a plane n x = d in the base frame: depths (240, 320), n, d."""
    normal, d = np.array([0.1, -0.2, 1.0]) / np.linalg.norm([0.1, -0.2, 1.0]), 0.1
    v, u = np.mgrid[:240, :320]
    rays = np.stack([(u - 160) / 300.0, (v - 120) / 310.0, np.ones_like(u)], axis=-1)
    directions = rays @ T[:3, :3].T
    return (d - normal @ T[:3, 3]) / (directions @ normal), normal, d


def test_points_of_a_depth_image_are_where_the_camera_saw_them() -> None:
    T = at(0.4, 0.1, 1.2) @ np.diag([1.0, -1.0, -1.0, 1.0])
    depth, normal, d = tilted_plane(T)
    assert (depth > 0).all()
    cloud = pdoik.Cloud.from_depth(depth, K, T)
    assert len(cloud) == depth.size
    np.testing.assert_allclose(cloud.points[:, :3] @ normal, d, atol=1e-9)
    holes = depth.copy()
    holes[:100] = np.nan
    holes[100:110] = 0.0
    holes[110] = np.inf
    assert len(pdoik.Cloud.from_depth(holes, K, T)) == (240 - 111) * 320
    whole = np.round(1000 * depth).astype(np.uint16)
    rounded = pdoik.Cloud.from_depth(whole, [300, 310, 160, 120], T)
    np.testing.assert_allclose(rounded.points[:, :3] @ normal, d, atol=1.5e-3)
    near = pdoik.Cloud.from_depth(depth, K, T, float(np.median(depth)))
    assert depth.size * 0.45 < len(near) < depth.size * 0.55
    assert len(pdoik.Cloud.from_depth(depth, K, T, 0.1)) == 0
    thinned = pdoik.Cloud.from_depth(depth, K, T, leaf=0.02, solid=True)
    assert 0 < len(thinned) < depth.size // 5
    assert (thinned.points[:, :3] @ normal).max() < d + 1e-6  # sunk, away from the camera
    assert (thinned.points[:, :3] @ normal < d - 0.002).mean() > 0.9


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"image": np.ones((2, 2, 3))}, r"shape \(2, 2, 3\).*expected depths \(H, W\)"),
        ({"image": np.zeros((240, 320))}, "none with a depth above 0"),
        ({"image": np.full((240, 320), np.nan)}, "none with a depth above 0"),
        ({"image": np.full((240, 320), 900.0)}, "more than 900 m away: is it in other units"),
        ({"image": np.full((240, 320), 2, np.uint16)}, "less than 0.002 m away"),
        ({"K": np.eye(4)}, r"K has shape \(4, 4\)"),
        ({"K": [300, 310, 640, 120]}, "of another image size"),
        ({"K": [0, 310, 160, 120]}, "focal lengths"),
        ({"K": K.T}, "no matrix of a camera"),
        ({"T_base_camera": np.diag([2.0, 1, 1, 1])}, "no rigid transform"),
        ({"T_base_camera": np.eye(3)}, "T_base_camera has shape"),
        ({"max_range": -1.0}, "max_range is -1.0"),
        ({"scale": 0.0}, "scale is 0.0"),
    ],
)
def test_depth_images_that_make_no_sense_are_refused(change: dict[str, object], says: str) -> None:
    given: dict[str, object] = {"image": np.ones((240, 320)), "K": K, **change}
    with pytest.raises(ValueError, match=says):
        pdoik.Cloud.from_depth(**given)  # type: ignore[arg-type]


def test_images_of_points_are_taken_without_the_pixels_that_saw_nothing() -> None:
    rng = np.random.default_rng(0)
    for dtype in (np.float32, np.float64):
        image = rng.uniform([-1, -1, 2], [1, 1, 4], (20, 30, 3)).astype(dtype)
        image[::2, :, 1] = np.nan
        kept = image[1::2].reshape(-1, 3)
        cloud = pdoik.Cloud(image)
        np.testing.assert_array_equal(cloud.points[np.argsort(cloud.ids), :3], kept)
        robot = arm_of_capsules("panda")
        solver, q = pdoik.Solver(robot), robot.mid_configuration()
        assert solver.judge(robot.fk(q), q, obstacles=image).clearance == pytest.approx(
            solver.judge(robot.fk(q), q, obstacles=kept).clearance
        )
    with pytest.raises(ValueError, match="in each pixel: a camera that saw nothing"):
        pdoik.Cloud(np.full((4, 4, 3), np.nan))
    with pytest.raises(ValueError, match=r"expected \(N, 3\)"):
        pdoik.Cloud(np.zeros((4, 4, 2)))
