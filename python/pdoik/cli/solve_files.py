"""What pdoik solve writes: a picture, and a report to send."""

from __future__ import annotations

from pathlib import Path

import pdoik
from pdoik._extras import asks_for
from pdoik.reports import ending_of

from .messages import fail, misuse_fails, tell, warn, warnings_given
from .obstacles import solver_of
from .solution import AllSolutions, Solution


def check_picture(picture: Path | None) -> None:
    """Leave with status 2 where it cannot be written."""
    if picture is None:
        return
    if picture.suffix.lower() != ".png":
        fail(f"--picture: expected a name that ends in .png, got {picture.name!r}")
    if not picture.parent.is_dir():
        fail(f"--picture: there is no folder {picture.parent}")


def check_report(report: Path | None) -> None:
    """Leave with status 2 where it cannot be written."""
    if report is None:
        return
    with misuse_fails("--report"):
        ending_of(report)
    if not report.parent.is_dir():
        fail(f"--report: there is no folder {report.parent}")


def write_report(report: Path, solution: Solution | AllSolutions, urdf: str | None) -> None:
    """Question and answer, as `pdoik report` reads them."""
    question = solution.question
    with misuse_fails("--report"), warnings_given():
        pdoik.write_report(
            report,
            solver_of(solution.robot, solution.options, solution.obstacles),
            question.goals,
            obstacles=None if solution.obstacles is None else solution.obstacles.kept(),
            result=solution.answer,
            call=question.call,
            urdf=urdf,
            **question.keywords(),
        )
    tell(f"{report}: say in its note what is wrong, and send it; pdoik report {report} asks again")


def draw(picture: Path, solution: Solution | AllSolutions) -> None:
    """The robot at its answer, or at the nearest of all, with the target that it is about."""
    with asks_for("plot"):
        from pdoik.picture import draw_solution  # matplotlib takes longer to import than to solve

    result, obstacles = solution.nearest, solution.obstacles
    if result is None:
        warn("--picture: there is no solution to draw")
        return
    with misuse_fails("--picture"):
        draw_solution(
            picture,
            pdoik.Solver(solution.robot, solution.options),
            result,
            solution.question.target(result),
            None if obstacles is None else obstacles.kept(),
            surface=None if obstacles is None or obstacles.leaf == 0 else obstacles.surface,
        )
