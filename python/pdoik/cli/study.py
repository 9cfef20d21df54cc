"""pdoik study: a first study.yaml, and what a study can show before anything is looked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from pdoik._addresses import at_home
from pdoik._extras import asks_for
from pdoik._files import write_whole
from pdoik.descriptions import RobotDescription

from .messages import NOT_SOLVED, err, fail, misuse_fails, out
from .robots import PackageDirs, RobotArgument, XacroArguments, package_places, xacro_arguments
from .story import story
from .tables import json_text

app = typer.Typer(name="study", no_args_is_help=True, rich_markup_mode="rich")


@app.callback()
def study() -> None:
    """A first study.yaml from a robot and logs, and what a study can show."""


@app.command("new")
def new(
    robot: RobotArgument,
    logs: Annotated[list[Path], typer.Argument(help="Recordings of any kind, or their folders.")],
    out_file: Annotated[Path, typer.Option("--out", help="Where to write it.")] = Path(
        "study.yaml"
    ),
    topic: Annotated[
        str | None, typer.Option(help="Of joint states in bags, where there are several.")
    ] = None,
    command_topic: Annotated[str | None, typer.Option(help="Of commands in bags.")] = None,
    columns: Annotated[
        Path | None,
        typer.Option(
            help="A YAML file whose 'joints:', 'columns:', 'units:' and 'ignore:', as in a study,"
            " say how the logs are read, where their names do not."
        ),
    ] = None,
    entry: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUE",
            help="Said in each recording's entry: rate=100, demo=3, env=0. Repeatable.",
        ),
    ] = None,
    package_dirs: PackageDirs = None,
    xacro_args: XacroArguments = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite what is there.")] = False,
) -> None:
    """Write a commented study.yaml of a robot and logs, and ask about what cannot be guessed.

    The URDF of a robot that is named, or of a xacro file, is written next to it.

    [bold]Example[/]: pdoik study new robot.urdf monday.mcap tuesday.mcap
    """
    if out_file.is_dir():
        fail(f"--out {out_file}: is a folder, expected a file")
    if out_file.exists() and not force:
        fail(f"--out {out_file}: is there already; --force overwrites it")
    if not out_file.parent.is_dir():
        fail(f"--out {out_file}: there is no folder {out_file.parent}")
    with asks_for("sim2real"), misuse_fails(), err.status("reading"):
        from pdoik.sim2real import draft_study

        description = _description(robot, out_file.parent, package_dirs, xacro_args, force)
        draft = draft_study(
            description,
            logs,
            folder=out_file.parent,
            topic=topic,
            command_topic=command_topic,
            reading=columns,
            entry=dict(map(_pair, entry or ())),
        )
        write_whole(out_file, draft.text)
    for line in draft.guesses:
        out.print(escape(line), highlight=False)
    if draft.questions:
        out.print("[bold]To be answered[/]", highlight=False)
    for line in draft.questions:
        out.print(escape(f"  {line}"), highlight=False)
    out.print(escape(str(out_file)), highlight=False)


def _description(
    robot: str,
    folder: Path,
    packages: Sequence[str] | None,
    arguments: Sequence[str] | None,
    force: bool,
) -> Path:
    """The robot's own file, or its URDF in a folder where it is named or a xacro file."""
    given = RobotDescription.of(
        robot, packages=package_places(packages), arguments=xacro_arguments(arguments)
    )
    own = given.place
    if given.kind == "mjcf" or (given.kind == "urdf" and own == at_home(robot).resolve()):
        return own
    file = folder / given.urdf_name
    text = given.urdf()
    if file.exists() and not force and file.read_text(encoding="utf-8") != text:
        fail(f"{file}: is there already, and is another; --force overwrites it")
    write_whole(file, text)
    return file


def _pair(text: str) -> tuple[str, object]:
    """Key and value of KEY=VALUE, the value as YAML has it."""
    key, equals, value = text.partition("=")
    if not key or not equals:
        fail(f"--entry {text}: expected KEY=VALUE")
    with asks_for("sim2real"):
        import yaml
    try:
        return key.strip(), yaml.safe_load(value)
    except yaml.YAMLError as error:
        fail(f"--entry {text}: no value: {error}")


@app.command("check")
def check(
    study: Annotated[Path, typer.Argument(help="YAML: robot, joints, recordings.")],
    json: Annotated[
        Path | None,
        typer.Option("--out", "--json", help="Write all of it into this JSON file, too."),
    ] = None,
) -> None:
    """Say what a study's channels and motions can show, and what is missing for the rest.

    A size is the smallest that `pdoik diagnose` would find with a probability of about 0.9, on such
    recordings and by its own thresholds: what the effect adds along the recorded motion is held
    against the noise that is left besides friction, offsets, rotors and bodies. It is assumed that
    the noise stays as it is, and that nothing else of the kind is wrong at the place.

    Status 1 where nothing can be found at all.

    [bold]Example[/]: pdoik study check study.yaml
    """
    if not study.is_file():
        fail(f"study {study}: no such file")
    if json is not None and not json.parent.is_dir():
        fail(f"--json {json}: there is no folder {json.parent}")
    with asks_for("sim2real"), misuse_fails():
        from pdoik.sim2real import check_study

        from .study_tables import print_check

        with story(quiet=True) as tell:
            said = check_study(study, tell=tell)
        if json is not None:
            write_whole(json, json_text({"schema": "pdoik.study_check/1", **asdict(said)}) + "\n")
        print_check(said)
    if said.unanswerable:
        raise typer.Exit(NOT_SOLVED)


@app.command("keys")
def keys() -> None:
    """Every key that a study.yaml may have: what stands behind it, its default, an example.

    [bold]Example[/]: pdoik study keys
    """
    with asks_for("sim2real"):
        from pdoik.sim2real.study import reference
    for title, table in reference().items():
        out.print(f"[bold]{escape(title)}[/]")
        for name, key in table.items():
            default = f"; without it: {key.default}" if key.default else ""
            said = f"  {name}: {key.example}    # {key.words} ({key.kind}{default})"
            out.print(said, highlight=False, markup=False, soft_wrap=True)
