"""mink (MuJoCo): a frame task that follows the stations by quadratic programs, inside limits.

Nothing keeps it off itself or obstacles, as its users' examples have it for arms that follow.
"""

from typing import Any
from xml.etree import ElementTree

import mink
import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.paths.arms import judge_of, robot_of, spec_of
from bench.ik.paths.problem import Problem

SOLVER, DAMPING, POSTURE = "daqp", 1e-6, 1e-4
STARTS, ITERATIONS, FIRST = 20, 10, 80  # of the path, of a station, of the first one
EXACT = 5e-6  # [m] and [rad]


def follows(problem: Problem, rng: np.random.Generator) -> FloatArray | None:
    """Follow from random starts, until one meets all stations."""
    model = _model(problem)
    configuration, limits = mink.Configuration(model), [mink.ConfigurationLimit(model)]
    robot = problem.robot
    at = [int(model.joint(name).qposadr[0]) for name in robot.joint_names]
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    turns = [1.0, 1.0, 0.0] if problem.free else [1.0, 1.0, 1.0]
    task = mink.FrameTask("tool", "site", position_cost=1.0, orientation_cost=turns)
    posture = mink.PostureTask(model, cost=POSTURE)

    def meets(T: FloatArray, steps: int) -> bool:
        target = _turned_to(T, configuration) if problem.free else T
        task.set_target(mink.SE3.from_matrix(target))
        for _ in range(steps):
            if np.abs(task.compute_error(configuration)[:6] * [1, 1, 1, *turns]).max() < EXACT:
                return True
            posture.set_target(configuration.q)
            v = mink.solve_ik(
                configuration, [task, posture], 1.0, SOLVER, damping=DAMPING, limits=limits
            )
            configuration.integrate_inplace(v, 1.0)
        return False

    for _ in range(STARTS):
        q = np.zeros(model.nq)
        q[at] = rng.uniform(low, high)
        configuration.update(q)
        Q: list[Any] = []
        for T in problem.T:
            if not meets(T, ITERATIONS if Q else FIRST):
                break
            Q.append(configuration.q[at].copy())
        if len(Q) == len(problem.T):
            Q = [*Q, Q[0]] if problem.closed else Q
            # by what a program's rounding leaves
            return np.asarray(np.clip(Q, robot.lower, robot.upper))
    return None


def _turned_to(T: FloatArray, configuration: Any) -> FloatArray:
    """A goal whose turn about z is free, with the turn that is nearest."""
    at = configuration.get_transform_frame_to_world("tool", "site").as_matrix()
    R = T[:3, :3].T @ at[:3, :3]
    turn = np.arctan2(R[1, 0] - R[0, 1], R[0, 0] + R[1, 1])
    turned = T.copy()
    turned[:3, :3] = T[:3, :3] @ Rotation.from_rotvec([0.0, 0.0, turn]).as_matrix()
    return turned


def _model(problem: Problem) -> Any:
    """The arm without shapes, and a site at the tool."""
    xml = ElementTree.fromstring(spec_of(problem.arm).description())
    for link in xml.iterfind("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(xml, encoding="unicode"))
    spec.compiler.balanceinertia = True
    spec.compiler.boundmass = spec.compiler.boundinertia = 1e-3
    last = robot_of(problem.arm).joint_names[-1]
    body = next(each for each in spec.bodies if any(joint.name == last for joint in each.joints))
    model = judge_of(problem.arm).kinematics.model
    frame = model.frames[model.getFrameId(problem.robot.tip_links[0])]
    T = frame.placement.homogeneous @ problem.tool
    x, y, z, w = Rotation.from_matrix(T[:3, :3]).as_quat()
    body.add_site(name="tool", pos=T[:3, 3], quat=[w, x, y, z])
    return spec.compile()
