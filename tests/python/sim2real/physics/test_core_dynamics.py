"""The rigid body of pdoik.sim2real against MuJoCo and finite differences."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

import mujoco

import pdoik
from pdoik.sim2real.motion import RigidBody

ROBOTS = Path(pdoik.__file__).parent / "robots"
PANDA = ROBOTS / "panda.urdf", tuple(f"panda_joint{k}" for k in (3, 1, 7, 4, 2, 6, 5))
UR10 = (
    ROBOTS / "ur10.urdf",
    tuple(
        f"{name}_joint"
        for name in ("elbow", "wrist_3", "shoulder_pan", "wrist_1", "shoulder_lift", "wrist_2")
    ),
)
PART = ROBOTS / "panda.urdf", ("panda_joint6", "panda_joint2", "panda_joint4")  # others held
ARMS = pytest.mark.parametrize("arm", [PANDA, UR10, PART], ids=["panda", "ur10", "part of panda"])
ROWS = 6
STEP = 1e-5


class Judge:
    """MuJoCo's model of the same URDF: links, joints and inertias, nothing that could touch."""

    def __init__(self, robot: Path, joints: tuple[str, ...]) -> None:
        bare = ElementTree.Element("robot", {"name": "judge"})
        settings = ElementTree.SubElement(bare, "mujoco")
        plain = {"fusestatic": "false", "balanceinertia": "false", "boundmass": "0"}
        ElementTree.SubElement(settings, "compiler", plain)
        for element in ElementTree.parse(robot).getroot():
            if element.tag in ("link", "joint"):
                for part in [p for p in element if p.tag in ("visual", "collision", "dynamics")]:
                    element.remove(part)
                bare.append(element)
        self.model = mujoco.MjModel.from_xml_string(ElementTree.tostring(bare, encoding="unicode"))
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        self.data = mujoco.MjData(self.model)
        self.place = np.array([self.model.joint(name).dofadr[0] for name in joints])

    def torque(self, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> np.ndarray:
        """Inverse dynamics, (T, n)."""
        rows = []
        for each in zip(q, dq, ddq, strict=True):
            for name, values in zip(("qpos", "qvel", "qacc"), each, strict=True):
                getattr(self.data, name)[self.place] = values
            mujoco.mj_inverse(self.model, self.data)
            rows.append(self.data.qfrc_inverse[self.place].copy())
        return np.array(rows)

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        """(n, n)."""
        self.data.qpos[self.place] = q
        mujoco.mj_forward(self.model, self.data)
        full = np.zeros((self.model.nv, self.model.nv))
        for i, unit in enumerate(np.eye(self.model.nv)):
            mujoco.mj_mulM(self.model, self.data, full[i], unit)
        return full[np.ix_(self.place, self.place)]

    def pose(self, q: np.ndarray, link: str) -> np.ndarray:
        """Of a link in the world, (4, 4)."""
        self.data.qpos[self.place] = q
        mujoco.mj_kinematics(self.model, self.data)
        body = self.data.body(link)
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = body.xmat.reshape(3, 3), body.xpos
        return T


def motion(n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Random positions, speeds and accelerations; one of the positions is zero."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.5, 1.5, (ROWS, n))
    q[0] = 0.0
    return q, rng.uniform(-2, 2, (ROWS, n)), rng.uniform(-5, 5, (ROWS, n))


def body_of(arm: tuple[Path, tuple[str, ...]], rotor: Any = None) -> RigidBody:
    return RigidBody(*arm, rotor)


@ARMS
@pytest.mark.parametrize("seed", range(3))
def test_torques_are_mujocos_inverse_dynamics_in_the_studys_order(arm: Any, seed: int) -> None:
    body, judge = body_of(arm), Judge(*arm)
    q, dq, ddq = motion(body.n, seed)
    expected = judge.torque(q, dq, ddq)
    assert np.abs(expected).max() > 5.0
    assert body.dynamics(q, dq, ddq).tau == pytest.approx(expected, abs=1e-6)
    assert body.torque(q, dq, ddq) == pytest.approx(expected, abs=1e-6)
    still = np.zeros_like(q)
    assert body.gravity(q) == pytest.approx(judge.torque(q, still, still), abs=1e-6)


@ARMS
def test_the_mass_matrix_is_mujocos_and_the_diagonal_has_the_rotors(arm: Any) -> None:
    body, judge = body_of(arm), Judge(*arm)
    q, dq, ddq = motion(body.n)
    rotor = np.linspace(0.1, 0.9, body.n)
    mass = body_of(arm, rotor).dynamics(q, dq, ddq).mass_matrix  # never with rotors
    diagonal = body_of(arm, rotor).mass_diagonal(q[2])
    for t in range(ROWS):
        assert mass[t] == pytest.approx(judge.mass_matrix(q[t]), abs=1e-8)
    assert diagonal == pytest.approx(np.diag(mass[2]) + rotor, abs=1e-9)


@ARMS
def test_derivatives_by_position_and_speed_are_central_differences(arm: Any) -> None:
    body, judge = body_of(arm), Judge(*arm)
    q, dq, ddq = motion(body.n, 1)
    found = body.dynamics(q, dq, ddq)
    for j, unit in enumerate(STEP * np.eye(body.n)):
        by_q = judge.torque(q + unit, dq, ddq) - judge.torque(q - unit, dq, ddq)
        by_v = judge.torque(q, dq + unit, ddq) - judge.torque(q, dq - unit, ddq)
        assert found.dtau_dq[:, :, j] == pytest.approx(by_q / (2 * STEP), abs=1e-4)
        assert found.dtau_dv[:, :, j] == pytest.approx(by_v / (2 * STEP), abs=1e-4)
    scale = np.abs(found.dtau_dq).max(), np.abs(found.dtau_dv).max()
    assert min(scale) > 1.0  # or the tolerances would say nothing


@ARMS
def test_the_change_with_gravity_is_what_mujoco_needs_more_for_each_axis(arm: Any) -> None:
    body, judge = body_of(arm), Judge(*arm)
    q, dq, ddq = motion(body.n, 2)
    found = body.dynamics(q, dq, ddq).dtau_dgravity
    here = judge.torque(q, dq, ddq)
    for axis in range(3):
        judge.model.opt.gravity[axis] += 1.0
        assert found[:, :, axis] == pytest.approx(judge.torque(q, dq, ddq) - here, abs=1e-6)
        judge.model.opt.gravity[axis] -= 1.0


@ARMS
def test_the_regressor_times_the_bodys_own_parameters_is_its_torque(arm: Any) -> None:
    body = body_of(arm, np.full(len(arm[1]), 0.3))
    q, dq, ddq = motion(body.n, 3)
    parameters = body.inertial_parameters()
    regressor = body.regressor(q, dq, ddq)
    assert regressor.shape == (ROWS, body.n, body.n, 10)
    by_parameters = np.einsum("tjlk,lk->tj", regressor, parameters)
    assert by_parameters == pytest.approx(Judge(*arm).torque(q, dq, ddq), abs=1e-6)
    for link in range(body.n):  # joints that do not carry a link know nothing of it
        beyond = [j for j in range(body.n) if body.depth[j] > body.depth[link]]
        assert np.abs(regressor[:, beyond, link]).max(initial=0.0) < 1e-12


@ARMS
def test_a_link_heavier_in_mujoco_needs_what_the_regressor_says(arm: Any) -> None:
    body, judge = body_of(arm), Judge(*arm)
    q, dq, ddq = motion(body.n, 4)
    here = judge.torque(q, dq, ddq)
    for j, name in enumerate(arm[1]):
        link = judge.model.jnt_bodyid[judge.model.joint(name).id]
        com = judge.model.body_ipos[link]
        judge.model.body_mass[link] += 0.7  # a point at the link's centre of mass
        more = judge.torque(q, dq, ddq) - here
        judge.model.body_mass[link] -= 0.7
        x, y, z = com
        about = [y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y]
        point = 0.7 * np.array([1.0, x, y, z, *about])
        change = body.regressor(q, dq, ddq)[:, :, j] @ point
        assert change == pytest.approx(more, abs=1e-6), name


@ARMS
def test_poses_and_jacobians_are_mujocos(arm: Any) -> None:
    body, judge = body_of(arm), Judge(*arm)
    q = motion(body.n, 5)[0]
    link = body.links[body.last]
    poses, jacobians = body.poses_and_jacobians(q, body.frame(None))
    for t in range(ROWS):
        assert poses[t] == pytest.approx(judge.pose(q[t], link), abs=1e-9)
        linear, angular = np.zeros((2, 3, judge.model.nv))
        mujoco.mj_comPos(judge.model, judge.data)
        mujoco.mj_jacBody(judge.model, judge.data, linear, angular, judge.model.body(link).id)
        expected = np.vstack([linear, angular])[:, judge.place]
        assert jacobians[t] == pytest.approx(expected, abs=1e-9)
    each = body.joint_poses(q)
    for j, name in enumerate(body.links):
        assert each[3, j] == pytest.approx(judge.pose(q[3], name), abs=1e-9)


@ARMS
def test_a_displaced_joint_is_a_body_displaced_in_its_parents_axes_and_turned_in_its_own(
    arm: Any,
) -> None:
    body, judge = body_of(arm), Judge(*arm)
    q, dq, ddq = motion(body.n, 6)
    shift, turn = np.array([0.03, -0.02, 0.05]), np.array([0.2, -0.1, 0.3])
    angle = np.linalg.norm(turn)
    wxyz = np.append(np.cos(angle / 2), np.sin(angle / 2) * turn / angle)
    for j, name in enumerate(arm[1]):
        moved = Judge(*arm)
        link = moved.model.jnt_bodyid[moved.model.joint(name).id]
        moved.model.body_pos[link] += shift
        before = moved.model.body_quat[link].copy()
        mujoco.mju_mulQuat(moved.model.body_quat[link], before, wxyz)
        # Held joints are part of the placement: its parent is the last link that moves.
        parent = _parent_rotation(judge, name, arm[1])
        other = body.displaced(j, parent @ shift, turn)
        assert other.torque(q, dq, ddq) == pytest.approx(moved.torque(q, dq, ddq), abs=1e-6)
        poses, _ = other.poses_and_jacobians(q, other.frame(None))
        expected = [moved.pose(row, body.links[body.last]) for row in q]
        assert poses == pytest.approx(np.array(expected), abs=1e-9)
    assert body.torque(q, dq, ddq) == pytest.approx(judge.torque(q, dq, ddq), abs=1e-6)


def _parent_rotation(judge: Judge, joint: str, joints: tuple[str, ...]) -> np.ndarray:
    """From the axes of a joint's parent link to those of the last link that a study joint moves."""
    model = judge.model
    judge.data.qpos[:] = 0.0
    mujoco.mj_kinematics(model, judge.data)
    moving = {int(model.jnt_bodyid[model.joint(name).id]) for name in joints}
    parent = model.body_parentid[model.jnt_bodyid[model.joint(joint).id]]
    above = parent
    while above and above not in moving:
        above = model.body_parentid[above]
    rotations = [judge.data.xmat[k].reshape(3, 3) for k in (above, parent)]
    return rotations[0].T @ rotations[1]


def test_rotors_damping_and_dry_friction_of_the_description_are_part_of_its_torque(
    tmp_path: Path,
) -> None:
    robot = tmp_path / "arm.urdf"
    inertial = (
        '<inertial><origin xyz="0.1 0.02 0"/><mass value="1.5"/>'
        '<inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    robot.write_text(f"""<robot name="arm"><link name="base"/>
      <link name="a">{inertial}</link><link name="b">{inertial}</link>
      <joint name="first" type="continuous"><parent link="base"/><child link="a"/>
        <axis xyz="0 1 0"/><dynamics damping="0.7" friction="0.3"/></joint>
      <joint name="second" type="prismatic"><parent link="a"/><child link="b"/>
        <origin xyz="0.2 0 0"/><axis xyz="1 0 0"/><dynamics damping="2.5" friction="1.25"/>
        <limit lower="-1" upper="1" effort="9" velocity="2"/></joint></robot>""")
    joints = ("second", "first")
    rotor = np.array([0.4, 0.05])
    body, judge = RigidBody(robot, joints, rotor), Judge(robot, joints)
    q, dq, ddq = motion(2, 7)
    dq[np.abs(dq) < 0.1] = 0.5
    rest = np.array([2.5, 0.7]) * dq + np.array([1.25, 0.3]) * np.sign(dq) + rotor * ddq
    rigid = judge.torque(q, dq, ddq)
    assert body.dynamics(q, dq, ddq).tau == pytest.approx(rigid + rest, abs=1e-6)
    assert body.torque(q, dq, ddq) == pytest.approx(rigid, abs=1e-6)
    standing = body.dynamics(q, 0.0 * dq, 0.0 * ddq).tau
    assert standing == pytest.approx(judge.torque(q, 0.0 * dq, 0.0 * ddq), abs=1e-6)
    assert body.axis(0) is None  # it slides
    assert body.axis(1) == pytest.approx([0.0, 1.0, 0.0])


def test_a_joint_of_more_than_one_degree_of_freedom_is_refused(tmp_path: Path) -> None:
    robot = tmp_path / "ball.urdf"
    robot.write_text("""<robot name="ball"><link name="base"/><link name="a"><inertial>
      <mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="free" type="floating"><parent link="base"/><child link="a"/></joint></robot>""")
    with pytest.raises(ValueError, match="joint free has not one degree of freedom"):
        RigidBody(robot, ("free",), None)


def test_a_tip_that_is_no_link_is_refused() -> None:
    with pytest.raises(ValueError, match="tip 'gripper' is no link of the robot"):
        body_of(UR10).frame("gripper")
    body = body_of(UR10)
    assert body.model.frames[body.frame("tool0")].name == "tool0"


def test_places_along_the_chain_follow_the_robot_not_the_studys_order() -> None:
    path, joints = UR10
    body = RigidBody(path, joints, None)
    chain = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
    depth = [chain.index(name.removesuffix("_joint")) + 1 for name in joints]
    assert body.depth.tolist() == depth
    assert joints[body.last] == "wrist_3_joint"
    assert body.links[body.last] == "wrist_3_link"
    pairs = {(joints[a], joints[b]) for a, b in body.neighbours()}
    expected = {(f"{a}_joint", f"{b}_joint") for a, b in pairwise(chain)}
    assert pairs == expected | {(b, a) for a, b in expected}
