"""Every command under the name `pdoik`."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from typer.core import TyperGroup

import pdoik
from pdoik.errors import MissingExtraError

from .bench import bench
from .compare import compare
from .diagnose import diagnose
from .effects import app as effects
from .info import info
from .messages import fail, out
from .occupancy import occupancy
from .pairs import pairs
from .path import path
from .place import place
from .predict import predict
from .propose import propose
from .replay import replay
from .reports import report
from .solve import solve
from .study import app as study
from .thresholds import thresholds
from .view import view
from .watch import watch

__all__ = ["app"]


class _Commands(TyperGroup):
    """One of them may need a package that is not there."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except MissingExtraError as error:
            fail(str(error))


app = typer.Typer(
    cls=_Commands,
    name="pdoik",
    invoke_without_command=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
_ARM, _MACHINE, _WITHIN = "Inverse kinematics", "Simulation and machine", "What is behind it"
app.command(rich_help_panel=_ARM)(view)
app.command(rich_help_panel=_ARM)(solve)
app.command(rich_help_panel=_ARM)(path)
app.command(rich_help_panel=_ARM)(place)
app.command(rich_help_panel=_ARM)(report)
app.command(rich_help_panel=_ARM)(info)
app.command(rich_help_panel=_ARM)(occupancy)
app.command(rich_help_panel=_ARM)(pairs)
app.command(rich_help_panel=_ARM)(bench)
app.add_typer(study, rich_help_panel=_MACHINE)
app.command(rich_help_panel=_MACHINE)(diagnose)
app.command(rich_help_panel=_MACHINE)(propose)
app.command(rich_help_panel=_MACHINE)(predict)
app.command("simulate", rich_help_panel=_MACHINE)(replay)
app.command("replay", hidden=True)(replay)  # its name before
app.command(rich_help_panel=_MACHINE)(watch)
app.command(rich_help_panel=_MACHINE)(compare)
app.add_typer(effects, rich_help_panel=_WITHIN)
app.command(rich_help_panel=_WITHIN)(thresholds)


_FIRST = """pdoik: constrained inverse kinematics, and why a simulation and its robot disagree.

[bold]Play[/]      pdoik view                           robots in the browser: drag targets, shapes
[bold]Solve[/]     pdoik solve panda --target "0.4 0.1 0.5 1 0 0 0"
[bold]Your arm[/]  pdoik info robot.urdf                what pdoik makes of it; URDF, xacro or MJCF
          pdoik occupancy robot.urdf           hulls around its meshes, which obstacles need
[bold]Your log[/]  pdoik study new robot.urdf log.csv   then: pdoik diagnose study.yaml,
                                               pdoik view report

pdoik --help lists all commands, pdoik COMMAND --help the options of one."""


def _print_version(wanted: bool) -> None:
    if wanted:
        out.print(pdoik.__version__, highlight=False)
        raise typer.Exit


@app.callback()
def main(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and leave."
        ),
    ] = False,
) -> None:
    """Constrained inverse kinematics, and why a simulation and its robot disagree.

    Exit status: 0 solved (or done), 1 not solved, 2 misuse or a file that cannot be read.

    [bold]Example[/]: pdoik solve panda --target "0.4 0.1 0.5 1 0 0 0"
    """
    if context.invoked_subcommand is None:
        out.print(_FIRST, highlight=False)
