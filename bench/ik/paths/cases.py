"""One problem by its key, row:arm:kind:...:index:seed, as tables of trials have it."""

import json
from collections.abc import Callable, Mapping
from typing import Any

import pdoik
from bench.ik.paths import axis, closed, free, gap, impossible, memory, motion
from bench.ik.paths.arms import robot_of
from bench.ik.paths.problem import Problem
from bench.ik.paths.runs import row_of

DRAWN: Mapping[str, Callable[..., Problem]] = {
    "free": free.draw,
    "axis": axis.draw,
    "gap": gap.draw,
    "closed": closed.draw,
    "memory": memory.draw,
}


def problem(key: str) -> Problem:
    """A path.

    Raises:
        ValueError: There is no such row.
    """
    row, *words, index, seed = key.split(":")
    if row == "impossible":
        arm, kind = words
        return impossible.draw(arm, kind, int(index), int(seed))[0]
    if row not in DRAWN:
        raise ValueError(f"no row {row}; there are {', '.join([*DRAWN, 'impossible', 'motion'])}")
    return DRAWN[row](*words, int(index), int(seed))


def move(key: str) -> motion.Move:
    """A move in a room."""
    _, kind, index, seed = key.split(":")
    return motion.draw(kind, int(index), int(seed))


def told(key: str) -> str:
    """What comes of one case."""
    if key.startswith("motion:"):
        one = move(key)
        solver: Any = pdoik.Solver(robot_of(motion.ARM))
        answer = solver.plan_motion(one.q_from, None, one.q_to, one.world.given())
        row = motion.judged(one, answer.q if answer.success else None)
        return f"{key}\n{answer!r}\n{json.dumps(row, indent=1)}"
    drawn = problem(key)
    path = drawn.ask()
    return f"{key}\n{path!r}\n{json.dumps(row_of(drawn, path), indent=1, default=str)}"
