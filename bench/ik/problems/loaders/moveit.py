"""MotionBenchMaker's sets: scene0001.yaml (a PlanningScene) beside request0001.yaml."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.problems.judge import Judge
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import RobotFiles
from bench.ik.problems.solids import Solid, SolidError
from pdoik.scenes.contacts import read_matrix
from pdoik.scenes.moveit_yaml import read_attached, read_world
from pdoik.scenes.values import EntryError as LoaderError
from pdoik.scenes.values import numbers, read_pose, read_yaml, rotation


def read_moveit(folder: Path, files: RobotFiles) -> list[Problem]:
    """The problems of one folder, in the order of their numbers.

    A scene's request has the same number. The target is the tip's pose in the goal configuration,
    or the goal's pose constraints. Everything is taken to be in the frame of the robot's base
    unless fixed_frame_transforms say otherwise.

    Raises:
        LoaderError: A request is missing, or an entry cannot be read.
    """
    judge = Judge(files, "collision")
    problems = []
    for scene_file in sorted(folder.glob("scene*.y*ml"), key=_number):
        if "sensed" in scene_file.stem:  # a cloud's voxels, beside the true scene
            continue
        request_file = scene_file.with_name(scene_file.name.replace("scene", "request", 1))
        if not request_file.is_file():
            raise LoaderError(scene_file, f"its request {request_file.name} is not there")
        scene = read_yaml(scene_file)
        things = _things(scene, scene_file, judge.link_names)
        targets, goal_q = _goal(read_yaml(request_file), request_file, judge)
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
            )
        )
    return problems


def _things(scene: Mapping[str, Any], file: Path, links: Sequence[str]) -> dict[str, list[Solid]]:
    """By object; one of several pieces gives solids named id/0, id/1 and so on."""
    things: dict[str, list[Solid]] = {}
    for thing in read_world(scene, file, links=set(links)):
        for k, piece in enumerate(thing.pieces):
            name = f"{thing.name}/{k}" if len(thing.pieces) > 1 else thing.name
            try:
                kind = "mesh" if piece.kind == "convex_mesh" else piece.kind
                solid = Solid(name, kind, piece.size, piece.T, piece.vertices, piece.faces)
            except SolidError as error:
                raise LoaderError(file, str(error), piece.entry) from error
            things.setdefault(thing.name, []).append(solid)
    return things


def _number(file: Path) -> tuple[int, str]:
    digits = re.findall(r"\d+", file.stem)
    return (int(digits[-1]) if digits else 0, file.name)


def _goal(
    request: Mapping[str, Any], file: Path, judge: Judge
) -> tuple[dict[str, FloatArray], FloatArray | None]:
    constraints = request.get("goal_constraints") or []
    if not constraints:
        raise LoaderError(file, "has no goal", "goal_constraints")
    goal, entry = constraints[0], "goal_constraints[0]"
    if goal.get("joint_constraints"):
        q = _joints(request, goal["joint_constraints"], file, judge)
        return {tip: judge.fk(q, tip) for tip in judge.files.tips}, q
    if goal.get("position_constraints") and goal.get("orientation_constraints"):
        return {judge.files.tips[0]: _pose_goal(goal, file, judge)}, None
    raise LoaderError(file, "expected joint_constraints, or position and orientation", entry)


def _joints(
    request: Mapping[str, Any], constraints: Sequence[Mapping[str, Any]], file: Path, judge: Judge
) -> FloatArray:
    """The goal configuration; joints without a constraint stay as they start."""
    state = (request.get("start_state") or {}).get("joint_state") or {}
    values = dict(zip(state.get("name") or [], state.get("position") or [], strict=False))
    for k, constraint in enumerate(constraints):
        entry = f"goal_constraints[0].joint_constraints[{k}]"
        if not isinstance(constraint, Mapping) or "joint_name" not in constraint:
            raise LoaderError(file, "has no joint_name", entry)
        (values[constraint["joint_name"]],) = numbers(
            [constraint.get("position")], "q", file, f"{entry}.position"
        )
    if missing := [name for name in judge.joint_names if name not in values]:
        raise LoaderError(file, f"neither goal nor start has {missing}", "goal_constraints[0]")
    return np.array([float(values[name]) for name in judge.joint_names])


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
