"""The line that pdoik view draws to the nearest obstacle, against the solver's distances."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

import pdoik
from pdoik._hulls import gaps, placed_hulls
from pdoik.view import Session
from pdoik.view.nearest import limit_text, nearest_limit, nearest_obstacle
from pdoik.view.status import Meter, status_html
from pdoik.view.surfaces import shape_surface

CORNERS = [(x, y, z) for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (0.0, 0.2)]
KINDS = (
    "sphere", "box", "cylinder", "capsule", "half_space", "convex_mesh", "mesh", "boxes",
    "distance_field",
)  # fmt: skip


def shape(kind: str, rng: np.random.Generator) -> pdoik.Shape:
    """One of the kind somewhere around the robot, turned."""
    T = np.eye(4)
    T[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    T[:3, :3] *= np.linalg.det(T[:3, :3])
    T[:3, 3] = rng.uniform([-0.7, -0.7, 0.0], [0.7, 0.7, 1.0])
    match kind:
        case "sphere":
            return pdoik.Shape.sphere("it", T[:3, 3], 0.1)
        case "box":
            return pdoik.Shape.box("it", (0.3, 0.2, 0.1), T)
        case "cylinder":
            return pdoik.Shape.cylinder("it", 0.1, 0.3, T)
        case "capsule":
            return pdoik.Shape.capsule("it", 0.1, 0.3, T)
        case "half_space":
            return pdoik.Shape.half_space("it", T[:3, 2], T[:3, 3])
        case "mesh":
            ring = trimesh.creation.torus(0.2, 0.04, major_sections=12, minor_sections=6)
            return pdoik.Shape.mesh("it", ring.vertices, ring.faces, T)
        case "boxes":
            low = np.array([[-0.2, -0.2, 0.0], [0.1, 0.0, 0.1]])
            return pdoik.Shape.boxes("it", low, low + np.array([0.05, 0.1, 0.2]), T)
        case "distance_field":
            places = 0.02 * (np.indices((20, 20, 20)).transpose(1, 2, 3, 0) - 9.5)
            ball = np.linalg.norm(places, axis=-1) - 0.1
            return pdoik.Shape.distance_field("it", ball, 0.02, T)
        case _:
            return pdoik.Shape.convex_mesh("it", CORNERS, T)


@pytest.mark.parametrize("kind", KINDS)
def test_the_line_is_as_long_as_the_solver_says_and_ends_on_both_surfaces(
    kind: str, rng: np.random.Generator
) -> None:
    robot = pdoik.Robot.builtin("panda")
    solver = pdoik.Solver(robot)
    signs = []
    for _ in range(40):
        q, obstacle = rng.uniform(robot.lower, robot.upper), shape(kind, rng)
        found = nearest_obstacle(
            solver.clearances(q, [obstacle]), robot, q, np.empty((0, 4)), [obstacle]
        )
        assert found is not None
        assert found.line is not None
        hull, place = found.line
        if found.distance > 0 or kind not in ("mesh", "boxes"):
            assert np.linalg.norm(place - hull) == pytest.approx(abs(found.distance), abs=1e-6)
        if found.distance > 0:  # what is deep may come out behind
            assert shape_surface(obstacle)(hull)[0] == pytest.approx(found.distance, abs=1e-6)
            assert gaps(placed_hulls(robot, q), hull[None])[0] == pytest.approx(0, abs=1e-6)
        signs.append(np.sign(found.distance))
    assert 1 in signs


def test_of_spheroids_no_shorter_way_is_found_by_sampling(rng: np.random.Generator) -> None:
    robot = pdoik.Robot.builtin("panda")
    robot.occupancy = pdoik.Occupancy(
        spheroids=[("panda_link4", (0.0, 0.0, 0.0), "panda_link5", (0.0, 0.0, 0.0), 0.25)]
    )
    q = robot.mid_configuration()
    box = pdoik.Shape.box("box", (0.2, 0.2, 0.2), _at(0.6, 0.5, 0.2))
    found = nearest_obstacle(
        pdoik.Solver(robot).clearances(q, [box]), robot, q, np.empty((0, 4)), [box]
    )
    assert found is not None
    assert found.line is not None
    (hull,) = placed_hulls(robot, q)
    assert hull.gap(found.line[:1])[0] == pytest.approx(0, abs=1e-6)
    length = np.linalg.norm(found.line[1] - found.line[0])
    ways = rng.normal(size=(20_000, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    near = found.line[0] + 0.02 * ways * rng.uniform(size=(20_000, 1))
    inside = near[hull.gap(near) <= 0]
    assert len(inside) > 1000
    assert min(shape_surface(box)(point)[0] for point in inside[:4000]) >= length - 1e-6


def test_points_and_the_ball_are_named_and_nothing_is_where_there_is_nothing() -> None:
    session = Session(pdoik.Robot.builtin("panda"), pdoik.Options(max_time=5.0))
    shown = session.solve_once()
    assert shown is not None
    assert shown.nearest is None
    session.set_thinning(0.0, False)
    session.set_cloud([[0.9, 0.0, 0.5]])
    session.set_ball([3.0, 0.0, 0.5], 0.1)
    for radius, name in ((0.1, "points"), (2.4, "the ball")):
        session.set_ball([3.3, 0.0, 0.5], radius)
        shown = session.solve_once()
        assert shown is not None
        assert shown.nearest is not None
        assert shown.nearest.obstacle == name
        assert shown.nearest.line is not None
        length = np.linalg.norm(np.diff(shown.nearest.line, axis=0))
        assert length == pytest.approx(shown.result.clearance, abs=1e-9)
        assert f"{name}, from panda_link" in status_html(shown, Meter())


def test_the_joint_with_the_least_share_of_its_range_left_is_named() -> None:
    robot = pdoik.Robot.builtin("panda")
    q = robot.mid_configuration()
    q[5] = robot.upper[5] - np.radians(2.0)
    limit = nearest_limit(robot, q)
    assert limit is not None
    assert (limit.joint, limit.side) == (5, "upper")
    assert 100 * limit.share == pytest.approx(0.9, abs=0.1)
    assert limit_text(limit, robot) == "panda_joint6, 2.0° from its upper end, 1 % of the range"


def test_joints_without_limits_are_near_none() -> None:
    urdf = """<robot name="arm"><link name="base"/><link name="a"/><link name="b"/>
      <joint name="turn" type="continuous"><parent link="base"/><child link="a"/>
        <axis xyz="0 0 1"/></joint>
      {}</robot>"""
    slide = """<joint name="slide" type="prismatic"><parent link="a"/><child link="b"/>
      <axis xyz="1 0 0"/><limit lower="0" upper="0.5" effort="1" velocity="1"/></joint>"""
    fixed = """<joint name="slide" type="fixed"><parent link="a"/><child link="b"/></joint>"""
    assert nearest_limit(pdoik.Robot.from_urdf(urdf.format(fixed)), np.array([1.0])) is None
    robot = pdoik.Robot.from_urdf(urdf.format(slide))
    limit = nearest_limit(robot, np.array([9.0, 0.05]))
    assert limit is not None
    assert limit_text(limit, robot) == "slide, 50.0 mm from its lower end, 10 % of the range"


def _at(*xyz: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = xyz
    return T
