"""Rules of contact from Python: results judged by coal, and what MoveIt's files say by MoveIt's."""

from __future__ import annotations

import math
import pickle
import re
from collections.abc import Mapping
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import pdoik
from bench.ik.goals.peers.body import by_capsules
from command_line import run
from pdoik.reports import Wanted
from pdoik.scenes import EntryError, read_matrix, read_scene_file
from test_shapes import FloatArray, capsule_between, coal_distance, coal_geometry

ANY = -math.inf
UP = np.array([0.0, 0.0, 1.0])
DOWN = np.diag([1.0, -1.0, -1.0])
Rule = pdoik.ContactRule


def placed(x: float, y: float, z: float, R: FloatArray | None = None) -> FloatArray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    T[:3, :3] = np.eye(3) if R is None else R
    return T


# Judged by coal.


def coal_pairs(
    robot: pdoik.Robot,
    q: FloatArray,
    shapes: list[pdoik.Shape],
    held: Mapping[str, tuple[str, pdoik.Shape]],
) -> dict[tuple[str, str], float]:
    """The least distance of each link with each shape, and of each thing held with both."""
    least: dict[tuple[str, str], float] = {}
    geometries = {shape.name: coal_geometry(shape) for shape in shapes}
    bodies: list[tuple[str, object, FloatArray]] = []
    for link, vertices, triangles, _ in robot.occupancy.pieces:
        piece = pdoik.Shape.convex_mesh(link, vertices, triangles=triangles)
        bodies.append((link, coal_geometry(piece), robot.fk(q, link)))
    in_pieces = {name for name, *_ in bodies}
    for link, a, b, radius, _ in robot.occupancy.capsules:
        if link in in_pieces:
            continue
        T = robot.fk(q, link)
        ends = (T[:3, :3] @ a + T[:3, 3], T[:3, :3] @ b + T[:3, 3])
        bodies.append((link, *capsule_between(*ends, radius)))
    things = [
        (name, coal_geometry(shape), robot.fk(q, link) @ shape.T_base_shape)
        for name, (link, shape) in held.items()
    ]

    def add(one: str, other: str, distance: float) -> None:
        least[one, other] = min(least.get((one, other), math.inf), distance)

    for name, body, T in [*bodies, *things]:
        for shape in shapes:
            add(
                name,
                shape.name,
                coal_distance(body, T, geometries[shape.name], shape.T_base_shape),
            )
    for name, thing, T_thing in things:
        for link, body, T in bodies:
            add(name, link, coal_distance(thing, T_thing, body, T))
    return least


@pytest.mark.parametrize("name", ["panda", "ur10"])
def test_a_held_box_rests_on_its_table_and_all_else_keeps_off(name: str) -> None:
    robot = pdoik.Robot.builtin(name)
    hand = robot.link_names[-1]
    reach, height = (0.5, 0.2) if name == "panda" else (0.7, 0.2)
    box = pdoik.Shape.box("box", (0.08, 0.06, 0.1), placed(0, 0, 0.15))
    table = pdoik.Shape.box("table", (0.5, 0.6, 0.04), placed(reach, 0, height - 0.02))
    crate = pdoik.Shape.box("crate", (0.1, 0.1, 0.3), placed(reach, 0.12, height + 0.151))
    shapes, clearance = [table, crate], 0.02
    solver = pdoik.Solver(
        robot, pdoik.Options(clearance=clearance, max_time=np.inf, max_restarts=60)
    )
    solver.attach(hand, [box])
    rules = [Rule("box", "table", clearance=0.0)]
    rests = grazes = 0
    for k, y in enumerate(np.linspace(-0.2, 0.05, 8)):
        # The box's lower face is 0.1 m and half of 0.1 m beyond the flange.
        T = placed(reach, y, height + 0.2 + 1e-6, DOWN)
        refused = solver.solve(T, obstacles=shapes)
        assert not refused.success
        result = solver.solve(T, obstacles=pdoik.Scene(shapes, contacts=rules))
        pairs = coal_pairs(robot, np.asarray(result.q), shapes, {"box": (hand, box)})
        wanted = Wanted(robot.ignored_pairs, rules)
        room = min(
            distance - wanted.of(pair[:1], pair[1:], clearance)
            for pair, distance in pairs.items()
            if pair[1] in ("table", "crate")
        )
        if result.success:
            rests += 1
            assert room >= -3e-6
            assert 0.0 <= pairs["box", "table"] + 3e-6 <= 1e-4
            assert result.clearance == pytest.approx(pairs["box", "table"], abs=3e-6)
            assert result.room == pytest.approx(room, abs=5e-6)
        else:
            grazes += 1
            assert room < -1e-6, k
    assert rests >= 3
    assert grazes >= 1  # beside the crate it is nearer than 20 mm


@pytest.mark.parametrize(("pieces", "count", "clearance"), [(False, 25, 0.06), (True, 40, 0.12)])
def test_random_rules_are_kept_pair_by_pair(pieces: bool, count: int, clearance: float) -> None:
    robot = pdoik.Robot.builtin("panda") if pieces else by_capsules("panda")
    hand, rng, solved, own = robot.link_names[-1], np.random.default_rng(5), 0, 0
    names = ["table", "shelf", "shelf/1", "cup", "panda_link5", "panda_link6", "panda*", "*", "s*"]
    cup = pdoik.Shape.cylinder("cup", 0.04, 0.12, placed(0, 0, 0.12))
    for _ in range(count):
        q = robot.lower + rng.uniform(0.2, 0.8, 7) * (robot.upper - robot.lower)
        shapes = [
            pdoik.Shape.box(each, rng.uniform(0.05, 0.2, 3), placed(*rng.uniform(-0.7, 0.7, 3)))
            for each in ("table", "shelf", "shelf/1")
        ]
        rules = [
            Rule(one, other, clearance=float(rng.choice([-0.02, 0.0, 0.02, 0.08, ANY])))
            for one, other in rng.choice(names, (4, 2))
        ]
        rules += [Rule("cup", "nothing", optional=True)]
        base = [Rule("panda_link0", "*"), Rule("panda_link1", "*")]
        options = pdoik.Options(clearance=clearance, max_time=np.inf, max_restarts=30)
        solver = pdoik.Solver(robot, options)
        solver.attach(hand, [cup])
        scene = pdoik.Scene(shapes, contacts=[*base, *rules])
        result = solver.solve(robot.fk(q), obstacles=scene)
        wanted = Wanted(robot.ignored_pairs, scene.contacts)
        pairs = coal_pairs(robot, np.asarray(result.q), shapes, {"cup": (hand, cup)})
        rooms = [
            (distance - least, distance, least)
            for pair, distance in pairs.items()
            if pair[1] not in robot.link_names
            and (least := wanted.of(pair[:1], pair[1:], options.clearance)) > ANY
        ]
        room = min((each[0] for each in rooms), default=math.inf)
        if room > -options.clearance and min(each[1] for each in rooms) > 0:
            # Capsules, which count where nothing is too near, stand 15 mm out at most.
            assert room - 0.016 <= result.room <= room + 1e-5
            if room < 0 or not pieces:
                assert result.room == pytest.approx(room, abs=1e-5)
        if result.success:
            solved += 1
            assert room >= -1e-5
            own += any(distance < options.clearance - 1e-4 for _, distance, _ in rooms)
    assert solved > 12
    assert own > 0


def test_a_tracker_sets_down_to_contact_and_stays_off_else() -> None:
    robot = pdoik.Robot.builtin("panda")
    hand = robot.link_names[-1]
    box = pdoik.Shape.box("box", (0.08, 0.06, 0.1), placed(0, 0, 0.15))
    table = pdoik.Shape.box("table", (0.5, 0.6, 0.04), placed(0.5, 0, 0.18))
    solver = pdoik.Solver(robot, pdoik.Options(clearance=0.02, max_time=np.inf, max_restarts=100))
    scene = pdoik.Scene([table], contacts=[Rule("b*", "table", allowed=0)])
    solver.attach(hand, [box])
    start = solver.solve(placed(0.5, 0, 0.44, DOWN), obstacles=scene)
    assert start.success
    tracker = pdoik.Tracker(solver, max_time=1e9)
    tracker.attach_all(solver.carried)
    tracker.reset(start.q)
    for k in range(60):
        step = tracker.step(placed(0.5, 0, 0.44 - 0.001 * k, DOWN), scene)
        pairs = coal_pairs(robot, np.asarray(step.q), [table], {"box": (hand, box)})
        assert pairs["box", "table"] >= -1e-5
        assert min(d for (one, other), d in pairs.items() if one != "box") >= 0.02 - 1e-5
    assert pairs["box", "table"] < 1e-3
    assert step.tracking == "infeasible"


# What is carried.


def test_two_hands_on_one_box() -> None:
    left, right = "left_elbow_link", "right_elbow_link"
    robot = pdoik.Robot.builtin("h1", "pelvis", [left, right])
    hand = placed(0.3, 0.0, -0.015)
    goals = [
        pdoik.Goal(
            placed(0.4, 0.15, 0.15), type="position", tip=left, T_tip_tool=hand,
            position_slack=[0.05] * 3,
        ),
        pdoik.Goal(
            placed(0.3, -0.3, -0.015), type="axis", axis="x", tip=right, relative_to=left,
            T_tip_tool=hand,
        ),
    ]  # fmt: skip
    # Between the forearms' ends, and in both by a little.
    box = pdoik.Shape.box("box", (0.1, 0.3, 0.1), placed(0.3, -0.15, -0.015))
    options = pdoik.Options(max_time=np.inf, max_restarts=60)
    by_two = pdoik.Solver(robot, options)
    by_two.attach([left, right], [box])
    result = by_two.solve(goals, q0=np.zeros(robot.dof))
    assert result.success, result.message
    q = np.asarray(result.q)
    pairs = coal_pairs(robot, q, [], {"box": (left, box)})
    assert pairs["box", right] < 0
    assert min(d for (_, link), d in pairs.items() if "elbow" not in link) >= -1e-6
    by_one = pdoik.Solver(robot, options)
    by_one.attach(left, [box])
    assert by_one.judge(goals, q).self_distance == pytest.approx(pairs["box", right], abs=1e-6)
    assert not by_one.judge(goals, q).success
    by_one.detach()
    by_one.attach(left, [box], may_touch=[right])
    assert by_one.judge(goals, q).success
    (thing,) = by_two.carried
    assert (thing.links, [shape.name for shape in thing.shapes]) == ([left, right], ["box"])
    again = pdoik.Tracker(by_two)
    again.attach_all(pickle.loads(pickle.dumps(by_two.carried)))
    assert repr(again.carried) == "[<Attachment of box to left_elbow_link, right_elbow_link>]"
    again.detach(right)
    assert again.carried[0].links == [left]
    again.detach("box")
    assert again.carried == []


def test_several_objects_are_attached_at_once_or_none() -> None:
    robot = pdoik.Robot.builtin("panda")
    ball = pdoik.Shape.sphere
    solver = pdoik.Solver(robot)
    cup = pdoik.Attachment("panda_link8", [ball("cup", (0, 0, 0.1), 0.02)], ["table"])
    tool = pdoik.Attachment(
        "panda_link5",
        [ball("tool", (0, 0.2, 0), 0.02)],
        contacts=[Rule("tool", "cup", clearance=1)],
    )
    with pytest.raises(ValueError, match="nobody"):
        solver.attach_all([cup, pdoik.Attachment("nobody", tool.shapes)])
    assert solver.carried == []
    solver.attach_all([cup, tool])
    assert [each.contacts for each in solver.carried] == [[Rule("cup", "table")], tool.contacts]
    q = np.array([0.3, 0.2, 0.0, -1.8, 0.0, 2.2, 0.8])
    result = solver.judge(robot.fk(q), q)
    assert result.worst_constraint == "clearance of tool to cup"
    apart = np.linalg.norm(
        (robot.fk(q, "panda_link8") @ (0, 0, 0.1, 1) - robot.fk(q, "panda_link5") @ (0, 0.2, 0, 1))[
            :3
        ]
    )
    assert result.self_room == pytest.approx(apart - 0.04 - 1.0, abs=1e-9)
    solver.detach("tool")
    assert [each.links for each in solver.carried] == [["panda_link8"]]
    with pytest.raises(ValueError, match=r"'cap' is neither .*nearest: cup"):
        solver.detach("cap")
    solver.detach()
    assert solver.carried == []


# Rules and what is wrong with them.


def test_a_rule_says_what_it_is() -> None:
    for rule, clearance, text in (
        (Rule("a", "b"), ANY, "ContactRule('a', 'b', allowed=True)"),
        (Rule("a", "b", allowed=True), ANY, "ContactRule('a', 'b', allowed=True)"),
        (Rule("a", "b", allowed=0), 0.0, "ContactRule('a', 'b', clearance=0)"),
        (Rule("a", "b", allowed=0.005), -0.005, "ContactRule('a', 'b', clearance=-0.005)"),
        (Rule("a", "b", allowed=False), None, "ContactRule('a', 'b', allowed=False)"),
        (Rule("a", "b*", clearance=0.1), 0.1, "ContactRule('a', 'b*', clearance=0.1)"),
        (Rule("a", "b", optional=True), ANY, "ContactRule('a', 'b', allowed=True, optional=True)"),
    ):
        assert (rule.clearance, repr(rule)) == (clearance, text)
        again = eval(text, {"ContactRule": Rule})
        assert again == rule
        assert hash(pickle.loads(pickle.dumps(rule))) == hash(rule)
        assert rule != (rule.one, rule.other)
    with pytest.raises(ValueError, match="both given"):
        Rule("a", "b", allowed=True, clearance=0.0)
    with pytest.raises(ValueError, match="expected two names"):
        Rule("", "b")
    for wrong in (math.nan, math.inf, 1e9):
        with pytest.raises(ValueError, match="'a' and 'b'"):
            Rule("a", "b", clearance=wrong)
        with pytest.raises(ValueError, match="'a' and 'b'"):
            Rule("a", "b", allowed=-wrong)
    scene = pdoik.Scene(
        allowed=[("a", "b"), ("c", "d", 0.1)], contacts=[Rule("e", "f", clearance=1)]
    )
    assert scene.contacts == [
        Rule("a", "b"),
        Rule("c", "d", allowed=0.1),
        Rule("e", "f", clearance=1),
    ]
    assert scene.allowed == [("a", "b"), ("c", "d", 0.1)]


def test_names_of_nothing_are_refused_with_the_nearest_that_there_are() -> None:
    robot = pdoik.Robot.builtin("panda")
    table = pdoik.Shape.box("table", (1, 1, 0.1), placed(0, 0, -1))
    solver, T = pdoik.Solver(robot), robot.fk(robot.mid_configuration())
    for rule, says in (
        (Rule("panda_link8", "tabel"), "'tabel' is not there.*nearest: table"),
        (Rule("panda_lnk8", "table"), "'panda_lnk8' is not there.*nearest: panda_link8"),
        (Rule("finger*", "table"), r"'finger\*' means nothing that there is"),
    ):
        with pytest.raises(ValueError, match=says):
            solver.solve(T, obstacles=pdoik.Scene([table], contacts=[rule]))
        step = pdoik.Tracker(solver).step(T, pdoik.Scene([table], contacts=[rule]))
        assert step.tracking == "invalid_input"
        assert re.search(says, step.complaint)
    fine = [Rule("finger*", "tabel", optional=True), Rule("*", "points", clearance=0.1)]
    assert solver.solve(T, obstacles=pdoik.Scene([table], contacts=fine)).success


def test_points_are_a_thing_like_others() -> None:
    robot = pdoik.Robot.builtin("panda")
    q = np.array([0.3, 0.2, 0.0, -1.8, 0.0, 2.2, 0.8])
    link, a, b, radius, _ = next(c for c in robot.occupancy.capsules if c[0] == "panda_link5")
    T = robot.fk(q, link)
    point = (T @ (*(np.asarray(a) + b) / 2, 1.0))[:3]  # inside
    solver = pdoik.Solver(robot)

    def judged(*rules: pdoik.ContactRule) -> pdoik.Result:
        return solver.judge(robot.fk(q), q, pdoik.Scene(cloud=point[None], contacts=rules))

    bare = judged()
    assert bare.clearance < -0.5 * radius
    assert bare.room == bare.clearance
    depth = -bare.clearance
    let = judged(Rule(link, "points", allowed=depth + 1e-3))
    assert (let.clearance, let.success) == (
        bare.clearance,
        judged(Rule("panda*", "points", allowed=depth + 1e-3)).success,
    )
    assert judged(Rule(link, "points")).clearance > bare.clearance
    assert not judged(Rule(link, "points", allowed=depth - 1e-3)).success
    wide = judged(Rule("*", "points"), Rule(link, "points", clearance=0.2))
    assert (wide.clearance, wide.room) == pytest.approx((bare.clearance, bare.clearance - 0.2))


# MoveIt's files.


def moveits(matrix: Mapping[str, Any], one: str, other: str) -> bool:
    """AllowedCollisionMatrix::getAllowedCollision of what a message says."""
    names = matrix["entry_names"]
    defaults = dict(zip(matrix["default_entry_names"], matrix["default_entry_values"], strict=True))

    def by_default() -> bool | None:
        found = [defaults[name] for name in (one, other) if name in defaults]
        return all(found) if found else None

    if one in names and other in names:
        # What a message says of a pair is kept unless that is what the defaults say.
        return bool(matrix["entry_values"][names.index(one)]["enabled"][names.index(other)])
    return bool(by_default())


def test_a_planning_scenes_matrix_means_what_it_means_to_moveit() -> None:
    rng = np.random.default_rng(2)
    things = ["base", "elbow", "hand", "finger_1", "cup", "table", "<octomap>"]
    allowed = 0
    for _ in range(300):
        names = [str(each) for each in rng.permutation(things)[: rng.integers(0, 7)]]
        with_default = [str(each) for each in rng.permutation(things)[: rng.integers(0, 4)]]
        upper = np.triu(rng.random((len(names),) * 2) < 0.4, 1)
        matrix = {
            "entry_names": names,
            "entry_values": [{"enabled": row.tolist()} for row in upper | upper.T],
            "default_entry_names": with_default,
            "default_entry_values": (rng.random(len(with_default)) < 0.5).tolist(),
        }
        rules = read_matrix({"allowed_collision_matrix": matrix}, Path("x"), {"cup", "table"})
        wanted = Wanted([], rules)
        for i, one in enumerate(things):
            for other in things[:i]:
                ours = [name.replace("<octomap>", "points") for name in (one, other)]
                may = wanted.of(ours[:1], ours[1:], 0.02) == ANY
                assert may == moveits(matrix, one, other), (matrix, one, other)
                allowed += may
        assert all(rule.optional for rule in rules)
        assert all(
            rule.one not in ("cup", "table") for rule in rules if rule.other in ("base", "hand")
        )
    assert allowed > 500


def test_a_matrixs_names_are_never_patterns() -> None:
    names = ["hand", "box*", "b?x"]
    matrix = {
        "entry_names": names,
        "entry_values": [{"enabled": [one != other for other in names]} for one in names],
        "default_entry_names": ["*"],
        "default_entry_values": [True],
    }
    for there in ({"box*", "boxes"}, {"boxes"}):
        rules = read_matrix({"allowed_collision_matrix": matrix}, Path("x"), there)
        pairs = {(rule.one, rule.other) for rule in rules}
        assert pairs == ({("hand", "box*")} if "box*" in there else set())


def test_a_matrix_that_is_not_square_is_refused() -> None:
    for matrix, says in (
        ({"entry_names": ["a"], "entry_values": []}, "1 entry_names, 0 entry_values"),
        ({"default_entry_names": ["a"]}, "1 default_entry_names, 0 default_entry_values"),
    ):
        with pytest.raises(EntryError, match=says):
            read_matrix({"allowed_collision_matrix": matrix}, Path("x"))


def carrying_scene() -> dict[str, Any]:
    """A PlanningScene in which a hand holds a box that is on a table."""
    cube = {"type": 1, "dimensions": [0.06, 0.06, 0.06]}
    top = {"type": 1, "dimensions": [0.6, 0.6, 0.04]}
    names = ["panda_link0", "panda_link7", "box", "table", "panda_leftfinger"]
    pairs = {("box", "table"), ("panda_link0", "table"), ("panda_link7", "box")}
    values = [
        {"enabled": [(one, other) in pairs or (other, one) in pairs for other in names]}
        for one in names
    ]
    return {
        "robot_state": {
            "attached_collision_objects": [
                {
                    "link_name": "panda_link8",
                    "object": {
                        "id": "box",
                        "header": {"frame_id": "panda_link8"},
                        "pose": {"position": [0, 0, 0.1]},
                        "primitives": [cube, cube],
                        "primitive_poses": [{"position": [0, 0, 0]}, {"position": [0.06, 0, 0]}],
                    },
                    "touch_links": ["panda_leftfinger", "panda_link7"],
                }
            ]
        },
        "allowed_collision_matrix": {"entry_names": names, "entry_values": values},
        "world": {
            "collision_objects": [
                {
                    "id": "table",
                    "header": {"frame_id": "panda_link0"},
                    "primitives": [top],
                    "primitive_poses": [{"position": [0.5, 0, 0.1]}],
                }
            ]
        },
    }


def test_a_planning_scene_gives_what_is_attached_and_all_its_contacts(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(yaml.safe_dump(carrying_scene()))
    found = read_scene_file(path)
    (thing,) = found.attached
    assert thing.links == ["panda_link8"]
    assert [shape.name for shape in thing.shapes] == ["box", "box/1"]
    np.testing.assert_allclose(thing.shapes[1].T_base_shape[:3, 3], (0.06, 0, 0.1))
    touched = {(rule.one, rule.other) for rule in thing.contacts}
    links = ("panda_leftfinger", "panda_link7")
    assert touched == {(part, link) for part in ("box", "box/1") for link in links}
    said = [{rule.one, rule.other} for rule in found.contacts]
    assert {"box", "table"} in said
    assert {"panda_link0", "table"} in said
    robot = pdoik.Robot.builtin("panda")
    solver = pdoik.Solver(robot, pdoik.Options(clearance=0.02, max_time=np.inf, max_restarts=60))
    solver.attach_all(found.attached)
    assert solver.solve(placed(0.5, 0, 0.24, DOWN), obstacles=found.scene()).success
    with pytest.raises(pdoik.LoadError, match="links carry box, box/1"):
        pdoik.load_scene(path)
    content = carrying_scene()
    state = content["robot_state"]["attached_collision_objects"][0]
    state["object"]["header"]["frame_id"] = "world"
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(pdoik.LoadError, match=r"\(box\): is in the frame 'world'"):
        read_scene_file(path)


def test_an_srdf_gives_rules_in_moveits_order() -> None:
    text = """<robot name="panda">
      <disable_default_collisions link="panda_link7"/>
      <enable_collisions link1="panda_link7" link2="panda_link2"/>
      <disable_collisions link1="panda_link1" link2="panda_link3"/>
    </robot>"""
    rules = pdoik.load_srdf_contacts(text)
    assert rules == [
        Rule("panda_link7", "*", optional=True),
        Rule("panda_link7", "panda_link2", allowed=False, optional=True),
        Rule("panda_link1", "panda_link3", optional=True),
    ]
    wanted = Wanted([], rules)
    assert wanted.of(["table"], ["panda_link7"], 0.01) == ANY
    assert wanted.of(["panda_link2"], ["panda_link7"], 0.01) == 0.01
    robot = pdoik.Robot.builtin("panda")
    pairs = pdoik.load_srdf_pairs(text, robot)
    assert ("panda_link1", "panda_link3") in pairs
    off = {pair[1] for pair in pairs if pair[0] == "panda_link7"}
    assert off == set(robot.link_names) - {"panda_link7", "panda_link2"}
    with pytest.raises(pdoik.LoadError, match="the robot"):
        pdoik.load_srdf_pairs(text)


# Our own files, the command, and reports.

OWN = """
shapes:
  - {name: table, box: [0.6, 0.6, 0.04], position: [0.5, 0, 0.1]}
allowed: [[panda_link0, table]]
contacts:
  - {one: box, other: table, clearance: 0}
  - {one: "panda_link?", other: "t*", clearance: 0.03}
  - {one: panda_link8, other: table, allowed: 0.001}
  - {one: panda_link7, other: table, allowed: false}
  - {one: finger, other: table, allowed: true, optional: true}
attached:
  - link: [panda_link8]
    shapes: [{name: box, box: [0.06, 0.06, 0.06], position: [0, 0, 0.1]}]
    may_touch: [panda_link7]
    contacts: [{one: box, other: "panda_link[6]", allowed: true}]
"""


def test_our_yaml_says_them_and_they_are_saved(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(OWN)
    found = read_scene_file(path)
    rules = [
        Rule("panda_link0", "table"),
        Rule("box", "table", clearance=0),
        Rule("panda_link?", "t*", clearance=0.03),
        Rule("panda_link8", "table", allowed=0.001),
        Rule("panda_link7", "table", allowed=False),
        Rule("finger", "table", optional=True),
    ]
    assert list(found.contacts) == rules
    (thing,) = found.attached
    assert thing.links == ["panda_link8"]
    assert thing.contacts == [Rule("box", "panda_link[6]"), Rule("box", "panda_link7")]
    pdoik.save_scene(found.scene(), tmp_path / "again.yaml")
    assert pdoik.load_scene(tmp_path / "again.yaml").contacts == rules


@pytest.mark.parametrize(
    ("part", "says"),
    [
        ({"contacts": [{"one": "a"}]}, r"contacts\[0\]: expected {one, other"),
        ({"contacts": [{"one": "a", "other": 3}]}, r"contacts\[0\]: expected two names"),
        ({"contacts": [{"one": "a", "other": "b", "depth": 3}]}, r"contacts\[0\]: expected {one"),
        (
            {"contacts": [{"one": "a", "other": "b", "clearance": "x"}]},
            r"clearance: expected metres",
        ),
        (
            {"contacts": [{"one": "a", "other": "b", "clearance": True}]},
            "clearance: expected metres",
        ),
        (
            {"contacts": [{"one": "a", "other": "b", "allowed": "no"}]},
            "allowed: expected true, false",
        ),
        ({"contacts": [{"one": "a", "other": "b", "allowed": -1}]}, r"contacts\[0\]: .*depth"),
        ({"contacts": [{"one": "a", "other": "b", "optional": 1}]}, "optional: expected true or"),
        ({"contacts": 3}, "contacts: expected a list of rules"),
        ({"attached": 3}, "attached: expected a list"),
        ({"attached": [{"link": "a"}]}, r"attached\[0\]: expected {link, shapes}"),
        ({"attached": [{"link": 3, "shapes": []}]}, r"attached\[0\].link: expected names"),
        ({"attached": [{"link": "a", "shapes": [{}]}]}, r"attached\[0\].shapes\[0\]: has no name"),
    ],
)
def test_bad_rules_in_a_file_are_refused(tmp_path: Path, part: Any, says: str) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(yaml.safe_dump({"shapes": [], **part}))
    with pytest.raises(pdoik.LoadError, match=f"scene.yaml: {says}|{says}"):
        read_scene_file(path)


def test_the_command_solves_with_them_and_others_say_that_they_do_not(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(OWN)
    target = "0.5 0 0.2505 1 0 0 0"  # 0.5 mm above the table
    more = ["--max-time", "5", "--clearance", "0.02"]
    told = run("solve", "panda", "--target", target, "--scene", str(path), *more)
    assert told.exit_code == 0, told.output
    path.write_text(OWN.replace("clearance: 0}", "clearance: 0.01}"))
    told = run("solve", "panda", "--target", target, "--scene", str(path), *more)
    assert told.exit_code == 1
    assert "box to table" in told.output


def test_a_report_keeps_rules_and_what_two_links_carry(tmp_path: Path) -> None:
    robot = pdoik.Robot.builtin("panda")
    rng = np.random.default_rng(11)
    shapes = [
        pdoik.Shape.box("crate", (0.2, 0.2, 0.2), placed(0.5, 0.55, 0.4)),
        pdoik.Shape.box("crate/1", (0.2, 0.2, 0.2), placed(0.5, -0.4, 0.4)),
        pdoik.Shape.sphere("ball", (0.2, 0.6, 0.6), 0.15),
    ]
    points = rng.uniform([0.3, -0.6, 0.2], [0.8, 0.6, 1.0], (6, 3))
    rules = [
        *(Rule("*", "crate", clearance=0.1), Rule("panda_link5", "crate/1", clearance=-0.01)),
        *(Rule("panda_link?", "points", clearance=0.03), Rule("panda_link4", "points")),
        *(Rule("panda_link1", "panda_link6", clearance=0.12), Rule("ball", "panda_link7")),
        Rule("gone", "ball", optional=True),
    ]
    options = pdoik.Options(  # pieces are not the report's own code's
        clearance=0.01, max_time=np.inf, max_restarts=40, self_collision=True, exact_contact=False
    )
    solver = pdoik.Solver(robot, options)
    scene = pdoik.Scene(shapes, cloud=points, contacts=rules)
    q = np.array([0.3, 0.2, 0.0, -1.8, 0.0, 2.2, 0.8])
    path = tmp_path / "case.json"
    for carries in (False, True):
        if carries:
            cup = pdoik.Shape.cylinder("cup", 0.03, 0.1, placed(0, 0, 0.1))
            solver.attach(
                ["panda_link8", "panda_link5"], [cup], ["points"], [Rule("cup", "ball", allowed=0)]
            )
        pdoik.write_report(path, solver, robot.fk(q), obstacles=scene)
        replay = pdoik.replay_report(path)
        assert replay.same, replay.differences
        assert replay.faults == []
        (judged,) = replay.judged
        assert (judged.clearance is None) == carries
        result = solver.solve(robot.fk(q), obstacles=scene)
        assert result.success, result.message
        if not carries:
            assert not replay.unjudged
            assert (judged.room, judged.self_room) == pytest.approx((result.room, result.self_room))
            assert abs(judged.clearance - 0.01 - judged.room) > 1e-3
    # A judge who was told other rules would not believe it.
    solver.detach()
    pdoik.write_report(path, solver, robot.fk(q), obstacles=scene)
    spoiled = path.read_text().replace('"clearance": 0.1,', '"clearance": 0.5,')
    assert spoiled != path.read_text()
    path.write_text(spoiled)
    assert any("less than wanted" in fault for fault in pdoik.replay_report(path).faults)


def test_patterns_mean_what_fnmatch_says() -> None:
    robot = pdoik.Robot.builtin("panda")
    q = robot.mid_configuration()
    rng = np.random.default_rng(1)
    solver = pdoik.Solver(robot)
    for _ in range(60):
        name = "".join(rng.choice(list("ab/[]"), rng.integers(1, 6)))
        pattern = "".join(rng.choice(list("ab*?[]"), rng.integers(1, 6)))
        ball = pdoik.Shape.sphere(name, robot.fk(q)[:3, 3], 0.1)
        scene = pdoik.Scene([ball], contacts=[Rule("*", pattern, optional=True)])
        may = solver.judge(robot.fk(q), q, scene).clearance == np.inf
        assert may == fnmatchcase(name, pattern.replace("[", "[[]")), (name, pattern)
