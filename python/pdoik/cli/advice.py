"""What may help where a solve failed."""

from __future__ import annotations

from .solution import Solution

_NO_OBSTACLE = {"out_of_reach", "base_collision", "nearest"}  # is in the way


def advice(solution: Solution) -> list[str]:
    """What may help after a failure, most promising first."""
    result, options = solution.result, solution.options
    if result.success:
        return []
    is_bare = not isinstance(solution.question.goals, list)
    looser = {
        "pose": "--goal axis or --goal position, if the tool may turn about its axis or freely",
        "axis": "--goal position, if the tool's direction does not matter",
    }
    tips = []
    if result.status == "out_of_reach":
        tips.append(
            "a target nearer to the robot; positions are in metres in the base link's frame"
        )
    elif result.status == "base_collision":
        tips.append(
            "removing the robot's own points from the cloud, and checking that obstacles are in the"
            f" frame of {solution.robot.base_link}, in metres; or --no-base-collision, if the"
            " robot stands on what it shows"
        )
    elif result.status == "nearest":
        tips.append("--q0 or --max-restarts, if another answer may be turned less")
    elif result.status == "blocked":
        tips.append("another target, or the obstacles without what the tool is to touch")
    else:
        if options.method == "paper":
            tips.append("--method default, which starts again where the paper's method gives up")
        elif result.status == "time_limit":
            tips.append(f"--max-time {10 * options.max_time:g}, ten times as long")
        else:
            n_starts = options.max_restarts + 1
            tips.append(f"another target: after {n_starts} starts this one may have no solution")
            tips.append(f"--max-restarts {10 * n_starts} with a longer --max-time")
        if result.self_distance < options.self_clearance - options.clearance_tolerance:
            tips.append(
                "--srdf with the pairs of links that may touch (pdoik pairs finds them), or"
                " --no-self-collision"
            )
        if options.goal in looser and solution.question.call == "solve" and is_bare:
            tips.append(looser[options.goal])
    if result.status in {"base_collision", "blocked"} and not solution.robot.occupancy.pieces:
        tips.append("hulls with pieces of the links themselves, which pdoik occupancy makes")
    if solution.obstacles is not None and result.status not in _NO_OBSTACLE:
        given = "--cloud" if solution.obstacles.scene is None else "--scene"
        tips.append(f"the same without {given}, which shows whether obstacles are in the way")
    tips.append("--report case.json, if it should have been solved: a file to send with an issue")
    return tips
