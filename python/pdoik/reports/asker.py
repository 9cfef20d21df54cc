"""Asks a report's question."""

from __future__ import annotations

from typing import Any

from ..solver import Solver
from ..tracker import Tracker
from .call import read_keywords
from .goals import read_goals
from .obstacles import read_obstacles
from .values import Entry


class Asker:
    """Asks a report's question.

    Args:
        solver: To ask.
        kind: "solve", "batch", "any", "all" or "steps".
        tracker: Of steps: made anew for each question.
    """

    def __init__(self, solver: Solver, kind: str, tracker: dict[str, Any] | None = None) -> None:
        self.solver = solver
        self.kind = kind
        self.tracker = tracker
        self.carried = solver.carried

    @classmethod
    def of(cls, solver: Solver | Tracker, kind: str) -> Asker:
        """Asker with a tracker's solver and settings."""
        if isinstance(solver, Solver):
            return cls(solver, kind)
        asker = cls(solver.solver, kind, solver.settings)
        asker.carried = solver.carried
        return asker

    def ask(self, question: Entry) -> Any:
        """The answers, among the obstacles as they are in the file.

        Returns:
            A list of results, one for each target; of all solutions what `solve_all` returns.
        """
        obstacles = read_obstacles(question["obstacles"]).given
        if self.kind == "steps":
            return self._steps(question, obstacles)
        keywords = read_keywords(question, self.solver.robot.dof, self.kind)
        goals = read_goals(question["target"], batch=self.kind in ("batch", "any"))
        match self.kind:
            case "batch":
                return list(self.solver.solve_batch(goals, obstacles=obstacles, **keywords))
            case "any":
                return [self.solver.solve_any(goals, obstacles=obstacles, **keywords)]
            case "all":
                return self.solver.solve_all(goals, obstacles=obstacles, **keywords)
        return [self.solver.solve(goals, obstacles=obstacles, **keywords)]

    def _steps(self, question: Entry, obstacles: Any) -> Any:
        assert self.tracker is not None
        dof = self.solver.robot.dof
        tracker = Tracker(
            self.solver, **{**self.tracker, "max_time": self.tracker["max_time"] or None}
        )
        tracker.attach_all(self.carried)
        tracker.reset(question["q0"].array(dof))
        tracker.set_posture(question["posture"].array_or_none(dof))
        return [
            tracker.step(read_goals(target, nan=True), obstacles)
            for target in question["targets"].items()
        ]
