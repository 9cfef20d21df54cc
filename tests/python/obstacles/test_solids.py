"""Where solids are nearest to each other, against the solver's distances; what constraints name."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

import pdoik
from pdoik._hulls import gaps, placed_hulls
from pdoik.solids import (
    binding,
    link_pieces,
    named_part,
    nearest_obstacle,
    nearest_points,
    shape_surface,
    without_numbers,
)
from pdoik.view import Session
from pdoik.view.status import Meter, status_html
from solid_kinds import KINDS, shape

# A field's value between cells is no distance to its surface where that is bent.
EXACT = [kind for kind in KINDS if kind != "distance_field"]


def off_the_robot(robot: pdoik.Robot, q: np.ndarray, place: np.ndarray) -> float:
    """How far a place is from the nearest surface of a hull or of a link's piece."""
    least = abs(gaps(placed_hulls(robot, q), place[None])[0])
    if least < 1e-6:
        return float(least)
    links = {link for link, *_ in robot.occupancy.pieces}
    pieces = [piece for link in links for piece in link_pieces(robot, q, link)]
    return float(min(least, *(abs(shape_surface(piece)(place)[0]) for piece in pieces)))


@pytest.mark.parametrize("kind", EXACT)
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
        if found.distance > 0:  # what is deep may come out behind
            assert np.linalg.norm(place - hull) == pytest.approx(found.distance, abs=1e-6)
            assert shape_surface(obstacle)(hull)[0] == pytest.approx(found.distance, abs=1e-6)
            assert off_the_robot(robot, q, hull) == pytest.approx(0, abs=1e-6)
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


@pytest.mark.parametrize("kind", EXACT)
def test_of_a_spheroid_that_overlaps_a_shape_the_line_ends_on_both_surfaces(
    kind: str, rng: np.random.Generator
) -> None:
    robot = pdoik.Robot.builtin("panda")
    robot.occupancy = pdoik.Occupancy(
        spheroids=[("panda_link4", (0.0, 0.0, 0.0), "panda_link5", (0.0, 0.0, 0.0), 0.25)]
    )
    overlaps = 0
    for _ in range(120):
        q, obstacle = rng.uniform(robot.lower, robot.upper), shape(kind, rng)
        (hull,) = placed_hulls(robot, q)
        end, place = nearest_points(hull, obstacle)
        assert hull.gap(end[None])[0] == pytest.approx(0, abs=1e-6)
        assert shape_surface(obstacle)(place)[0] == pytest.approx(0, abs=1e-6)
        overlaps += int(hull.gap(place[None])[0] < 0)
        flipped = nearest_points(obstacle, hull)
        np.testing.assert_allclose(flipped, [place, end], atol=1e-5)
    assert overlaps > 2


def test_where_a_capsule_touches_and_its_link_does_not_the_line_is_from_the_links_piece() -> None:
    robot = pdoik.Robot.builtin("panda")
    cube = trimesh.creation.box(extents=(0.04, 0.04, 0.04))
    places = [cube.vertices, cube.vertices + np.array([0.0, 0.06, 0.0])]
    robot.occupancy = pdoik.Occupancy(
        capsules=[("panda_link8", (0, 0, -0.1), (0, 0, 0.1), 0.1)],
        pieces=[("panda_link8", vertices, cube.faces, 0.0) for vertices in places],
    )
    solver, q = pdoik.Solver(robot), robot.mid_configuration()
    for x, length in ((0.3, 0.15), (0.12, 0.05), (0.08, 0.01)):  # the first one off the capsule
        ball = pdoik.Shape.sphere("ball", (robot.fk(q) @ _at(x, 0.0, 0.0))[:3, 3], 0.05)
        point = np.array([[*ball.T_base_shape[:3, 3], 0.05]])
        for found in (
            nearest_obstacle(solver.clearances(q, [ball]), robot, q, np.empty((0, 4)), [ball]),
            nearest_obstacle(solver.clearances(q, point), robot, q, point, []),
        ):
            assert found is not None
            assert found.line is not None
            assert found.distance == pytest.approx(length, abs=1e-9)
            assert np.linalg.norm(found.line[1] - found.line[0]) == pytest.approx(length, abs=1e-6)
            at_ball = np.linalg.norm(found.line[1] - point[0, :3])
            assert at_ball == pytest.approx(0.05, abs=1e-6)


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
        assert f"{name}, {1e3 * length:.1f} mm from panda_link" in status_html(shown, Meter())


def test_the_line_to_a_distance_field_ends_where_its_surface_is_nearest(
    rng: np.random.Generator,
) -> None:
    robot = pdoik.Robot.builtin("panda")
    solver = pdoik.Solver(robot)
    apart = 0
    for _ in range(16):
        q, ball = rng.uniform(robot.lower, robot.upper), shape("distance_field", rng)
        found = nearest_obstacle(solver.clearances(q, [ball]), robot, q, np.empty((0, 4)), [ball])
        assert found is not None
        assert found.line is not None
        part = named_part(found.part, robot, q)
        assert part is not None
        hull, place = found.line
        assert shape_surface(ball)(place)[0] == pytest.approx(0, abs=1e-5)
        if found.distance > 0:
            assert off_the_robot(robot, q, hull) == pytest.approx(0, abs=3e-3)
            middle = ball.T_base_shape[:3, :3] @ np.full(3, 0.2) + ball.T_base_shape[:3, 3]
            length, exact = np.linalg.norm(hull - place), np.linalg.norm(hull - middle) - 0.1
            assert length == pytest.approx(exact, abs=0.02)  # a cell
            apart += 1
    assert apart > 8


@pytest.mark.parametrize("kind", EXACT)
def test_the_line_from_what_is_held_is_as_long_as_the_solver_says(
    kind: str, rng: np.random.Generator
) -> None:
    robot = pdoik.Robot.builtin("panda")
    robot.occupancy = pdoik.Occupancy(spheres=[("panda_link2", (0.0, 0.0, 0.0), 1e-3)])
    held = {
        "brick": pdoik.Shape.box("brick", (0.05, 0.1, 0.2), _at(0.0, 0.0, 0.15)),
        "can": pdoik.Shape.cylinder("can", 0.05, 0.2, _at(0.0, 0.0, 0.15)),
        "pill": pdoik.Shape.capsule("pill", 0.05, 0.2, _at(0.0, 0.0, 0.15)),
    }
    apart = 0
    for name, solid in held.items():
        solver = pdoik.Solver(robot)
        solver.attach("panda_link8", [solid])
        for _ in range(25):
            q, obstacle = rng.uniform(robot.lower, robot.upper), shape(kind, rng)
            found = nearest_obstacle(
                solver.clearances(q, [obstacle]),
                robot,
                q,
                np.empty((0, 4)),
                [obstacle],
                carried=solver.carried,
            )
            assert found is not None
            if found.part != name or found.distance <= 0:
                continue
            assert found.line is not None
            length = np.linalg.norm(found.line[1] - found.line[0])
            assert length >= found.distance - 1e-6
            if kind not in ("mesh", "boxes"):  # projections may end at another place of those
                assert length == pytest.approx(found.distance, abs=1e-4)
            apart += 1
    assert apart > 5


def test_of_two_spheroids_and_capsules_no_nearer_points_are_found_by_sampling(
    rng: np.random.Generator,
) -> None:
    robot = pdoik.Robot.builtin("panda")
    robot.occupancy = pdoik.Occupancy(
        spheroids=[("panda_link0", (0.0, 0.0, 0.0), "panda_link0", (0.1, 0.0, 0.0), 0.1)],
        capsules=[("panda_link8", (0.0, 0.0, 0.0), (0.0, 0.1, 0.1), 0.04)],
    )
    hulls = placed_hulls(robot, robot.mid_configuration())
    line = nearest_points(*hulls)
    assert line is not None
    length = np.linalg.norm(line[1] - line[0])
    for hull, end in zip(hulls, line, strict=True):
        assert hull.gap(end[None])[0] == pytest.approx(0, abs=1e-6)
        near = end + rng.normal(scale=0.02, size=(20_000, 3))
        inside = near[hull.gap(near) <= 0]
        other = line[1] if hull is hulls[0] else line[0]
        assert len(inside) > 500
        assert np.linalg.norm(inside - other, axis=1).min() >= length - 1e-6
    np.testing.assert_allclose(nearest_points(*hulls[::-1]), line[::-1], atol=1e-5)


def test_what_the_worst_constraint_names_is_found_whatever_things_are_called() -> None:
    robot = pdoik.Robot.builtin("panda")
    solver = pdoik.Solver(robot, pdoik.Options(self_collision=True))
    solver.attach("panda_link8", [pdoik.Shape.box("cup to go", (0.05, 0.05, 0.3), _at(0, 0, 0.2))])
    q = np.array([0.0, 0.3, 0.0, -1.8, 0.0, 2.1, 0.8])
    tip = robot.fk(q)
    wall = pdoik.Shape.box("way to the door", (0.2, 0.2, 0.2), tip @ _at(0, 0, 0.3))
    result = solver.judge(tip, q, [wall])
    found = binding(result, robot, [wall.name], ["cup to go"])
    assert (found.held, found.shape, found.hulls) == (("cup to go",), "way to the door", ())

    result = solver.judge(tip, q, np.array([[*(tip @ _at(0, 0, 0.3))[:3, 3]]]))
    found = binding(result, robot, [], ["cup to go"])
    assert (found.held, found.obstacle) == (("cup to go",), 0)

    folded = robot.mid_configuration()
    folded[3], folded[5] = -3.0, 0.0
    result = solver.judge(robot.fk(folded), folded)
    found = binding(result, robot, [], ["cup to go"])
    assert len(found.held) + len(found.hulls) == 2
    for number in found.hulls:
        assert placed_hulls(robot, folded)[number].name in result.worst_constraint
    assert "capsule" not in without_numbers(result.worst_constraint)

    robot.occupancy = pdoik.Occupancy()
    result = pdoik.Solver(robot).judge(robot.fk(q) @ _at(0, 0, 0.1), q)
    assert result.worst_constraint == "position"
    assert binding(result, robot) == ((), (), None, None)
    assert named_part("panda_link3 (capsule 4)", robot, q) is None


def _at(*xyz: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = xyz
    return T
