"""One method, one set of problems: every answer judged, and the row that it makes."""

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np

from bench.ik.problems.judge import Judge
from bench.ik.problems.methods import Method
from bench.ik.problems.problem import Problem

TOLERANCE = 1e-4  # of a right answer's position [m] and rotation [rad]
Trial = dict[str, Any]


def run(
    problems: Sequence[Problem],
    method: Method,
    judge: Judge,
    advance: Callable[[], object] = lambda: None,
    starts: int = 0,
) -> dict[float, list[Trial]]:
    """Every problem answered within every budget of the method, and judged: by budget [s].

    The judge has the method's order of joints; `advance` is called after each problem. With starts
    a problem is asked from as many random ones.
    """
    trials: dict[float, list[Trial]] = {budget: [] for budget in method.budgets}
    for k, problem in enumerate(problems):
        obstacles, intake = method.take_in(problem)
        if k == 0:  # the first solve pays for what is loaded only once
            method.answer(problem, obstacles, method.budgets[0])
        known = problem.goal_q is not None and judge.fault(problem, problem.goal_q) is None
        touch = method.touches(problem, obstacles) if known else None
        for budget, start in product(method.budgets, range(1, starts + 1) if starts else [0]):
            result = method.answer(problem, obstacles, budget, start)
            fault = None
            if result.success:
                fault = judge.misses(result.q, problem.targets, TOLERANCE, TOLERANCE)
                fault = fault or judge.fault(problem, result.q)
            trials[budget].append(
                {
                    "problem": problem.name,
                    "claimed": result.success,
                    "fault": fault,  # what the judge says against a claimed answer
                    "known": known,  # whether a valid configuration is known
                    "hulls_touch": touch,  # whether that one does by the method's own account
                    "time": result.time,
                    "intake": intake,
                    "reason": f"{result.status}: {result.worst_constraint}",
                }
            )
        advance()
    return trials


def row_of(
    name: str, robot: str, method: str, budget: float, trials: Sequence[Trial]
) -> dict[str, Any]:
    """A line of the table; the budget is in [s], times are of all problems [ms]."""
    times = 1e3 * np.array([trial["time"] for trial in trials])
    solved = [trial["claimed"] and trial["fault"] is None for trial in trials]
    known = [trial["known"] for trial in trials]
    median, p95, p99 = np.percentile(times, [50, 95, 99])
    return {
        "set": name,
        "robot": robot,
        "method": method,
        "budget": 1e3 * budget,
        "total": len(trials),
        "solved": sum(solved),
        "wrong": sum(trial["fault"] is not None for trial in trials),
        "none": sum(not trial["claimed"] for trial in trials),
        "missed": sum(k and not s for k, s in zip(known, solved, strict=True)),
        "ceiling": sum(known),
        "hulls_touch": sum(trial["hulls_touch"] is True for trial in trials),
        "median": float(median),
        "p95": float(p95),
        "p99": float(p99),
        "max": float(times.max()),
        "intake": 1e3 * float(np.median([trial["intake"] for trial in trials])),
    }


COLUMNS = {
    "set": "{set}",
    "robot": "{robot}",
    "method": "{method}",
    "budget [ms]": "{budget:g}",
    "solved": "{solved} / {total}",
    **{name: f"{{{name}}}" for name in ("wrong", "none", "missed")},
    "known": "{ceiling}",
    "hulls touch": "{hulls_touch}",
    "median": "{median:.2f}",
    "p95": "{p95:.2f}",
    "p99": "{p99:.2f}",
    "max [ms]": "{max:.2f}",
    "intake [ms]": "{intake:.0f}",
}


def cells(row: dict[str, Any]) -> list[str]:
    """A row as text, in the order of COLUMNS."""
    return [text.format(**row) for text in COLUMNS.values()]
