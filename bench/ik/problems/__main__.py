"""Command line: run problem sets, say how many can be solved at all, draw them.

    python -m bench.ik.problems run box cage --robot panda --count 20 --budget 10 --budget 100
    python -m bench.ik.problems run --from DIR/box_panda --robot panda
    python -m bench.ik.problems list
    python -m bench.ik.problems draw --out bench/ik/problems/families.png

Run from the repository's root. Problems, hulls and results are kept in build/bench/problems.
"""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import Progress

from bench.common.commands import BUILD, console, plain_errors, write_report
from bench.common.markdown import markdown_table
from bench.common.provenance import provenance
from bench.common.whole_files import write_text
from bench.ik.problems.draw import draw_failures, draw_sheet
from bench.ik.problems.families import FAMILIES
from bench.ik.problems.held import HeldRobots, given_by_user
from bench.ik.problems.loaders import read_problems
from bench.ik.problems.make import problems_of, with_valid_configuration
from bench.ik.problems.methods import LEAF, SPACING, Method, usual_way
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import Meshes, RobotFiles, robot_files
from bench.ik.problems.trials import COLUMNS, Trial, cells, row_of
from bench.ik.problems.trials import run as run_trials

app = typer.Typer(help=__doc__, no_args_is_help=True, add_completion=False)
OUT = BUILD / "problems"


@app.command("list")
def list_families() -> None:
    """The families and their robots."""
    for family in FAMILIES.values():
        console.print(f"{family.name}: {family.about} ({', '.join(family.robots)})")


@app.command()
def run(
    families: Annotated[list[str] | None, typer.Argument(help="Our own; all by default.")] = None,
    source: Annotated[
        list[Path] | None, typer.Option("--from", help="A published set's folder or file.")
    ] = None,
    robot: Annotated[str, typer.Option(help="panda, ur5, ur10, or any with --urdf.")] = "panda",
    count: Annotated[int, typer.Option(min=1, help="Problems of each set.")] = 100,
    seed: Annotated[int, typer.Option(min=0, help="Of our own families.")] = 0,
    method: Annotated[
        list[str] | None,
        typer.Option(
            help="shapes, cloud or solid_cloud; repeatable. Shapes, or for concave meshes"
            " solid_cloud, otherwise."
        ),
    ] = None,
    budget: Annotated[list[float] | None, typer.Option(help="Milliseconds; repeatable.")] = None,
    meshes: Annotated[Meshes, typer.Option(help="What the judge looks at.")] = "visual",
    hull_meshes: Annotated[Meshes, typer.Option(help="What the hulls hold.")] = "collision",
    urdf: Annotated[Path | None, typer.Option(help="Another description of the robot.")] = None,
    srdf: Annotated[Path | None, typer.Option(help="Its SRDF.")] = None,
    packages: Annotated[list[Path] | None, typer.Option(help="Folders of packages.")] = None,
    tip: Annotated[str | None, typer.Option(help="Tip link, with --urdf.")] = None,
    base: Annotated[str | None, typer.Option(help="Base link, with --urdf.")] = None,
    hold: Annotated[
        list[str] | None, typer.Option(help="JOINT=VALUE that stands still, whatever a set says.")
    ] = None,
    spacing: Annotated[
        float, typer.Option(min=0.05, help="Of the points that clouds are made of, in mm.")
    ] = 1e3 * SPACING,
    leaf: Annotated[
        float, typer.Option(min=0.1, help="Of the grid that thins clouds, in mm.")
    ] = 1e3 * LEAF,
    starts: Annotated[
        int, typer.Option(min=0, help="Random ones that each problem is solved from; 0 for none.")
    ] = 0,
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = OUT,
) -> None:
    """Solve problem sets and judge every answer by meshes."""
    with plain_errors():
        fixed = dict(map(_held, hold or []))
        files = given_by_user(_files(robot, urdf, srdf, packages, tip, base), fixed)
        robots = HeldRobots(files, meshes, hull_meshes)
        sets = {}
        for path in source or []:
            for name, problems in read_problems(path, files, robots.joint_names).items():
                with console.status(f"looking for valid configurations of {name}"):
                    sets[name] = [
                        p
                        if p.goal_q is not None
                        else with_valid_configuration(p, robots.of(p.held).searching())
                        for p in problems[:count]
                    ]
        ours = [name for name, family in FAMILIES.items() if files.name in family.robots]
        for name in families or ([] if source else ours):
            with console.status(f"making {name} for {files.name}"):
                sets[name] = problems_of(
                    name, files.name, count, seed, joint_names=robots.joint_names, told=fixed
                )
        rows = []
        budgets = [milliseconds / 1e3 for milliseconds in budget or [10.0, 100.0]]
        with Progress(console=console, transient=True) as progress:
            for name, problems in sets.items():
                for way in method or [usual_way(problems)]:
                    task = progress.add_task(f"{name} {way}", total=len(problems))
                    done: dict[float, list[Trial]] = {seconds: [] for seconds in budgets}
                    for held, some in robots.groups(problems):
                        answering = Method(
                            way, held.robot, budgets, some[0], spacing / 1e3, leaf / 1e3
                        )
                        trials = run_trials(
                            some,
                            answering,
                            held.judge,
                            lambda task=task: progress.advance(task),
                            starts,
                        )
                        for seconds in budgets:
                            done[seconds] += trials[seconds]
                    rows += [
                        {**row_of(name, files.name, way, seconds, trials), "trials": trials}
                        for seconds, trials in done.items()
                    ]
                for standing in sorted({_standing(problem) for problem in problems} - {""}):
                    console.print(f"{name}: held as the set says: {standing}")
        table = markdown_table([*COLUMNS], [cells(row) for row in rows])
        out.mkdir(parents=True, exist_ok=True)
        stem = f"{files.name}-{'-'.join(sets)}"[:80]
        facts = {"provenance": provenance(BUILD.parent), "meshes": meshes}
        text = {**facts, "hull_meshes": hull_meshes, "rows": rows}
        write_text(out / f"{stem}.json", json.dumps(text, indent=1) + "\n")
        write_report(out / f"{stem}.md", table)
        print(table)


def _files(
    robot: str,
    urdf: Path | None,
    srdf: Path | None,
    packages: list[Path] | None,
    tip: str | None,
    base: str | None,
) -> RobotFiles:
    """The known robot of this name, or one that is described by the options."""
    if urdf is None:
        given = {"--srdf": srdf, "--packages": packages, "--tip": tip, "--base": base}
        if alone := [option for option, value in given.items() if value]:
            raise typer.BadParameter(f"{alone[0]} is for a robot of one's own: give --urdf, too")
        return robot_files(robot)
    if tip is None:
        raise typer.BadParameter("--urdf needs --tip")
    folders = tuple(packages or [urdf.parent])
    return RobotFiles(
        name=robot, urdf=urdf, srdf=srdf, package_dirs=folders, tips=(tip,), base=base
    )


def _standing(problem: Problem) -> str:
    """Where a problem's joints stand, in words."""
    return ", ".join(f"{name}={value:g}" for name, value in sorted(problem.held.items()))


def _held(entry: str) -> tuple[str, float]:
    joint, _, value = entry.partition("=")
    try:
        return joint, float(value)
    except ValueError:
        raise typer.BadParameter(f"--hold {entry}: expected JOINT=VALUE") from None


@app.command()
def draw(
    out: Annotated[Path, typer.Option(help="The picture.")] = OUT / "families.png",
    seed: Annotated[int, typer.Option(min=0)] = 0,
    failed: Annotated[
        list[Path] | None, typer.Option(help="Results of run: draw what was not solved instead.")
    ] = None,
) -> None:
    """One problem of each family, drawn with its defining configuration; or what failed."""
    with plain_errors():
        out.parent.mkdir(parents=True, exist_ok=True)
        if failed:
            console.print(f"{draw_failures(out, failed, seed)} problems drawn")
        else:
            draw_sheet(out, seed)


if __name__ == "__main__":
    app()
