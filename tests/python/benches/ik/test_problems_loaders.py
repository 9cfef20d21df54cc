"""Published problem sets are read as they are, and refused by file and entry."""

from __future__ import annotations

import pickle
import tarfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("coal")
pytest.importorskip("pinocchio")

import trimesh

from bench.ik.problems.held import given_by_user
from bench.ik.problems.judge import Judge
from bench.ik.problems.loaders import LoaderError, read_problems
from bench.ik.problems.problem import load, save
from bench.ik.problems.robots import robot_files
from polygon_files import FORMATS, ply_bytes, prism
from problem_sets import (
    READY,
    planning_scene,
    request,
    vamp_sets,
    write_moveit,
    write_pcd,
    write_vamp,
)

PANDA = robot_files("panda")
NORMALS = "x y z normal_x normal_y normal_z curvature"


@pytest.fixture(scope="module")
def judge() -> Judge:
    return Judge(PANDA, "collision")


def test_a_moveit_folder_gives_its_shapes_and_the_goals_pose(tmp_path: Path, judge: Judge) -> None:
    folder = write_moveit(tmp_path / "box_panda", planning_scene(), request())
    (problem,) = read_problems(folder, PANDA)["box_panda"]
    solids = {solid.name: solid for solid in problem.solids}
    assert list(solids) == ["shelf", "can", "ball", "cone", "table", "chips/0", "chips/1", "floor"]
    assert solids["shelf"].size == (0.4, 0.6, 0.04)
    assert solids["can"].kind == "cylinder"
    assert solids["can"].size == (0.03, 0.14)  # the file has height, then radius
    assert solids["ball"].size == (0.05,)
    assert np.ptp(solids["cone"].vertices[:, 2]) == pytest.approx(0.2)
    np.testing.assert_allclose(solids["table"].T[:3, 3], (1, 0, 0.6))  # frame, object, piece
    np.testing.assert_allclose(solids["chips/1"].T[:3, 3], (0.9, 0.3, 0.8))
    np.testing.assert_allclose(solids["floor"].T[:3, 3], (0, 0, -1))  # 2 z + 2 = 0
    assert problem.allowed == {("panda_hand", "shelf")}
    np.testing.assert_allclose(problem.goal_q, READY)
    T = problem.targets["panda_hand_tcp"]
    np.testing.assert_allclose(T, judge.fk(np.array(READY), "panda_hand_tcp"))


def test_folders_of_folders_and_archives_are_sets_in_order(tmp_path: Path) -> None:
    for number in (2, 10, 1):
        write_moveit(tmp_path / "in/cage_panda", planning_scene(), request(), number)
    write_moveit(tmp_path / "in/box_panda", planning_scene(), request())
    with tarfile.open(tmp_path / "problems.tar.bz2", "w:bz2") as archive:
        archive.add(tmp_path / "in", "problems")
    for path in (tmp_path / "in", tmp_path / "problems.tar.bz2"):
        sets = read_problems(path, PANDA)
        names = [problem.name for problem in sets["cage_panda"]]
        assert names == [f"cage_panda/scene{number:04d}" for number in (1, 2, 10)]
        assert len(sets["box_panda"]) == 1


def test_a_goal_given_as_a_pose_of_the_flange_is_turned_into_the_tools(
    tmp_path: Path, judge: Judge
) -> None:
    q = np.array(READY)
    T = judge.fk(q, "panda_link8")
    xyzw = trimesh.transformations.quaternion_from_matrix(T)[[1, 2, 3, 0]].tolist()
    region = {"primitive_poses": [{"position": T[:3, 3].tolist(), "orientation": [0, 0, 0, 1]}]}
    asked = request()
    asked["goal_constraints"] = [
        {
            "position_constraints": [{"link_name": "panda_link8", "constraint_region": region}],
            "orientation_constraints": [{"link_name": "panda_link8", "orientation": xyzw}],
        }
    ]
    folder = write_moveit(tmp_path / "posed", planning_scene(), asked)
    (problem,) = read_problems(folder, PANDA)["posed"]
    assert problem.goal_q is None
    expected = judge.fk(q, "panda_hand_tcp")
    np.testing.assert_allclose(problem.targets["panda_hand_tcp"], expected, atol=1e-9)


FINGERS = ["panda_finger_joint1", "panda_finger_joint2"]


def with_fingers(opening: list[float]) -> Any:
    """A request as MotionBenchMaker's sets have it: the start tells of the fingers, too."""
    asked = request()
    state = asked["start_state"]["joint_state"]
    state["name"] = [*state["name"], *FINGERS[: len(opening)], "virtual_gripper_joint"]
    state["position"] = [*state["position"], *opening, 0.8]
    return asked


def test_joints_that_nobody_moves_are_held_where_the_set_says(tmp_path: Path, judge: Judge) -> None:
    scene = planning_scene()
    folder = write_moveit(tmp_path / "cage_panda", scene, with_fingers([0.065, 0.03]), 1)
    write_moveit(folder, scene, with_fingers([0.065]), 2)  # the second finger follows the first
    write_moveit(folder, scene, request(), 3)
    state = {"joint_state": {"name": FINGERS, "position": [0.01, 0.02]}}
    write_moveit(folder, {**scene, "robot_state": state}, request(), 4)
    problems = read_problems(folder, PANDA)["cage_panda"]
    said = [(0.065, 0.03), (0.065, 0.065), (), (0.01, 0.02)]
    assert [p.held for p in problems] == [dict(zip(FINGERS, each, strict=False)) for each in said]
    for problem in problems:
        files = PANDA.standing(problem.held, judge.joint_names)
        held = Judge(files, "collision")
        assert held.joint_names == judge.joint_names  # the arm's alone
        T_hand_finger = np.linalg.inv(held.fk(problem.goal_q, "panda_hand")) @ held.fk(
            problem.goal_q, "panda_leftfinger"
        )
        opening = problem.held.get("panda_finger_joint1", 0.04)
        np.testing.assert_allclose(T_hand_finger[:3, 3], (0, opening, 0.0584), atol=1e-9)
        np.testing.assert_allclose(problem.goal_q, READY)
        save(tmp_path / "kept.json", [problem])
        assert load(tmp_path / "kept.json")[0].held == problem.held


def test_what_the_user_holds_stands_whatever_the_set_says(tmp_path: Path) -> None:
    folder = write_moveit(tmp_path / "cage_panda", planning_scene(), with_fingers([0.065, 0.03]))
    files = replace(PANDA, told={"panda_finger_joint1": 0.02})
    (problem,) = read_problems(folder, files)["cage_panda"]
    assert problem.held == {"panda_finger_joint2": 0.03}
    still = files.standing(problem.held, []).still
    assert still == {"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.03}
    with pytest.raises(ValueError, match="no joint 'panda_finger' to hold"):
        given_by_user(PANDA, {"panda_finger": 0.02})


def test_a_robots_other_joints_need_no_hold_where_the_set_tells_them(tmp_path: Path) -> None:
    folder = write_moveit(tmp_path / "cage_panda", planning_scene(), with_fingers([0.065, 0.065]))
    files = replace(PANDA, held={})  # as of --urdf, where nobody knows of fingers
    arm = [f"panda_joint{k}" for k in range(1, 8)][::-1]
    (problem,) = read_problems(folder, files, arm)["cage_panda"]
    np.testing.assert_allclose(problem.goal_q, READY[::-1])
    assert problem.held == dict.fromkeys(FINGERS, 0.065)


@pytest.mark.parametrize(
    ("state", "says"),
    [
        ({"name": FINGERS, "position": [0.1]}, r"start_state.joint_state: 2 names, 1 positions"),
        (
            {"name": FINGERS, "position": [0.1, None]},
            r"start_state.joint_state.position\[1\]: expected",
        ),
        ([0.1], r"start_state.joint_state: expected name and position"),
    ],
)
def test_a_bad_state_is_refused(tmp_path: Path, state: Any, says: str) -> None:
    asked = {**request(), "start_state": {"joint_state": state}}
    folder = write_moveit(tmp_path / "bad", planning_scene(), asked)
    with pytest.raises(LoaderError, match=f"request0001.yaml: {says}"):
        read_problems(folder, PANDA)


def test_an_octomap_is_its_boxes(tmp_path: Path) -> None:
    # The root's first child has one child that is taken: a cube of 16384 cells along an edge.
    octomap = {"binary": True, "id": "OcTree", "resolution": 2e-5, "data": [3, 0, 2, 0]}
    scene = {"world": {"collision_objects": [], "octomap": {"octomap": octomap}}}
    folder = write_moveit(tmp_path / "mapped", scene, request())
    (problem,) = read_problems(folder, PANDA)["mapped"]
    (solid,) = problem.solids
    assert (solid.name, solid.kind) == ("<octomap>/0", "box")
    np.testing.assert_allclose(solid.size, [0.32768] * 3)
    np.testing.assert_allclose(solid.T[:3, 3], [-0.65536 + 0.16384] * 3)


@pytest.mark.parametrize("suffix", [".json", ".pkl"])
def test_vamps_problems_are_the_same_by_either_file(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"problems{suffix}"
    if suffix == ".json":
        write_vamp(path)
    else:
        path.write_bytes(pickle.dumps(vamp_sets()))
    (problem,) = read_problems(path, PANDA)["box"]
    ball, can, wall = problem.solids
    assert (ball.size, can.size, wall.size) == ((0.1,), (0.03, 0.14), (0.2, 0.4, 0.6))
    turn = [[np.cos(0.6), -np.sin(0.6)], [np.sin(0.6), np.cos(0.6)]]
    np.testing.assert_allclose(can.T[:2, :2], turn)
    np.testing.assert_allclose(wall.T[:2, :2], turn)  # the quaternion, not the angles
    np.testing.assert_allclose(problem.goal_q, READY)


def test_a_pickle_that_would_run_something_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "problems.pkl"
    path.write_bytes(pickle.dumps({"problems": Path}))
    with pytest.raises(LoaderError, match=r"problems.pkl: cannot be read: holds a pathlib"):
        read_problems(path, PANDA)


def test_ebikes_scenarios_give_a_target_for_each_point(tmp_path: Path) -> None:
    top = trimesh.creation.box((1, 1, 0.02))
    leg = trimesh.creation.box((0.05, 0.05, 0.5))
    leg.apply_translation((0, 0, -0.4))
    trimesh.util.concatenate([top, leg]).export(tmp_path / "table.ply")
    write_pcd(tmp_path / "table.pcd", [[0.1, 0.2, 0.01, 0, 0, 1, 0]], NORMALS)
    write_pcd(tmp_path / "random.pcd", [[0.5, 0, 0.5, 1, 0, 0, 0]] * 3, NORMALS)
    files = robot_files("ur10")
    sets = read_problems(tmp_path, files)
    assert {name: len(problems) for name, problems in sets.items()} == {"random": 3, "table": 1}
    (problem,) = sets["table"]
    assert [solid.name for solid in problem.solids] == ["table/0", "table/1"]
    assert ("wrist_3_link", "table/0") in problem.allowed
    T = problem.targets["tool0"]
    np.testing.assert_allclose(T[:3, 3], (0.1, 0.2, 0.01), atol=1e-6)
    np.testing.assert_allclose(T[:3, 2], (0, 0, -1))  # against the normal
    assert sets["random"][0].solids == ()


@pytest.mark.parametrize("layout", FORMATS)
def test_ebikes_meshes_may_have_faces_of_many_corners(tmp_path: Path, layout: str) -> None:
    ell = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
    vertices, faces = prism(ell, 0.5)
    apart = [[corner + len(vertices) for corner in face] for face in faces]
    corners = np.vstack([vertices, vertices + np.array([5, 0, 0])])
    content = ply_bytes(corners, faces + apart, layout)
    (tmp_path / "two.ply").write_bytes(content)
    write_pcd(tmp_path / "two.pcd", [[0.1, 0.2, 0.5, 0, 0, 1, 0]], NORMALS)
    (problem,) = read_problems(tmp_path, robot_files("ur10"))["two"]
    assert [solid.name for solid in problem.solids] == ["two/0", "two/1"]
    assert [solid.surface().volume for solid in problem.solids] == pytest.approx([1.5, 1.5])
    (tmp_path / "two.ply").write_bytes(content[:-7])
    with pytest.raises(LoaderError, match=r"two.ply: not a mesh .* cut short"):
        read_problems(tmp_path, robot_files("ur10"))


def test_what_is_saved_is_read_back(tmp_path: Path) -> None:
    folder = write_moveit(tmp_path / "box_panda", planning_scene(), request())
    (problem,) = read_problems(folder, PANDA)["box_panda"]
    save(tmp_path / "kept.json", [problem])
    (kept,) = load(tmp_path / "kept.json")
    assert (kept.name, kept.allowed) == (problem.name, problem.allowed)
    np.testing.assert_array_equal(kept.goal_q, problem.goal_q)
    for mine, theirs in zip(kept.solids, problem.solids, strict=True):
        assert (mine.name, mine.kind, mine.size) == (theirs.name, theirs.kind, theirs.size)
        np.testing.assert_array_equal(mine.sample(0.05), theirs.sample(0.05))


CUP = {"link_name": "panda_hand", "object": {"id": "cup"}}
OBJECTS = "scene world collision_objects"
JOINTS = "request goal_constraints 0 joint_constraints"


@pytest.mark.parametrize(
    ("where", "value", "said"),
    [
        (f"{OBJECTS} 0 primitives 0 type", "torus", r"scene0001.*\[0\] \(shelf\).*'torus'"),
        (f"{OBJECTS} 1 primitives 0 dimensions", [1], r"\[1\] \(can\).*dimensions: expected 2"),
        (f"{OBJECTS} 1 primitives 0 dimensions", [1, -1], r"scene0001.*\(can\).*positive"),
        (f"{OBJECTS} 1 primitive_poses", [{}, {}], r"\(can\): 1 of primitive, 2 poses"),
        (f"{OBJECTS} 1 primitive_poses 0 position", [1, "x", 2], r"poses\[0\].position: expected"),
        (f"{OBJECTS} 5 meshes 0 triangles 0", [0, 1, 9], r"\(chips\).*vertex that is not there"),
        (f"{OBJECTS} 0 header frame_id", "panda_link5", r"\(shelf\).*link 'panda_link5'"),
        ("scene world", {}, r"scene0001.yaml: world: has no collision_objects"),
        ("scene robot_state", {"attached_collision_objects": [CUP]}, r"robot_state: attached"),
        ("request goal_constraints", [], r"request0001.yaml: goal_constraints: has no goal"),
        (f"{JOINTS} 2 position", None, r"request0001.yaml: .*joint_constraints\[2\].position"),
        (f"{JOINTS} 2", {"position": 1}, r"request0001.yaml: .*\[2\]: has no joint_name"),
    ],
)
def test_a_bad_moveit_file_is_refused_by_file_and_entry(
    tmp_path: Path, where: str, value: Any, said: str
) -> None:
    content: Any = {"scene": planning_scene(), "request": request()}
    *path, last = (int(word) if word.isdigit() else word for word in where.split())
    thing = content
    for step in path:
        thing = thing[step]
    thing[last] = value
    folder = write_moveit(tmp_path / "bad", content["scene"], content["request"])
    with pytest.raises(LoaderError, match=said):
        read_problems(folder, PANDA)


def test_other_files_are_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(LoaderError, match="nowhere: no such file"):
        read_problems(tmp_path / "nowhere", PANDA)
    with pytest.raises(LoaderError, match="neither scene"):
        read_problems(tmp_path, PANDA)
    (tmp_path / "scene0001.yaml").write_text("a: [1")
    with pytest.raises(LoaderError, match=r"scene0001.yaml: its request"):
        read_problems(tmp_path, PANDA)
    (tmp_path / "request0001.yaml").write_text("{}")
    with pytest.raises(LoaderError, match=r"scene0001.yaml: not YAML"):
        read_problems(tmp_path, PANDA)


def test_vamp_of_another_robot_and_without_a_radius_is_refused(tmp_path: Path) -> None:
    path = write_vamp(tmp_path / "problems.json")
    with pytest.raises(LoaderError, match=r"problems.json: robot: is for 'panda', not 'ur5'"):
        read_problems(path, robot_files("ur5"))
    path.write_text(path.read_text().replace('"radius": 0.03', '"radios": 0.03'))
    with pytest.raises(LoaderError, match=r"box\[0\].cylinder\[0\].radius"):
        read_problems(path, PANDA)


def test_targets_without_normals_are_refused(tmp_path: Path) -> None:
    write_pcd(tmp_path / "table.pcd", [[0, 0, 0]], "x y z")
    with pytest.raises(LoaderError, match=r"table.pcd: has no fields \['normal_x'"):
        read_problems(tmp_path, robot_files("ur10"))
    write_pcd(tmp_path / "table.pcd", [[0, 0, 0, 0, 0, 0, 0]], NORMALS)
    with pytest.raises(LoaderError, match=r"table.pcd: point 0"):
        read_problems(tmp_path, robot_files("ur10"))
