"""Misuse of goals by tip, balance and placements is refused by name."""

import numpy as np
import pytest

import pdoik
from trees import LEFT, RIGHT, SOLE, TIPS


@pytest.fixture(scope="module")
def h1() -> pdoik.Robot:
    return pdoik.Robot.builtin("h1")


def test_bad_goals_are_named_by_tip(h1: pdoik.Robot) -> None:
    solver = pdoik.Solver(h1)
    T = {tip: h1.fk(np.zeros(19), tip) for tip in TIPS}
    for goals, kind, message in [
        ({}, ValueError, f"there is no goal, expected one for at least one tip of {LEFT}"),
        (T[LEFT], ValueError, f"one target, but the robot has 4 tips.*{LEFT}, {RIGHT}"),
        ({"nose": T[LEFT]}, ValueError, f"'nose', which is no tip link of the robot: {LEFT}"),
        ({7: T[LEFT]}, TypeError, "a key of T_base_tip is 7, expected a tip link's name"),
        (
            {LEFT: T[LEFT], RIGHT: T[RIGHT] * np.nan},
            ValueError,
            rf"T_base_tip\['{RIGHT}'\] holds NaN",
        ),
        ({LEFT: 2 * T[LEFT]}, ValueError, rf"T_base_tip\['{LEFT}'\]"),
        ({RIGHT: T[RIGHT][:3, 3]}, ValueError, rf"\['{RIGHT}'\] has shape \(3,\), expected \(4, 4"),
        ({RIGHT: "up"}, TypeError, rf"T_base_tip\['{RIGHT}'\] has dtype"),
        ({LEFT: pdoik.Goal(T[LEFT], weight=-1)}, ValueError, f"weight of the goal for '{LEFT}' is"),
        ({LEFT: pdoik.Goal(T[LEFT], weight=np.nan)}, ValueError, f"weight of .*'{LEFT}' is nan"),
        (
            {LEFT: pdoik.Goal(T[LEFT], rotation_slack=(-1, 0, 0))},
            ValueError,
            f"rotation_slack of the goal for '{LEFT}' holds a number that is negative",
        ),
        (
            {LEFT: pdoik.Goal(T[LEFT], position_slack=(0, 0, -1e-9))},
            ValueError,
            f"position_slack of the goal for '{LEFT}' holds a number that is negative",
        ),
        (
            {LEFT: pdoik.Goal(T[LEFT], type="axis", axis=(0, 0, 0))},
            ValueError,
            f"axis of the goal for '{LEFT}' has length 0",
        ),
    ]:
        for call in (solver.solve, lambda g: solver.judge(g, np.zeros(19))):
            with pytest.raises(kind, match=message):
                call(goals)
    for arguments, message in [
        ({"type": "place"}, "type is 'place', expected one of 'pose', 'axis', 'position'"),
        ({"axis": "w"}, "axis is 'w', expected 'x', 'y', 'z' or a 3-vector"),
        ({"position_slack": (0, 0)}, r"position_slack has shape \(2,\), expected \(3,\)"),
        ({"rotation_slack": (0, np.nan, 0)}, "rotation_slack holds NaN"),
        ({"T_base_tip": np.zeros(3)}, r"T_base_tip has shape \(3,\), expected \(4, 4\)"),
    ]:
        with pytest.raises(ValueError, match=message):
            pdoik.Goal(**{"T_base_tip": T[LEFT], **arguments})


@pytest.mark.parametrize("method", [{"method": "paper"}, {"inner": "lbfgs"}])
def test_what_the_papers_minimiser_cannot_do_is_refused(method: dict) -> None:
    robot = pdoik.Robot.builtin("panda")
    solver = pdoik.Solver(robot, pdoik.Options(**method))
    T, q0 = robot.fk(robot.mid_configuration()), robot.mid_configuration()
    needs = "needs method 'default' with inner 'levenberg_marquardt'"
    with pytest.raises(ValueError, match=f"position_slack of the goal for 'panda_link8' {needs}"):
        solver.solve(pdoik.Goal(T, position_slack=(0.1, 0, 0)))
    with pytest.raises(ValueError, match=f"max_step {needs}"):
        solver.solve(T, q0=q0, max_step=np.ones(7))
    if "method" in method:
        with pytest.raises(ValueError, match="posture needs method 'default'"):
            solver.solve(T, posture=q0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"posture": np.zeros(18)}, r"posture has shape \(18,\), expected \(19,\)"),
        ({"posture": np.full(19, np.nan)}, "posture holds NaN"),
        ({"max_step": np.ones(19)}, "max_step needs q0"),
        ({"q0": np.zeros(19), "max_step": np.ones(3)}, r"max_step has shape \(3,\), expected"),
        ({"q0": np.zeros(19), "max_step": -np.ones(19)}, r"max_step\[0\] is -1"),
        ({"q0": np.zeros(19), "max_step": np.full(19, np.nan)}, "max_step"),
    ],
)
def test_bad_postures_and_steps_are_named(h1: pdoik.Robot, arguments: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pdoik.Solver(h1).solve({LEFT: h1.fk(np.zeros(19), LEFT)}, **arguments)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"joint_weights": [1, 2]}, "joint_weights has 2 entries, the robot has 19 joints"),
        ({"joint_weights": -np.ones(19)}, r"joint_weights\[0\] is -1"),
        ({"joint_weights": np.full(19, np.inf)}, "joint_weights holds infinity"),
        ({"posture_weight": 0.0}, "posture_weight is 0"),
        ({"self_clearance": np.nan}, "self_clearance is nan"),
        ({"prefer": "best"}, "prefer is 'best', expected one of 'first', 'nearest'"),
    ],
)
def test_options_of_trees_out_of_range_are_named(
    h1: pdoik.Robot, options: dict, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        pdoik.Solver(h1, pdoik.Options(**options))


@pytest.mark.parametrize(
    ("balance", "message"),
    [
        (
            {"com_lower": (1, 0, 0), "com_upper": (0, 1, 1)},
            r"balance.com_lower\[0\] is 1.* expected at most com_upper's 0",
        ),
        ({"com_lower": (0, np.nan, 0)}, r"balance.com_lower\[1\] is nan"),
        ({"com_lower": (0, 0)}, r"balance.com_lower has shape \(2,\), expected \(3,\)"),
        ({"contacts": {"sole": SOLE}}, "'sole' is not a link of 'h1'.*left_ankle_link"),
        ({"contacts": {LEFT: SOLE[:2]}}, "balance.contacts hold 2 points, expected at least 3"),
        ({"contacts": {LEFT: SOLE[:, :2]}}, rf"contacts\['{LEFT}'\] has shape \(4, 2\), expected"),
        ({"contacts": {LEFT: np.full((3, 3), np.nan)}}, f"contacts of '{LEFT}' hold NaN"),
        ({"contacts": {LEFT: SOLE}, "up": (0, 0, 0)}, "balance.up has length 0"),
        (
            {"contacts": {LEFT: SOLE}, "support_margin": np.nan},
            "balance.support_margin is nan, expected a finite number",
        ),
    ],
)
def test_a_balance_that_makes_no_sense_is_named(
    h1: pdoik.Robot, balance: dict, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        pdoik.Solver(h1, pdoik.Options(balance=pdoik.Balance(**balance)))


def test_balance_without_mass_is_refused() -> None:
    robot = pdoik.Robot.from_dh([pdoik.DhRow(a=0.3)])
    with pytest.raises(ValueError, match="links have no mass"):
        pdoik.Solver(robot, pdoik.Options(balance=pdoik.Balance(com_lower=(0, 0, 0))))
    with pytest.raises(ValueError, match="mass"):
        robot.center_of_mass([0.0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"T_world_base": np.eye(4), "floating_base": (-np.ones(6), np.ones(6))},
            "T_world_base and floating_base are both given",
        ),
        ({"floating_base": (-2 * np.ones(6), np.ones(6))}, r"bounds of base_pitch .*\(-pi/2, pi/2"),
        ({"floating_base": (np.ones(6), -np.ones(6))}, "bounds of base_x .* lower one first"),
        (
            {"floating_base": (np.full(6, -np.inf), np.ones(6))},
            "floating_base: lower holds NaN or inf",
        ),
        ({"floating_base": (-np.ones(5), np.ones(6))}, r"lower has shape \(5,\), expected \(6,\)"),
        ({"T_world_base": np.diag([2.0, 2, 2, 1])}, "T_world_base is not a rigid"),
        ({"T_world_base": np.eye(3)}, r"T_world_base has shape \(3, 3\), expected \(4, 4\)"),
        ({"T_world_base": np.eye(4), "base_link": "sole"}, "'sole' is not a link of 'h1'"),
        ({"base_link": "sole"}, "'sole' is not there"),
        ({"tip_link": [LEFT, "sole"]}, "'sole' is not a link of 'h1'"),
    ],
)
def test_placements_that_make_no_sense_are_named(arguments: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pdoik.Robot.builtin("h1", **arguments)
