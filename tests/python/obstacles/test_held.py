"""What a robot carries, from Python, judged by coal."""

import numpy as np
import pytest

import pdoik
from test_shapes import (
    arm_of_capsules,
    capsules_of,
    coal_distance,
    coal_geometry,
    random_pose,
    random_shapes,
)

IN_HAND = np.eye(4)
IN_HAND[2, 3] = 0.15
NAMES = ("panda", "ur10", "iiwa14")


def held_by(rng: np.random.Generator) -> pdoik.Shape:
    unheld = ("half_space", "mesh", "boxes")
    shapes = [each for each in random_shapes(rng) if each.kind not in unheld]
    like = shapes[rng.integers(len(shapes))]
    T = random_pose(rng, 0.1)
    T[2, 3] += 0.25
    if like.kind == "sphere":
        return pdoik.Shape.sphere("held", T[:3, 3], 0.2 * like.size[0])
    if like.kind == "convex_mesh":
        return pdoik.Shape.convex_mesh("held", 0.3 * np.asarray(like.vertices), T)
    make = getattr(pdoik.Shape, like.kind)
    size = 0.3 * np.asarray(like.size)
    return make("held", size, T) if like.kind == "box" else make("held", *size, T)


@pytest.mark.parametrize("name", NAMES)
def test_clearances_of_what_is_held_are_coals(name: str) -> None:
    robot = arm_of_capsules(name)
    hand = robot.link_names[-1]
    rng = np.random.default_rng(11)
    solver = pdoik.Solver(robot)
    nearest = 0
    for _ in range(40):
        held, shapes, q = (
            held_by(rng),
            random_shapes(rng),
            robot.lower + rng.random(robot.dof) * (robot.upper - robot.lower),
        )
        solver.attach(hand, [held])
        T_held = robot.fk(q, hand) @ held.T_base_shape
        for found, shape in zip(solver.clearances(q, shapes), shapes, strict=True):
            assert found.obstacle == shape.name
            parts = [(coal_geometry(held), T_held), *capsules_of(robot, q)]
            expected = min(
                coal_distance(part, T, coal_geometry(shape), shape.T_base_shape)
                for part, T in parts
            )
            if expected > 0:  # deeper than touching others measure otherwise
                assert found.distance == pytest.approx(expected, abs=2e-6)
            else:
                assert found.distance <= 1e-6
            nearest += found.part == "held"
        judged = solver.judge(robot.fk(q), q, shapes)
        least = min(each.distance for each in solver.clearances(q, shapes))
        if least > 0:
            assert judged.clearance == pytest.approx(least, abs=1e-9)
        else:  # deep in a surface another part of it may be told
            assert judged.clearance < 1e-6
        solver.detach()
    assert nearest > 5


def test_solves_keep_what_is_held_off_and_batches_know_of_it() -> None:
    robot = arm_of_capsules("panda")
    hand = robot.link_names[-1]
    stick = pdoik.Shape.box("stick", (0.03, 0.03, 0.2), IN_HAND)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=np.inf, max_restarts=50))
    rng = np.random.default_rng(5)
    solved = 0
    for _ in range(20):
        q = robot.lower + rng.uniform(0.2, 0.8, robot.dof) * (robot.upper - robot.lower)
        T = robot.fk(q)
        beside = robot.fk(q, hand) @ IN_HAND @ (0.06, 0.0, 0.0, 1.0)
        ball = pdoik.Shape.sphere("ball", beside[:3], 0.03)
        in_it = pdoik.Shape.sphere("ball", (robot.fk(q, hand) @ IN_HAND)[:3, 3], 0.03)
        assert solver.solve(T, q, [in_it]).status != "blocked"
        before = solver.solve_batch([T, T], q, [in_it])
        solver.attach(hand, [stick])
        blocked = solver.solve(T, q, [in_it])
        assert (blocked.status, blocked.worst_constraint) == (
            "blocked",
            "clearance of stick to ball",
        )
        assert [r.status for r in solver.solve_batch([T, T], q, [in_it])] == ["blocked"] * 2
        result = solver.solve(T, q, [ball])
        if result.success:
            solved += 1
            T_stick = robot.fk(result.q, hand) @ IN_HAND
            assert (
                coal_distance(coal_geometry(stick), T_stick, coal_geometry(ball), ball.T_base_shape)
                > -1e-6
            )
        solver.detach(hand)
        after = solver.solve_batch([T, T], q, [in_it])
        assert [r.status for r in after] == [r.status for r in before]
    assert solved > 10


def test_a_tracker_with_a_stick_stops_before_what_is_ahead() -> None:
    robot = arm_of_capsules("panda")
    hand = robot.link_names[-1]
    stick = pdoik.Shape.box("stick", (0.03, 0.03, 0.2), IN_HAND)
    q = robot.mid_configuration()
    T = robot.fk(q)
    ahead = robot.fk(q, hand) @ (0.0, 0.0, 0.3, 1.0)
    ball = pdoik.Shape.sphere("ball", ahead[:3], 0.03)
    for carries in (True, False):
        tracker = pdoik.Tracker(pdoik.Solver(robot), max_time=1e9)
        tracker.reset(q)
        if carries:
            tracker.attach(hand, [stick])
        goal, least = T.copy(), np.inf
        for _ in range(40):
            goal[:3, 3] += 0.001 * T[:3, 2]
            step = tracker.step(goal, [ball])
            least = min(least, step.clearance)
        assert step.tracking == ("infeasible" if carries else "tracking")
        assert least > -1e-5


def test_what_makes_no_sense_is_refused() -> None:
    robot = arm_of_capsules("panda")
    hand = robot.link_names[-1]
    solver = pdoik.Solver(robot)
    cube = pdoik.Shape.box("cube", (0.05, 0.05, 0.05), IN_HAND)
    solver.attach(hand, [cube])
    with pytest.raises(ValueError, match="'cube' is attached to"):
        solver.attach(hand, [cube])
    with pytest.raises(ValueError, match="no joint moves 'panda_link0'"):
        solver.attach("panda_link0", [pdoik.Shape.sphere("ball", (0, 0, 0), 0.1)])
    with pytest.raises(ValueError, match="half-space"):
        solver.attach(hand, [pdoik.Shape.half_space("floor", (0, 0, 1), (0, 0, 0))])
    with pytest.raises(ValueError, match="nobody"):
        solver.attach("nobody", [pdoik.Shape.sphere("ball", (0, 0, 0), 0.1)])
    with pytest.raises(ValueError, match="nobody"):
        solver.detach("nobody")
    table = pdoik.Shape.sphere(
        "table", (robot.fk(robot.mid_configuration()) @ IN_HAND)[:3, 3], 0.05
    )
    q = robot.mid_configuration()
    assert solver.judge(robot.fk(q), q, [table]).clearance < 0
    solver.detach()
    solver.attach(hand, [cube], may_touch=["table"])
    assert solver.clearances(q, [table])[0].part != "cube"
