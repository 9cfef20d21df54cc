"""The humanoid that dodges what flies at it, in MuJoCo (the paper's experiment 3).

python -m bench.humanoid --quick
"""

import os
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from rich.console import Console
from rich.progress import track

from bench.common.commands import BUILD, console

if TYPE_CHECKING:
    from bench.humanoid.trials.experiment import Experiment

Mode = Literal["predict", "react", "stand", "all"]
SetupName = Literal["welded", "free", "balanced", "paper", "all"]
errors = Console(stderr=True, soft_wrap=True)

app = typer.Typer(pretty_exceptions_enable=False)


@app.command()
def main(
    mode: Annotated[
        Mode,
        typer.Option(
            help="'predict' knows the path beforehand, 'react' sees the cloud of the moment,"
            " 'stand' is pushed."
        ),
    ] = "all",
    setup: Annotated[
        SetupName,
        typer.Option(
            help="Feet 'welded', 'free' on the floor, the same 'balanced' by the controller, or on"
            " a weld and a ball as in the 'paper', with its three throws."
        ),
    ] = "all",
    throws: Annotated[int | None, typer.Option(min=1, help="20 otherwise; paper: 3.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of throws and first guesses.")] = 0,
    ycb: Annotated[
        Path | None,
        typer.Option(
            help="Folder of the YCB objects; $PDOIK_SHARED/ycb otherwise, else primitives of their"
            " size."
        ),
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(help="Search for each throw, 2 otherwise.")
    ] = None,
    long_seconds: Annotated[
        float | None,
        typer.Option(help="Search that says whether a throw can be dodged at all, 20 otherwise."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Three throws, small budgets.")] = False,
    out: Annotated[
        Path, typer.Option(help="Folder of the results; what is there is not run again.")
    ] = BUILD / "humanoid",
    film: Annotated[
        bool, typer.Option("--film", help="Write film.mp4 and film.gif of the first dodge.")
    ] = False,
    figure: Annotated[
        bool, typer.Option("--picture", "--figure", help="Write figure.png of a dodge.")
    ] = False,
) -> None:
    """Throw things at a Unitree H1 in MuJoCo and see whether it dodges and stands.

    Writes report.md, report.json and a log of each run's joints: pdoik view h1 --replay. Once
    stopped, the same command goes on where it was.
    """
    if film or figure:
        os.environ.setdefault("MUJOCO_GL", "egl")  # read where mujoco is imported first: below
    from bench.humanoid.report.report import write_report
    from bench.humanoid.trials.experiment import Experiment, settings_for
    from bench.humanoid.world.objects import ycb_folder

    with _misuse_ends():
        for option, value in (("--seconds", seconds), ("--long-seconds", long_seconds)):
            if value is not None and not 0 < value <= 3600:
                raise ValueError(f"{option} is {value:g}, expected seconds from 0 to 3600")
        if ycb is not None and not ycb.is_dir():
            raise ValueError(f"--ycb {ycb}: no such folder")
        if out.exists() and not out.is_dir():
            raise ValueError(f"--out {out}: is a file, expected a folder")
    settings = settings_for(
        quick,
        modes=None if mode == "all" else (mode,),
        setups=None if setup == "all" else (setup,),
        throws=throws,
        seed=seed,
        ycb=ycb_folder(ycb),
        seconds=seconds,
        long_seconds=long_seconds,
    )
    with _misuse_ends("" if ycb is None else f"--ycb {ycb}: "):
        experiment = Experiment(settings, out)
    made = f"YCB, {settings.ycb}" if settings.ycb else "primitives of the YCB scans' size"
    console.print(f"objects: {made}", highlight=False, markup=False, soft_wrap=True)
    with _misuse_ends():
        for job in track(experiment.jobs(), "trials", console=errors, transient=True):
            experiment.run(job)
        command = shlex.join(["python", "-m", "bench.humanoid", *sys.argv[1:]])
        report = write_report(experiment, command)
    console.print(str(report), highlight=False, markup=False, soft_wrap=True)
    if film or figure:
        _draw(experiment, film, figure)


def _draw(experiment: "Experiment", film: bool, figure: bool) -> None:
    from bench.humanoid.report.gallery import dodges, draw_figure, draw_film

    found = dodges(experiment)
    if not found:
        errors.print("warning: nothing was dodged by a plan: no film, no figure", highlight=False)
        return
    try:
        for wanted, draw in ((film, draw_film), (figure, draw_figure)):
            for path in draw(experiment, found) if wanted else ():
                console.print(str(path), highlight=False, markup=False, soft_wrap=True)
    except Exception as error:  # MuJoCo's and OpenGL's own, by driver
        _fail(f"cannot draw: {error} (Debian: apt install libegl1 libgl1-mesa-dri)")


@contextmanager
def _misuse_ends(subject: str = "") -> Iterator[None]:
    """End the command with a line and status 2 where an option or a file is wrong."""
    try:
        yield
    except (ValueError, OSError) as error:  # pdoik.LoadError is a ValueError
        _fail(f"{subject}{error}")


def _fail(text: str) -> None:
    errors.print(f"error: {text}", highlight=False, markup=False)
    raise typer.Exit(2)


if __name__ == "__main__":
    app()
