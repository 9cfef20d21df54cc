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
from .h1 import h1
from .info import info
from .messages import fail, out
from .occupancy import occupancy
from .pairs import pairs
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
app.command()(solve)
app.command()(report)
app.command()(info)
app.command()(occupancy)
app.command()(pairs)
app.command()(bench)
app.command()(view)
app.command()(h1)
app.command()(diagnose)
app.command()(compare)
app.command()(predict)
app.command()(replay)
app.command()(watch)
app.command()(propose)
app.add_typer(effects)
app.add_typer(study)
app.command()(thresholds)


_FIRST = """pdoik: constrained inverse kinematics, and why a simulation and its robot disagree.

[bold]Play[/]      pdoik view                           a robot in the browser: drag its target
[bold]Solve[/]     pdoik solve --robot panda --target "0.4 0.1 0.5 1 0 0 0"
[bold]Your arm[/]  pdoik info robot.urdf                what pdoik makes of it; URDF, xacro or MJCF
          pdoik occupancy robot.urdf           hulls around its meshes, which obstacles need
[bold]Your log[/]  pdoik study new robot.urdf log.csv   then: pdoik diagnose study.yaml

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
    """Constrained inverse kinematics: joint limits and obstacle points, for arms.

    Exit status: 0 solved (or done), 1 not solved, 2 misuse or a file that cannot be read.

    [bold]Example[/]: pdoik solve --robot panda --target "0.4 0.1 0.5 1 0 0 0"
    """
    if context.invoked_subcommand is None:
        out.print(_FIRST, highlight=False)
