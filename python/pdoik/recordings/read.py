"""A log of any kind as a table: its columns named, its rows gathered."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from .columns import SUPPLY, Table
from .logs import Log, Part, check_size, open_log
from .names import BEYOND_SECONDS, Known, Settled, listed, naming_notes, settle
from .recording import FloatArray
from .units import KNOWN, Units


def read_table(
    path: Path, name: str, known: Known, part: Part, units: Units, given: Mapping[str, Any]
) -> Table:
    """The columns of a log that are channels, or the time.

    Args:
        path: Of a file or folder of any kind in `logs.KINDS`.
        name: What messages call it.
        known: Joints, and what is said of columns.
        part: Which rows.
        units: What is said of units; a log's own are in the table.
        given: What else is said of how to read it: `rate`, and keys of its kind.

    Raises:
        LoadError: it cannot be read, has no time, a cell is no number, or it has too many rows.
    """
    rate = given.get("rate")
    with open_log(path, name, {key: v for key, v in given.items() if key != "rate"}) as log:
        settled, unsettled = settle(name, log.columns, known)
        naming = naming_notes(settled)
        period = _period(log, name, settled, rate)
        clocks = ("time", BEYOND_SECONDS)
        wanted = [each for each in settled if each.target not in clocks]
        timed = [each for each in settled if each.target in clocks and period is None]
        step = _time_unit(timed, units)
        columns = [each.column.name for each in (*timed, *wanted)]
        check_size(name, log.count(columns) if columns else 0.0, part)
        pieces = _timed(log, columns, period, timed[1:])
        start, rows = _gather(name, pieces, part, step)
        if not len(rows):
            raise LoadError(f"{name}: no rows" + ("" if part.window is None else " in the window"))
        if period is not None:
            naming.append(f"no column of times: {1 / period:.6g} rows a second")
        read = {each.column.name for each in settled}
        return Table(
            name=name,
            start=start + log.origin,
            time=rows[:, 0],
            clock=_clock(timed, units) if period is None else f"{1 / period:.6g} rows a second",
            columns={
                each.target: rows[:, k] * each.factor for k, each in enumerate(wanted, start=1)
            },
            others=tuple(each.name for each in log.columns if each.name not in read),
            units={
                "voltage" if each.target == SUPPLY else each.target: each.unit
                for each in wanted
                if each.unit
            },
            readings=tuple(naming),
            unsettled=tuple(unsettled),
            notes=(*log.notes, *naming, *unsettled, *part.notes),
        )


def _period(log: Log, name: str, settled: Sequence[Settled], rate: float | None) -> float | None:
    """[s] between rows where times are not read from a column."""
    timed = [each.column.name for each in settled if each.target == "time"]
    if rate is not None:
        if timed:
            raise LoadError(f"{name}: rate: it has times already, in column {timed[0]!r}")
        return 1.0 / rate
    if timed:
        return None
    period = log.period()
    if period is None:
        names = [each.name for each in log.columns]
        raise LoadError(
            f"{name}: expected a column 'time' [s]{nearest('time', names)}; it has {listed(names)};"
            " 'columns: {time: NAME}' says which it is, or 'rate:' [Hz] that rows are even"
        )
    return period


def _time_unit(timed: Sequence[Settled], units: Units) -> float:
    """The unit [s] of the column of times; what is counted, or made of stamps, is in seconds."""
    if len(timed) != 1 or timed[0].column.converted:
        return 1.0
    return _said_of(timed[0], units).factor("time")


def _said_of(time: Settled, units: Units) -> Units:
    return units.with_written({"time": time.unit} if time.unit else {})


def _clock(timed: Sequence[Settled], units: Units) -> str:
    """What times are read from, in words."""
    names = " and ".join(repr(each.column.name) for each in timed)
    if len(timed) > 1:
        return f"columns {names}"
    if timed[0].column.converted:
        return f"{names}, by the log's own stamps or dates"
    unit, source = _said_of(timed[0], units).said_of("time")
    return f"column {names} in {unit or 's'}" + (", assumed" if source == "assumed" else "")


def _timed(
    log: Log, columns: Sequence[str], period: float | None, beyond: Sequence[Settled]
) -> Iterator[FloatArray]:
    """Rows whose first column is the time; what is `beyond` its seconds follows in the log."""
    seen = 0
    for piece in log.pieces(columns):
        if beyond:
            piece[:, 1] = piece[:, 0] + piece[:, 1] * KNOWN["time"][beyond[0].unit]
            yield piece[:, 1:]
            continue
        if period is None:
            yield piece
            continue
        time = np.arange(seen, seen + len(piece)) * period
        seen += len(piece)
        yield np.column_stack([time, piece])


def _gather(
    name: str, pieces: Iterator[FloatArray], part: Part, unit: float
) -> tuple[float, FloatArray]:
    """Time of the first row [s] and the rows kept, their time since then in column 0."""
    start = None
    kept: list[FloatArray] = []
    seen = count = 0
    for piece in pieces:
        piece[~np.isfinite(piece)] = np.nan
        if start is None and np.isfinite(piece[:, 0]).any():
            start = float(piece[np.isfinite(piece[:, 0]), 0][0])
        piece[:, 0] = (piece[:, 0] - (start or 0.0)) * unit
        rows = piece[(-seen) % part.every :: part.every]
        seen += len(piece)
        if part.window is not None:
            rows = rows[(rows[:, 0] >= part.window[0]) & (rows[:, 0] <= part.window[1])]
        kept.append(rows)
        count += len(rows)
        check_size(name, count, Part(max_rows=part.max_rows))
        if part.window is not None and len(piece) and piece[-1, 0] > part.window[1]:
            break
    if not kept:
        return 0.0, np.empty((0, 1))
    table = np.concatenate(kept)
    first = float(table[0, 0]) if len(table) and np.isfinite(table[0, 0]) else 0.0
    table[:, 0] -= first
    return (start or 0.0) * unit + first, table
