"""A robot without hulls is refused among obstacles, since nothing would keep it off them."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pdoik

POINTS = np.array([[0.4, 0.0, 0.5], [0.4, 0.1, 0.5]])
BALL = pdoik.Shape.sphere("ball", (0.4, 0.0, 0.5), 0.1)
REFUSED = r"'panda' has no hulls .*pdoik occupancy.*hulls=True.*ignore_obstacles_without_hulls"
SOMETHING = {
    "points": (POINTS, "2 points, 0 shapes"),
    "cloud": (pdoik.Cloud(POINTS), "2 points, 0 shapes"),
    "shapes": ([BALL], "0 points, 1 shapes"),
    "scene": (pdoik.Scene([BALL], cloud=POINTS), "2 points, 1 shapes"),
}
NOTHING: dict[str, Any] = {
    "None": None,
    "no points": np.empty((0, 3)),
    "no shapes": [],
    "empty cloud": pdoik.Cloud(np.empty((0, 3))),
    "empty scene": pdoik.Scene(),
}


@pytest.fixture
def bare() -> pdoik.Robot:
    robot = pdoik.Robot.builtin("panda")
    robot.occupancy = pdoik.Occupancy()
    return robot


Asks = Callable[[pdoik.Solver, Any], Any]
CALLS: dict[str, Asks] = {
    "solve": lambda solver, scene: solver.solve(_T(solver), obstacles=scene),
    "solve_batch": lambda solver, scene: solver.solve_batch(
        np.stack([_T(solver)] * 3), obstacles=scene
    ),
    "judge": lambda solver, scene: solver.judge(
        _T(solver), solver.robot.mid_configuration(), obstacles=scene
    ),
    "clearances": lambda solver, scene: solver.clearances(
        solver.robot.mid_configuration(), obstacles=scene
    ),
    "reachability": lambda solver, scene: pdoik.reachability(
        solver.robot,
        scene,
        pdoik.Grid.box([0.3, -0.2, 0.2], [0.5, 0.2, 0.6], 0.2, orientations=2),
        options=solver.options,
    ),
}


def _T(solver: pdoik.Solver) -> Any:
    return solver.robot.fk(solver.robot.mid_configuration())


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("obstacles", SOMETHING)
def test_what_takes_obstacles_refuses_them(bare: pdoik.Robot, call: str, obstacles: str) -> None:
    scene, counted = SOMETHING[obstacles]
    with pytest.raises(ValueError, match=REFUSED) as refused:
        CALLS[call](pdoik.Solver(bare), scene)
    assert counted in str(refused.value)


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("obstacles", NOTHING)
def test_no_obstacles_are_fine(bare: pdoik.Robot, call: str, obstacles: str) -> None:
    CALLS[call](pdoik.Solver(bare), NOTHING[obstacles])


@pytest.mark.parametrize("call", CALLS)
def test_they_are_ignored_by_who_says_so(bare: pdoik.Robot, call: str) -> None:
    options = pdoik.Options(ignore_obstacles_without_hulls=True)
    CALLS[call](pdoik.Solver(bare, options), SOMETHING["scene"][0])


def test_hulls_on_one_link_are_enough(bare: pdoik.Robot) -> None:
    bare.occupancy = pdoik.Occupancy(spheres=[("panda_link4", (0, 0, 0), 0.05)])
    solver = pdoik.Solver(bare)
    assert solver.solve(_T(solver), obstacles=[[2.0, 0.0, 0.0]]).success


def test_a_cloud_that_is_filled_later_is_seen(bare: pdoik.Robot) -> None:
    cloud, solver = pdoik.Cloud(np.empty((0, 3))), pdoik.Solver(bare)
    assert solver.solve(_T(solver), obstacles=cloud).success
    cloud.update(POINTS, [[0, -1, 0], [1, 1, 1]])
    with pytest.raises(ValueError, match=REFUSED):
        solver.solve(_T(solver), obstacles=cloud)


def test_what_it_carries_is_refused_as_well(bare: pdoik.Robot) -> None:
    solver = pdoik.Solver(bare)
    solver.attach("panda_link7", [pdoik.Shape.sphere("cup", (0, 0, 0.2), 0.05)])
    with pytest.raises(ValueError, match=REFUSED):
        solver.solve(_T(solver))
    solver.detach()
    assert solver.solve(_T(solver)).success


def test_a_tracker_holds_its_answer_and_says_why(bare: pdoik.Robot) -> None:
    tracker = pdoik.Tracker(pdoik.Solver(bare))
    q = bare.mid_configuration()
    tracker.reset(q)
    T = bare.fk(q + 1e-3)
    for scene, _ in SOMETHING.values():
        step = tracker.step(T, obstacles=scene)
        assert (step.tracking, step.success) == ("invalid_input", False)
        assert "'panda' has no hulls" in step.complaint
        np.testing.assert_array_equal(step.q, q)
    step = tracker.step(T, obstacles=None)
    assert (step.tracking, step.complaint) == ("tracking", "")
    told = pdoik.Solver(bare, pdoik.Options(ignore_obstacles_without_hulls=True))
    ignoring = pdoik.Tracker(told)
    ignoring.reset(q)
    assert ignoring.step(T, obstacles=POINTS).tracking == "tracking"


def test_the_objective_refuses_them(bare: pdoik.Robot) -> None:
    lagrangian = pdoik.Lagrangian(bare)
    with pytest.raises(ValueError, match=REFUSED):
        lagrangian.set_obstacles(POINTS)


def test_the_window_shows_a_robot_without_hulls_among_obstacles(bare: pdoik.Robot) -> None:
    """It says beside the robot that the solver cannot see them."""
    pytest.importorskip("viser")
    from pdoik.view import Session

    session = Session(bare, pdoik.Options(max_time=0.5))
    session.set_cloud(POINTS)
    assert session.solve_once() is not None


def test_a_report_that_is_older_than_the_option_is_replayed_as_it_was(
    bare: pdoik.Robot, tmp_path: Path
) -> None:
    solver = pdoik.Solver(bare, pdoik.Options(ignore_obstacles_without_hulls=True))
    case = tmp_path / "case.json"
    pdoik.write_report(case, solver, _T(solver), obstacles=POINTS)
    text = json.loads(case.read_text())
    del text["options"]["ignore_obstacles_without_hulls"]
    case.write_text(json.dumps(text))
    replay = pdoik.replay_report(case)
    assert replay.same, replay.differences
    assert replay.faults == []
