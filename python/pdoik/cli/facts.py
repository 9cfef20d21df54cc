"""The outcome of a solve for programs; SI units."""

from __future__ import annotations

import pdoik
from pdoik.reports import goals_entry

from .obstacles import Obstacles
from .solution import AllSolutions, Solution, distance_to

_FIGURES = (  # of a Result
    *("q", "success", "status", "message", "goal_index", "position_error", "rotation_error"),
    *("clearance", "center_of_mass", "balance_violation", "self_distance", "limit_violation"),
    *("room", "self_room"),
    *("worst_constraint", "worst_violation"),
    *("dq_dT", "manipulability", "singular_distance"),
    *("iterations", "evaluations", "restarts", "intake", "late_evaluations", "time"),
)


def facts(solution: Solution) -> dict[str, object]:
    """Everything in a solution, for JSON; SI units."""
    result = solution.result
    target = {"T_base_tip": solution.question.target(result)}
    obstacles = _obstacles(solution.obstacles, solution.surface_clearance)
    return _asked(solution) | target | _of_result(result) | obstacles


def all_facts(solution: AllSolutions) -> dict[str, object]:
    """The same of all solutions, each in `solutions`."""
    found = solution.answer
    return _asked(solution) | {
        "success": solution.is_found,
        "status": found.status,
        "complete": found.complete,
        "coverage": found.coverage,
        "restarts": found.restarts,
        "time": found.time,
        "solutions": [
            {"turns": turns, "distance": distance_to(solution, each)} | _of_result(each)
            for each, turns in zip(found, found.turns, strict=True)
        ],
        **_obstacles(solution.obstacles, None),
    }


def _obstacles(obstacles: Obstacles | None, surface_clearance: float | None) -> dict[str, object]:
    cloud = scene = None
    if obstacles is not None and obstacles.scene is not None:
        scene = {
            "file": str(obstacles.scene.path),
            "shapes": [shape.name for shape in obstacles.shapes],
            "points": len(obstacles.scene.surface),
        }
    if obstacles is not None and len(obstacles.surface):
        cloud = {
            "file": str(obstacles.file),
            "points": len(obstacles.surface),
            "leaf": obstacles.leaf,
            "obstacles": len(obstacles.cloud),
            "clearance_before_thinning": surface_clearance,
        }
    return {"cloud": cloud, "scene": scene}


def _asked(solution: Solution | AllSolutions) -> dict[str, object]:
    robot, question = solution.robot, solution.question
    listed = isinstance(question.goals, list)
    return {
        "robot": robot.name,
        "base_link": robot.base_link,
        "tip_link": robot.tip_links[0],
        "tip_links": list(robot.tip_links),
        "joint_names": list(robot.joint_names),
        "goal": solution.options.goal,
        "goals": goals_entry(question.goals)["goals"] if listed else None,
        "lock": question.lock,
    }


def _of_result(result: pdoik.Result) -> dict[str, object]:
    return {name: getattr(result, name) for name in _FIGURES}
