"""pdoik simulate: the motion that a diagnosed model makes of commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from pdoik._extras import asks_for

from .messages import misuse_fails, out
from .motions import Columns, check_files, read_motion, reading_of, write_motion


def replay(
    model: Annotated[Path, typer.Argument(help="model.json of pdoik diagnose.")],
    commands: Annotated[
        Path,
        typer.Argument(
            help="Log of any kind with time and q_des.<joint> or tau_cmd.<joint>; a recording will"
            " do, its first q.<joint> is then where the motion starts."
        ),
    ],
    without_findings: Annotated[
        bool, typer.Option("--without-findings", help="By the model as it was before.")
    ] = False,
    columns: Columns = None,
    output: Annotated[Path, typer.Option("--out", help="CSV to write.")] = Path("replay.csv"),
) -> None:
    """Simulate the robot under its controller for given commands.

    Writes the channels of a recording: time, q, dq, tau and the commands.

    [bold]Example[/]: pdoik simulate report/model.json commands.csv --out replay.csv
    """
    check_files(model, commands, output)
    with asks_for("sim2real"), misuse_fails():
        from pdoik.sim2real import load_model
        from pdoik.sim2real import replay as simulate

        loaded = load_model(model)
        motion = read_motion(commands, loaded.joints, reading_of(columns), commands=True)
        simulated = simulate(loaded, motion, findings=not without_findings)
        channels = {name: getattr(simulated, name) for name in simulated.channels if name != "tip"}
        write_motion(output, loaded.joints, simulated.start + simulated.time, channels)
    for reason in () if without_findings else loaded.not_simulated:
        out.print(f"note: {reason}", highlight=False)
    out.print(escape(str(output)), highlight=False)
