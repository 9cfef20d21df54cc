"""One method, one set of problems: every answer judged, and the row that it makes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from bench.ik.problems.judge import Judge
from bench.ik.problems.methods import Answer, Method
from bench.ik.problems.problem import Problem

TOLERANCE = 1e-4  # of a right answer's position [m] and rotation [rad]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One problem's outcome."""

    problem: str
    claimed: bool
    fault: str | None  # what the judge says against a claimed answer
    known: bool  # whether a valid configuration is known
    hulls_touch: bool | None  # whether that one touches by the method's own account
    time: float  # [s]
    intake: float  # [s]
    reason: str

    @property
    def solved(self) -> bool:
        """Claimed, and nothing against it."""
        return self.claimed and self.fault is None


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A line of the table; times are of all problems [ms]."""

    set: str
    robot: str
    method: str
    budget: float  # [ms]
    total: int
    solved: int
    wrong: int  # claimed, and the judge says no
    none: int  # not claimed
    missed: int  # not solved, though a valid configuration is known
    ceiling: int  # problems of which a valid configuration is known
    hulls_touch: int  # of those, how many touch by the method's own account
    median: float
    p95: float
    p99: float
    max: float
    intake: float  # median

    @classmethod
    def of(cls, name: str, robot: str, method: str, budget: float, trials: Sequence[Trial]) -> Row:
        """The row of these trials; budget in [s]."""
        times = 1e3 * np.array([trial.time for trial in trials])
        median, p95, p99 = np.percentile(times, [50, 95, 99])
        return cls(
            set=name,
            robot=robot,
            method=method,
            budget=1e3 * budget,
            total=len(trials),
            solved=sum(trial.solved for trial in trials),
            wrong=sum(trial.fault is not None for trial in trials),
            none=sum(not trial.claimed for trial in trials),
            missed=sum(trial.known and not trial.solved for trial in trials),
            ceiling=sum(trial.known for trial in trials),
            hulls_touch=sum(trial.hulls_touch is True for trial in trials),
            median=float(median),
            p95=float(p95),
            p99=float(p99),
            max=float(times.max()),
            intake=1e3 * float(np.median([trial.intake for trial in trials])),
        )


def cells(row: Row) -> list[str]:
    """A row as text, in the order of COLUMNS."""
    return [
        row.set,
        row.robot,
        row.method,
        f"{row.budget:g}",
        f"{row.solved} / {row.total}",
        *(str(n) for n in (row.wrong, row.none, row.missed, row.ceiling, row.hulls_touch)),
        *(f"{t:.2f}" for t in (row.median, row.p95, row.p99, row.max)),
        f"{row.intake:.0f}",
    ]


COLUMNS = (
    "set",
    "robot",
    "method",
    "budget [ms]",
    "solved",
    "wrong",
    "none",
    "missed",
    "known",
    "hulls touch",
    "median",
    "p95",
    "p99",
    "max [ms]",
    "intake [ms]",
)


def run(
    problems: Sequence[Problem],
    method: Method,
    judge: Judge,
    advance: Callable[[], object] = lambda: None,
) -> dict[float, list[Trial]]:
    """Every problem answered within every budget of the method, and judged: by budget [s].

    Args:
        problems: Of the robot that method and judge are for.
        method: Who answers.
        judge: In the method's order of joints.
        advance: Called after each problem.
    """
    trials: dict[float, list[Trial]] = {budget: [] for budget in method.budgets}
    for k, problem in enumerate(problems):
        scene = method.take_in(problem)
        if k == 0:  # the first solve pays for what is loaded only once
            method.answer(problem, scene, method.budgets[0])
        known = problem.goal_q is not None and judge.is_good(problem, problem.goal_q)
        touch = method.touches(problem, scene) if known else None
        for budget in method.budgets:
            answer = method.answer(problem, scene, budget)
            trials[budget].append(
                Trial(
                    problem=problem.name,
                    claimed=answer.claimed,
                    fault=_fault(judge, problem, answer),
                    known=known,
                    hulls_touch=touch,
                    time=answer.time,
                    intake=scene.time,
                    reason=answer.reason,
                )
            )
        advance()
    return trials


def _fault(judge: Judge, problem: Problem, answer: Answer) -> str | None:
    """What is wrong with a claimed answer."""
    if not answer.claimed:
        return None
    missed = judge.misses(answer.q, problem.targets, TOLERANCE, TOLERANCE)
    return missed or judge.fault(problem, answer.q)


def to_json(row: Row, trials: Sequence[Trial]) -> dict[str, Any]:
    """A row with its trials."""
    return {**asdict(row), "trials": [asdict(trial) for trial in trials]}
