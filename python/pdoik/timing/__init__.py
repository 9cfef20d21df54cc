"""When to be where on a path: speeds for whole paths and for moves.

`time_path` and `time_motion` take configurations joined by straight lines, round the corners
by no more than is given, and give the fastest motion from rest to rest within limits of speed,
acceleration and jerk; or one whose tool goes at a constant speed wherever joints allow it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pdoik import _core
from pdoik._extras import asks_for
from pdoik.timing.limits import Tool, joint_limits
from pdoik.timing.trajectory import Dip, Recheck, Trajectory

if TYPE_CHECKING:
    from pdoik.timing.piece import Piece, Use

__all__ = ["Dip", "Recheck", "Trajectory", "time_motion", "time_path"]

FloatArray = npt.NDArray[np.float64]

_SAME = 1e-9  # rows that are no farther apart than this are one [rad] or [m]
_WHOLE = 1e-9  # of a period: what is beyond a whole number of them by no more is on it
_STRAIGHT = 1e-6  # turns of direction that are no larger than this are none
_LEAST_DEVIATION = 1e-9  # of what is straight but for this


def time_path(
    robot: _core.Robot,
    q: npt.ArrayLike,
    *,
    max_acceleration: npt.ArrayLike | None = None,
    max_speed: npt.ArrayLike | None = None,
    max_jerk: npt.ArrayLike | None = None,
    tool_speed: float | None = None,
    tool_turn: float | None = None,
    tip: str | None = None,
    T_tip_tool: npt.ArrayLike | None = None,
    at: npt.ArrayLike | None = None,
    rest_at: Sequence[int] = (),
    deviation: float = 1e-4,
    rate: float | None = None,
) -> Trajectory:
    """Time a path of many rows, such as `Solver.solve_path` gives.

    Without tool_speed the motion is the fastest within the limits. With it, the tool goes at that
    speed, never faster, and slower only where a limit binds: the trajectory's dips say where and
    which. It begins and ends at rest. What is returned was measured: at several moments of every
    step of it speeds, accelerations and jerks were within their limits.

    The path's corners are rounded by a cubic spline that is twice continuously differentiable and
    keeps within `deviation` of the straight lines between rows (`pdoik.timing.curve`). Then the
    fastest way along it is found (TOPP-RA: Pham and Pham, IEEE T-RO 34(3), 2018); with limits of
    jerk, a descent goes on from there (Debrouwere et al., IEEE T-RO 29(6), 2013): seconds.

    Args:
        robot: Whose joints they are; its speed limits hold.
        q: Configurations one after the other, shape (m, n) [rad] or [m]. Repeated rows are one.
        max_acceleration: Of all joints, or of each, shape (n,) [rad/s^2] or [m/s^2]. Has to be
            given, for robots' descriptions have none.
        max_speed: The same of speeds, besides those of the robot [rad/s] or [m/s]. Has to be given
            for joints that have no limit there.
        max_jerk: The same of jerks, infinity for none [rad/s^3] or [m/s^3]; None for no limits:
            acceleration then jumps.
        tool_speed: Of the tool's origin, in the base frame [m/s].
        tool_turn: How fast the tool may turn, at most [rad/s].
        tip: Whose speed it is; None for the tip, if there is one only.
        T_tip_tool: The tool in the tip link's frame, shape (4, 4) [m]; None for the link itself.
        at: A place on the path for each row, rising, shape (m,), such as `at` of a path's result;
            None for rows' numbers.
        rest_at: Rows at which to come to rest, exactly there.
        deviation: How far a joint may be off the straight lines [rad] or [m]; 0 for resting at
            every corner. The smaller it is, the slower corners are; and rows of a smooth path have
            corners between them too, where steps are longer than about sqrt(8 deviation).
        rate: Samples a second [Hz]. The last is then up to one period after the end. None for as
            many as the motion's own steps, at uneven times.

    Returns:
        The trajectory, with its dips and what became of `deviation`.

    Raises:
        ValueError: A shape or a number is wrong, q has no two different rows, max_acceleration is
            missing, or a joint that moves has no speed limit or one of 0.
        PdoikError: No motion is found, to the precision of numbers.
        MissingExtraError: scipy is not installed.

    >>> import numpy as np
    >>> import pdoik
    >>> robot = pdoik.Robot.builtin("panda")
    >>> q = robot.mid_configuration() + np.linspace(0.0, 0.5, 50)[:, None]
    >>> pdoik.time_path(robot, q, max_acceleration=5.0)
    <Trajectory of 7 joints, 0.6325 s, 201 samples>
    """
    rows = _rows(robot, q)
    limits = joint_limits(robot, np.ptp(rows, axis=0) > 0.0, max_speed, max_acceleration, max_jerk)
    tool = Tool.of(robot, tip, T_tip_tool, tool_speed, tool_turn)
    if not (np.isfinite(deviation) and deviation >= 0.0):
        raise ValueError(f"deviation is {deviation}, expected 0 or more")
    if rate is not None and not (np.isfinite(rate) and rate > 0.0):
        raise ValueError(f"rate is {rate}, expected a positive number [Hz]")
    places = _places(at, len(rows))
    rests = _rests(rest_at, len(rows))

    kept = np.append(True, np.abs(np.diff(rows, axis=0)).max(axis=1) > _SAME)
    rests, rows, places = (np.cumsum(kept) - 1)[rests], rows[kept], places[kept]
    if len(rows) < 2:
        raise ValueError("q has no two different rows")
    s = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(rows / limits.speed, axis=0), axis=1)))
    if deviation == 0.0:
        rests = np.append(rests, _corners(rows / limits.speed, s))
    ends = np.unique(np.concatenate([[0], rests, [len(rows) - 1]]))
    with asks_for("timing"):
        from pdoik.timing.piece import time_piece
    allowed = max(deviation, _LEAST_DEVIATION)
    pieces = [
        time_piece(rows[a : b + 1], s[a : b + 1], places[a : b + 1], limits, tool, allowed)
        for a, b in pairwise(ends)
    ]
    return _joined(tuple(robot.joint_names), pieces, tool, rate)


def time_motion(
    robot: _core.Robot,
    q: npt.ArrayLike,
    *,
    max_acceleration: npt.ArrayLike | None = None,
    max_speed: npt.ArrayLike | None = None,
    max_jerk: npt.ArrayLike | None = None,
    deviation: float = 0.01,
    rate: float | None = None,
) -> Trajectory:
    """Time a move with few corners, such as `Solver.plan_motion` gives: `time_path` without a tool.

    Args:
        robot: As for `time_path`, like the others.
        q: Corners, shape (m, n) [rad] or [m].
        max_acceleration: As there.
        max_speed: As there.
        max_jerk: As there.
        deviation: As there, but larger: corners are cut by this much, so what the move is clear of
            by less may be touched. `Trajectory.recheck` shows it.
        rate: As there.

    Raises:
        ValueError: As there.
        PdoikError: As there.
        MissingExtraError: As there.
    """
    return time_path(
        robot,
        q,
        max_acceleration=max_acceleration,
        max_speed=max_speed,
        max_jerk=max_jerk,
        deviation=deviation,
        rate=rate,
    )


def _rows(robot: _core.Robot, q: npt.ArrayLike) -> FloatArray:
    rows = np.array(q, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != robot.dof or len(rows) < 2:
        raise ValueError(f"q has shape {rows.shape}, expected (m, {robot.dof}) with 2 rows or more")
    wrong = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(wrong):
        raise ValueError(f"row {wrong[0]} of q holds NaN or infinity")
    return rows


def _places(at: npt.ArrayLike | None, count: int) -> FloatArray:
    if at is None:
        return np.arange(count, dtype=np.float64)
    places = np.array(at, dtype=np.float64)
    if places.shape != (count,):
        raise ValueError(f"at has shape {places.shape}, expected ({count},)")
    if not (np.isfinite(places).all() and (np.diff(places) >= 0.0).all()):
        raise ValueError("at does not rise, or holds NaN or infinity")
    return places


def _rests(rest_at: Sequence[int], count: int) -> npt.NDArray[np.int64]:
    for row in rest_at:
        if not 0 <= row < count:
            raise ValueError(f"rest_at has {row}, and q has {count} rows")
    return np.array(rest_at, dtype=np.int64)


def _corners(rows: FloatArray, s: FloatArray) -> npt.NDArray[np.int64]:
    directions = np.diff(rows, axis=0) / np.diff(s)[:, None]
    turns = np.linalg.norm(np.diff(directions, axis=0), axis=1)
    return np.flatnonzero(turns > _STRAIGHT) + 1


def _joined(
    names: tuple[str, ...],
    timed: Sequence[tuple[Piece, Use]],
    tool: Tool | None,
    rate: float | None,
) -> Trajectory:
    """One trajectory of pieces that follow one another."""
    from pdoik.timing.dips import dips

    pieces = [piece for piece, _ in timed]
    starts = list(accumulate((piece.duration for piece in pieces), initial=0.0))
    if rate is None:
        inner = [start + piece.nodes[:-1] for start, piece in zip(starts, pieces, strict=False)]
        time = np.append(np.concatenate(inner), starts[-1])
    else:
        time = np.arange(int(np.ceil(starts[-1] * rate - _WHOLE)) + 1) / rate
    which = np.clip(np.searchsorted(starts, time, side="right") - 1, 0, len(pieces) - 1)
    states = [piece.states(time[which == k] - starts[k]) for k, piece in enumerate(pieces)]
    at, q, dq, ddq, _ = (np.concatenate(each) for each in zip(*states, strict=True))
    q[-1], dq[-1], ddq[-1] = pieces[-1].end, 0.0, 0.0
    found = []
    if tool is not None and np.isfinite(tool.speed):
        found = [dips(use, tool, starts[k], names) for k, (_, use) in enumerate(timed)]
    return Trajectory(
        joint_names=names,
        time=time,
        q=q,
        dq=dq,
        ddq=ddq,
        at=at,
        dips=tuple(dip for each in found for dip in each),
        deviation=max(piece.curve.deviation for piece in pieces),
    )
