"""The law of each joint's controller: its figures, how well it predicts, what it hides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import Recording

from ..findings import ControllerEstimate, Estimate
from ..thresholds import ControllerThresholds
from .choose import Chosen, chosen, let_go, predicted
from .law import Fitted
from .rows import EFFORTS, Feeds, Piece, effort_of, pieces_of

_RESTING = 50  # numerics: samples without a change that are a rest
_LEAST_HELD = 20  # numerics: changes by which a period is found
_DELAYS = {"effort": "delay", "command": "command_delay", "speed": "speed_delay"}
_NAMES = {"rate": "kd_command", "ratio": "kp"}


@dataclass(frozen=True, kw_only=True, eq=False)
class JointLaw:
    """What was estimated of a joint, with all that it rests on."""

    estimate: ControllerEstimate
    chosen: Chosen | None = None
    feeds: Feeds | None = None
    each: tuple[tuple[float, float], ...] = ()  # position gain and error of every recording alone

    def let_go(
        self, recording: Recording, j: int, limits: ControllerThresholds
    ) -> NDArray[np.bool_]:
        """Samples at which the drive of joint j has let go, (T,)."""
        if self.chosen is None or self.feeds is None:
            return np.zeros(len(recording.time), dtype=np.bool_)
        effort, most = self.estimate.effort, len(recording.time)
        (piece,) = pieces_of((recording,), j, effort, self.feeds, limits, most)
        return let_go(piece, self.chosen, limits)


def joint_law(
    joint: str,
    j: int,
    fit: Sequence[Recording],
    validate: Sequence[Recording],
    feeds: Feeds,
    limits: ControllerThresholds,
) -> JointLaw:
    """The law of joint number j.

    Args:
        joint: its name.
        j: its column.
        fit: recordings to learn from, thinned.
        validate: recordings that judge, thinned.
        feeds: what the model feeds forward.
        limits: what is believed.
    """
    effort = effort_of((*fit, *validate), j)
    if not effort:
        return JointLaw(estimate=ControllerEstimate(joint=joint, law=""))
    pieces = pieces_of(fit, j, effort, feeds, limits)
    moving = any(np.ptp(piece.error) > 0.0 and np.ptp(piece.effort) > 0.0 for piece in pieces)
    found = chosen(pieces, limits) if moving else None
    if found is None:
        return JointLaw(estimate=ControllerEstimate(joint=joint, law="", effort=effort))
    judges = pieces_of(validate, j, effort, feeds, limits) or pieces
    explained, left = _judged(judges, found, limits)
    gains = _gains(pieces, found, effort, limits)
    believed = explained >= limits.believed and _holds(gains["kp"], limits)
    if not believed:
        gains = {}
    return JointLaw(
        estimate=ControllerEstimate(
            joint=joint,
            law=found.law.form.kind if believed else "",
            effort=effort,
            unit=EFFORTS[effort],
            gains=gains,
            table=_table(found.pieces, found.law) if believed else (),
            explained=explained,
            error=left,
            data=", ".join(piece.name for piece in judges),
        ),
        chosen=found if believed else None,
        feeds=feeds,
        each=tuple(_alone(piece, found) for piece in found.pieces) if believed else (),
    )


def _holds(kp: Estimate, limits: ControllerThresholds) -> bool:
    """Whether a law pulls to its command: else it only repeats what the machine's motion is."""
    return kp.value > limits.gain_t * kp.std


def _alone(piece: Piece, found: Chosen) -> tuple[float, float]:
    """The position gain and its error of one recording."""
    law = replace(found.law, pieces=(piece,)).whole
    name = "ratio" if found.law.form.kind == "cascade" else "kp"
    return law.value(name), law.std(name)


def _judged(
    judges: Sequence[Piece], found: Chosen, limits: ControllerThresholds
) -> tuple[float, float]:
    """Share of the variance explained, and what is left (root mean square)."""
    left, whole = [], []
    for piece in judges:
        asked = predicted(piece, found.law, found.limit)
        silent = np.abs(piece.effort) <= limits.no_effort * np.abs(piece.effort).max()
        use = piece.use & ~silent
        left.append((piece.effort - asked)[use])
        whole.append(piece.effort[use])
    every = np.concatenate(whole)
    if len(every) < 2:
        return 0.0, 0.0
    rest = float(np.mean(np.concatenate(left) ** 2))
    return 1.0 - rest / max(float(np.var(every)), 1e-300), float(np.sqrt(rest))


def _gains(
    pieces: Sequence[Piece], found: Chosen, effort: str, limits: ControllerThresholds
) -> dict[str, Estimate]:
    """Figures with their errors, at least a share of them, by name."""
    form, whole, unit = found.law.form, found.law.whole, EFFORTS[effort]
    units = {"kp": f"{unit}/rad", "kd": f"{unit} s/rad", "ki": f"{unit}/(rad s)"}
    units |= {"kv": f"{unit} s/rad", "rate": f"{unit} s/rad", "ratio": "1/s", "bias": unit}
    if form.kind == "cascade":
        units["ki"] = f"{unit}/rad"
    names = [*(["ratio"] if form.kind == "cascade" else []), *form.names]
    result = {}
    for name in names if form.integrates else [*names, "bias"]:
        if not name.startswith("knee"):
            value = whole.value(name)
            error = float(
                np.hypot(whole.std(name), 0.0 if name == "bias" else limits.gain_error * value)
            )
            result[_NAMES.get(name, name)] = _estimate(value, error, units.get(name, "-"))
    for name in form.nonlinear:
        if name != "ratio":
            said = "time_constant" if name == "lag" else _DELAYS[form.late]
            result[said] = _estimate(getattr(form, name), whole.std(name), "s")
    if np.isfinite(found.limit):
        top = 0.001 * found.limit
        result["limit"] = _estimate(found.limit, top, unit)
    period = held_period(pieces, limits.steady)
    if period:
        result["period"] = _estimate(period, 0.25 * pieces[0].period, "s")
    return result


def held_period(pieces: Sequence[Piece], steady: float) -> float:
    """Time for which the controller keeps its effort, where the log is faster [s]; else 0."""
    found = []
    for piece in pieces:
        gaps = np.diff(np.flatnonzero(np.diff(piece.effort) != 0.0))
        gaps = gaps[gaps < _RESTING]
        if len(gaps) < _LEAST_HELD:
            return 0.0
        count = float(np.median(gaps))
        if count < 2.0 or np.mean(np.abs(gaps - count) < 1.0) < steady:
            return 0.0
        found.append(float(np.mean(gaps)) * piece.period)
    return float(np.median(found))


def _table(pieces: Sequence[Piece], law: Fitted) -> tuple[tuple[float, float], ...]:
    """Error and effort of a table, at its knees and its ends."""
    if law.form.kind != "table":
        return ()
    most = max(float(np.max(np.abs(piece.error[piece.use]))) for piece in pieces)
    kp, slopes = law.gains[0], law.gains[2 : 2 + len(law.form.knees)]
    at = np.array([0.0, *law.form.knees, most])
    beyond = np.maximum(at[:, None] - np.array(law.form.knees), 0.0)
    effort = kp * at + beyond @ slopes
    pairs = [(float(x), float(y)) for x, y in zip(at, effort, strict=True)]
    return (*((-x, -y) for x, y in pairs[:0:-1]), *pairs)


def _estimate(value: float | np.floating, std: float, unit: str) -> Estimate:
    return Estimate.normal(float(value), std, unit)
