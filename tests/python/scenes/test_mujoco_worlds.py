"""MuJoCo's worlds as scenes, judged by MuJoCo: distances, contacts, and what is left out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import trimesh

import pdoik
from mujoco_worlds import ARM, WORLD, Truth, arm_of, written
from pdoik.scenes import read_scene_file

RNG = np.random.default_rng(4)
NAMES = ["floor", "geom1", "table", "table/1", "pot", "ball", "door", "door/1", "rock"]
KEYFRAME = """
<keyframe>
  <key name="home" qpos="0 0 0 0 0 0  0.3 -0.7 0.8 1 0 0 0  0"/>
  <key name="open" qpos="0 0 0 0 0 0  0.5 0.6 0.9 0.7 0.1 0 0.7  1.1"/>
</keyframe>
"""


def loaded(path: Path, **asked: Any) -> tuple[pdoik.Robot, pdoik.Scene]:
    robot = arm_of(path)
    return robot, pdoik.load_scene(path, robot=robot, **asked)


def told(robot: pdoik.Robot, scene: pdoik.Scene, q: np.ndarray) -> dict[str, float]:
    """How far each shape is from the arm, by pdoik."""
    solver = pdoik.Solver(robot)
    found: dict[str, float] = {}
    for each in solver.clearances(q, scene):
        found[each.obstacle] = min(each.distance, found.get(each.obstacle, np.inf))
    return found


@pytest.mark.parametrize("keyframe", [None, "open", 1])
def test_all_kinds_are_as_far_away_as_in_mujoco(tmp_path: Path, keyframe: str | int | None) -> None:
    path = written(tmp_path, more=KEYFRAME)
    robot, scene = loaded(path, keyframe=keyframe)
    assert [shape.name for shape in scene.shapes] == NAMES
    truth = Truth(path, None if keyframe is None else 1)
    drawn = mujoco.mj_name2id(truth.model, mujoco.mjtObj.mjOBJ_GEOM, "drawn")
    geoms = [g for g in range(truth.model.ngeom) if g not in truth.own and g != drawn]
    apart = dict.fromkeys(NAMES, 0)
    for _ in range(40):
        q = RNG.uniform(robot.lower, robot.upper)
        truth.move(robot, q)
        ours = told(robot, scene, q)
        for name, g in zip(NAMES, geoms, strict=True):
            theirs = truth.distance(g)
            if ours[name] < 0 < theirs:
                assert truth.pierces(g), name
            elif theirs > 1e-3:
                apart[name] += 1
                # The polyhedron around an ellipsoid is half a hundredth larger.
                off = 0.0 if name != "pot" else 0.005 * 0.15
                assert -1e-5 - off <= ours[name] - theirs <= 1e-5, name
            else:
                assert ours[name] < 2e-3, name
    assert min(apart.values()) > 5


def clutter() -> str:
    """Forty solids about the arm, none of them near its first joints."""
    kinds = ["box", "ellipsoid", "cylinder", "capsule"] * 10
    places = RNG.uniform((-0.8, -1.1, 0.2), (1.0, 0.7, 1.4), (400, 3))
    away = places[np.linalg.norm(places[:, :2] - [0.1, -0.2], axis=1) > 0.35]
    return "".join(
        f'<geom type="{kind}" size="0.05 0.06 0.07" pos="{x:.3f} {y:.3f} {z:.3f}" euler="{k} 0 9"/>'
        for k, (kind, (x, y, z)) in enumerate(zip(kinds, away, strict=False))
    )


def test_a_solver_keeps_off_a_world_by_mujocos_own_contacts(tmp_path: Path) -> None:
    path = written(tmp_path, WORLD + clutter())
    robot, scene = loaded(path)
    truth = Truth(path)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.2))
    solved = through = 0
    for _ in range(120):
        target = robot.fk(RNG.uniform(robot.lower, robot.upper))
        blind = solver.solve(target)
        if blind.success:
            truth.move(robot, blind.q)
            through += bool(truth.touches())
        result = solver.solve(target, obstacles=scene)
        if not result.success:
            continue
        solved += 1
        truth.move(robot, result.q)
        assert truth.touches() == []
        tip, base = truth.state.site("tip"), truth.state.body("base")
        at = base.xmat.reshape(3, 3).T @ (tip.xpos - base.xpos)
        np.testing.assert_allclose(at, target[:3, 3], atol=1e-4)
    assert solved > 30
    assert through > 30  # the world is in the way


def test_the_base_may_stand_on_the_floor_and_excluded_pairs_may_touch(tmp_path: Path) -> None:
    sunk = ARM.replace('pos="0.1 -0.2 0.3"', 'pos="0.1 -0.2 0.05"')
    more = '<contact><exclude body1="hand" body2="ball"/></contact>'
    path = written(tmp_path, arm=sunk, more=more)
    robot, scene = loaded(path)
    allowed = set(scene.allowed)
    standing = {"floor", "geom1", "table", "table/1", "pot", "rock"}
    assert allowed == {("base", name) for name in standing} | {("hand", "ball")}
    # With a hull of its own the base is in the floor, and nobody minds.
    foot = ("base", (0.0, 0.0, -0.12), 0.1)
    robot.occupancy = pdoik.Occupancy(spheres=[foot], capsules=robot.occupancy.capsules)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.5))
    target = robot.fk([0.3, 0.4, 0.5, 0.1, 0.4, 0.0])
    assert solver.solve(target, obstacles=scene).success
    without = pdoik.Scene(scene.shapes)
    assert solver.solve(target, obstacles=without).status == "base_collision"
    assert not [each for each in allowed if each[0] == "turret"]


def test_a_shape_that_moves_may_not_touch_because_of_its_name(tmp_path: Path) -> None:
    world = (
        '<geom name="shelf" type="box" size="0.1 0.1 0.1" pos="5 0 0"/>'
        '<body name="cart" pos="0.1 -0.2 0.3"><freejoint/>'
        '<geom name="shelf/7" type="sphere" size="0.1"/></body>'
    )
    robot, scene = loaded(written(tmp_path, world))
    assert scene.allowed == [("base", "shelf")]  # and pieces of a shelf, of which this is none
    robot.occupancy = pdoik.Occupancy(spheres=[("base", (0.0, 0.0, 0.0), 0.1)])
    q = robot.mid_configuration()
    tip = robot.fk(q)
    solver = pdoik.Solver(robot)
    assert solver.solve(tip, q, obstacles=scene).status == "base_collision"
    bare = pdoik.Scene(scene.shapes, allowed=scene.allowed)
    assert solver.solve(tip, q, obstacles=bare).status != "base_collision"


def test_a_base_that_floats_may_not_touch(tmp_path: Path) -> None:
    links = "".join(
        f'<body name="panda_link{k}"><joint name="panda_joint{k}"/><geom size="0.01"/>'
        for k in range(1, 8)
    )
    path = tmp_path / "world.xml"
    path.write_text(
        '<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>'
        f'<body name="panda_link0"><geom size="0.1"/>{links}{"</body>" * 8}</worldbody></mujoco>'
    )
    bounds = ([-1, -1, -1, -1, -1, -1], [1, 1, 1, 1, 1, 1])
    for floating, allowed in ((None, [("panda_link0", "floor")]), (bounds, [])):
        robot = pdoik.Robot.builtin("panda", floating_base=floating)
        scene = pdoik.load_scene(path, robot=robot)
        assert [shape.name for shape in scene.shapes] == ["floor"]
        assert scene.allowed == allowed


# What is left out, and in whose frame the rest is.


def test_obstacles_are_in_the_frame_of_the_base_link(tmp_path: Path) -> None:
    path = written(tmp_path)
    robot = arm_of(path)
    truth = Truth(path)
    mujoco.mj_forward(truth.model, truth.state)
    ball = truth.state.body("ball").xpos

    def center(**asked: Any) -> np.ndarray:
        shapes = pdoik.load_scene(path, **asked).shapes
        return next(s.T_base_shape[:3, 3] for s in shapes if s.name == "ball")

    base = truth.state.body("base")
    np.testing.assert_allclose(
        center(robot=robot), base.xmat.reshape(3, 3).T @ (ball - base.xpos), atol=1e-9
    )
    np.testing.assert_allclose(center(), ball)  # nobody named a robot
    np.testing.assert_allclose(center(robot=arm_of(path, None)), ball)  # its base is "world"
    tip = truth.state.site("tip")
    np.testing.assert_allclose(
        center(robot=robot, frame="tip"), tip.xmat.reshape(3, 3).T @ (ball - tip.xpos), atol=1e-9
    )
    table = truth.state.body("table")
    np.testing.assert_allclose(
        center(frame="table"), table.xmat.reshape(3, 3).T @ (ball - table.xpos), atol=1e-9
    )


def test_the_robot_is_known_by_the_names_of_its_links_or_joints(tmp_path: Path) -> None:
    path = written(tmp_path)
    arm = arm_of(path)
    found = read_scene_file(path, robot=arm)
    assert [shape.name for shape in found.shapes] == NAMES
    said = " ".join(found.left_out)
    assert "body base" in said
    assert "body hand" in said
    assert "geom drawn, which nothing touches" in said
    # A robot of other links, but the same joints; and the other way round.
    for old, new in ((' name="turret"', ' name="link1"'), ('joint name="j', 'joint name="q')):
        other = tmp_path / "robot.xml"
        other.write_text(path.read_text().replace(old, new))
        robot = pdoik.Robot.from_mjcf(other, base_link="base", tip_link="tip")
        scene = pdoik.load_scene(path, robot=robot)
        assert [shape.name for shape in scene.shapes] == NAMES
    # Another one is none of the file's, whatever its base is called.
    stranger = pdoik.Robot.builtin("panda")
    assert len(pdoik.load_scene(path, robot=stranger).shapes) == len(NAMES) + 7


def test_doors_and_free_bodies_of_the_robots_own_file_stay_obstacles(tmp_path: Path) -> None:
    path = written(tmp_path)
    whole = pdoik.Robot.from_mjcf(path, base_link="base", tip_link="tip")
    assert "hinge" in whole.joint_names
    assert {"ball", "table", "rock", "door"} <= set(whole.link_names)
    assert [shape.name for shape in pdoik.load_scene(path, robot=whole).shapes] == NAMES


def test_bodies_are_left_out_by_name_with_what_hangs_on_them(tmp_path: Path) -> None:
    path = written(tmp_path)
    scene = pdoik.load_scene(path, without=["base", "table"])
    assert [s.name for s in scene.shapes] == [
        n for n in NAMES if n not in ("table", "table/1", "pot")
    ]
    scene = pdoik.load_scene(path, without=["base", "floor", "pot", "geom1"])
    assert [s.name for s in scene.shapes] == ["table", "table/1", "ball", "door", "door/1", "rock"]
    with pytest.raises(
        pdoik.LoadError, match=r"world.xml: there is no body or geom 'tabel' .*base, tur"
    ):
        pdoik.load_scene(path, without=["tabel"])


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"keyframe": "shut"}, r"has no keyframe 'shut': home, open"),
        ({"keyframe": 2}, r"has no keyframe 2: home, open"),
        ({"frame": "nowhere"}, r"no body or site 'nowhere' for the base frame: world, base"),
    ],
)
def test_names_that_are_not_there_are_refused(tmp_path: Path, asked: Any, says: str) -> None:
    with pytest.raises(pdoik.LoadError, match=f"world.xml: {says}"):
        pdoik.load_scene(written(tmp_path, more=KEYFRAME), **asked)


def test_a_robot_whose_base_link_is_not_there_is_asked_about(tmp_path: Path) -> None:
    path = written(tmp_path)
    other = tmp_path / "robot.xml"
    other.write_text(path.read_text().replace(' name="base"', ' name="pedestal"'))
    robot = pdoik.Robot.from_mjcf(other, base_link="pedestal", tip_link="tip")
    with pytest.raises(pdoik.LoadError, match=r"no body 'pedestal', its base link: .*frame=NAME"):
        pdoik.load_scene(path, robot=robot)
    scene = pdoik.load_scene(path, robot=robot, frame="base")
    assert [shape.name for shape in scene.shapes] == NAMES


# What is told.


def test_what_is_driven_and_no_robot_is_told(tmp_path: Path) -> None:
    motors = '<actuator><motor joint="j1"/><motor joint="j2"/></actuator>'
    path = written(tmp_path, more=motors)
    with pytest.warns(pdoik.ObstacleWarning, match=r"actuators move turret, upper, .*give robot="):
        pdoik.load_scene(path)
    pdoik.load_scene(path, robot=arm_of(path))
    pdoik.load_scene(path, without=["base"])


def test_what_is_seen_and_touches_nothing_is_told(tmp_path: Path) -> None:
    seen = (
        '<geom name="glass" type="box" size="1 1 1" contype="0" conaffinity="0"/>'
        '<body name="ghost"><geom size="1" contype="0" conaffinity="0"/></body>'
    )
    path = written(tmp_path, WORLD + seen)
    with pytest.warns(
        pdoik.ObstacleWarning, match=r"nothing can touch glass, ghost, whose contype"
    ):
        pdoik.load_scene(path, robot=arm_of(path))
    pdoik.load_scene(path, robot=arm_of(path), without=["ghost", "glass"])
    paired = '<contact><pair geom1="glass" geom2="g5"/></contact>'
    path = written(tmp_path, WORLD + seen, more=paired)
    scene = pdoik.load_scene(path, robot=arm_of(path), without=["ghost"])
    assert "glass" in [shape.name for shape in scene.shapes]


def test_a_world_of_the_robot_alone_is_told_to_be_empty(tmp_path: Path) -> None:
    path = written(tmp_path, "")
    with pytest.warns(
        pdoik.ObstacleWarning, match=r"world.xml: holds no obstacles but .*body base"
    ):
        scene = pdoik.load_scene(path, robot=arm_of(path))
    assert scene.shapes == []


def test_a_world_in_millimetres_is_told(tmp_path: Path) -> None:
    boxes = '<geom type="box" size="400 300 20"/><geom type="cylinder" size="35 50"/>'
    path = written(tmp_path, boxes, arm="")
    with pytest.warns(pdoik.ObstacleWarning, match=r"2 of its 2 shapes .* is it in millimetres"):
        pdoik.load_scene(path)


# Other kinds of geoms.


def test_meshes_are_the_hulls_that_mujoco_collides(tmp_path: Path) -> None:
    ring = trimesh.creation.torus(0.25, 0.04, major_sections=16, minor_sections=8)
    ring.export(tmp_path / "ring.obj")
    path = tmp_path / "world.xml"
    path.write_text(
        '<mujoco><asset><mesh name="ring" file="ring.obj" scale="1 2 1"/></asset><worldbody>'
        '<body name="ring" pos="0.1 0.2 0.3" euler="30 0 0"><geom type="mesh" mesh="ring"/></body>'
        "</worldbody></mujoco>"
    )
    (shape,) = pdoik.load_scene(path).shapes
    assert shape.kind == "convex_mesh"
    T = trimesh.transformations.rotation_matrix(np.deg2rad(30), [1, 0, 0])
    T[:3, 3] = 0.1, 0.2, 0.3
    expected = ring.vertices * [1, 2, 1] @ T[:3, :3].T + T[:3, 3]
    hull = trimesh.Trimesh(expected, ring.faces).convex_hull
    placed = shape.vertices @ shape.T_base_shape[:3, :3].T + shape.T_base_shape[:3, 3]
    np.testing.assert_allclose(np.ptp(placed, axis=0), np.ptp(hull.vertices, axis=0), atol=1e-6)
    np.testing.assert_allclose(placed.mean(axis=0), [0.1, 0.2, 0.3], atol=1e-6)
    ours = trimesh.Trimesh(shape.vertices, shape.triangles)
    assert ours.volume == pytest.approx(hull.volume, rel=1e-5)


def test_a_height_field_is_where_mujoco_has_it(tmp_path: Path) -> None:
    heights = RNG.uniform(0, 1, (5, 8))
    path = tmp_path / "world.xml"
    words = " ".join(f"{z:.9f}" for z in heights.ravel())
    path.write_text(
        '<mujoco><asset><hfield name="hill" nrow="5" ncol="8" size="1.4 0.8 0.5 0.1" '
        f'elevation="{words}"/></asset><worldbody>'
        '<geom name="hill" type="hfield" hfield="hill" pos="0.5 0.2 -0.3" euler="0 0 35"/>'
        "</worldbody></mujoco>"
    )
    (shape,) = pdoik.load_scene(path).shapes
    assert shape.kind == "mesh"
    mesh = trimesh.Trimesh(shape.vertices, shape.triangles, process=False)
    mesh.apply_transform(shape.T_base_shape)
    assert mesh.is_watertight
    words = [" ".join(map(repr, each.ravel().tolist())) for each in (mesh.vertices, mesh.faces)]
    ours = mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="m" vertex="{words[0]}" face="{words[1]}"/></asset>'
        '<worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>'
    )
    theirs = mujoco.MjModel.from_xml_path(str(path))
    geom, hits = np.zeros(1, np.int32), 0
    for start in np.c_[RNG.uniform((-1, -1), (2, 1.4), (200, 2)), np.full(200, 2.0)]:
        far = []
        for model in (ours, theirs):
            state = mujoco.MjData(model)
            mujoco.mj_forward(model, state)
            down = np.array([0, 0, -1.0])
            far.append(mujoco.mj_ray(model, state, start, down, None, 1, -1, geom))
        assert far[0] == pytest.approx(far[1], abs=1e-5)
        hits += far[0] > 0
    assert hits > 50


# Files that are none.


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<mujoco><worldbody><geom size='-1'/></worldbody></mujoco>", "MuJoCo cannot read it: "),
        (
            "<mujoco><asset><mesh file='gone.stl'/></asset></mujoco>",
            "MuJoCo cannot read it: .*gone.stl",
        ),
        ("<robot name='r'/>", "is a robot, which Robot.from_urdf reads, and no scene"),
        ("<scene/>", "expected <mujoco> or <sdf>, got <scene>"),
        ("<mujoco>", "not XML"),
        ("", "not XML"),
    ],
)
def test_files_that_are_no_worlds_are_refused(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "world.xml"
    path.write_text(text)
    with pytest.raises(pdoik.LoadError, match=f"world.xml: {says}"):
        pdoik.load_scene(path)


def test_what_only_other_files_have_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text("shapes: [{name: ball, sphere: 1}, {name: cube, box: [1, 1, 1]}]")
    with pytest.raises(pdoik.LoadError, match=r"has no keyframes"):
        pdoik.load_scene(path, keyframe=0)
    assert [s.name for s in pdoik.load_scene(path, without=["ball"]).shapes] == ["cube"]
    with pytest.raises(pdoik.LoadError, match=r"there is no object 'bell' .*: ball, cube"):
        pdoik.load_scene(path, without="bell")
