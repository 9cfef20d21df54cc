"""Makes a recording of a file's raw columns, or a message that says what is wrong with them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from .columns import CONTACT, VECTORS, Table, channel_of, joints_of, pose_columns
from .duty import with_supply
from .encoder_steps import encoder_steps
from .glitches import glitches
from .mend_jumps import with_jumps_mended
from .recording import CHANNELS, STILL, FloatArray, Recording, Role
from .resample import GAP, Grid, on_grid, uniform_grid
from .suspected_unit import SuspectedUnitError
from .units import Units

SHORTEST = 2.0  # [s]
FEWEST = 50  # samples

_DUPLICATES = 0.3  # share of rows whose time stamp is the one before
_MEASURED = ("dq", "tau", "current", "duty")  # a joint that moves changes these


def to_recording(
    table: Table,
    joints: tuple[str, ...],
    role: Role,
    units: Units,
    slides: Collection[str] = (),
    feet: tuple[str, ...] = (),
) -> Recording:
    """A file's columns in SI units on a uniform grid, repairs noted.

    Args:
        table: What the file holds, time in seconds.
        joints: Whose columns are taken, in this order.
        role: Of the file.
        units: Of the columns.
        slides: The prismatic ones among the joints.
        feet: Links whose sensors' columns are read, in their order.

    Raises:
        LoadError: a position column is missing or jumps throughout, time runs backwards or stands,
            it is too short.
    """
    _check_positions(table, joints)
    table = with_supply(_with_rising_time(table), joints)
    _check_length(table, units)
    table = with_jumps_mended(table, joints, units, slides)
    grid = uniform_grid(table.time)
    notes = [*table.notes, *_grid_notes(grid)]
    valid = np.ones(len(grid.time), dtype=np.bool_)
    arrays: dict[str, FloatArray | None] = {}
    for channel in CHANNELS:
        columns = [f"{channel}.{joint}" for joint in joints]
        factors = [
            units.factor(column, joint in slides)
            for column, joint in zip(columns, joints, strict=True)
        ]
        arrays[channel] = _channel(table, grid, channel, columns, factors, valid, notes)
    poses = {of: _pose(table, grid, of, units, valid, notes) for of in ("tip", "base")}
    imu = {of: _vector(table, grid, of, units, valid, notes) for of in VECTORS}
    contact = _channel(
        table, grid, "contact", [CONTACT + foot for foot in feet], [1.0] * len(feet), valid, notes
    )
    q = arrays.pop("q")
    logged = [
        table.columns[f"q.{joint}"] * units.factor(f"q.{joint}", joint in slides)
        for joint in joints
    ]
    assert q is not None
    recording = Recording(
        name=table.name,
        role=role,
        start=table.start,
        time=grid.time,
        q=q,
        contact=contact,
        tip=poses["tip"],
        base=poses["base"],
        gyro=imu["gyro"],
        acc=imu["acc"],
        valid=valid,
        raw_period=grid.raw_period,
        jitter=grid.jitter,
        steps=encoder_steps(logged),
    )
    recording = replace(recording, **arrays)  # type: ignore[arg-type]
    if not valid.all():
        notes.append(f"{100 * (1 - valid.mean()):.2g} % of the samples lie in gaps: not used")
    return replace(_without_frozen(recording, joints, notes), notes=tuple(notes))


def moves(recording: Recording) -> NDArray[np.bool_]:
    """Which joints move, (n,)."""
    return np.asarray(np.ptp(recording.q, axis=0) > STILL)


def _check_positions(table: Table, joints: tuple[str, ...]) -> None:
    has = joints_of(table.columns)
    for joint in joints:
        if joint not in has:
            column = f"q.{joint}"
            names = [*table.columns, *table.others]
            free = [each for each in names if not _is_of(each, joints)]
            near = nearest(column, free) or nearest(column, names)
            why = "".join(f"; {each}" for each in table.unsettled)
            raise LoadError(
                f"{table.name}: expected a column {column!r} [rad]{near};"
                f" it has positions of {', '.join(has) or 'no joint'}{why}"
            )
        values = table.columns[f"q.{joint}"]
        if np.isfinite(values).sum() < FEWEST <= len(values):
            raise LoadError(
                f"{table.name}: column 'q.{joint}' has {np.isfinite(values).sum()} numbers in"
                f" {len(values)} rows, expected at least {FEWEST}"
            )


def _is_of(column: str, joints: tuple[str, ...]) -> bool:
    """Whether it is a channel of one of the joints."""
    pair = channel_of(column)
    return pair is not None and pair[1] in joints


def _with_rising_time(table: Table) -> Table:
    """The table without rows that have no time or that of the row before."""
    time, notes = table.time, list(table.notes)
    keep = np.isfinite(time)
    if not keep.any():
        raise LoadError(f"{table.name}: column 'time' holds no numbers")
    if not keep.all():
        notes.append(f"{(~keep).sum()} rows without a time left out")
    rows = np.flatnonzero(keep)
    steps = np.diff(time[rows])
    if (steps < 0).any():
        k = int(np.argmax(steps < 0))
        raise LoadError(
            f"{table.name}: time runs backwards in data row {rows[k + 1] + 1}:"
            f" {table.start + time[rows[k + 1]]:.6f} s after {table.start + time[rows[k]]:.6f} s"
            f" ({(steps < 0).sum()} such steps); sort the rows, or cut the file there"
        )
    again = np.concatenate([[False], steps == 0])
    if again.mean() > _DUPLICATES:
        raise LoadError(
            f"{table.name}: {again.sum()} of {len(rows)} rows have the stamp of the one before;"
            f" expected 'time' with enough digits to tell rows apart"
        )
    if again.any():
        notes.append(f"{again.sum()} rows with the time stamp of the row before left out")
        rows = rows[~again]
    first = float(time[rows[0]])
    return replace(
        table,
        start=table.start + first,
        time=time[rows] - first,
        columns={name: values[rows] for name, values in table.columns.items()},
        notes=tuple(notes),
    )


def _check_length(table: Table, units: Units) -> None:
    if len(table.time) < FEWEST:
        raise LoadError(
            f"{table.name}: {len(table.time)} samples, expected at least {FEWEST}: the recording is"
            " too short"
        )
    step = float(np.median(np.diff(table.time)))
    if step > 0.5 and not units.settles("time"):
        unit = "ms" if step < 500 else "us" if step < 5e5 else "ns"
        raise SuspectedUnitError(
            f"{table.name}: rows are {step:g} s apart; if column 'time' is in {unit} and not in s,"
            f" say so: 'units: {{time: {unit}}}' (else 'units: {{time: s}}')",
            "time",
            unit,
            f"rows would be {step:g} s apart",
        )
    if table.time[-1] < SHORTEST:
        raise LoadError(
            f"{table.name}: lasts {table.time[-1]:.3g} s, expected at least {SHORTEST:g} s: the"
            " recording is too short"
        )


def _grid_notes(grid: Grid) -> list[str]:
    notes = []
    if not grid.as_recorded:
        notes.append(
            f"resampled to {1 / grid.period:.4g} Hz (its time steps scatter by"
            f" {100 * grid.jitter / grid.raw_period:.2g} % of their median)"
        )
    steps = np.diff(grid.raw)
    gaps = steps[steps > GAP * grid.raw_period]
    if len(gaps):
        notes.append(f"{len(gaps)} gaps in time, the longest {gaps.max():.3g} s")
    return notes


def _channel(
    table: Table,
    grid: Grid,
    channel: str,
    columns: list[str],
    factors: list[float],
    valid: NDArray[np.bool_],
    notes: list[str],
) -> FloatArray | None:
    """A channel on the grid, None if no joint has it; `valid` and `notes` are added to."""
    out = np.full((len(grid.time), len(columns)), np.nan)
    for k, (column, factor) in enumerate(zip(columns, factors, strict=True)):
        values = table.columns.get(column)
        if values is None:
            continue
        missing = ~np.isfinite(values)
        if missing.all():
            notes.append(f"column {column!r} holds no numbers")
            continue
        jumping = glitches(values) if channel == "q" else np.zeros(len(values), dtype=np.bool_)
        if jumping.any():
            notes.append(_of_glitches(column, values * factor, jumping))
            values = np.where(jumping, np.nan, values)
        out[:, k], backed = on_grid(grid, channel, values * factor)
        valid &= backed
        if missing.any():
            lost = "" if backed.all() else "; the longer gaps are not used"
            notes.append(f"{missing.sum()} missing values of {column!r} bridged{lost}")
    return None if np.isnan(out).all() else out


def _of_glitches(column: str, values: FloatArray, jumping: NDArray[np.bool_]) -> str:
    """What was left out, and how far it jumped, in words."""
    rest = np.interp(np.flatnonzero(jumping), np.flatnonzero(~jumping), values[~jumping])
    size = float(np.median(np.abs(values[jumping] - rest)))
    return (
        f"{jumping.sum()} readings of {column!r} that jump by {size:.2g} and come back within"
        " samples left out: the sensor or its bus is faulty"
    )


def _vector(
    table: Table,
    grid: Grid,
    of: str,
    units: Units,
    valid: NDArray[np.bool_],
    notes: list[str],
) -> FloatArray | None:
    """A channel of an IMU on the grid, (T, 3)."""
    names = [f"{of}.{axis}" for axis in VECTORS[of]]
    lost = [name for name in names if name not in table.columns]
    if len(lost) == len(names):
        return None
    if lost:
        raise LoadError(f"{table.name}: expected {' '.join(names)}; missing: {', '.join(lost)}")
    return _channel(table, grid, of, names, [units.factor(of)] * 3, valid, notes)


def _pose(
    table: Table,
    grid: Grid,
    of: str,
    units: Units,
    valid: NDArray[np.bool_],
    notes: list[str],
) -> FloatArray | None:
    """A pose on the grid; a tip's orientation is NaN where only its position was measured."""
    names = pose_columns(of)
    there = [name for name in names if name in table.columns]
    if not there:
        return None
    whole = (list(names), list(names[:3])) if of == "tip" else (list(names),)
    if there not in whole:
        lost = [name for name in names if name not in there]
        enough = ", with or without " if of == "tip" else " "
        raise LoadError(
            f"{table.name}: expected {' '.join(names[:3])}{enough}{' '.join(names[3:])}; missing:"
            f" {', '.join(lost)}"
        )
    if any(not np.isfinite(table.columns[name]).any() for name in there):
        notes.append(f"the {of}'s columns hold no numbers")
        return None
    pose = np.stack([table.columns[name] for name in there], axis=1)
    pose[:, :3] *= units.factor(of)
    if len(there) == 7:
        pose[:, 3:] = _unit_quaternions(table.name, of, pose[:, 3:])
    else:
        notes.append(f"the {of}'s orientation was not recorded")
    out = np.full((len(grid.time), 7), np.nan)
    for k in range(pose.shape[1]):
        out[:, k], backed = on_grid(grid, of, pose[:, k])
        valid &= backed
    if len(there) == 7:
        out[:, 3:] /= np.linalg.norm(out[:, 3:], axis=1, keepdims=True)
    return out


def _unit_quaternions(name: str, of: str, wxyz: FloatArray) -> FloatArray:
    """Quaternions of norm 1 with no jumps of sign, (R, 4)."""
    norms = np.linalg.norm(wxyz, axis=1)
    there = np.isfinite(norms)
    if there.any() and np.abs(norms[there] - 1).max() > 0.05:
        worst = norms[there][np.abs(norms[there] - 1).argmax()]
        raise LoadError(
            f"{name}: the {of}'s quaternion ({of}.qw ... {of}.qz) has norm {worst:.3g}, expected 1"
        )
    out = wxyz / norms[:, None]
    rows = np.flatnonzero(there)
    turns = np.sum(out[rows[1:]] * out[rows[:-1]], axis=1) < 0
    signs = np.concatenate([[1.0], np.where(np.cumsum(turns) % 2, -1.0, 1.0)])
    out[rows] *= signs[:, None]
    return np.asarray(out, dtype=np.float64)


def _without_frozen(recording: Recording, joints: tuple[str, ...], notes: list[str]) -> Recording:
    """The recording without measured columns that never change though their joint moves."""
    moving = moves(recording)
    for joint, moved in zip(joints, moving, strict=True):
        if not moved:
            notes.append(f"joint {joint} does not move")
    changed: dict[str, FloatArray | None] = {}
    for channel in _MEASURED:
        values = getattr(recording, channel)
        if values is None:
            continue
        frozen = np.ptp(values, axis=0) == 0
        for k in np.flatnonzero(frozen):
            what = f"column '{channel}.{joints[k]}' is {values[0, k]:g} throughout"
            notes.append(what + (" though the joint moves: left out" if moving[k] else ""))
        if (frozen & moving).any():
            kept = np.where(frozen & moving, np.nan, values)
            changed[channel] = None if np.isnan(kept).all() else kept
    return replace(recording, **changed)  # type: ignore[arg-type]
