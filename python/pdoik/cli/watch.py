"""pdoik watch: what has changed of a machine since its diagnosis, from logs as they grow."""

from __future__ import annotations

import os
import select
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TextIO

import typer
from rich.markup import escape

from pdoik._extras import asks_for

from . import interrupts
from .messages import fail, misuse_fails, out, warn
from .motions import Columns, read_motion, reading_of

if TYPE_CHECKING:
    from pdoik.recordings import Reading
    from pdoik.sim2real import Alarm, Watch
    from pdoik.sim2real.watch import Piece

    Pieces = Iterator[Piece]
    Stopped = Callable[[], bool]

ALARMED = 3
_PAUSE = 0.1  # between looks at the files [s]


def watch(
    model: Annotated[Path, typer.Argument(help="model.json of pdoik diagnose.")],
    logs: Annotated[
        list[Path],
        typer.Argument(
            help="CSV files with time, q.<joint> and tau.<joint>, read one after the other; or one"
            " folder into which such files are written; or - for standard input."
        ),
    ],
    once: Annotated[
        bool, typer.Option("--once", help="Read what is there and end: status 3 after an alarm.")
    ] = False,
    calibrate: Annotated[
        list[Path] | None,
        typer.Option(help="Log of the healthy machine, for the floor; may be given several times."),
    ] = None,
    columns: Columns = None,
    output: Annotated[
        Path | None, typer.Option("--out", help="JSON lines to add to, one for each alarm.")
    ] = None,
    false_alarms: Annotated[
        float, typer.Option(min=1e-6, help="False alarms in 24 h of motion, all joints together.")
    ] = 1.0,
    friction_change: Annotated[
        float,
        typer.Option(min=0.0, help="Share by which friction may differ from day to day."),
    ] = 0.15,
) -> None:
    """Watch a machine: what has changed since its diagnosis, at which joint, since when, and why.

    The torque that the model leaves unexplained is held against its floor by CUSUM charts. A change
    is reported twice: at once when it is noticed, and when its cause is learnt.

    Exit status with --once: 0 no alarm, 3 an alarm, 2 misuse.

    [bold]Example[/]: pdoik watch report/model.json logs/ --out alarms.jsonl
    """
    _check(model, logs, calibrate or [], output)
    with asks_for("sim2real"), misuse_fails():
        from pdoik.sim2real import Thresholds, Watch, calibrated, load_model

        changed = {"watch.alarms_per_day": false_alarms, "watch.friction_change": friction_change}
        thresholds = Thresholds().changed(changed)
        loaded = load_model(model)
        reading = reading_of(columns)
        if calibrate:
            healthy = [read_motion(each, loaded.joints, reading) for each in calibrate]
            loaded = calibrated(loaded, healthy, thresholds=thresholds.watch)
        watching = Watch(loaded, thresholds=thresholds)
        for name in watching.unwatched:
            warn(f"{name} hardly moves in the healthy logs: it is not watched")
        if output is None:
            _follow(watching, loaded.joints, logs, reading, once, None)
        else:
            with output.open("a", encoding="utf-8") as file:
                _follow(watching, loaded.joints, logs, reading, once, file)
    if once and watching.alarms:
        raise typer.Exit(ALARMED)


def _check(model: Path, logs: list[Path], calibrate: list[Path], output: Path | None) -> None:
    """Leave with status 2 unless all can be read and the output may be written."""
    for path in (model, *calibrate, *(each for each in logs if str(each) != "-")):
        if not path.exists():
            fail(f"{path}: no such file")
    alone = [each for each in logs if str(each) == "-" or each.is_dir()]
    if alone and len(logs) > 1:
        fail(f"{alone[0]}: a folder or standard input is watched alone, came {len(logs)} logs")
    if output is not None and output.is_dir():
        fail(f"--out {output}: is a folder, expected a file")
    if output is not None and not output.parent.is_dir():
        fail(f"--out {output}: no such folder: {output.parent}")
    read = [path for path in (model, *calibrate, *logs) if path.is_file()]
    if output is not None and output.exists() and any(output.samefile(path) for path in read):
        fail(f"--out {output}: is also read, expected another file")


def _follow(
    watching: Watch,
    joints: tuple[str, ...],
    logs: list[Path],
    reading: Reading,
    once: bool,
    file: TextIO | None,
) -> None:
    """Watch until there is no more, or Ctrl-C."""
    with interrupts.noted() as stop:
        pieces = _pieces(logs, joints, reading, once, lambda: not stop.empty())
        for name, columns in pieces:
            alarms = watching.end() if columns is None else watching.feed(columns, source=name)
            _report(alarms, file)
            if not stop.empty():
                return
    if once or str(logs[0]) == "-":
        _report(watching.end(), file)


def _report(alarms: Iterable[Alarm], file: TextIO | None) -> None:
    for alarm in alarms:
        out.print(escape(str(alarm)), highlight=False)
        if file is not None:
            file.write(alarm.to_json() + "\n")
            file.flush()


def _pieces(
    logs: list[Path], joints: tuple[str, ...], reading: Reading, once: bool, stopped: Stopped
) -> Pieces:
    from pdoik.sim2real.watch import Folder, Tail

    if str(logs[0]) == "-":
        yield from _standard_input(joints, reading, stopped)
        return
    *finished, last = logs
    for path in finished:
        with closing(Tail(path, joints, reading)) as tail:
            yield from tail.read()
        yield path.name, None
    kind = Folder if last.is_dir() else Tail
    with closing(kind(last, joints, reading)) as source:
        while not stopped():
            yield from source.read()
            if once:
                return
            time.sleep(_PAUSE)


def _standard_input(joints: tuple[str, ...], reading: Reading, stopped: Stopped) -> Pieces:
    from pdoik.sim2real.watch import CsvStream

    stream = CsvStream("standard input", joints, reading)
    number = sys.stdin.fileno()
    while not stopped():
        ready, _, _ = select.select([number], [], [], _PAUSE)
        if not ready:
            continue
        piece = os.read(number, 1 << 16)
        if not piece:
            return
        for columns in stream.add(piece):
            yield stream.name, columns
