"""MotionBenchMaker's sets: scene0001.yaml (a PlanningScene) next to request0001.yaml."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.problems.judge import Judge
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import RobotFiles
from bench.ik.problems.solids import Solid, SolidError, box, pose
from pdoik.scenes import EntryError as LoaderError
from pdoik.scenes import (
    Piece,
    numbers,
    read_attached,
    read_matrix,
    read_pose,
    read_world,
    read_yaml,
    rotation,
)


def read_moveit(
    folder: Path, files: RobotFiles, joint_names: Sequence[str] | None = None
) -> list[Problem]:
    """The problems of one folder, in the order of their numbers.

    A scene's request has the same number. The target is the tip's pose in the goal configuration,
    or the goal's pose constraints. Joints that are not moved, such as fingers, are held where the
    goal, the request's start or the scene's robot state has them. Everything is taken to be in the
    frame of the robot's base unless fixed_frame_transforms say otherwise.

    Args:
        folder: With scene0001.yaml and request0001.yaml.
        files: Of the robot.
        joint_names: The joints that are moved; None for all that the files do not hold.

    Raises:
        LoaderError: A request is missing, or an entry cannot be read.
    """
    judges = _Judges(files, joint_names)
    problems = []
    for scene_file in sorted(folder.glob("scene*.y*ml"), key=_number):
        if "sensed" in scene_file.stem:  # a cloud's voxels, next to the true scene
            continue
        request_file = scene_file.with_name(scene_file.name.replace("scene", "request", 1))
        if not request_file.is_file():
            raise LoaderError(scene_file, f"its request {request_file.name} is not there")
        scene, request = read_yaml(scene_file), read_yaml(request_file)
        values = {
            **_state(scene.get("robot_state"), scene_file, "robot_state"),
            **_state(request.get("start_state"), request_file, "start_state"),
            **_goal_joints(request, request_file),
        }
        held, judge = judges.of(values)
        things = _things(scene, scene_file, judge.link_names)
        targets, goal_q = _goal(request, values, request_file, judge)
        if read_attached(scene, scene_file):
            raise LoaderError(scene_file, "attached objects are not supported", "robot_state")
        allowed = [
            (rule.one, solid.name)
            for rule in read_matrix(scene, scene_file, things)
            for solid in things.get(rule.other, ())
            if rule.clearance is not None and rule.one not in things
        ]
        problems.append(
            Problem(
                name=f"{folder.name}/{scene_file.stem}",
                robot=files.name,
                solids=tuple(solid for solids in things.values() for solid in solids),
                targets=targets,
                goal_q=goal_q,
                allowed=frozenset(allowed),
                held=held,
            )
        )
    return problems


class _Judges:
    """A judge for each place where joints stand that are not moved."""

    def __init__(self, files: RobotFiles, joint_names: Sequence[str] | None) -> None:
        self._files = files
        self._judges = {frozenset[tuple[str, float]](): Judge(files, "collision", joint_names)}
        (first,) = self._judges.values()
        self._moved = first.joint_names

    def of(self, values: Mapping[str, float]) -> tuple[dict[str, float], Judge]:
        """Where the joints are held that these values say, and the judge."""
        files = self._files.standing(values, self._moved)
        held = {k: v for k, v in files.told.items() if k not in self._files.told}
        key = frozenset(held.items())
        if key not in self._judges:
            self._judges[key] = Judge(files, "collision", self._moved)
        return held, self._judges[key]


def _things(scene: Mapping[str, Any], file: Path, links: Sequence[str]) -> dict[str, list[Solid]]:
    """Solids by object; one of several pieces gives solids named id/0, id/1 and so on."""
    things: dict[str, list[Solid]] = {}
    for thing in read_world(scene, file, links=set(links)):
        for k, piece in enumerate(thing.pieces):
            name = f"{thing.name}/{k}" if len(thing.pieces) > 1 else thing.name
            try:
                things.setdefault(thing.name, []).extend(_solids(name, piece))
            except SolidError as error:
                raise LoaderError(file, str(error), piece.entry) from error
    return things


def _solids(name: str, piece: Piece) -> list[Solid]:
    """A piece; the boxes of an octomap one by one."""
    if piece.kind == "boxes":
        corners = zip(piece.vertices[0::2], piece.vertices[1::2], strict=True)
        return [
            box(f"{name}/{k}", high - low, piece.T @ pose((low + high) / 2))
            for k, (low, high) in enumerate(corners)
        ]
    kind = "mesh" if piece.kind == "convex_mesh" else piece.kind
    return [Solid(name, kind, piece.size, piece.T, piece.vertices, piece.faces)]


def _number(file: Path) -> tuple[int, str]:
    digits = re.findall(r"\d+", file.stem)
    return (int(digits[-1]) if digits else 0, file.name)


def _state(state: Any, file: Path, entry: str) -> dict[str, float]:
    """Where a moveit_msgs/RobotState has its joints."""
    entry = f"{entry}.joint_state"
    joints = (state.get("joint_state") if isinstance(state, Mapping) else None) or {}
    if not isinstance(joints, Mapping):
        raise LoaderError(file, f"expected name and position, got {joints!r}", entry)
    names, positions = joints.get("name") or [], joints.get("position") or []
    if len(names) != len(positions):
        raise LoaderError(file, f"{len(names)} names, {len(positions)} positions", entry)
    return {
        str(name): float(numbers([value], "q", file, f"{entry}.position[{k}]")[0])
        for k, (name, value) in enumerate(zip(names, positions, strict=True))
    }


def _goal_joints(request: Mapping[str, Any], file: Path) -> dict[str, float]:
    """Where the goal's joint constraints have joints."""
    constraints = request.get("goal_constraints") or []
    if not constraints:
        raise LoaderError(file, "has no goal", "goal_constraints")
    values = {}
    for k, constraint in enumerate(constraints[0].get("joint_constraints") or []):
        entry = f"goal_constraints[0].joint_constraints[{k}]"
        if not isinstance(constraint, Mapping) or "joint_name" not in constraint:
            raise LoaderError(file, "has no joint_name", entry)
        position = numbers([constraint.get("position")], "q", file, f"{entry}.position")
        values[str(constraint["joint_name"])] = float(position[0])
    return values


def _goal(
    request: Mapping[str, Any], values: Mapping[str, float], file: Path, judge: Judge
) -> tuple[dict[str, FloatArray], FloatArray | None]:
    """The targets, and the configuration that defines them if one does.

    Joints without a constraint stay as they start.
    """
    goal, entry = request["goal_constraints"][0], "goal_constraints[0]"
    if goal.get("joint_constraints"):
        if missing := [name for name in judge.joint_names if name not in values]:
            raise LoaderError(file, f"neither goal nor start has {missing}", entry)
        q = np.array([values[name] for name in judge.joint_names])
        return {tip: judge.fk(q, tip) for tip in judge.files.tips}, q
    if goal.get("position_constraints") and goal.get("orientation_constraints"):
        return {judge.files.tips[0]: _pose_goal(goal, file, judge)}, None
    raise LoaderError(file, "expected joint_constraints, or position and orientation", entry)


def _pose_goal(goal: Mapping[str, Any], file: Path, judge: Judge) -> FloatArray:
    at, turn = goal["position_constraints"][0], goal["orientation_constraints"][0]
    entry = "goal_constraints[0].position_constraints[0]"
    poses = (at.get("constraint_region") or {}).get("primitive_poses") or []
    if not poses:
        raise LoaderError(file, "its region has no primitive_poses", entry)
    T = read_pose(poses[0], file, f"{entry}.constraint_region")
    T[:3, :3] = rotation(
        turn.get("orientation"), file, "goal_constraints[0].orientation_constraints[0]"
    )
    if at.get("target_point_offset"):
        offset = numbers(at["target_point_offset"], "xyz", file, f"{entry}.target_point_offset")
        T[:3, 3] -= T[:3, :3] @ offset
    link, tip = at.get("link_name"), judge.files.tips[0]
    if link == tip or not link:
        return T
    if link not in judge.link_names:
        raise LoaderError(file, f"the robot has no link {link!r}", entry)
    q = judge.random(np.random.default_rng(0))
    other = judge.random(np.random.default_rng(1))
    fixed = [np.linalg.inv(judge.fk(p, link)) @ judge.fk(p, tip) for p in (q, other)]
    if not np.allclose(fixed[0], fixed[1], atol=1e-9):
        raise LoaderError(file, f"the goal is for {link!r}, which moves against {tip!r}", entry)
    return np.asarray(T @ fixed[0])
