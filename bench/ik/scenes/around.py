"""Random objects around an arm, and what trials need of an arm, made once per process."""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm
from bench.ik.judges.arm_meshes import arm_meshes
from bench.ik.judges.meshes import Body, MeshJudge, self_judge
from bench.ik.judges.recheck import UrdfChain
from bench.ik.methods import Method, Problem, Terms, make_method
from bench.ik.scenes.objects import ObjectModel, Scene, primitive_models, random_scene, ycb_models

START_INSET = 0.01  # the start is moved this much of each range off the limits


def random_scene_around(
    arm: Arm, judge: MeshJudge, models: Sequence[ObjectModel], n_objects: int, seed: Any
) -> tuple[FloatArray, Scene, tuple[Body, ...]]:
    """A random configuration, objects clear of it by their meshes, and those meshes.

    These are steps 1 and 2 of the paper's list; objects that touch are drawn again. The seed is
    what numpy.random.default_rng takes.
    """
    rng = np.random.default_rng(seed)
    q = arm.random_configuration(rng)
    bodies: list[Body] = []

    def is_clear(scene: Scene) -> bool:
        placed = scene.objects[-1]
        body = Body.of(placed.model.name, placed.triangles)
        if judge.collision(q, [body]) is not None:
            return False
        bodies.append(body)
        return True

    return q, random_scene(rng, models, n_objects, is_clear), tuple(bodies)


def start_configuration(arm: Arm) -> FloatArray:
    """Zero, moved off the limits, (n,) [rad]."""
    inset = START_INSET * (arm.robot.upper - arm.robot.lower)
    return np.clip(0.0, arm.robot.lower + inset, arm.robot.upper - inset)


@cache
def arm_named(robot: str) -> Arm:
    """A shipped robot."""
    return Arm.builtin(robot)


@cache
def chain_of(robot: str) -> UrdfChain:
    """The robot's kinematics by plain NumPy."""
    return UrdfChain(arm_named(robot).urdf, arm_named(robot).robot.joint_names)


@cache
def mesh_judge(robot: str) -> MeshJudge:
    """Says what it runs into, by the published meshes."""
    return MeshJudge(arm_named(robot))


@cache
def itself_judge(robot: str) -> Callable[[FloatArray], bool]:
    """Says of a configuration whether its links meet, by the published meshes."""
    return self_judge(pdoik.Robot.builtin(robot), arm_meshes(arm_named(robot)))


@cache
def models_of(ycb: str | None) -> tuple[ObjectModel, ...]:
    """The YCB objects of a folder, or primitives without one."""
    return primitive_models() if ycb is None else ycb_models(Path(ycb))


@cache
def prepared_method(name: str, robot: str, terms: Terms, libraries: str = "") -> Method:
    """A method that has solved one easy problem, so that no trial pays for its first call."""
    arm = arm_named(robot)
    method = make_method(name, arm, terms, Path(libraries))
    q0 = arm.robot.mid_configuration()
    point = np.array([[0.0, 0.0, 5.0, 0.01]])
    method.solve(Problem(T_base_tip=arm.robot.fk(q0 + 0.01), q0=q0, points=point))
    return method
