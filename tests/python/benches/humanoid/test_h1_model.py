"""The H1 in MuJoCo: figures against Pinocchio, hulls, standing, and throws that hit."""

from __future__ import annotations

import os
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import pdoik

mujoco = pytest.importorskip("mujoco", reason="needs the Python package mujoco")

from bench.common.arrays import moved  # noqa: E402
from bench.humanoid import hulls as h1_hulls  # noqa: E402
from bench.humanoid.trials.draw_throws import Hit, draw_throws  # noqa: E402
from bench.humanoid.world.controller import Controller  # noqa: E402
from bench.humanoid.world.log import log_columns, write_log  # noqa: E402
from bench.humanoid.world.model import body_pose, build_world  # noqa: E402
from bench.humanoid.world.objects import OBJECT_NAMES, FlyingObject, load_object  # noqa: E402
from bench.humanoid.world.robot import (  # noqa: E402
    FREE,
    OCCUPANCY,
    PAPER,
    SETUPS,
    TIP_LINK,
    URDF,
    Setup,
    robot_in_world,
)
from bench.humanoid.world.simulate import Push, hold, simulate  # noqa: E402
from bench.humanoid.world.standing import COM_LOWER, COM_UPPER, standing_posture  # noqa: E402
from bench.humanoid.world.throws import Throw  # noqa: E402
from pdoik.view.h1_shapes import JOINT_NAMES, ROOT_LINK, SHAPES  # noqa: E402

ALL_SETUPS = pytest.mark.parametrize("setup", SETUPS.values(), ids=list(SETUPS))


def random_posture(rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(robot_in_world(FREE).lower, robot_in_world(FREE).upper)


@pytest.fixture(scope="module")
def ycb() -> Path:
    beside = Path(__file__).resolve().parents[5] / "shared"
    folder = Path(os.environ.get("PDOIK_SHARED", beside)) / "ycb"
    if not folder.is_dir():
        pytest.skip("needs ycb from the shared material (PDOIK_SHARED or ../shared)")
    return folder


@pytest.fixture(scope="module")
def things(ycb: Path) -> dict[str, FlyingObject]:
    return {name: load_object(name, ycb) for name in OBJECT_NAMES}


@pytest.fixture(scope="module")
def hits(things: dict[str, FlyingObject]) -> list[Hit]:
    return draw_throws(things, FREE, n=20, seed=0)[0]


def test_joints_come_in_the_order_of_the_solver_s_robot() -> None:
    assert tuple(robot_in_world(FREE).joint_names) == JOINT_NAMES


def test_mass_and_com_height_are_the_same_to_pinocchio_mujoco_and_pdoik() -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="needs the Python package pin")
    model = pinocchio.buildModelFromUrdf(str(URDF), pinocchio.JointModelFreeFlyer())
    data = model.createData()
    q = pinocchio.neutral(model)
    com = pinocchio.centerOfMass(model, data, q)
    pinocchio.framesForwardKinematics(model, data, q)
    ankle = data.oMf[model.getFrameId("left_ankle_link")].translation
    assert pinocchio.computeTotalMass(model) == pytest.approx(51.601, abs=1e-9)
    assert com[2] - ankle[2] == pytest.approx(0.938, abs=5e-4)

    world = build_world(FREE)
    standing = world.standing_data(np.zeros(19))
    assert world.model.body_subtreemass[world.root] == pytest.approx(51.601, abs=1e-9)
    height = standing.subtree_com[world.root, 2] - standing.xpos[world.feet[0], 2]
    assert height == pytest.approx(com[2] - ankle[2], abs=1e-9)
    assert robot_in_world(FREE).center_of_mass(np.zeros(19)) == pytest.approx(
        standing.subtree_com[world.root], abs=1e-9
    )


@pytest.mark.parametrize("seed", range(5))
def test_every_link_is_where_pinocchio_and_pdoik_put_it(seed: int) -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="needs the Python package pin")
    q = random_posture(np.random.default_rng(seed))
    model = pinocchio.buildModelFromUrdf(str(URDF))
    data = model.createData()
    q_pinocchio = np.zeros(model.nq)
    for name, angle in zip(JOINT_NAMES, q, strict=True):
        q_pinocchio[model.joints[model.getJointId(name)].idx_q] = angle
    pinocchio.framesForwardKinematics(model, data, q_pinocchio)
    T_root_ankle = data.oMf[model.getFrameId("left_ankle_link")].homogeneous

    world = build_world(FREE)
    standing = world.standing_data(q)
    robot = robot_in_world(FREE)
    for link in robot.link_names[1:]:  # all but the world
        T_world_link = body_pose(standing, world.model.body(link).id)
        T_root_link = data.oMf[model.getFrameId(link)].homogeneous
        T_base_link = np.linalg.inv(T_root_ankle) @ T_root_link
        assert FREE.T_world_base @ T_base_link == pytest.approx(robot.fk(q, link), abs=1e-9)
        assert robot.fk(q, link) == pytest.approx(T_world_link, abs=1e-9)


def test_limits_are_the_same_to_mujoco_pdoik_and_the_description() -> None:
    world, robot = build_world(FREE), robot_in_world(FREE)
    ranges = np.array([world.model.joint(name).range for name in JOINT_NAMES])
    assert ranges[:, 0] == pytest.approx(robot.lower, abs=1e-12)
    assert ranges[:, 1] == pytest.approx(robot.upper, abs=1e-12)
    limits = {
        joint.attrib["name"]: joint.find("limit").attrib
        for joint in ElementTree.parse(URDF).getroot().findall("joint")
    }
    assert robot.velocity == pytest.approx([float(limits[n]["velocity"]) for n in JOINT_NAMES])
    assert world.effort == pytest.approx([float(limits[n]["effort"]) for n in JOINT_NAMES])


def test_every_shape_lies_within_its_link_s_hulls() -> None:
    hulls = h1_hulls.read_hulls()
    assert len(hulls) <= 35
    gaps = h1_hulls.worst_gaps(hulls)
    assert len(gaps) == len(SHAPES)
    assert max(gaps.values()) <= 0
    assert h1_hulls.worst_gaps(hulls[1:])["torso_link_0"] > 0.01  # a missing hull would show


def test_mujoco_measures_distances_to_the_very_shapes_that_the_hulls_cover() -> None:
    world = build_world(FREE)
    data, rng = world.standing_data(np.zeros(19)), np.random.default_rng(0)
    assert len(world.robot_geoms) == len(SHAPES)
    for k, shape in enumerate(SHAPES):
        geom = world.model.geom(f"{shape.link}_{k}").id
        R = data.geom_xmat[geom].reshape(3, 3)
        T = body_pose(data, world.model.geom_bodyid[geom])
        points = h1_hulls.shape_surface(shape, rng)[:200]
        local = (moved(points, T) - data.geom_xpos[geom]) @ R
        size = world.model.geom_size[geom]
        if shape.kind == "sphere":
            off = np.linalg.norm(local, axis=1) - size[0]
        elif shape.kind == "capsule":
            local[:, 2] -= np.clip(local[:, 2], -size[1], size[1])
            off = np.linalg.norm(local, axis=1) - size[0]
        else:
            radial = np.linalg.norm(local[:, :2], axis=1) - size[0]
            off = np.maximum(radial, np.abs(local[:, 2]) - size[1])
        assert np.abs(off).max() < 1e-3  # the mesh is within its sagitta of the surface


@ALL_SETUPS
def test_the_standing_posture_holds_still_on_its_feet(setup: Setup) -> None:
    q = standing_posture(setup)
    robot = robot_in_world(setup)
    assert (robot.lower <= q).all()
    assert (q <= robot.upper).all()
    T_world_tip = robot.fk(q, TIP_LINK)
    assert T_world_tip[:3, 3] == pytest.approx(setup.T_world_tip[:3, 3], abs=1e-6)
    if setup is not PAPER:
        assert T_world_tip == pytest.approx(setup.T_world_tip, abs=1e-6)
    assert robot.fk(q, ROOT_LINK)[2, 2] > 0.9999
    com = robot.center_of_mass(q)
    assert (com > COM_LOWER).all()
    assert (com < COM_UPPER).all()
    if setup is FREE:
        assert -0.08 < com[1] < -0.03
    world = build_world(setup)
    torque = Controller(world).gravity_torque(world.standing_data(q))
    assert (np.abs(torque) / world.effort).max() < 0.5


@ALL_SETUPS
def test_it_stands_ten_seconds(setup: Setup) -> None:
    q = standing_posture(setup)
    run = simulate(build_world(setup), q, hold(q), 10.0)
    assert not run.fallen
    assert run.foot_drift < 1e-3
    assert np.abs(run.com[-1] - run.com[0]).max() < 1e-3


@ALL_SETUPS
@pytest.mark.parametrize("direction", [(60, 0, 0), (-60, 0, 0), (0, 60, 0), (0, -60, 0)])
def test_it_takes_a_push_of_60_n_for_a_tenth_of_a_second(
    setup: Setup, direction: tuple[float, float, float]
) -> None:
    q = standing_posture(setup)
    push = Push(force=direction, begin=0.5, end=0.6)
    run = simulate(build_world(setup), q, hold(q), 3.0, push=push)
    moved = np.linalg.norm(run.com - run.com[0], axis=1)
    assert moved.max() > 5e-4  # the push was felt
    assert not run.fallen
    assert run.foot_drift < 1e-3


def test_a_push_too_hard_is_seen_as_a_fall() -> None:
    q = standing_posture(FREE)
    run = simulate(
        build_world(FREE), q, hold(q), 3.0, push=Push(force=(0, -400, 0), begin=0.1, end=0.3)
    )
    assert run.fallen
    assert len(run.time) < 3000


@pytest.mark.parametrize("seed", range(3))
@ALL_SETUPS
def test_gravity_torques_do_the_work_that_the_weight_does(setup: Setup, seed: int) -> None:
    """In any motion with the feet at rest, tau . dq = m g dz, whatever the feet's wrenches."""
    world = build_world(setup)
    q = standing_posture(setup) + np.random.default_rng(seed).uniform(-0.1, 0.1, 19)
    data, model = world.standing_data(q), world.model
    tau = Controller(world).gravity_torque(data)
    feet, com = np.zeros((12, model.nv)), np.zeros((3, model.nv))
    for k, foot in enumerate(world.feet):
        mujoco.mj_jacBody(model, data, feet[6 * k : 6 * k + 3], feet[6 * k + 3 : 6 * k + 6], foot)
    mujoco.mj_jacSubtreeCom(model, data, com, world.root)
    held = feet[:9] if setup is PAPER else feet
    motions = np.linalg.svd(held)[2][len(held) :]  # with the feet at rest
    assert motions[:, world.dof_index] @ tau == pytest.approx(
        motions @ com[2] * 51.601 * 9.81, abs=1e-6
    )


def test_torques_and_commanded_speeds_keep_their_limits() -> None:
    q = standing_posture(FREE)
    far = q.copy()
    far[JOINT_NAMES.index("left_shoulder_roll_joint")] = 3.0
    world = build_world(FREE)
    run = simulate(world, q, hold(far), 0.5)
    assert (np.abs(run.tau) <= world.effort).all()
    assert run.saturation.max() > 0.05  # it was asked for more
    assert (np.abs(run.dq) <= 1.1 * robot_in_world(FREE).velocity).all()


@pytest.mark.parametrize("name", OBJECT_NAMES)
def test_stand_ins_are_about_as_large_as_the_scans(
    name: str, things: dict[str, FlyingObject]
) -> None:
    scan, stand_in = things[name], load_object(name)
    assert stand_in.radius == pytest.approx(scan.radius, rel=0.1)
    assert np.sort(np.ptp(stand_in.surface, axis=0)) == pytest.approx(
        np.sort(np.ptp(scan.surface, axis=0)), abs=0.03
    )


def test_the_can_s_cloud_has_the_paper_s_168_points(things: dict[str, FlyingObject]) -> None:
    assert things["002_master_chef_can"].cloud.shape == (168, 3)


def test_an_unknown_object_is_refused() -> None:
    with pytest.raises(ValueError, match="name is 'brick'"):
        load_object("brick")


def test_a_swept_cloud_holds_the_object_at_every_instant(things: dict[str, FlyingObject]) -> None:
    thing = things["011_banana"]
    throw = Throw(
        object_name=thing.name,
        aim=(0.0, 0.0, 1.2),
        start=(0.3, -2.4, 1.5),
        speed=3.0,
        arc=0.4,
        tumble=(4.0, 2.0, 0.0),
    )
    balls = throw.swept_cloud(thing, 0.3, 0.5)
    for t in np.linspace(0.3, 0.5, 17):
        points = moved(thing.surface, throw.pose(t))[::20]
        gaps = np.linalg.norm(points[:, None] - balls[:, :3], axis=2) - balls[:, 3]
        assert gaps.min(axis=1).max() <= 0


def test_a_path_leads_through_its_aim_at_any_speed() -> None:
    throw = Throw(
        object_name="011_banana", aim=(0.1, 0, 1.2), start=(0.3, -2.4, 1.5), speed=3.0, arc=0.4
    )
    for speed in (0.25, 1.0, 4.0):
        other = throw.at_speed(speed)
        assert other.pose(0)[:3, 3] == pytest.approx(throw.start)
        assert other.pose(other.arrival)[:3, 3] == pytest.approx(throw.aim)
        assert other.pose(0.3 * other.arrival) == pytest.approx(throw.pose(0.3 * throw.arrival))


def test_each_of_twenty_throws_hits_a_robot_that_stands_still(hits: list[Hit]) -> None:
    assert len(hits) == 20
    assert {hit.throw.object_name for hit in hits} == set(OBJECT_NAMES)
    assert len({hit.contact.link for hit in hits}) >= 4
    for hit in hits:
        assert 2.0 <= hit.throw.speed <= 4.0
        assert hit.contact.time > 0.3


def test_drawing_throws_again_gives_the_same_ones(
    hits: list[Hit], things: dict[str, FlyingObject]
) -> None:
    assert draw_throws(things, FREE, n=3, seed=0)[0] == hits[:3]


def test_contact_and_distance_agree(hits: list[Hit], things: dict[str, FlyingObject]) -> None:
    hit, q = hits[0], standing_posture(FREE)
    world = build_world(FREE, things[hit.throw.object_name])
    run = simulate(world, q, hold(q), throw=hit.throw, stop_at_contact=True)
    assert run.contact is not None
    before = run.distance_time < run.contact.time - 0.002
    assert (run.distance[before] > 0).all()
    assert run.distance[-1] < 0.02
    assert not run.dodged


def test_a_log_has_one_column_per_joint_and_signal(tmp_path: Path) -> None:
    q = standing_posture(FREE)
    run = simulate(build_world(FREE), q, hold(q), 0.05)
    write_log(run, tmp_path / "run.csv")
    header = (tmp_path / "run.csv").read_text().splitlines()[0]
    assert header.split(",") == log_columns()
    rows = np.loadtxt(tmp_path / "run.csv", delimiter=",", skiprows=1)
    assert rows.shape == (50, 1 + 4 * 19 + 7)
    column = log_columns().index("q.left_knee_joint")
    assert rows[:, column] == pytest.approx(run.q[:, JOINT_NAMES.index("left_knee_joint")])
    assert [path.name for path in tmp_path.iterdir()] == ["run.csv"]


def test_the_shipped_hulls_load() -> None:
    occupancy = pdoik.Occupancy.load(OCCUPANCY)
    assert len(occupancy.spheroids) + len(occupancy.spheres) == len(h1_hulls.read_hulls())
