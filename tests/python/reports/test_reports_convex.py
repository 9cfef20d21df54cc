"""Distances of convex bodies by which reports judge contact of links themselves: coal's, too."""

from pathlib import Path

import coal
import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import pdoik
from pdoik.reports import Body, apart, piece, to_shape

CUBE = trimesh.creation.box((0.06, 0.06, 0.06))


def placed(rng: np.random.Generator, far: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    T[:3, 3] = far * rng.normal(size=3)
    return T


def polytope(rng: np.random.Generator) -> trimesh.Trimesh:
    return trimesh.convex.convex_hull(rng.normal(size=(int(rng.integers(4, 30)), 3)))


def coal_convex(mesh: trimesh.Trimesh) -> coal.Convex:
    points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for point in mesh.vertices:
        points.append(point)
    for face in mesh.faces:
        triangles.append(coal.Triangle(*map(int, face)))
    return coal.Convex(points, triangles)


def coal_distance(a: object, T_a: np.ndarray, b: object, T_b: np.ndarray) -> float:
    at = [coal.Transform3s(T[:3, :3], T[:3, 3]) for T in (T_a, T_b)]
    return float(coal.distance(a, at[0], b, at[1], coal.DistanceRequest(), coal.DistanceResult()))


@pytest.mark.parametrize("seed", range(60))
def test_polytopes_are_as_far_apart_or_as_deep_in_each_other_as_coal_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    meshes, poses = [polytope(rng) for _ in range(2)], [placed(rng, 1.5) for _ in range(2)]
    a, b = (
        piece(np.array(mesh.vertices), np.array(mesh.faces), T)
        for mesh, T in zip(meshes, poses, strict=True)
    )
    judged = coal_distance(coal_convex(meshes[0]), poses[0], coal_convex(meshes[1]), poses[1])
    found = apart(a, b)
    if judged > 0.0:
        assert found == pytest.approx(judged, abs=1e-9)
        assert apart(a, b, 0.5 * judged) >= 0.5 * judged
    else:  # in one direction at least, not deeper than in the best
        assert found <= judged + 1e-6


@pytest.mark.parametrize("seed", range(30))
def test_a_body_is_as_far_from_shapes_as_coal_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mesh, T_body, T = polytope(rng), placed(rng, 2.0), placed(rng, 2.0)
    body = piece(np.array(mesh.vertices), np.array(mesh.faces), T_body)
    shapes = [
        (pdoik.Shape.sphere("it", T[:3, 3], 0.4), coal.Sphere(0.4)),
        (pdoik.Shape.box("it", [0.3, 0.5, 0.7], T), coal.Box(0.3, 0.5, 0.7)),
        (pdoik.Shape.cylinder("it", 0.3, 0.8, T), coal.Cylinder(0.3, 0.8)),
        (pdoik.Shape.capsule("it", 0.3, 0.8, T), coal.Capsule(0.3, 0.8)),
    ]
    for shape, other in shapes:
        judged = coal_distance(coal_convex(mesh), T_body, other, shape.T_base_shape)
        found = to_shape(body, shape)
        if judged > 1e-6:
            assert found == pytest.approx(judged, abs=1e-5), shape.kind
        else:
            assert found <= 1e-5, shape.kind
    triangles = pdoik.Shape.mesh("it", np.array(CUBE.vertices) * 10, np.array(CUBE.faces), T)
    judged = coal_distance(coal_convex(mesh), T_body, coal.Box(0.6, 0.6, 0.6), T)
    found = to_shape(body, triangles)
    assert (found == pytest.approx(judged, abs=1e-9)) if judged > 0.0 else (found <= 1e-9)
    plane = pdoik.Shape.half_space("it", [0, 0, 1.0], [0, 0, 0.2])
    lowest = float((np.array(mesh.vertices) @ T_body[2, :3] + T_body[2, 3]).min())
    assert to_shape(body, plane) == pytest.approx(lowest - 0.2, abs=1e-12)


def test_balls_that_meet_in_one_point_are_as_deep_as_both() -> None:
    ball = Body(np.zeros((1, 3)), 0.2)
    assert apart(ball, Body(np.zeros((1, 3)), 0.3)) == -0.5


@pytest.mark.parametrize("name", ["panda", "ur10"])
def test_contact_within_capsules_is_judged_by_the_links_themselves(
    name: str, tmp_path: Path
) -> None:
    robot, rng = pdoik.Robot.builtin(name), np.random.default_rng(3)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0, report_clearance=0.05))
    file, within = tmp_path / "case.json", 0
    for _ in range(30):
        q = rng.uniform(np.maximum(robot.lower, -2.0), np.minimum(robot.upper, 2.0))
        link, a, b, radius, _ = robot.occupancy.capsules[
            int(rng.integers(len(robot.occupancy.capsules)))
        ]
        aside = rng.normal(size=3)
        aside *= (radius + 0.028) / np.linalg.norm(aside)  # a ball's middle, 2 mm too near
        T = np.eye(4)
        T[:3, 3] = (robot.fk(q, link) @ [*(np.add(a, b) / 2), 1.0])[:3] + aside
        corners = np.array(CUBE.vertices)
        shapes = [
            pdoik.Shape.sphere("ball", T[:3, 3], 0.03),
            pdoik.Shape.mesh("cube", 0.9 * corners, np.array(CUBE.faces), T),
        ]
        result = solver.solve(robot.fk(q), q0=q, obstacles=shapes)
        pdoik.write_report(file, solver, robot.fk(q), q0=q, obstacles=shapes)
        replay = pdoik.replay_report(file)
        assert replay.faults == []
        assert not replay.unjudged
        by_capsules = pdoik.Solver(robot, pdoik.Options(exact_contact=False)).judge(
            robot.fk(q), result.q, obstacles=shapes
        )
        within += result.success and not by_capsules.success
    assert within > 0  # else it was not put to the test
