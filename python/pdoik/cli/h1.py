"""pdoik h1: the humanoid that dodges what flies at it, in MuJoCo (the paper's experiment 3)."""

from __future__ import annotations

import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from pdoik._extras import asks_for
from pdoik.errors import MissingExtraError

from .messages import err, fail, misuse_fails, out, warn

if TYPE_CHECKING:
    from pdoik.h1.experiment import Experiment

Mode = Literal["predict", "react", "stand", "all"]
SetupName = Literal["welded", "free", "balanced", "paper", "all"]

_TRIALS, _SEARCH, _OUTPUT = "Trials", "Search", "Output"


def h1(
    mode: Annotated[
        Mode,
        typer.Option(
            help="'predict' knows the path beforehand, 'react' sees the cloud of the moment,"
            " 'stand' is pushed.",
            rich_help_panel=_TRIALS,
        ),
    ] = "all",
    setup: Annotated[
        SetupName,
        typer.Option(
            help="Feet 'welded', 'free' on the floor, the same 'balanced' by the controller, or on"
            " a weld and a ball as in the 'paper', with its three throws.",
            rich_help_panel=_TRIALS,
        ),
    ] = "all",
    throws: Annotated[
        int | None,
        typer.Option(min=1, help="How many, 20 otherwise; paper: 3.", rich_help_panel=_TRIALS),
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, help="Of throws and first guesses.", rich_help_panel=_TRIALS)
    ] = 0,
    ycb: Annotated[
        Path | None,
        typer.Option(
            help="Folder of the YCB objects; $PDOIK_SHARED/ycb otherwise, else primitives of their"
            " size.",
            rich_help_panel=_TRIALS,
        ),
    ] = None,
    seconds: Annotated[
        float | None,
        typer.Option(help="Search for each throw, 2 otherwise.", rich_help_panel=_SEARCH),
    ] = None,
    long_seconds: Annotated[
        float | None,
        typer.Option(
            help="Search that says whether a throw can be dodged at all, 20 otherwise.",
            rich_help_panel=_SEARCH,
        ),
    ] = None,
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Three throws, small budgets.", rich_help_panel=_SEARCH),
    ] = False,
    out_folder: Annotated[
        Path,
        typer.Option(
            "--out",
            help="Folder for results, logs and report; what is there is not run again.",
            rich_help_panel=_OUTPUT,
        ),
    ] = Path("pdoik-h1"),
    film: Annotated[
        bool,
        typer.Option(
            "--film",
            help="Write film.mp4 and film.gif of the first dodge.",
            rich_help_panel=_OUTPUT,
        ),
    ] = False,
    figure: Annotated[
        bool,
        typer.Option(
            "--picture", "--figure", help="Write figure.png of a dodge.", rich_help_panel=_OUTPUT
        ),
    ] = False,
) -> None:
    """Throw things at a Unitree H1 in MuJoCo and see whether it dodges and stands.

    Writes report.md, report.json and a log of each run's joints: pdoik view h1 --replay. Once
    stopped, the same command goes on where it was.

    [bold]Example[/]: pdoik h1 --mode predict --setup welded --out h1 --film --picture
    """
    if film or figure:
        os.environ.setdefault("MUJOCO_GL", "egl")  # read when mujoco is imported
    with asks_for("h1"):
        import mujoco  # noqa: F401
    from pdoik.h1.experiment import MODES, Experiment, settings_for
    from pdoik.h1.model import SETUPS
    from pdoik.h1.objects import ycb_folder
    from pdoik.h1.report import write_report

    for option, value in (("--seconds", seconds), ("--long-seconds", long_seconds)):
        if value is not None and not 0 < value <= 3600:
            fail(f"{option} is {value:g}, expected seconds from 0 to 3600")
    if ycb is not None and not ycb.is_dir():
        fail(f"--ycb {ycb}: no such folder")
    if out_folder.exists() and not out_folder.is_dir():
        fail(f"--out {out_folder}: is a file, expected a folder")
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
    assert set(settings.modes) <= set(MODES)
    assert set(settings.setups) <= set(SETUPS)
    with misuse_fails("" if ycb is None else f"--ycb {ycb}"):
        experiment = Experiment(settings, out_folder)
    if settings.ycb is None:
        out.print("objects: primitives of the YCB scans' size", highlight=False)
    else:
        out.print(f"objects: YCB, {settings.ycb}", highlight=False)
    with misuse_fails():
        _run(experiment)
        command = shlex.join(["pdoik", *sys.argv[1:]])
        report = write_report(experiment, command)
    out.print(escape(str(report)), highlight=False)
    if film or figure:
        _draw(experiment, film, figure)


def _run(experiment: Experiment) -> None:
    jobs = experiment.jobs()
    with Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=err,
        transient=True,
        disable=not err.is_terminal,
    ) as progress:
        task = progress.add_task("", total=len(jobs))
        for job in jobs:
            progress.update(task, description=job.name)
            experiment.run(job)
            progress.advance(task)


def _draw(experiment: Experiment, film: bool, figure: bool) -> None:
    from pdoik.h1.gallery import dodges, draw_figure, draw_film

    found = dodges(experiment)
    if not found:
        warn("nothing was dodged by a plan: no film, no figure")
        return
    try:
        for wanted, draw in ((film, draw_film), (figure, draw_figure)):
            if wanted:
                with asks_for("h1"):
                    for path in draw(experiment, found):
                        out.print(escape(str(path)), highlight=False)
    except MissingExtraError:
        raise
    except Exception as error:  # MuJoCo's and OpenGL's own, by driver
        fail(f"cannot draw: {error} (Debian: apt install libegl1 libgl1-mesa-dri)")
