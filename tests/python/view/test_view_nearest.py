"""The line on the page to the nearest obstacle: of each kind of shape."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import pytest

import pdoik
from pdoik._hulls import gaps, placed_hulls
from pdoik.solids import shape_surface
from pdoik.view import Session
from solid_kinds import KINDS, shape

pytest.importorskip("viser", reason="pip install 'pdoik[view]'")

from pdoik.view.drawing.nearest_scene import NearestScene
from pdoik.view.model import builtin_model
from pdoik.view.server import start_server
from pdoik.view.viewer import Viewer

PATIENCE = 120.0  # [s], on a busy machine
CELL = 0.02  # of the distance field [m]


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    """A Panda, on a page that nobody looks at."""
    model = builtin_model("panda")
    server = start_server("127.0.0.1", 0)
    viewer = Viewer(server, model, Session(model.robot, pdoik.Options(max_time=5.0)))
    yield viewer
    viewer.close()
    server.stop()


def wait(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def posed(
    viewer: Viewer, q: np.ndarray, *obstacles: pdoik.Shape, rules: Sequence[pdoik.ContactRule] = ()
) -> None:
    """The robot there, beside these alone, as the page has it."""
    before = viewer.nearest_scene._shown
    viewer.session.set_shapes(obstacles, rules)
    viewer.session.set_posture(q)
    viewer.worker.wake()

    def is_drawn() -> bool:
        shown = viewer.nearest_scene._shown
        if shown is None or shown is before or shown.origin == "target":
            return False
        return np.array_equal(shown.q, q) and shown.cloud.shapes == obstacles

    wait(is_drawn)
    with viewer._drawing:  # words come last
        pass


def drawn_ends(scene: NearestScene) -> np.ndarray:
    """Of the line as the page draws it, (2, 3) [m]."""
    line: Any = scene._line
    ends = np.array([ball.position for ball in scene._ends])
    np.testing.assert_allclose(line.points[0], ends, atol=1e-6)
    return ends


@pytest.mark.parametrize("kind", KINDS)
def test_the_line_leads_from_the_robot_to_a_shape_of_each_kind_and_tells_its_length(
    viewer: Viewer, kind: str, rng: np.random.Generator
) -> None:
    robot, scene = viewer.session.robot, viewer.nearest_scene
    apart = 0
    for _ in range(6):
        q, obstacle = rng.uniform(robot.lower, robot.upper), shape(kind, rng)
        posed(viewer, q, obstacle)
        distance = pdoik.Solver(robot).clearances(q, [obstacle])[0].distance
        hull, place = drawn_ends(scene)
        millimetres = f"{1e3 * distance:.1f} mm"
        assert scene._label.text == millimetres
        assert f"it, {millimetres} from panda_link" in viewer.status.text
        np.testing.assert_allclose(scene._label.position, (hull + place) / 2, atol=1e-9)
        assert scene._color == ((211, 21, 27) if distance < -1e-6 else (43, 47, 54))
        if distance <= 0:
            continue
        apart += 1
        assert shape_surface(obstacle)(place)[0] == pytest.approx(0, abs=1e-5)
        length = np.linalg.norm(place - hull)
        if kind == "distance_field":  # which knows little of what is beside its cells
            assert length > distance - CELL
        else:
            assert length == pytest.approx(distance, abs=1e-6)
            assert gaps(placed_hulls(robot, q), hull[None])[0] == pytest.approx(0, abs=1e-6)
    assert apart > 1


def test_of_two_obstacles_the_one_that_a_rule_keeps_farther_off_is_shown(viewer: Viewer) -> None:
    robot, scene = viewer.session.robot, viewer.nearest_scene
    q = robot.mid_configuration()
    near = pdoik.Shape.sphere("near", (0.3, 0.6, 0.5), 0.1)
    far = pdoik.Shape.sphere("far", (0.3, -0.8, 0.5), 0.1)
    to_near, to_far = (each.distance for each in pdoik.Solver(robot).clearances(q, [near, far]))
    assert 0.05 < to_near < to_far
    posed(viewer, q, near, far)
    assert scene._color == (43, 47, 54)
    assert scene._label.text == f"{1e3 * to_near:.1f} mm"
    posed(viewer, q, near, far, rules=[pdoik.ContactRule("*", "far", clearance=to_far + 0.02)])
    assert scene._color == (211, 21, 27)
    assert scene._label.text == f"{1e3 * to_far:.1f} mm"
    assert "far, " in viewer.status.text


def test_the_line_goes_with_its_obstacle_and_with_its_switch(viewer: Viewer) -> None:
    robot, scene = viewer.session.robot, viewer.nearest_scene
    q = robot.mid_configuration()
    posed(viewer, q, pdoik.Shape.sphere("it", (0.8, 0.0, 0.3), 0.1))
    before = drawn_ends(scene)
    posed(viewer, q, pdoik.Shape.sphere("it", (0.8, 0.3, 0.3), 0.1))
    after = drawn_ends(scene)
    assert np.linalg.norm(after[1] - before[1]) > 0.1

    scene.show_line(False)
    assert scene._color is None
    scene.show_line(True)
    np.testing.assert_array_equal(drawn_ends(scene), after)
    viewer.drop_shapes()
    wait(lambda: scene._color is None)
