"""Gazebo's worlds as scenes: placed as Drake places them, and by hand."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import pdoik
from pdoik.scenes import read_scene_file
from polygon_files import CUBE, QUADS, ply_bytes


def pose(x: float, y: float, z: float, *rpy: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    if rpy:
        T[:3, :3] = Rotation.from_euler("xyz", rpy).as_matrix()
    return T


def written(folder: Path, inside: str, name: str = "cell.sdf", version: str = "1.9") -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    inside = re.sub(r"(<pose[^>]*>)(\S+ \S+ \S+)(</pose>)", r"\1\2 0 0 0\3", inside)  # not turned
    path.write_text(f'<?xml version="1.0"?><sdf version="{version}">{inside}</sdf>')
    return path


def world(inside: str) -> str:
    return f'<world name="cell">{inside}</world>'


def body(geometry: str, more: str = "", name: str = "link") -> str:
    """A link with one collision."""
    return (
        f'<link name="{name}">{more}<collision name="c"><geometry>{geometry}</geometry>'
        "</collision></link>"
    )


BALL = "<sphere><radius>0.1</radius></sphere>"


def found(path: Path, **asked: Any) -> dict[str, pdoik.Shape]:
    return {shape.name: shape for shape in pdoik.load_scene(path, **asked).shapes}


def placed(path: Path, **asked: Any) -> dict[str, np.ndarray]:
    return {name: np.asarray(shape.T_base_shape) for name, shape in found(path, **asked).items()}


# Kinds.


def test_every_kind_comes_out_with_its_sizes(tmp_path: Path) -> None:
    kinds = {
        "box": "<box><size>0.1 0.2 0.3</size></box>",
        "ball": BALL,
        "can": "<cylinder><radius>0.1</radius><length>0.4</length></cylinder>",
        "pill": "<capsule><radius>0.1</radius><length>0.4</length></capsule>",
        "egg": "<ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid>",
        "hat": "<cone><radius>0.1</radius><length>0.4</length></cone>",
        "floor": "<plane><normal>0 1 0</normal><size>1 1</size></plane>",
        "none": "<empty/>",
    }
    models = [f'<model name="{name}">{body(kind)}</model>' for name, kind in kinds.items()]
    shapes = found(written(tmp_path, world("".join(models))))
    assert {name: shape.kind for name, shape in shapes.items()} == {
        **{"box": "box", "ball": "sphere", "can": "cylinder", "pill": "capsule"},
        **{"egg": "convex_mesh", "hat": "convex_mesh", "floor": "half_space"},
    }
    assert list(shapes["box"].size) == [0.1, 0.2, 0.3]
    assert list(shapes["can"].size) == list(shapes["pill"].size) == [0.1, 0.4]
    np.testing.assert_allclose(shapes["floor"].T_base_shape[:3, 2], (0, 1, 0), atol=1e-12)
    egg = trimesh.Trimesh(shapes["egg"].vertices, shapes["egg"].triangles)
    exact = 4 / 3 * np.pi * 0.1 * 0.2 * 0.3
    assert exact < egg.volume < 1.02 * exact
    heights = np.einsum("ij,ij->i", egg.face_normals, egg.triangles[:, 0])
    support = np.linalg.norm(egg.face_normals * [0.1, 0.2, 0.3], axis=1)
    assert (heights >= support - 1e-9).all()  # no face cuts into the ellipsoid


def test_meshes_are_found_scaled_and_turned_inside_out_by_no_mirror(tmp_path: Path) -> None:
    cube = ply_bytes(CUBE, QUADS, "binary_little_endian")
    ell = trimesh.util.concatenate(
        [trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1))]
    )
    ell.vertices[8:] += [2, 0, 0]  # two boxes apart: no convex thing
    for folder in ("models/part/meshes", "meshes"):
        (tmp_path / folder).mkdir(parents=True)
        name = "cube.ply" if folder == "meshes" else "own.ply"
        (tmp_path / folder / name).write_bytes(cube)
        ell.export(tmp_path / folder / "two.stl")
    uses = [
        ("named", "model://part/meshes/own.ply", "1 2 3"),
        ("beside", "meshes/cube.ply", "1 1 1"),
        ("address", f"file://{tmp_path / 'meshes/cube.ply'}", "0.5 0.5 0.5"),
        ("mirrored", "meshes/two.stl", "-1 1 0.5"),
    ]
    models = [
        f'<model name="{n}">{body(f"<mesh><uri>{u}</uri><scale>{s}</scale></mesh>")}</model>'
        for n, u, s in uses
    ]
    path = written(tmp_path, world("".join(models)))
    shapes = found(path, packages=[tmp_path / "models"])
    volumes = {
        name: trimesh.Trimesh(s.vertices, s.triangles, process=False).volume
        for name, s in shapes.items()
    }
    assert volumes == pytest.approx({"named": 6, "beside": 1, "address": 0.125, "mirrored": 1})
    assert shapes["mirrored"].kind == "mesh"
    assert shapes["beside"].kind == "convex_mesh"
    with pytest.raises(
        pdoik.LoadError, match=r"model named, link link, collision c: mesh .*'part'"
    ):
        pdoik.load_scene(path)


# Where things are.


FRAMES = world(
    f"""
    <frame name="corner"><pose>1 2 0 0 0 0.5</pose></frame>
    <model name="table">
      <pose relative_to="corner">0.1 0 0.4 0 0 0.2</pose>
      <static>true</static>
      <frame name="edge" attached_to="leg"><pose degrees="true">0 0 0.1 0 0 90</pose></frame>
      <link name="top">
        <collision name="a"><pose>0 0 0.02 0.1 0 0</pose>
          <geometry><box><size>1 0.6 0.04</size></box></geometry></collision>
        <collision name="b"><pose relative_to="edge">0.3 0 0</pose>
          <geometry>{BALL}</geometry></collision>
      </link>
      <link name="leg"><pose relative_to="top">0.4 0.2 -0.3</pose>
        <collision name="c"><geometry><box><size>0.05 0.05 0.6</size></box></geometry></collision>
      </link>
    </model>
    <model name="lamp" placement_frame="foot">
      <pose relative_to="table::edge" rotation_format="quat_xyzw">0 0 0.5 0 0 0.6 0.8</pose>
      <link name="foot"><pose>0 0 -0.2 0 0.3 0</pose></link>
      <link name="head"><pose relative_to="joint">0 0 0.1</pose>
        <collision name="c"><geometry>{BALL}</geometry></collision></link>
      <link name="arm"><pose>0 0.2 0.3</pose></link>
      <joint name="joint" type="revolute"><pose>0 0.1 0 0 0 0.4</pose>
        <parent>foot</parent><child>arm</child><axis><xyz>0 0 1</xyz></axis></joint>
      <joint name="fixed" type="fixed"><parent>arm</parent><child>head</child></joint>
      <model name="shade"><pose relative_to="head">0.1 0 0 0.2 0 0</pose>
        {body(BALL, "<pose>0 0.05 0</pose>")}</model>
    </model>
    """
)


def test_frames_and_placements_are_followed(tmp_path: Path) -> None:
    corner = pose(1, 2, 0, 0, 0, 0.5)
    table = corner @ pose(0.1, 0, 0.4, 0, 0, 0.2)
    leg = table @ pose(0.4, 0.2, -0.3)
    edge = leg @ pose(0, 0, 0.1, 0, 0, np.pi / 2)
    turn = pose(0, 0, 0.5)
    turn[:3, :3] = Rotation.from_quat([0, 0, 0.6, 0.8]).as_matrix()
    lamp = edge @ turn @ np.linalg.inv(pose(0, 0, -0.2, 0, 0.3, 0))
    head = lamp @ pose(0, 0.2, 0.3) @ pose(0, 0.1, 0, 0, 0, 0.4) @ pose(0, 0, 0.1)
    expected = {
        "table": table @ pose(0, 0, 0.02, 0.1, 0, 0),
        "table/1": edge @ pose(0.3, 0, 0),
        "table/2": leg,
        "lamp": head,
        "lamp::shade": head @ pose(0.1, 0, 0, 0.2, 0, 0) @ pose(0, 0.05, 0),
    }
    path = written(tmp_path, FRAMES)
    where = placed(path)
    assert list(where) == list(expected)
    for name, T in expected.items():
        np.testing.assert_allclose(where[name][:3, 3], T[:3, 3], atol=1e-12, err_msg=name)
    np.testing.assert_allclose(where["table"], expected["table"], atol=1e-12)
    in_frame = placed(path, frame="table::edge")
    for name, T in expected.items():
        seen = (np.linalg.inv(edge) @ T)[:3, 3]
        np.testing.assert_allclose(in_frame[name][:3, 3], seen, atol=1e-12)


def test_drake_places_them_alike(tmp_path: Path) -> None:
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    from pydrake.geometry import Role
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
    from pydrake.systems.framework import DiagramBuilder

    write_library(tmp_path / "models")
    include = "<include><uri>package://models/mug</uri><pose>1 0 0 0 0 1</pose></include>"
    path = written(tmp_path, FRAMES.replace("</world>", f"{include}</world>"))
    builder = DiagramBuilder()
    plant, graph = AddMultibodyPlantSceneGraph(builder, 0.0)
    parser = parsing.Parser(plant)
    parser.package_map().Add("models", str(tmp_path / "models"))
    parser.AddModels(str(path))
    plant.Finalize()
    context = builder.Build().CreateDefaultContext()
    query = graph.get_query_output_port().Eval(graph.GetMyContextFromRoot(context))
    inspector = query.inspector()
    theirs = [
        query.GetPoseInWorld(each).GetAsMatrix4()[:3, 3]
        for each in inspector.GetAllGeometryIds(Role.kProximity)
    ]
    ours = placed(path, packages=[tmp_path])
    assert len(ours) == len(theirs) == 6
    for name, T in ours.items():
        assert min(np.linalg.norm(T[:3, 3] - at) for at in theirs) < 1e-9, name


# Includes.


def write_library(folder: Path) -> None:
    """A model with two versions of its file."""
    mug = '<model name="mug"><pose>9 9 9</pose>' + body(BALL, "<pose>0 0 0.05</pose>") + "</model>"
    written(folder / "mug", mug, "model.sdf")
    written(folder / "mug", '<model name="old"/>', "model-1_4.sdf", version="1.4")
    (folder / "mug/model.config").write_text(
        '<model><name>mug</name><sdf version="1.4">model-1_4.sdf</sdf>'
        '<sdf version="1.10">model.sdf</sdf><sdf version="1.9">model-1_4.sdf</sdf></model>'
    )


def test_models_are_included_by_address_under_other_names_and_poses(tmp_path: Path) -> None:
    write_library(tmp_path / "models")
    nested = written(
        tmp_path / "models/tray",
        '<model name="tray"><include><uri>../mug</uri><name>cup</name><pose>0.2 0 0</pose>'
        "</include></model>",
        "tray.sdf",
    )
    inside = f"""
      <include><uri>model://mug</uri></include>
      <include><uri>model://mug</uri><name>second</name><pose>1 0 0 0 0 1</pose></include>
      <include><uri>models/mug/model.sdf</uri><name>third</name><pose>0 1 0</pose></include>
      <include><uri>{nested}</uri><pose>0 0 1</pose></include>
    """
    path = written(tmp_path, world(inside))
    where = placed(path, packages=[tmp_path / "models"])
    expected = {
        "mug": (9, 9, 9.05),
        "second": (1, 0, 0.05),
        "third": (0, 1, 0.05),
        "tray::cup": (0.2, 0, 1.05),
    }
    assert {name: tuple(T[:3, 3].round(9)) for name, T in where.items()} == expected
    kept = found(path, packages=[tmp_path / "models"], without=["mug", "tray"])
    assert list(kept) == ["second", "third"]


def test_gazebos_own_path_of_models_is_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_library(tmp_path / "library")
    path = written(tmp_path / "elsewhere", world("<include><uri>model://mug</uri></include>"))
    with pytest.raises(pdoik.LoadError, match=r"include model://mug: model 'model://mug': .*mug"):
        pdoik.load_scene(path)
    for variable in ("GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH"):
        monkeypatch.setenv(variable, str(tmp_path / "library"))
        assert list(found(path)) == ["mug"]
        monkeypatch.delenv(variable)


# What an older editor saves.


def test_the_saved_state_says_where_models_are(tmp_path: Path) -> None:
    two = body(BALL, name="a") + body(BALL, "<pose>0 0 1</pose>", name="b")
    state = """
      <state world_name="cell">
        <model name="moved"><pose>5 6 7 0 0 1</pose><scale>1 1 1</scale>
          <link name="a"><pose>5 6 7 0 0 1</pose></link>
          <link name="b"><pose>5 6 9 0 0 1</pose></link></model>
        <model name="whole"><pose>1 0 0 0 0 0</pose></model>
      </state>"""
    names = ("moved", "whole", "as_written")
    models = "".join(f'<model name="{n}"><pose>0 0 3</pose>{two}</model>' for n in names)
    path = written(tmp_path, world(models + state), "cell.world", version="1.6")
    where = {name: tuple(T[:3, 3].round(9)) for name, T in placed(path).items()}
    assert where == {
        **{"moved": (5, 6, 7), "moved/1": (5, 6, 9), "whole": (1, 0, 0), "whole/1": (1, 0, 1)},
        **{"as_written": (0, 0, 3), "as_written/1": (0, 0, 4)},
    }
    for old, new, says in (
        ("<scale>1 1 1", "<scale>2 1 1", r"state, model moved: is scaled by \[2.0, 1.0, 1.0\]"),
        ('<model name="whole"><pose>1', '<model name="hole"><pose>1', r"no such model"),
        ('<link name="b"><pose>5', '<link name="z"><pose>5', r"no frame 'z' in it: a, b"),
    ):
        path.write_text(path.read_text().replace(old, new))
        with pytest.raises(pdoik.LoadError, match=says):
            pdoik.load_scene(path)
        path.write_text(path.read_text().replace(new, old))


# The robot.


def robot_model(base: str = "panda_link0", fixed: bool = True) -> str:
    """Panda as a URDF becomes one: its links, and joints of the same names."""
    links = "".join(body(BALL, name=f"panda_link{k}") for k in range(1, 8))
    joints = "".join(
        f'<joint name="panda_joint{k}" type="revolute"><parent>panda_link{k - 1}</parent>'
        f"<child>panda_link{k}</child></joint>"
        for k in range(1, 8)
    ).replace("panda_link0", base)
    weld = f'<joint name="weld" type="fixed"><parent>world</parent><child>{base}</child></joint>'
    weld = weld if fixed else ""
    return (
        f'<model name="arm"><pose>1 0 0.5 0 0 1</pose>{body(BALL, name=base)}{links}{joints}{weld}'
        "</model>"
    )


TABLE = f'<model name="table"><static>1</static>{body(BALL, name="base_link")}</model>'
MUG = f'<model name="mug"><pose>1 0 1</pose>{body(BALL, name="panda_link0")}</model>'


def test_the_robot_is_left_out_and_its_base_is_the_base_frame(tmp_path: Path) -> None:
    robot = pdoik.Robot.builtin("panda")
    path = written(tmp_path, world(robot_model() + TABLE + MUG))
    scene = pdoik.load_scene(path, robot=robot)
    assert [shape.name for shape in scene.shapes] == ["table", "mug"]  # whatever its link is called
    T = np.linalg.inv(pose(1, 0, 0.5, 0, 0, 1))
    np.testing.assert_allclose(scene.shapes[0].T_base_shape[:3, 3], T[:3, 3], atol=1e-12)
    assert scene.allowed == [("panda_link0", "table")]  # neither can move, the mug can
    assert "model arm" in read_scene_file(path, robot=robot).left_out
    assert len(pdoik.load_scene(path).shapes) == 10
    loose = written(tmp_path, world(robot_model(fixed=False) + TABLE), "loose.sdf")
    assert pdoik.load_scene(loose, robot=robot).allowed == []
    other = written(tmp_path, world(robot_model("pedestal") + TABLE), "other.sdf")
    with pytest.raises(pdoik.LoadError, match=r"arm, has no link or frame 'panda_link0', .*arm::L"):
        pdoik.load_scene(other, robot=robot)
    scene = pdoik.load_scene(other, robot=robot, frame="arm::pedestal")
    np.testing.assert_allclose(scene.shapes[0].T_base_shape[:3, 3], T[:3, 3], atol=1e-12)


# What is told and refused.


def test_what_nothing_touches_is_told(tmp_path: Path) -> None:
    ghost = '<link name="l"><visual name="v"><geometry/></visual></link>'
    passed = body(BALL).replace(
        "</collision>",
        "<surface><contact><collide_bitmask>0x00</collide_bitmask></contact></surface></collision>",
    )
    models = f'<model name="ghost">{ghost}</model><model name="air">{passed}</model>{MUG}'
    path = written(tmp_path, world(models + '<actor name="walker"/>'))
    with pytest.warns(pdoik.ObstacleWarning, match=r"nothing can touch ghost::l, which are seen"):
        scene = read_scene_file(path)
    assert [shape.name for shape in scene.shapes] == ["mug"]
    told = " ".join(scene.left_out)
    assert "model air, link link, collision c, which nothing touches" in told
    assert "actor walker" in told
    assert read_scene_file(path, without=["ghost"]).left_out[0] == "model ghost"


def test_an_empty_world_is_told(tmp_path: Path) -> None:
    with pytest.warns(pdoik.ObstacleWarning, match=r"cell.sdf: holds no obstacles; whatever"):
        pdoik.load_scene(written(tmp_path, world("")))


def test_a_comment_may_stand_before_the_declaration(tmp_path: Path) -> None:
    path = written(tmp_path, MUG)
    path.write_text(f"\n<!-- who wrote it -->\n{path.read_text()}")
    assert list(found(path)) == ["mug"]


def test_a_file_of_one_model_is_a_scene(tmp_path: Path) -> None:
    assert list(found(written(tmp_path, MUG))) == ["mug"]
    assert list(found(written(tmp_path, world(MUG), "cell.xml"))) == ["mug"]


def test_an_open_mesh_and_one_in_millimetres_are_told(tmp_path: Path) -> None:
    box = trimesh.creation.box((300, 200, 100))
    box.export(tmp_path / "part.stl")
    box.update_faces(np.arange(12) > 0)
    box.apply_scale(0.001)
    box.export(tmp_path / "open.stl")

    def of(file: str, scale: float = 1.0) -> Path:
        mesh = f"<mesh><uri>{file}</uri><scale>{scale} {scale} {scale}</scale></mesh>"
        models = f'<model name="part">{body(mesh)}</model>{MUG}{TABLE}'
        return written(tmp_path, world(models))

    with pytest.warns(pdoik.ObstacleWarning, match=r"the mesh 'part' .* give it a scale of 0.001"):
        pdoik.load_scene(of("part.stl"))
    pdoik.load_scene(of("part.stl", 0.001))
    with pytest.warns(pdoik.ObstacleWarning, match=r"'part' is not closed: .*fill_holes"):
        pdoik.load_scene(of("open.stl"))


HUGE = "<include><uri>self.sdf</uri></include>"


@pytest.mark.parametrize(
    ("inside", "says"),
    [
        (MUG + MUG, r"two models are named 'mug'"),
        ("<model>" + body(BALL) + "</model>", r"a model has no name"),
        (f'<model name="m">{body("<box/>")}</model>', r"model m, link link, collision c: .*<size>"),
        (
            f'<model name="m">{body("<box><size>1 2 x</size></box>")}</model>',
            r"expected 3 numbers in <size>, got '1 2 x'",
        ),
        (
            f'<model name="m">{body("<sphere><radius>-1</radius></sphere>")}</model>',
            r"collision c: shape 'm'",
        ),
        (
            f'<model name="m">{body("<heightmap/>")}</model>',
            r"<heightmap> is not read: leave its model out .*Shape.height_field",
        ),
        (
            f'<model name="m">{body("<mesh><uri>a.stl</uri><submesh/></mesh>")}</model>',
            r"a <submesh> is not read",
        ),
        (
            f'<model name="m"><pose>1 2 3 4</pose>{body(BALL)}</model>',
            r"<pose> of euler_rpy is '1 2",
        ),
        (
            f'<model name="m"><pose relative_to="n">1 2 3 0 0 0</pose>{body(BALL)}</model>',
            r"no frame 'n' in it: m",
        ),
        (
            '<model name="m">'
            + body(BALL, '<pose relative_to="b">0 0 0 0 0 0</pose>', "a")
            + body(BALL, '<pose relative_to="a">0 0 0 0 0 0</pose>', "b")
            + "</model>",
            r"model m: poses stand on each other: a on b on a",
        ),
        ("<include/>", r"an <include> has no <uri>"),
        (
            "<include><uri>https://fuel.gazebosim.org/mug</uri></include>",
            r"include https://.*: is not fetched: download the model",
        ),
        ("<include><uri>gone.sdf</uri></include>", r"include gone.sdf: model 'gone.sdf': no such"),
        ("<population/>", r"<population> is not read"),
    ],
)
def test_what_is_wrong_is_told(tmp_path: Path, inside: str, says: str) -> None:
    with pytest.raises(pdoik.LoadError, match=f"cell.sdf: .*{says}"):
        pdoik.load_scene(written(tmp_path, world(inside)))


def test_a_model_that_includes_itself_is_refused(tmp_path: Path) -> None:
    written(tmp_path, f'<model name="m">{HUGE}</model>', "self.sdf")
    with pytest.raises(pdoik.LoadError, match=r"self.sdf: .*one includes itself"):
        pdoik.load_scene(written(tmp_path, world(HUGE)))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<sdf><world name='a'/><world name='b'/></sdf>", r"holds 2 worlds \(a, b\)"),
        ("<robot/>", r"expected <sdf>, got <robot>"),
        ("<sdf>", "not XML"),
        ("\x00\x01", "not XML"),
    ],
)
def test_files_that_are_no_worlds_are_refused(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "cell.world"
    path.write_text(text)
    with pytest.raises(pdoik.LoadError, match=f"cell.world: {says}"):
        pdoik.load_scene(path)


def test_names_that_are_not_there_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, world(MUG))
    with pytest.raises(pdoik.LoadError, match=r"there is no model 'jug' to be left out: mug"):
        pdoik.load_scene(path, without=["jug"])
    with pytest.raises(pdoik.LoadError, match=r"no frame 'jug' in it: mug"):
        pdoik.load_scene(path, frame="jug")
    with pytest.raises(pdoik.LoadError, match=r"has no keyframes"):
        pdoik.load_scene(path, keyframe="home")
