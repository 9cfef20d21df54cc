"""The paper's first experiment, trial by trial: scenarios, methods, criteria (Sec. exp1)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from bench.ik.experiment import ARMS, Arm
from bench.ik.judges.arm_meshes import arm_meshes
from bench.ik.judges.itself import self_judge
from bench.ik.judges.meshes import Body, MeshJudge
from bench.ik.judges.recheck import UrdfChain
from bench.ik.methods import Answer, Method, Problem, Terms, make_method
from bench.ik.scenes.objects import ObjectModel, Scene, primitive_models, random_scene, ycb_models

FloatArray = npt.NDArray[np.float64]

LIMIT_TOLERANCE = 0.01  # criterion 4, of each joint's range
START_INSET = 0.01  # the start is moved this much of each range off the limits


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """Objects about an arm, and a target that one configuration reaches clear of them."""

    q: FloatArray  # that configuration, (n,) [rad]
    T_base_tip: FloatArray  # (4, 4)
    objects: tuple[Body, ...]  # meshes in the base frame
    cloud: FloatArray  # (K, 3) [m]


def random_scenario(
    arm: Arm,
    judge: MeshJudge,
    models: Sequence[ObjectModel],
    n_objects: int,
    leaf: float,
    seed: Any,
) -> Scenario:
    """Steps 1 and 2 of the paper's list; objects that touch the configuration are drawn again.

    Args:
        arm: The robot, at the origin.
        judge: Of collisions, on meshes.
        models: To draw objects from.
        n_objects: How many.
        leaf: Of the voxel grid over the joined cloud, anchored at the origin [m].
        seed: What numpy.random.default_rng takes.
    """
    q, scene, bodies = random_scene_around(arm, judge, models, n_objects, seed)
    return Scenario(q=q, T_base_tip=arm.robot.fk(q), objects=bodies, cloud=scene.cloud(leaf))


def random_scene_around(
    arm: Arm, judge: MeshJudge, models: Sequence[ObjectModel], n_objects: int, seed: Any
) -> tuple[FloatArray, Scene, tuple[Body, ...]]:
    """A random configuration, objects clear of it by their meshes, and those meshes."""
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


def scenario_seed(seed: int, robot: str, n_objects: int, index: int) -> list[int]:
    """What one scenario of the campaign with this seed is drawn from."""
    return [seed, sorted(ARMS).index(robot), n_objects, index]


def start_configuration(arm: Arm) -> FloatArray:
    """Zero, moved off the limits, (n,) [rad]."""
    inset = START_INSET * (arm.robot.upper - arm.robot.lower)
    return np.clip(0.0, arm.robot.lower + inset, arm.robot.upper - inset)


@dataclass(frozen=True, slots=True)
class Criteria:
    """Judges answers by the paper's four criteria, with none of the library's own functions."""

    chain: UrdfChain
    judge: MeshJudge
    meets_itself: Callable[[FloatArray], bool]
    tip_link: str

    @classmethod
    def of(cls, arm: Arm) -> Criteria:
        """For answers of this arm."""
        chain = UrdfChain(arm.urdf, arm.robot.joint_names)
        return cls(chain, mesh_judge(arm.name), itself_judge(arm.name), arm.tip_link)

    def verdict(self, scenario: Scenario, answer: Answer, terms: Terms) -> dict[str, Any]:
        """Errors, violations and which criteria hold."""
        T, target = self.chain.fk(answer.q, self.tip_link), scenario.T_base_tip
        axis = "xyz".index(terms.goal_axis)
        a, b = T[:3, axis], target[:3, axis]
        position_error = float(np.linalg.norm(T[:3, 3] - target[:3, 3]))
        rotation_error = float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
        lower, upper = self.chain.limits.T
        beyond = np.maximum(lower - answer.q, answer.q - upper) / (upper - lower)
        collision = self.judge.collision(answer.q, scenario.objects)
        in_time = answer.time <= terms.max_time
        reached = (
            position_error < terms.position_tolerance and rotation_error < terms.rotation_tolerance
        )
        within = bool(beyond.max() <= LIMIT_TOLERANCE)
        return {
            "position_error": position_error,
            "rotation_error": rotation_error,
            "limit_violation": float(max(beyond.max(), 0.0)),
            "collision": collision or "",
            "in_time": in_time,
            "fails_limits": not within,
            "fails_collision": collision is not None,
            "fails_pose": not reached,
            "meets_itself": self.meets_itself(answer.q),  # no criterion of the paper's
            "success": in_time and reached and within and collision is None,
        }


def run_block(job: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The trials of some consecutive scenarios of one arm and number of objects.

    Args:
        job: robot, n_objects, first, count, seed, leaf, ycb, max_time, tolerance [m] and [rad]; and
            methods, a list of (name, goal axis, number of scenarios that it takes part in).
    """
    arm = arm_named(job["robot"])
    criteria, models = Criteria.of(arm), models_of(job["ycb"])
    q0 = start_configuration(arm)
    rows = []
    for index in range(job["first"], job["first"] + job["count"]):
        seed = scenario_seed(job["seed"], arm.name, job["n_objects"], index)
        scenario = random_scenario(arm, criteria.judge, models, job["n_objects"], job["leaf"], seed)
        problem = Problem(T_base_tip=scenario.T_base_tip, q0=q0, points=scenario.cloud)
        for name, axis, count in job["methods"]:
            if index >= count:
                continue
            terms = Terms(
                goal_axis=axis,
                position_tolerance=job["tolerance"],
                rotation_tolerance=job["tolerance"],
                max_time=job["max_time"],
            )
            method = _method(name, arm.name, terms)
            answer = method.solve(problem)
            rows.append(
                {
                    "robot": arm.name,
                    "n_objects": job["n_objects"],
                    "index": index,
                    "axis": axis,
                    "method": name,
                    "language": method.language,
                    "n_points": len(scenario.cloud),
                    "claimed": answer.claimed,
                    "time": answer.time,
                    "iterations": answer.iterations,
                    "evaluations": answer.evaluations,
                    "restarts": answer.restarts,
                    "q": answer.q.tolist(),
                    **criteria.verdict(scenario, answer, terms),
                    "finished": time.time(),
                }
            )
    return rows


@lru_cache
def mesh_judge(robot: str) -> MeshJudge:
    """The judge of a shipped robot, loaded once per process."""
    return MeshJudge(arm_named(robot))


@lru_cache
def itself_judge(robot: str) -> Callable[[FloatArray], bool]:
    """Says of a shipped robot's configuration whether its links meet by the published meshes."""
    meshes = {link: part for link, part in arm_meshes(arm_named(robot)).items() if len(part)}
    return self_judge(pdoik.Robot.builtin(robot), meshes)


@lru_cache
def arm_named(robot: str) -> Arm:
    """A shipped robot, loaded once per process."""
    return Arm.builtin(robot)


@lru_cache
def models_of(ycb: str | None) -> tuple[ObjectModel, ...]:
    """The YCB objects of a folder, or primitives without one, loaded once per process."""
    return primitive_models() if ycb is None else ycb_models(Path(ycb))


@lru_cache
def _method(name: str, robot: str, terms: Terms) -> Method:
    """A method that has solved one easy problem, so that no trial pays for its first call."""
    arm = arm_named(robot)
    method = make_method(name, arm, terms)
    q0 = start_configuration(arm)
    method.solve(Problem(T_base_tip=arm.robot.fk(q0 + 0.01), q0=q0))
    return method
