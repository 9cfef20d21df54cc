"""pdoik compare: a simulator and the machine, and what of its properties differs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from pdoik._extras import asks_for

from .messages import fail, misuse_fails, out
from .story import story

if TYPE_CHECKING:
    from pdoik.sim2real.simulators import Comparison


def compare(
    study: Annotated[Path, typer.Argument(help="YAML: simulator or simulation, recordings.")],
    out_folder: Annotated[
        Path, typer.Option("--out", help="Folder for the comparison; its files are replaced.")
    ] = Path("comparison"),
) -> None:
    """Hold your simulator against the machine under the same commands, and say what differs.

    The study has `simulator: {mjcf: model.xml}`, which is run as it is, or `simulation:`, logs of
    any simulator; with `robot:` too, what the simulator has beyond the description is listed apart.

    Writes comparison.json, patched.xml (the MJCF with what the machine has beyond it), patch.md
    (the same in the words of Isaac and Gazebo), figures and compare.html.

    [bold]Example[/]: pdoik compare study.yaml --out comparison
    """
    if study.is_dir():
        fail(f"study {study}: is a folder, expected a YAML file")
    if not study.is_file():
        fail(f"study {study}: no such file")
    if out_folder.exists() and not out_folder.is_dir():
        fail(f"--out {out_folder}: is a file, expected a folder")
    with asks_for("sim2real"), misuse_fails():
        from pdoik.sim2real import SimulationError
        from pdoik.sim2real.simulators import compare as compared
        from pdoik.sim2real.simulators import write

        with story() as tell:
            try:
                comparison = compared(study, tell=tell)
            except SimulationError as error:
                fail(str(error))
        path = write(out_folder, comparison)
        _print(comparison)
    out.print(escape(str(path)), highlight=False)


_LINES = 12  # of findings of a step


def _print(comparison: Comparison) -> None:
    from pdoik.sim2real.report import number
    from pdoik.sim2real.simulators import finding_line, headline

    for pair in comparison.pairs:
        said = (
            f"{pair.machine.name} and {pair.simulation.name}: the same commands, by {pair.by};"
            f" the machine's log is {number(1e3 * pair.shift)} ms later"
        )
        out.print(escape(said), highlight=False)
    for step in (comparison.simulator, comparison.machine):
        if step is None:
            continue
        out.print(f"[bold]{escape(headline(step))}[/]", highlight=False)
        for name, fit in step.joints.items():
            said = f"  {name}: {number(fit.before)} -> {number(fit.after)} rad rms, held out"
            out.print(escape(said), highlight=False)
        for finding in step.findings[:_LINES]:
            out.print(escape(finding_line(finding)), highlight=False)
        if len(step.findings) > _LINES:
            out.print(f"... and {len(step.findings) - _LINES} more", highlight=False)
        for finding in step.suspected[:3]:
            out.print(escape(f"suspected: {finding_line(finding)}"), highlight=False)
