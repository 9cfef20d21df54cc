"""The simulation of whole arms against Pinocchio."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="needs the Python package mujoco")
pinocchio = pytest.importorskip("pinocchio", reason="needs the Python package pin")

import pdoik  # noqa: E402
from pdoik.recordings import Recording  # noqa: E402
from pdoik.sim2real.effects import parts_of  # noqa: E402
from pdoik.sim2real.simulation import (  # noqa: E402
    GravityModel,
    Simulator,
    Stepper,
)
from sim2real_robots import commands, pd  # noqa: E402

ROBOTS = Path(pdoik.__file__).parent / "robots"
PANDA, UR10 = ROBOTS / "panda.urdf", ROBOTS / "ur10.urdf"
JOINTS = tuple(f"panda_joint{k}" for k in range(1, 8))
POSE = np.array([0.3, -0.4, 0.2, -1.8, 0.4, 1.6, 0.5])


def waves(t: np.ndarray) -> np.ndarray:
    return POSE + 0.3 * np.sin(np.outer(t, np.linspace(1.0, 2.5, 7)))


def inverse_dynamics(model: Any, run: Recording) -> np.ndarray:
    """Torques for a run's motion, with accelerations by central differences."""
    data = model.createData()
    assert run.dq is not None
    ddq = np.gradient(run.dq, run.period, axis=0)
    rows = zip(run.q, run.dq, ddq, strict=True)
    return np.array([pinocchio.rnea(model, data, *row).copy() for row in rows])


@pytest.fixture(scope="module")
def motion() -> Recording:
    time = 1e-3 * np.arange(2001)
    speed = np.gradient(waves(time), 1e-3, axis=0)
    return commands(2.0, n=7, q=waves, q_des=waves, dq_des=speed)


def panda_with(link: str, mass: float, com: np.ndarray, inertia: np.ndarray) -> Any:
    model = pinocchio.buildModelFromUrdf(str(PANDA))
    frame = model.frames[model.getFrameId(link)]
    body = frame.placement.act(pinocchio.Inertia(mass, com, inertia))
    model.inertias[frame.parentJoint] += body
    return model


@pytest.mark.parametrize("effect", ["none", "payload", "link_inertial_error", "gravity_direction"])
def test_the_torque_of_a_simulated_motion_is_its_inverse_dynamics(
    effect: str, motion: Recording
) -> None:
    com, inertia = np.array([0.02, -0.03, 0.1]), np.diag([0.01, 0.02, 0.015])
    model = pinocchio.buildModelFromUrdf(str(PANDA))
    links, values = [], {}
    if effect == "payload":
        links = ["panda_link8"]
        model = panda_with("panda_link8", 2.0, com, inertia)
        values = dict(zip(("com_x", "com_y", "com_z"), com, strict=True))
        values |= {"mass": 2.0, "ixx": 0.01, "iyy": 0.02, "izz": 0.015}
    elif effect == "link_inertial_error":
        links = ["panda_link4"]
        model = panda_with("panda_link4", 1.5, com, inertia)
        whole = pinocchio.Inertia(1.5, com, inertia).toDynamicParameters()
        names = ["d_mass", *(f"d_first_moment_{axis}" for axis in "xyz")]
        names += [f"d_i{axes}" for axes in ("xx", "xy", "yy", "xz", "yz", "zz")]
        values = dict(zip(names, whole, strict=True))
    elif effect == "gravity_direction":
        values = {"tilt_x": 0.05, "tilt_y": -0.08}
        model.gravity.linear = 9.81 * np.array(
            [np.sin(-0.08) * np.cos(0.05), -np.sin(0.05), -np.cos(0.05) * np.cos(-0.08)]
        )
    added = () if effect == "none" else parts_of(effect, [], links, None, values)
    simulator = Simulator(PANDA, JOINTS, pd(2000.0, 100.0, 7), np.zeros(7), added, timestep=5e-4)
    run = simulator.replay(motion)
    expected = inverse_dynamics(model, run)
    inner = slice(200, -2)
    assert run.tau is not None
    # Torques are logged at the start of steps: half a step of their change is in the difference.
    assert run.tau[inner] == pytest.approx(expected[inner], abs=0.08)
    plain = inverse_dynamics(pinocchio.buildModelFromUrdf(str(PANDA)), run)
    if effect != "none":
        assert np.abs(run.tau - plain)[inner].max() > 1.0


@pytest.mark.parametrize("seed", range(5))
def test_the_controller_s_gravity_is_pinocchio_s(seed: int) -> None:
    q = np.random.default_rng(seed).uniform(-2, 2, 7)
    model = pinocchio.buildModelFromUrdf(str(PANDA))
    expected = pinocchio.computeGeneralizedGravity(model, model.createData(), q)
    assert GravityModel(PANDA, JOINTS)(q.tolist()) == pytest.approx(expected, abs=1e-10)


def test_gravity_compensation_does_not_know_of_a_payload(motion: Recording) -> None:
    still = commands(3.0, n=7, q=POSE, q_des=POSE)
    controller = pd(2000.0, 200.0, 7, gravity_compensation=True)
    rotor = np.full(7, 0.2)
    held = Simulator(PANDA, JOINTS, controller, rotor).replay(still)
    assert held.q == pytest.approx(still.q, abs=1e-9)
    payload = parts_of("payload", [], ["panda_link8"], None, {"mass": 3.0, "com_z": 0.1})
    loaded = Simulator(PANDA, JOINTS, controller, rotor, payload).replay(still)
    model = panda_with("panda_link8", 3.0, np.array([0, 0, 0.1]), np.zeros((3, 3)))
    expected = pinocchio.rnea(model, model.createData(), loaded.q[-1], np.zeros(7), np.zeros(7))
    assert loaded.tau is not None
    assert loaded.tau[-1] == pytest.approx(expected, abs=1e-3)
    assert np.abs(loaded.q[-1] - POSE).max() > 1e-3


def model_pose(model: Any, q: np.ndarray) -> np.ndarray:
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, q)
    return np.asarray(data.oMf[model.getFrameId("tool0")].homogeneous)


def test_some_joints_in_any_order_with_the_others_held() -> None:
    joints = ("wrist_1_joint", "shoulder_lift_joint", "elbow_joint")
    stepper = Stepper(UR10, joints, rotor_inertia=np.zeros(3), tip="tool0")
    model = pinocchio.buildModelFromUrdf(str(UR10))
    q, dq = np.array([0.4, -0.9, 1.2]), np.array([0.5, 0.2, -0.7])
    stepper.reset(q, dq)
    place = [model.joints[model.getJointId(joint)].idx_v for joint in joints]
    whole_q, whole_dq = np.zeros(6), np.zeros(6)
    whole_q[place], whole_dq[place] = q, dq
    expected = model_pose(model, whole_q)
    assert stepper.tip_pose == pytest.approx(expected, abs=1e-9)
    whole_q[place] += 0.5 * stepper.timestep * dq  # leapfrog: accelerations of the middle
    data = model.createData()
    M = pinocchio.crba(model, data, whole_q)
    M = (np.triu(M) + np.triu(M, 1).T)[np.ix_(place, place)]
    bias = pinocchio.nle(model, data, whole_q, whole_dq)[place]
    dt = stepper.timestep
    stepper.step([0.0, 0.0, 0.0])
    assert (stepper.dq - dq) / dt == pytest.approx(np.linalg.solve(M, -bias), rel=1e-9)


def test_a_displaced_joint_moves_the_tip_as_pinocchio_says() -> None:
    values = {"dx": 0.01, "dy": -0.02, "dz": 0.005, "rx": 0.03, "ry": -0.02, "rz": 0.04}
    error = parts_of("kinematic_error", ["panda_joint4"], values=values)
    run = commands(0.02, n=7, q=POSE, q_des=POSE)
    simulator = Simulator(PANDA, JOINTS, pd(1.0, 1.0, 7), np.full(7, 1.0), error, tip="panda_link8")
    pose = simulator.replay(run, tip=True).tip
    assert pose is not None
    model = pinocchio.buildModelFromUrdf(str(PANDA))
    joint = model.getJointId("panda_joint4")
    place = model.jointPlacements[joint].copy()  # shifted in the parent's axes, turned in its own
    place.translation = place.translation + np.array([0.01, -0.02, 0.005])
    place.rotation = place.rotation @ pinocchio.exp3(np.array([0.03, -0.02, 0.04]))
    model.jointPlacements[joint] = place
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, POSE)
    expected = data.oMf[model.getFrameId("panda_link8")]
    assert pose[0, :3] == pytest.approx(expected.translation, abs=1e-9)
    w, x, y, z = pose[0, 3:]
    R = pinocchio.Quaternion(w, x, y, z).toRotationMatrix()
    assert pytest.approx(expected.rotation, abs=1e-9) == R
