"""Reports of goals of every kind: the same question from the file, the same answer, judged."""

from __future__ import annotations

import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pdoik
from pdoik.reports import (
    Entry,
    Kinematics,
    MassBox,
    goals_entry,
    json_lines,
    read_goals,
    requirements,
)
from references import PinocchioRobot
from trees import H1_XML, TIPS, by_name, crouch

PATIENT = {"max_time": 60.0, "max_restarts": 60}  # so that no clock ends a solve
Q = np.array([0.3, 0.4, 0.0, -1.8, 0.0, 2.2, 0.8])
FIELDS = [name for name in vars(pdoik.Goal) if isinstance(vars(pdoik.Goal)[name], property)]
FREE = np.inf


@pytest.fixture
def case(tmp_path: Path) -> Path:
    return tmp_path / "case.json"


def panda(**options: Any) -> pdoik.Solver:
    return pdoik.Solver(pdoik.Robot.builtin("panda"), pdoik.Options(**{**PATIENT, **options}))


@functools.cache
def humanoid() -> pdoik.Solver:
    robot = pdoik.Robot.from_urdf(H1_XML, tip_link=TIPS)
    return pdoik.Solver(robot, pdoik.Options(**PATIENT, self_collision=False))


def tool(x: float = 0.05) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    T[:3, 3] = [x, 0.02, 0.15]
    return T


T = panda().robot.fk(Q)
GOALS = {
    "plain": pdoik.Goal(T),
    "all of it": pdoik.Goal(
        T, type="axis", axis=[0, 1, 1], weight=2.5, position_slack=[0.1, 0, FREE],
        rotation_slack=[0.1, 0.2, np.pi], stands=True, relative_to="left", tip="right",
        T_tip_tool=tool(), soft=True, priority="position", position_tolerance=1e-3,
        rotation_tolerance=2e-3,
    ),
    "region": pdoik.Goal.region(
        T, position=[[-FREE, -0.1, 0], [0.2, FREE, 0]], rotation=[[-np.pi, 0, 0], [np.pi, 0.2, 0]]
    ),
    "look": pdoik.Goal.look_at([0.3, -0.4, 1 / 3], axis="x", cone=0.2, soft=True),
    "mass": pdoik.Goal.center_of_mass([-FREE, -0.1, -FREE], [0.2, FREE, FREE]),
    "place": pdoik.Goal([0.1, 0.2, 0.3], type="position", priority="both"),
}  # fmt: skip


def same(one: Any, other: Any) -> bool:
    if isinstance(one, pdoik.Goal):
        return all(same(getattr(one, name), getattr(other, name)) for name in FIELDS)
    if isinstance(one, np.ndarray):
        return bool(one.tobytes() == other.tobytes())
    return bool(one == other and type(one) is type(other))


def read_again(goals: Any) -> Any:
    return read_goals(Entry(json.loads(json_lines(goals_entry(goals))), "case.json", "target"))


@pytest.mark.parametrize("name", GOALS)
def test_a_file_has_all_that_a_goal_says(name: str) -> None:
    assert len(FIELDS) == 14
    assert same(GOALS[name], read_again(GOALS[name]))
    many = list(GOALS.values())
    assert all(map(same, many, read_again(many)))
    by_tip = read_again({"left": [GOALS[name], T], "right": T})
    assert same(by_tip["left"][0], GOALS[name])
    assert same(by_tip["left"][1], T)
    assert same(by_tip["right"], T)


@functools.cache
def asked() -> dict[str, tuple[pdoik.Solver, Any, dict[str, Any]]]:
    """Questions of all kinds: who is asked, the targets, the rest."""
    arm, h1 = panda(), humanoid()
    six = pdoik.Solver(pdoik.Robot.builtin("ur10"), pdoik.Options(**PATIENT))
    there = arm.robot.fk(Q) @ tool()
    grasps = np.array([arm.robot.fk(Q + 0.1 * k) for k in range(6)])
    far = T + np.eye(4, 4, 3) * 9.0
    left, right = TIPS[2:]
    standing = h1.robot.fk(crouch(h1.robot), left), h1.robot.fk(crouch(h1.robot), right)
    between = np.linalg.inv(standing[0]) @ standing[1]
    over = pdoik.Goal(standing[0], tip=left, type="position", position_slack=[0.05] * 3)
    hands = [over, pdoik.Goal(between, tip=right, relative_to=left)]
    mass = pdoik.Goal.center_of_mass([-0.05, -0.05, -FREE], [0.05, 0.05, FREE])
    bound = {"q0": Q, "max_step": np.full(7, 0.05)}  # so small that it is not turned enough
    turned = arm.robot.fk(Q)
    turned[:3, :3] = turned[:3, :3] @ tool()[:3, :3]
    ur_target = six.robot.fk(six.robot.mid_configuration() + 0.3)
    wall = np.array([[0.9, 0.3, 0.2, 0.05]])
    boxed = pdoik.Options(
        **PATIENT, self_collision=False, balance=pdoik.Balance(com_lower=(-1, -1, -1))
    )
    return {
        "tool of a goal": (arm, pdoik.Goal(there, T_tip_tool=tool()), {"q0": Q * 0.9}),
        "tool of the call": (arm, there, {"T_tip_tool": tool()}),
        "tool of the options": (panda(T_tip_tool=tool()), there, {}),
        "tools by tip": (h1, {left: standing[0] @ tool()}, {"T_tip_tool": {left: tool()}}),
        "region": (arm, pdoik.Goal.region(T, position=[[-0.2, 0, -FREE], [0.2, 0, 0]]), {}),
        "a list": (arm, [pdoik.Goal(T, type="position"), pdoik.Goal.look_at([0.9, 0, 0])], {}),
        "a wish": (arm, [pdoik.Goal(T, type="axis"), pdoik.Goal(far, soft=True)], {}),
        "tolerances": (arm, pdoik.Goal(T, position_tolerance=0.02, rotation_tolerance=0.1), {}),
        "relative": (h1, hands, {"q0": crouch(h1.robot) * 0.9}),
        "mass": (h1, [over, mass], {}),
        "mass by options": (pdoik.Solver(h1.robot, boxed), [over], {}),
        "nearest": (arm, turned, {"priority": "position", **bound}),
        "lock": (arm, T, {"lock": {"panda_joint3": 0.2}}),
        "any": (arm, grasps, {"call": "solve_any"}),
        "any by cost": (arm, grasps, {"call": "solve_any", "costs": [3, 2, 5, 1, 4, 6]}),
        "any of lists": (arm, [far, [pdoik.Goal(T)], T], {"call": "solve_any", "q0": Q}),
        "batch of lists": (arm, [[pdoik.Goal(T)], [pdoik.Goal.look_at([0.9, 0, 0])]], {}),
        "batch": (arm, grasps, {"lock": [{"panda_joint3": 0.1 * k} for k in range(6)]}),
        "all": (six, ur_target, {"call": "solve_all"}),
        "all from there": (
            six,
            [pdoik.Goal(ur_target)],
            {"call": "solve_all", "limit": 3, "q0": np.full(6, 0.2), "obstacles": wall},
        ),
        "all of none": (six, far, {"call": "solve_all"}),
    }  # fmt: skip


@pytest.mark.parametrize("name", asked())
def test_a_report_gives_the_same_answer_to_the_bit_and_holds(name: str, case: Path) -> None:
    solver, target, rest = asked()[name]
    pdoik.write_report(case, solver, target, **rest)
    replay = pdoik.replay_report(case)
    assert (replay.same, replay.clocked) == (True, []), replay.differences
    assert replay.faults == []
    call = rest.get("call", "solve_batch" if name.startswith("batch") else "solve")
    result = getattr(solver, call)(target, **{k: v for k, v in rest.items() if k != "call"})
    each = result if call in ("solve_batch", "solve_all") else [result]
    assert [a["q"].tolist() for a in replay.answers] == [r.q.tolist() for r in each]
    assert [a["goal_index"] for a in replay.answers] == [r.goal_index for r in each]
    assert [a["message"] for a in replay.answers] == [r.message for r in each]
    wanted = {"nearest": "nearest", "all of none": None}.get(name, "solved")
    assert all(answer["status"] == wanted for answer in replay.answers)
    if name.startswith("all"):
        assert replay.found is not None
        assert replay.found["complete"] == result.complete
        assert replay.found["turns"] == result.turns
    pdoik.write_report(case, solver, target, **rest, result=result)
    assert pdoik.replay_report(case).same


def edited(case: Path, change: Callable[[Any], object]) -> pdoik.Replay:
    content = json.loads(case.read_text())
    change(content)
    case.write_text(json.dumps(content))
    return pdoik.replay_report(case)


def moved(content: Any, key: str, by: float) -> None:
    """The target, or one of a list."""
    target = content["question"]["target"]
    at = target["goals"][-1] if "goals" in target else target
    at = next(iter(at["tips"].values())) if "tips" in at else at
    at[key][0][3] += by


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("tool of a goal", lambda c: moved(c, "T_tip_tool", 0.01), "position error"),
        ("tools by tip", lambda c: moved(c, "T_base_tip", 0.01), "position error"),
        ("relative", lambda c: moved(c, "T_base_tip", 0.01), "position error of right_elbow_link"),
        ("a list", lambda c: moved(c, "T_base_tip", 0.2), "rotation error of panda_link8"),
        ("any", lambda c: c["question"]["target"]["T_base_tip"].reverse(), "position error"),
        ("all", lambda c: moved(c, "T_base_tip", 0.01), "position error"),
        (
            "mass",
            lambda c: c["question"]["target"]["goals"][1].update(
                position_slack=[0.05, 1e-6, "inf"]
            ),
            "balance violation",
        ),
        (
            "tolerances",
            lambda c: c["question"]["target"].update(rotation_tolerance=1e-12),
            "rotation error",
        ),
    ],
)
def test_a_false_claim_is_told(
    name: str, change: Callable[[Any], object], words: str, case: Path
) -> None:
    solver, target, rest = asked()[name]
    pdoik.write_report(case, solver, target, **rest)
    claims = [each for each in edited(case, change).faults if "claims success, but" in each]
    assert any(words in each for each in claims), claims


def test_a_wish_is_not_judged_and_where_a_position_comes_first_its_orientation_neither(
    case: Path,
) -> None:
    solver, target, rest = asked()["a wish"]
    pdoik.write_report(case, solver, target, **rest)
    (judged,) = edited(case, lambda c: moved(c, "T_base_tip", 0.3)).judged
    assert judged.faults == ()
    solver, target, rest = asked()["nearest"]
    pdoik.write_report(case, solver, target, **rest)
    replay = pdoik.replay_report(case)
    assert replay.judged[0].rotation_error > 0.5
    (fault,) = edited(case, lambda c: c["question"].update(priority="both")).judged[0].faults
    assert fault.startswith("claims all but orientation, but rotation error is")


def test_a_joint_that_was_to_stay_and_did_not_is_told(case: Path) -> None:
    solver, target, rest = asked()["lock"]
    pdoik.write_report(case, solver, target, **rest)
    replay = edited(case, lambda c: c["question"]["lock"].update(panda_joint3=0.25))
    assert "panda_joint3 was to stay at 0.25; it is at 0.2" in replay.faults


def test_its_errors_and_its_centre_of_mass_are_those_of_another_library() -> None:
    h1, rng = humanoid().robot, np.random.default_rng(3)
    pinocchio, kinematics = PinocchioRobot.floating(H1_XML), Kinematics(h1)
    base, left, right = h1.base_link, *TIPS[2:]
    goals = [
        pdoik.Goal(np.eye(4), tip=right, relative_to=left, T_tip_tool=tool()),
        pdoik.Goal.look_at([0.5, 0.1, 0.2], axis="x", tip=left, T_tip_tool=tool()),
        pdoik.Goal.center_of_mass([-FREE] * 3, [-9, FREE, FREE]),
    ]
    related, looking, _ = asked_of = requirements(
        goals, h1.tip_links, pdoik.Options(), pdoik.reports.call.Call()
    )
    box = MassBox(h1, pdoik.Options())
    for _ in range(20):
        q = rng.uniform(np.maximum(h1.lower, -2), np.minimum(h1.upper, 2))
        pinocchio.set(by_name(h1, q))
        poses = kinematics.poses(q)
        at = pinocchio.pose(left, right) @ tool()
        assert related.errors(poses)[0] == pytest.approx(np.linalg.norm(at[:3, 3]), abs=1e-9)
        angle = np.arccos(np.clip((np.trace(at[:3, :3]) - 1) / 2, -1, 1))
        assert related.errors(poses)[1] == pytest.approx(angle, abs=1e-6)
        hand = pinocchio.pose(base, left) @ tool()
        sight = np.array([0.5, 0.1, 0.2]) - hand[:3, 3]
        cosine = hand[:3, 0] @ sight / np.linalg.norm(sight)
        assert looking.errors(poses) == (0.0, pytest.approx(np.arccos(cosine), abs=1e-6))
        found = box(asked_of, poses)
        assert found is not None
        np.testing.assert_allclose(found[0], pinocchio.center_of_mass(base), atol=1e-9)
        assert found[1] == pytest.approx(found[0][0] + 9)


NEW = ("lock", "T_tip_tool", "priority")


def test_reports_of_before_are_read(case: Path) -> None:
    solver = panda()
    goal = pdoik.Goal(T, type="axis", axis="x", rotation_slack=[0.1] * 3)
    pdoik.write_report(case, solver, goal, q0=Q)

    def older(content: Any) -> None:
        content["pdoik_report"] = 1
        del content["found"]
        for name in NEW:
            del content["question"][name]
        for name in ("T_tip_tool", "priority"):
            del content["options"][name]
        known = ("T_base_tip", "type", "axis", "weight", "position_slack", "rotation_slack")
        target = content["question"]["target"]
        content["question"]["target"] = {name: target[name] for name in known}
        for name in ("goal_index", "message"):
            del content["answers"][0][name]

    replay = edited(case, older)
    assert (replay.same, replay.faults) == (True, [])


def test_what_belongs_to_another_call_is_refused(case: Path) -> None:
    solver = panda()
    for keywords, words in (
        ({"call": "solved"}, "call is 'solved'"),
        ({"costs": [1.0]}, "costs are of call='solve_any'"),
        ({"limit": 2}, "limit and distinct"),
        ({"call": "solve_all", "priority": "position"}, "no priority"),
        ({"call": "solve_all", "result": solver.solve(T)}, "expected Solutions"),
    ):
        with pytest.raises(ValueError, match=words):
            pdoik.write_report(case, solver, T, **keywords)
    assert not case.exists()
