"""A question and its answer in one file: the same answer from it, and what it says judged."""

from __future__ import annotations

import contextlib
import functools
import gzip
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

import pdoik
from command_line import misuse, run, solve
from pdoik.errors import LoadError
from pdoik.reports import Kinematics, segment_to_shape, to_spheroid
from random_urdf import random_urdf

PATIENT = {"max_time": 60.0, "max_restarts": 60}  # so that no clock ends a solve
Q = np.array([0.3, 0.4, 0.0, -1.8, 0.0, 2.2, 0.8])


@pytest.fixture
def case(tmp_path: Path) -> Path:
    return tmp_path / "case.json"


def panda(**options: Any) -> pdoik.Solver:
    return pdoik.Solver(pdoik.Robot.builtin("panda"), pdoik.Options(**{**PATIENT, **options}))


def points(seed: int = 0, count: int = 40) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.uniform([0.3, -0.5, 0.0, 0.0], [0.8, 0.5, 0.8, 0.02], (count, 4))


def placed(*xyz: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = Rotation.from_rotvec([0.3, -0.5, 0.7]).as_matrix()
    T[:3, 3] = xyz
    return T


SHAPES = [
    pdoik.Shape.box("box", [0.1, 0.2, 0.3], placed(0.7, 0.2, 0.1)),
    pdoik.Shape.sphere("ball", [0.5, 0.4, 0.6], 0.1),
    pdoik.Shape.cylinder("can", 0.05, 0.2, placed(0.6, -0.3, 0.2)),
    pdoik.Shape.capsule("pill", 0.05, 0.2, placed(0.1, 0.6, 0.5)),
    pdoik.Shape.half_space("floor", [0, 0.1, 1], [0, 0, -0.2]),
    pdoik.Shape.convex_mesh(
        "stone", np.random.default_rng(5).normal(size=(12, 3)) * 0.05, placed(0.2, -0.6, 0.3)
    ),
    pdoik.Shape.boxes(
        "bricks",
        [[0, 0, 0], [0.1, 0, 0]],
        [[0.1, 0.1, 0.1], [0.2, 0.1, 0.2]],
        placed(-0.6, 0.3, 0.2),
    ),
    pdoik.Shape.mesh(
        "wedge",
        [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]],
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        placed(-0.6, -0.3, 0.2),
    ),
    pdoik.Shape.distance_field(
        "map",
        np.linalg.norm(np.indices((12, 12, 12)) - 5.5, axis=0) * 0.02 - 0.05,
        0.02,
        placed(-0.2, 0.7, 0.2),
    ),
]


@functools.cache
def asked() -> dict[str, tuple[Any, Any, dict[str, Any]]]:
    """Questions of all kinds: what is asked, the targets, the rest."""
    solver = panda()
    robot = solver.robot
    T, goal = robot.fk(Q), pdoik.Goal(robot.fk(Q), type="axis", axis="x", rotation_slack=[0.1] * 3)
    carrying = panda()
    cup = pdoik.Shape.cylinder("cup", 0.03, 0.1, placed(0, 0, 0.1))
    carrying.attach("panda_link8", [cup], may_touch=["panda_link7"])
    tracker = pdoik.Tracker(solver, max_time=1.0, max_speed=np.full(7, 0.5))
    path = [robot.fk(Q + 0.002 * k) for k in range(12)]
    path[5] = np.full((4, 4), np.nan)
    many = np.array([robot.fk(Q + 0.1 * k) for k in range(6)])
    h1 = pdoik.Robot.builtin("h1", floating_base=([-1.0] * 6, [1.0] * 6))
    tips = {tip: h1.fk(0.5 * h1.mid_configuration() + 0.1, tip) for tip in h1.tip_links[:2]}
    feet = {"left_ankle_link": [(0.1, 0.05, -0.05), (-0.1, 0.05, -0.05), (0.0, -0.1, -0.05)]}
    balance = pdoik.Options(**PATIENT, balance=pdoik.Balance(contacts=feet))
    arm = pdoik.Robot.from_dh([pdoik.DhRow(d=0.3), pdoik.DhRow(alpha=1.5, a=0.2, d=0.3)])
    between = ("link1", (0, 0, 0), "tool", (0, 0, 0), 0.3)
    arm.occupancy = pdoik.Occupancy(spheres=[("link2", (0, 0, 0), 0.05)], spheroids=[between])
    position = pdoik.Solver(arm, pdoik.Options(**PATIENT, goal="position"))
    cloud = pdoik.Cloud(points(1))
    cloud.update(points(2)[:5, :3], [[0.3, -0.5, 0.0], [0.8, 0.5, 0.8]])
    allowed = [("panda_link0", "floor"), ("panda_link1", "box")]
    scene = pdoik.Scene(SHAPES, cloud=points(), allowed=allowed)
    return {
        "points": (solver, T, {"obstacles": points(), "q0": Q * 0.5}),
        "points of three": (solver, T, {"obstacles": points()[:, :3], "posture": Q * 0.9}),
        "updated cloud": (solver, T, {"obstacles": cloud}),
        "shapes": (solver, T, {"obstacles": SHAPES}),
        "scene": (solver, T, {"obstacles": scene}),
        "goal": (solver, goal, {"obstacles": points(3), "q0": Q, "max_step": np.full(7, 1.5)}),
        "impossible": (solver, T, {"obstacles": points(4, 3000)}),
        "paper": (panda(method="paper"), T, {"obstacles": points()}),
        "carrying": (carrying, T, {"obstacles": points()}),
        "batch": (solver, many, {"obstacles": points(), "q0": Q}),
        "steps": (tracker, path, {"obstacles": points(), "q0": Q, "posture": Q}),
        "humanoid": (pdoik.Solver(h1, balance), tips, {}),
        "spheroids": (position, arm.fk([0.2, 0.3])[:3, 3], {"obstacles": points()}),
    }


@pytest.mark.parametrize("name", asked())
def test_a_report_gives_the_same_answer_to_the_bit_and_holds(name: str, case: Path) -> None:
    solver, target, rest = asked()[name]
    pdoik.write_report(case, solver, target, note=name, **rest)
    replay = pdoik.replay_report(case)
    assert (replay.same, replay.clocked) == (True, []), replay.differences
    assert replay.faults == []
    assert replay.note == name
    assert json.loads(case.read_text())["by"]["simd"] == pdoik.simd_name()
    if isinstance(solver, pdoik.Solver) and name != "batch":
        result = solver.solve(target, **rest)
        assert replay.answers[0]["q"].tobytes() == result.q.tobytes()
        assert replay.answers[0]["clearance"] == result.clearance
    if name not in ("paper", "carrying", "humanoid", "spheroids"):
        assert not replay.unjudged
        judged = [each.clearance for each in replay.judged if each.clearance is not None]
        assert judged
        assert np.isfinite(judged).all()


def edited(case: Path, change: Callable[[Any], object]) -> pdoik.Replay:
    content = json.loads(case.read_text())
    change(content)
    case.write_text(json.dumps(content))
    return pdoik.replay_report(case)


def near_miss() -> tuple[pdoik.Solver, np.ndarray, np.ndarray]:
    """A solve whose answer is clear of a point by some centimetres."""
    solver = panda(clearance=0.01)
    T = solver.robot.fk(Q)
    return solver, T, T[:3, 3] + np.array([[0.2, 0.1, 0.3]])


@pytest.mark.parametrize(
    ("key", "value", "fault"),
    [
        ("position_error", 0.5, "says position error is 0.5 m; it is"),
        ("rotation_error", 0.5, "says rotation error is 0.5 rad; it is"),
        ("clearance", 0.5, "says clearance is 0.5 m; it is"),
        ("self_distance", 0.5, "says self distance is 0.5 m; it is"),
        ("limit_violation", 0.5, "says limit violation is 0.5 rad or m; it is"),
    ],
)
def test_a_false_figure_is_told(key: str, value: float, fault: str, case: Path) -> None:
    solver, T, obstacles = near_miss()
    pdoik.write_report(case, solver, T, obstacles=obstacles)
    replay = edited(case, lambda content: content["answers"][0].update({key: value}))
    assert not replay.same
    assert [each for each in replay.faults if each.startswith(fault)], replay.faults


def test_false_claims_of_success_are_told(case: Path) -> None:
    solver, T, obstacles = near_miss()
    pdoik.write_report(case, solver, T, obstacles=obstacles)
    q = json.loads(case.read_text())["answers"][0]["q"]
    tip = solver.robot.fk(q)[:3, 3].tolist()
    for change, words in (
        (lambda c: c["answers"][0]["q"].__setitem__(3, q[3] + 1e-4), "position error"),
        (lambda c: c["answers"][0]["q"].__setitem__(5, 9.0), "limit violation"),
        (lambda c: c["question"]["obstacles"].update(points=[tip]), "clearance"),
    ):
        pdoik.write_report(case, solver, T, obstacles=obstacles)
        replay = edited(case, change)
        claims = [each for each in replay.faults if each.startswith("claims success")]
        assert any(words in each for each in claims), replay.faults


def test_what_differs_is_told_with_what_may_be_why(case: Path) -> None:
    solver, T, obstacles = near_miss()
    pdoik.write_report(case, solver, T, obstacles=obstacles)

    def elsewhere(content: Any) -> None:
        content["by"] |= {"simd": "none", "core": "other", "processor": "Z80"}
        content["answers"][0]["q"][0] = float(np.nextafter(content["answers"][0]["q"][0], 1))
        content["answers"][0]["iterations"] += 1

    replay = edited(case, elsewhere)
    assert replay.differences[0].startswith("q differs by up to")
    assert replay.differences[1].startswith("iterations was")
    assert [reason.split(":")[0] for reason in replay.reasons] == [
        *("other instructions", "another build", "another processor")
    ]


def test_what_the_clock_ended_need_not_come_again(case: Path) -> None:
    solver = panda(max_time=1e-9)
    pdoik.write_report(case, solver, solver.robot.fk(Q), obstacles=points(4, 3000))
    replay = pdoik.replay_report(case)
    assert replay.answers[0]["status"] == "time_limit"
    assert (replay.clocked, replay.same, replay.faults) == ([0], True, [])


def test_a_result_that_was_given_is_the_one_in_the_report(case: Path) -> None:
    solver = panda()
    T = solver.robot.fk(Q)
    result = solver.solve(T, q0=Q * 0.8)
    pdoik.write_report(case, solver, T, result=result)  # from another start than it says
    replay = pdoik.replay_report(case)
    assert replay.answers[0]["q"].tobytes() == result.q.tobytes()
    assert not replay.same
    assert not replay.faults
    batch = solver.solve_batch(T[None])
    with pytest.raises(ValueError, match="result is BatchResult, expected a Result"):
        pdoik.write_report(case, solver, T, result=batch)
    with pytest.raises(ValueError, match="q0 is where a tracker was reset to"):
        pdoik.write_report(case, pdoik.Tracker(solver), [T])


def test_its_kinematics_are_those_of_another_library() -> None:
    pin = pytest.importorskip("pinocchio")
    for seed in range(6):
        rng = np.random.default_rng(seed)
        text = random_urdf(rng).xml
        robot = pdoik.Robot.from_urdf(text)
        model = pin.buildModelFromXML(text, mimic=False)
        data, kinematics = model.createData(), Kinematics(robot)
        q = rng.uniform(-1, 1, robot.dof)
        whole = pin.neutral(model)
        for name in model.names[1:]:
            joint = model.joints[model.getJointId(name)]
            x = kinematics.position(name, q)
            whole[joint.idx_q : joint.idx_q + joint.nq] = (
                x if joint.nq == 1 else (np.cos(x), np.sin(x))
            )
        pin.framesForwardKinematics(model, data, whole)
        for link, T in kinematics.poses(q).items():
            frame = model.getFrameId(link, pin.FrameType.BODY)
            np.testing.assert_allclose(T, data.oMf[frame].homogeneous, atol=1e-12)


def test_its_distances_are_those_of_many_samples() -> None:
    rng = np.random.default_rng(0)
    a, b, semi_major = np.array([0.1, 0.2, 0.3]), np.array([0.4, -0.1, 0.3]), 0.3
    directions = rng.normal(size=(200_000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    half = np.linalg.norm(b - a) / 2
    axis = (b - a) / np.linalg.norm(b - a)
    minor = np.sqrt(semi_major**2 - half**2)
    along = directions @ axis
    surface = (a + b) / 2 + minor * directions + (semi_major - minor) * along[:, None] * axis
    for point in rng.uniform(-0.6, 0.9, (8, 3)):
        nearest = np.linalg.norm(surface - point, axis=1).min()
        inside = np.linalg.norm(point - a) + np.linalg.norm(point - b) < 2 * semi_major
        found = to_spheroid(point[None], a, b, semi_major)[0]
        assert found == pytest.approx(-nearest if inside else nearest, abs=3e-3)
    mesh = next(shape for shape in SHAPES if shape.name == "wedge")
    corners = mesh.vertices @ mesh.T_base_shape[:3, :3].T + mesh.T_base_shape[:3, 3]
    weights = rng.dirichlet(np.full(3, 1.0), 1000)
    skin = np.concatenate([weights @ corners[triangle] for triangle in mesh.triangles])
    solid = Delaunay(corners)
    for _ in range(8):
        p, q = corners.mean(axis=0) + rng.uniform(-0.3, 0.3, (2, 3))
        way = p + np.linspace(0, 1, 60)[:, None] * (q - p)
        found = segment_to_shape(p, q, mesh)
        assert (found < 0) == (solid.find_simplex(way) >= 0).any() or abs(found) < 1e-3
        if found > 0:
            nearest = min(np.linalg.norm(skin - each, axis=1).min() for each in way)
            assert found == pytest.approx(nearest, abs=5e-3)


GARBAGE = {
    "no JSON": ("{", "no report"),
    "a list": ("[]", "expected the entry 'pdoik_report'"),
    "newer": ('{"pdoik_report": 99}', "a newer pdoik's"),
    "twice": ('{"pdoik_report": 1, "pdoik_report": 1}', "given twice"),
    "deep": ("[" * 100_000, "no report"),
    "little": ('{"pdoik_report": 1}', "robot: is missing"),
}


@pytest.mark.parametrize("name", GARBAGE)
def test_garbage_is_no_report(name: str, case: Path) -> None:
    text, words = GARBAGE[name]
    case.write_text(text)
    with pytest.raises(LoadError, match=words) as caught:
        pdoik.replay_report(case)
    assert "case.json" in str(caught.value)


def mutations(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The paths of all values, of a list those of its first entry."""
    if not isinstance(value, dict | list):
        return [path]
    inner = value.items() if isinstance(value, dict) else list(enumerate(value))[:1]
    return [path, *(each for key, part in inner for each in mutations(part, (*path, key)))]


@pytest.mark.parametrize("kind", ["solve", "steps"])
def test_whatever_entry_is_spoiled_the_complaint_is_a_load_error(kind: str, case: Path) -> None:
    arm = pdoik.Robot.from_dh([pdoik.DhRow(d=0.1, a=0.2)] * 2)
    options = pdoik.Options(max_restarts=1, ignore_obstacles_without_hulls=True)
    solver = pdoik.Solver(arm, options)
    if kind == "solve":
        solver.attach("link2", [pdoik.Shape.box("cup", [0.1, 0.1, 0.1])])
        allowed = [("link1", "stone", 0.1)]
        scene = pdoik.Scene([SHAPES[5]], cloud=points()[:3], allowed=allowed)
        pdoik.write_report(case, solver, pdoik.Goal(np.eye(4)), q0=[0.1, 0.2], obstacles=scene)
    else:
        steps = {"q0": [0.1, 0.2], "obstacles": points()[:3]}
        pdoik.write_report(case, pdoik.Tracker(solver), [arm.fk([0.1, 0.2])] * 2, **steps)
    content = json.loads(case.read_text())
    tried = 0
    for path in mutations(content)[1:]:
        for junk in (None, "junk", 1e300):
            spoiled = json.loads(json.dumps(content))
            at = spoiled
            for key in path[:-1]:
                at = at[key]
            at[path[-1]] = junk
            case.write_text(json.dumps(spoiled))
            tried += 1
            with contextlib.suppress(LoadError):
                pdoik.replay_report(case)
    assert tried > 300


def test_a_report_is_whole_or_not_there(case: Path) -> None:
    solver = panda()
    pdoik.write_report(case, solver, solver.robot.fk(Q))
    before = case.read_bytes()
    with pytest.raises(ValueError, match="T_base_tip has a last row"):
        pdoik.write_report(case, solver, np.ones((4, 4)))
    with pytest.raises(ValueError, match=r"ends in .json or .json.gz, got 'case.yaml'"):
        pdoik.write_report(case.with_suffix(".yaml"), solver, solver.robot.fk(Q))
    assert case.read_bytes() == before
    assert [each.name for each in case.parent.iterdir()] == ["case.json"]
    packed = case.with_name("case.json.gz")
    pdoik.write_report(packed, solver, solver.robot.fk(Q))
    assert gzip.decompress(packed.read_bytes()).startswith(b'{\n "pdoik_report": 2')
    assert pdoik.replay_report(packed).same
    packed.write_bytes(packed.read_bytes()[:500])
    with pytest.raises(LoadError, match="cannot read"):
        pdoik.replay_report(packed)


def test_the_command_line_writes_reports_and_asks_them_again(tmp_path: Path) -> None:
    cloud, case = tmp_path / "scan.npy", tmp_path / "case.json"
    np.save(cloud, points()[:, :3])
    solved = solve("--cloud", cloud, "--report", case, target="0.45 0.1 0.5 1 0 0 0")
    assert f"pdoik report {case}" in solved.stderr
    again = run("report", case)
    assert again.exit_code == 0, again.output
    for words in ("a solve of panda", "the same answer, to the bit", "hold, by other code"):
        assert words in again.stdout
    facts = json.loads(run("report", case, "--json").stdout)
    assert facts["same"]
    assert facts["answers"] == facts["again"] or facts["answers"][0]["q"] == facts["again"][0]["q"]
    content = json.loads(case.read_text())
    content["answers"][0]["clearance"] += 0.01
    case.write_text(json.dumps(content))
    wrong = run("report", case)
    assert wrong.exit_code == 1
    assert "not the same answer" in wrong.stdout
    assert "says clearance is" in wrong.stdout
    misuse(run("report", tmp_path / "nix.json"), "nix.json", "No such file")
    misuse(run("report", case, "--urdf", tmp_path / "arm.urdf"), "holds no URDF")
    misuse(solve("--report", tmp_path / "case.zip"), "--report", ".json.gz")
    misuse(solve("--report", tmp_path / "no" / "case.json"), "--report", "no folder")


def test_the_urdf_goes_along_and_a_robot_that_is_not_its_own_is_told(tmp_path: Path) -> None:
    arm, case = tmp_path / "arm.urdf", tmp_path / "case.json"
    robots = Path(pdoik.__file__).parent / "robots"
    arm.write_text((robots / "ur10.urdf").read_text())
    words = ("--robot", arm, "--target", "0.5 0.2 0.5 1 0 0 0", "--max-time", "5")
    assert run("solve", *words, "--report", case).exit_code == 0
    assert pdoik.replay_report(case).faults == []
    assert run("report", case, "--urdf", tmp_path / "out.urdf").exit_code == 0
    assert (tmp_path / "out.urdf").read_text() == arm.read_text()

    def longer(content: Any) -> None:
        content["robot"]["joints"][1]["T_parent_child"][2][3] += 0.01

    name = json.loads(case.read_text())["robot"]["joints"][1]["name"]
    assert f"origin of joint {name} is not the URDF's" in edited(case, longer).faults
