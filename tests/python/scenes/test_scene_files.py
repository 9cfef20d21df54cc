"""Scenes from files: what they hold comes out, what cannot be is refused by file and entry."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
import yaml

import pdoik
from pdoik.scenes import read_scene_file
from problem_sets import planning_scene

XYZW = [0.0, 0.0, 0.6, 0.8]  # of a turn about z, by this:
TURN = np.array([[0.28, -0.96, 0.0], [0.96, 0.28, 0.0], [0.0, 0.0, 1.0]])
CORNERS = [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def shapes(scene: pdoik.Scene) -> dict[str, pdoik.Shape]:
    return {shape.name: shape for shape in scene.shapes}


def at(x: float, y: float, z: float, R: Any = None) -> Any:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    T[:3, :3] = np.eye(3) if R is None else R
    return T


def written(folder: Path, content: Any, name: str = "scene.yaml") -> Path:
    path = folder / name
    path.write_text(content if isinstance(content, str) else yaml.safe_dump(content))
    return path


# Our own YAML.

OWN = """
shapes:
  - {name: table, box: [1, 0.8, 0.05], position: [0.5, 0, -0.03], rpy: [0.1, 0.2, 0.3]}
  - {name: ball, sphere: 0.1, position: [0, 0, 1]}
  - {name: can, cylinder: {radius: 0.03, length: 0.12}, position: [1, 2, 3], xyzw: [0, 0, 0.6, 0.8]}
  - {name: pill, capsule: {radius: 0.02, length: 0.1},
     T: [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]}
  - {name: wall, half_space: {normal: [-2, 0, 0], point: [1.5, 5, 0]}}
  - {name: rock, convex_mesh: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}}
  - {name: part, convex_mesh: {file: meshes/part.stl}, position: [0, 0, 2]}
cloud: scan.xyz
leaf: 0.1
radii: true
allowed: [[panda_link0, table]]
"""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((0.2, 0.3, 0.4)).export(tmp_path / "meshes/part.stl")
    (tmp_path / "scan.xyz").write_text("3 0 0.01\n3 0 0.02\n4 0 0\n")
    return written(tmp_path, OWN)


def test_our_yaml_gives_every_kind_where_it_says(own: Path) -> None:
    scene = pdoik.load_scene(own)
    found = shapes(scene)
    assert [shape.kind for shape in scene.shapes] == [
        *("box", "sphere", "cylinder", "capsule", "half_space", "convex_mesh", "convex_mesh")
    ]
    assert [list(found[name].size) for name in ("table", "ball", "can", "pill")] == [
        *([1, 0.8, 0.05], [0.1], [0.03, 0.12], [0.02, 0.1])
    ]
    about_z = trimesh.transformations.rotation_matrix
    R = about_z(0.3, [0, 0, 1]) @ about_z(0.2, [0, 1, 0]) @ about_z(0.1, [1, 0, 0])  # as in URDF
    np.testing.assert_allclose(found["table"].T_base_shape, at(0.5, 0, -0.03, R[:3, :3]))
    np.testing.assert_allclose(found["ball"].T_base_shape[:3, 3], (0, 0, 1))
    np.testing.assert_allclose(found["can"].T_base_shape, at(1, 2, 3, TURN), atol=1e-12)
    np.testing.assert_allclose(
        found["pill"].T_base_shape, at(1, 2, 3, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    )
    np.testing.assert_allclose(found["wall"].T_base_shape[:3, 2], (-1, 0, 0), atol=1e-12)
    assert found["wall"].T_base_shape[0, 3] == pytest.approx(1.5)
    np.testing.assert_array_equal(np.sort(found["rock"].vertices, axis=0)[-1], 1)
    assert found["part"].vertices.shape == (8, 3)
    np.testing.assert_allclose(found["part"].T_base_shape, at(0, 0, 2))
    assert scene.allowed == [("panda_link0", "table")]
    assert scene.cloud is not None
    assert scene.cloud.points.shape == (2, 4)  # thinned, with radii
    assert len(read_scene_file(own).surface) == 3


def test_what_is_saved_is_loaded_again(own: Path, tmp_path: Path) -> None:
    scene = pdoik.load_scene(own)
    pdoik.save_scene(scene, tmp_path / "again.yaml")
    again = pdoik.load_scene(tmp_path / "again.yaml")
    assert again.cloud is None
    assert again.allowed == scene.allowed
    assert len(again.shapes) == len(scene.shapes)
    for mine, theirs in zip(scene.shapes, again.shapes, strict=True):
        assert (mine.name, mine.kind, mine.size) == (theirs.name, theirs.kind, theirs.size)
        np.testing.assert_allclose(mine.T_base_shape, theirs.T_base_shape, atol=1e-14)
        np.testing.assert_array_equal(mine.vertices, theirs.vertices)
        np.testing.assert_array_equal(mine.triangles, theirs.triangles)
    assert [file.name for file in tmp_path.glob(".*")] == []


# MoveIt's .scene.

TETRAHEDRON = "mesh\n4 4\n" + "".join(" ".join(map(str, row)) + "\n" for row in CORNERS + FACES)
OLD = f"""(noname)+
* shelf board
2
box
0.4 0.6 0.04
0.8 0 0.3
0 0 0.6 0.8
0 0 1 0.3
cylinder
0.03 0.14
0.7 0 0.4
0 0 0 1
0 0 0 0
* rock
1
{TETRAHEDRON}0 0 1
0 0 0 1
0 0 0 0
* rest
3
sphere
0.05
1 2 3
0 0 0 1
0 0 0 0
cone
0.05 0.2
0 0 0.5
0 0 0 1
0 0 0 0
plane
0 0 2 1
0 0 0
0 0 0 1
0 0 0 0
.
"""
NEW = """scene
* shelf
1 0 0
0 0 0.6 0.8
2
box
0.4 0.6 0.04
0.5 0 0
0 0 0 1
0 0 0 0
plane
1 0 0 -0.25
0 0 0
0 0 0 1
0 0 0 0
1
the handle
0 0 0
0 0 0 1
* ball
0 0 0
0 0 0 1
1
sphere
0.05
1 2 3
0 0 0 1
0 0 0 0
0
.
"""


def test_moveits_older_text_gives_every_type(tmp_path: Path) -> None:
    found = shapes(pdoik.load_scene(written(tmp_path, OLD, "old.scene")))
    assert list(found) == ["shelf board", "shelf board/1", "rock", "rest", "rest/1", "rest/2"]
    assert list(found["shelf board"].size) == [0.4, 0.6, 0.04]
    np.testing.assert_allclose(found["shelf board"].T_base_shape, at(0.8, 0, 0.3, TURN))
    assert list(found["shelf board/1"].size) == [0.03, 0.14]
    assert sorted(found["rock"].vertices.tolist()) == sorted(CORNERS)
    np.testing.assert_allclose(found["rock"].T_base_shape, at(0, 0, 1))
    np.testing.assert_allclose(found["rest"].T_base_shape[:3, 3], (1, 2, 3))
    cone = found["rest/1"].vertices
    tip = cone[cone[:, 2].argmax()]
    np.testing.assert_allclose(tip, (0, 0, 0.1), atol=1e-12)
    radii = np.linalg.norm(cone[cone[:, 2] < 0][:, :2], axis=1)
    assert radii.min() >= 0.05 - 1e-12 or radii.min() == 0  # around the cone
    assert radii.max() < 0.0502
    assert found["rest/2"].kind == "half_space"
    np.testing.assert_allclose(found["rest/2"].T_base_shape[:3, 2:].T, [(0, 0, 1), (0, 0, -0.5)])


def test_moveits_newer_text_places_shapes_in_their_object(tmp_path: Path) -> None:
    found = shapes(pdoik.load_scene(written(tmp_path, NEW, "new.scene")))
    assert list(found) == ["shelf", "shelf/1", "ball"]
    np.testing.assert_allclose(found["shelf"].T_base_shape, at(1.14, 0.48, 0, TURN))
    wall = found["shelf/1"].T_base_shape  # x = 0.25 in the object
    np.testing.assert_allclose(wall[:3, 2], TURN[:, 0], atol=1e-12)
    assert wall[:3, 3] @ TURN[:, 0] == pytest.approx(0.28 + 0.25)


# MoveIt's YAML.


def test_moveits_yaml_gives_objects_and_contacts(tmp_path: Path) -> None:
    scene = pdoik.load_scene(written(tmp_path, planning_scene()))
    found = shapes(scene)
    assert list(found) == ["shelf", "can", "ball", "cone", "table", "chips", "chips/1", "floor"]
    assert list(found["can"].size) == [0.03, 0.14]  # the file has height, then radius
    np.testing.assert_allclose(found["table"].T_base_shape[:3, 3], (1, 0, 0.6))
    np.testing.assert_allclose(found["chips/1"].T_base_shape[:3, 3], (0.9, 0.3, 0.8))
    np.testing.assert_allclose(found["floor"].T_base_shape[:3, 2:].T, [(0, 0, 1), (0, 0, -1)])
    assert scene.allowed == [("panda_hand", "panda_link7"), ("panda_hand", "shelf")]
    assert all(rule.optional for rule in scene.contacts)  # a robot may lack such links


def test_a_named_frame_is_the_base_and_others_are_refused(tmp_path: Path) -> None:
    content = planning_scene()
    path = written(tmp_path, content)
    with pytest.raises(pdoik.LoadError, match=r"\(shelf\): is in the frame 'panda_link0'"):
        pdoik.load_scene(path, frame="table_frame")
    for item in content["world"]["collision_objects"]:
        if item.get("header") == {"frame_id": "panda_link0"}:
            item["header"] = {"frame_id": "world"}
    found = shapes(pdoik.load_scene(written(tmp_path, content), frame="table_frame"))
    np.testing.assert_allclose(found["table"].T_base_shape[:3, 3], (1, 0, 0.1), atol=1e-12)
    np.testing.assert_allclose(found["shelf"].T_base_shape[:3, 3], (0.8, 0, -0.2))
    with pytest.raises(pdoik.LoadError, match="names no frames"):
        pdoik.load_scene(written(tmp_path, NEW, "new.scene"), frame="world")


@pytest.mark.parametrize("beside", [True, False])
def test_meshes_are_found_beside_the_scene_or_in_packages(tmp_path: Path, beside: bool) -> None:
    folder = tmp_path / "scenes" if beside else tmp_path / "packages/things"
    (folder / "meshes").mkdir(parents=True)
    for name in ("scenes", "packages"):
        (tmp_path / name).mkdir(exist_ok=True)
    trimesh.creation.box((1, 1, 1)).export(folder / "meshes/part.stl")
    mesh = {"resource": "package://things/meshes/part.stl", "dimensions": [0.1, 0.2, 0.3]}
    item = {"id": "part", "meshes": [mesh], "mesh_poses": [{"position": [1, 0, 0]}]}
    path = written(tmp_path / "scenes", {"world": {"collision_objects": [item]}})
    (part,) = pdoik.load_scene(path, packages=[tmp_path / "packages"]).shapes
    np.testing.assert_allclose(np.ptp(part.vertices, axis=0), (0.1, 0.2, 0.3))


# What is refused.


def test_meshes_that_are_open_or_not_convex_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, {"shapes": [{"name": "it", "convex_mesh": {"file": "it.stl"}}]})
    box = trimesh.creation.box((1, 1, 1))
    ell = trimesh.util.concatenate([box, box.copy().apply_translation((1.2, 0, 0))])
    ell.export(tmp_path / "it.stl")
    with pytest.raises(pdoik.LoadError, match=r"scene.yaml: shapes\[0\] \(it\).*not convex.*90.9%"):
        pdoik.load_scene(path)
    box.update_faces(np.arange(12) > 0)
    box.export(tmp_path / "it.stl")
    with pytest.raises(pdoik.LoadError, match=r"shapes\[0\] \(it\).*the mesh has holes"):
        pdoik.load_scene(path)


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ({"box": None}, r"shapes\[0\] \(it\).box: expected 3 numbers xyz"),
        ({"box": [1, 2]}, r"shapes\[0\] \(it\).box: expected 3 numbers"),
        ({"box": [1, -2, 1]}, r"shapes\[0\] \(it\): shape 'it'"),
        ({"sphere": float("nan")}, r"shapes\[0\] \(it\).sphere.radius: expected 1 numbers"),
        ({"cylinder": {"radius": 1}}, r"\(it\).cylinder: expected {radius, length}"),
        ({"capsule": [1, 2]}, r"\(it\).capsule: expected {radius, length}"),
        ({"cone": [1, 2]}, r"\(it\): unknown key 'cone'"),
        ({}, r"\(it\): expected one of box.* got none"),
        ({"sphere": 1, "box": [1, 1, 1]}, r"got box and sphere"),
        ({"sphere": 1, "position": [0, 0]}, r"\(it\).position: expected 3"),
        ({"sphere": 1, "rpy": [0, 0, 0], "xyzw": XYZW}, r"\(it\): expected T, or position"),
        ({"box": [1, 1, 1], "xyzw": [0, 0, 0, 0]}, r"\(it\).xyzw: the quaternion is zero"),
        ({"box": [1, 1, 1], "T": [[1, 0, 0, 0]]}, r"\(it\).T: expected 4 rows"),
        ({"box": [1, 1, 1], "T": np.diag([2.0, 1, 1, 1]).tolist()}, r"\(it\): .*T_base_shape"),
        ({"half_space": {"normal": [0, 0, 0], "point": [0, 0, 0]}}, "the normal is zero"),
        ({"convex_mesh": {"file": "gone.stl"}}, r"\(it\).convex_mesh: mesh 'gone.stl'"),
        ({"convex_mesh": {"vertices": [[0, 0, 0]] * 4}}, r"\(it\).*one plane"),
        (
            {"convex_mesh": {"vertices": CORNERS, "triangles": [*FACES[:3], [0, 1, 2]]}},
            r"\(it\).*hole",
        ),
        ({"convex_mesh": {"vertices": CORNERS, "triangles": [[0, 1, 9]]}}, "not there"),
    ],
)
def test_a_bad_shape_is_refused_by_file_and_entry(
    tmp_path: Path, entry: dict[str, Any], says: str
) -> None:
    path = written(tmp_path, {"shapes": [{"name": "it", **entry}]})
    with pytest.raises(pdoik.LoadError, match=rf"scene.yaml: .*{says}"):
        pdoik.load_scene(path)


def test_rules_of_what_is_left_out_need_it_no_longer(tmp_path: Path) -> None:
    far = [{"name": name, "sphere": 0.1, "position": [9, 9, 9]} for name in ("mug", "jug")]
    contacts = [
        {"one": "panda_link7", "other": "mug"},
        {"one": "panda_link*", "other": "m*", "clearance": 0.05},
        {"one": "panda_link7", "other": "jug", "clearance": 0.01},
    ]
    path = written(tmp_path, {"shapes": far, "contacts": contacts})
    scene = pdoik.load_scene(path, without=["mug"])
    assert [shape.name for shape in scene.shapes] == ["jug"]
    before = pdoik.load_scene(path).contacts
    assert [rule.clearance for rule in scene.contacts] == [rule.clearance for rule in before]
    assert [rule.optional for rule in before] == [False, False, False]
    assert [rule.optional for rule in scene.contacts] == [True, True, False]
    robot = pdoik.Robot.builtin("panda")
    solver, q = pdoik.Solver(robot), robot.mid_configuration()
    assert np.isfinite(solver.judge(robot.fk(q), q, scene).clearance)
    with pytest.raises(ValueError, match="mug"):
        solver.judge(robot.fk(q), q, pdoik.Scene(scene.shapes, contacts=before))


def test_a_rule_of_what_is_left_out_is_no_pattern_for_others(tmp_path: Path) -> None:
    shapes = [{"name": name, "sphere": 0.1, "position": [9, 9, 9]} for name in ("m*", "mug")]
    path = written(
        tmp_path, {"shapes": shapes, "contacts": [{"one": "panda_link7", "other": "m*"}]}
    )
    assert len(pdoik.load_scene(path).contacts) == 1
    assert len(pdoik.load_scene(path, without=["m*"]).contacts) == 0


BALL = {"name": "ball", "sphere": 1}


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ({"shapes": [BALL, BALL]}, r"shapes\[1\] \(ball\): two shapes are named 'ball'"),
        ({"shapes": [{"sphere": 1}]}, r"shapes\[0\]: has no name"),
        ({"shapes": [BALL], "allowed": [["hand", "mug"]]}, r"allowed\[0\]: .*'mug'"),
        ({"shapes": [BALL], "allowed": [["hand"]]}, r"allowed\[0\]: expected \[link, shape\]"),
        ({"cloud": "gone.pcd"}, r"cloud: .*gone.pcd: no such file"),
        ({"shapes": [], "leaf": -1}, "leaf: expected metres"),
        ({"objects": []}, "expected shapes, .*got 'objects'"),
        ("", "expected a mapping"),
        ("a: [1", "not YAML"),
    ],
)
def test_a_bad_file_is_refused(tmp_path: Path, content: Any, says: str) -> None:
    with pytest.raises(pdoik.LoadError, match=rf"scene.yaml: {says}"):
        pdoik.load_scene(written(tmp_path, content))


def test_what_is_not_there_and_other_files_are_refused(tmp_path: Path) -> None:
    for name, says in (
        ("gone.yaml", "no such file"),
        ("gone.scene", "no such file"),
        ("x.json", "json"),
    ):
        with pytest.raises(pdoik.LoadError, match=f"{name}: .*{says}"):
            pdoik.load_scene(tmp_path / name)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("box\n0.4", "torus\n0.4", r"line 4, object 'shelf board': unknown type 'torus'"),
        ("0.4 0.6 0.04", "0.4 0.6", r"object 'shelf board'"),  # and takes the next line's
        ("0.8 0 0.3", "0.8 nan 0.3", r"line 6, object 'shelf board': expected 3 numbers"),
        ("0 0 0.6 0.8", "0 0 0 0", r"line 7, object 'shelf board': the quaternion is zero"),
        ("0.05\n1 2 3", "-0.05\n1 2 3", r"object 'rest': shape 'rest': radius"),
        ("0 2 1\n", "0 2 9\n", r"object 'rock': a triangle has a vertex that is not there"),
        ("* rest", "* rock", r"object 'rock': two shapes are named 'rock'"),
        ("* rest", "*", r"has no name"),
        ("0 0 2 1", "0 0 0 1", r"object 'rest': the plane's normal is zero"),
        (".\n", "", r"the file is cut short"),
        ("* rest", "rest", r"expected '\* id' or '.', got 'rest'"),
    ],
)
def test_a_bad_text_is_refused_by_line_and_object(
    tmp_path: Path, old: str, new: str, says: str
) -> None:
    text = OLD[: -len(old)] + new if OLD.endswith(old) else OLD.replace(old, new, 1)
    with pytest.raises(pdoik.LoadError, match=rf"bad.scene: .*{says}"):
        pdoik.load_scene(written(tmp_path, text, "bad.scene"))
