"""pdoik predict: the torque that a diagnosed model needs for a motion."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from pdoik._extras import asks_for

from .messages import misuse_fails, out
from .motions import Columns, check_files, read_motion, reading_of, write_motion


def predict(
    model: Annotated[Path, typer.Argument(help="model.json of pdoik diagnose.")],
    recording: Annotated[Path, typer.Argument(help="Log of any kind with time and q.<joint>.")],
    robot: Annotated[
        Path | None,
        typer.Option(help="URDF or MJCF instead of the study's, as with a known load in the hand."),
    ] = None,
    without_findings: Annotated[
        bool, typer.Option("--without-findings", help="By the model as it was before.")
    ] = False,
    columns: Columns = None,
    output: Annotated[Path, typer.Option("--out", help="CSV to write.")] = Path("torque.csv"),
) -> None:
    """Predict the drives' torque for a motion.

    Writes time and tau.<joint>.

    [bold]Example[/]: pdoik predict report/model.json recording.csv --out torque.csv
    """
    check_files(model, recording, output, robot)
    with asks_for("sim2real"), misuse_fails():
        from pdoik.sim2real import load_model
        from pdoik.sim2real import predict as torque_of

        loaded = load_model(model)
        if robot is not None:
            loaded = loaded.with_robot(robot)
        motion = read_motion(recording, loaded.joints, reading_of(columns))
        tau = torque_of(loaded, motion, findings=not without_findings)  # (T, n)
        write_motion(output, loaded.joints, motion.start + motion.time, {"tau": tau})
    out.print(escape(str(output)), highlight=False)
