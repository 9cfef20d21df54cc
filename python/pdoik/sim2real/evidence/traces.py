"""Residuals of every recording at the rate it was filtered at, before and after the findings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pdoik.recordings import FloatArray

from ..motion import Balances, Key, Prepared, columns_of, zero_phase
from ..regression import Weighted, effect_of
from ..report import Traces

if TYPE_CHECKING:
    from ..infer import Examination


_AXES: tuple[Key, ...] = (("tip", 0), ("tip", 1), ("tip", 2))


def traces_of(examination: Examination) -> tuple[Traces, ...]:
    """All recordings, in the study's order."""
    prepared = examination.prepared
    every = examination.state.fit.weighted + examination.prediction.events
    by_finding = [
        [pair for pair in every if any(pair[0] is term for term in terms)]
        for terms in examination.terms
    ]
    parts = {
        motion.recording.name: _traces(balances, i, weighted, by_finding, prepared)
        for balances, weighted in _halves(examination)
        for i, motion in enumerate(balances.motions)
    }
    return tuple(parts[recording.name] for recording in prepared.study.recordings)


def shown_key(balances: Balances, j: int) -> Key | None:
    """The balance that joint j is judged by."""
    from ..infer import preferred

    return next((key for key in preferred(j) if key in balances.residual), None)


def units_of(examination: Examination) -> tuple[str, ...]:
    """Units of each joint's residual, (n,)."""
    prepared = examination.prepared
    return tuple(
        _sliding(fit.unit) if slides(prepared, j) else fit.unit
        for j, fit in enumerate(examination.diagnosis.joints.values())
    )


def slides(prepared: Prepared, j: int) -> bool:
    """Whether joint j is prismatic."""
    return prepared.body is not None and prepared.body.axis(j) is None


def channel_notes(examination: Examination) -> tuple[str, ...]:
    """What the balances say that no joint's residual shows: tip and speed."""
    prediction = examination.prediction
    b = prediction.balances
    left = prediction.residual(examination.state.fit)
    notes = []
    if all(key in b.residual for key in _AXES):
        before, after = (
            1e3 * float(np.sqrt(sum(b.rms(key, values[key]) ** 2 for key in _AXES)))
            for values in (b.residual, left)
        )
        notes.append(
            f"The tip stands {before:.3g} mm from where the model puts it (root mean square on"
            f" held-out data), {after:.3g} mm with the findings."
        )
    for j, name in enumerate(examination.prepared.study.joints):
        key: Key = ("velocity", j)
        if key not in b.residual or b.rms(key) < b.thresholds.diagnosis.sure * b.sigma[key]:
            continue
        notes.append(
            f"dq.{name} differs from the derivative of q.{name} by {b.rms(key):.3g} rad/s,"
            f" {b.rms(key, left[key]):.3g} rad/s with the findings."
        )
    return tuple(notes)


def _halves(examination: Examination) -> list[tuple[Balances, Weighted]]:
    prepared = examination.prepared
    weighted = examination.state.fit.weighted
    halves = [(prepared.fit, weighted)]
    if prepared.validate is not None:
        halves.append((prepared.validate, weighted + examination.prediction.events))
    return halves


def _traces(
    b: Balances, i: int, weighted: Weighted, by_finding: list[Weighted], prepared: Prepared
) -> Traces:
    motion = b.motions[i]
    shape = motion.q.shape
    before, after, measured, *predicted = (np.full(shape, np.nan) for _ in range(5))
    step = _step(b, i)
    change = _added(b, i, weighted)
    parts = [np.full(shape, np.nan) for _ in by_finding]
    shares = [_added(b, i, each) for each in by_finding]
    for j in range(b.n):
        key = shown_key(b, j)
        raw = None if key is None else _raw(b, i, key)
        if key is None or raw is None:
            continue
        left = zero_phase(raw[1], motion.cutoff, motion.period)
        gone = zero_phase(change.get(key, np.zeros(shape[0])), motion.cutoff, motion.period)
        rows = b.mask[key][b.starts[i] : b.starts[i + 1]]
        rows = rows & np.append(rows[1:], rows[-1])  # a sample counts if both rows about it do
        mask = np.repeat(rows, step)[: shape[0]]
        if not mask.any():
            mask = np.ones(shape[0], dtype=bool)
        before[:, j] = np.where(mask, left, np.nan)
        after[:, j] = np.where(mask, left - gone, np.nan)
        measured[:, j] = zero_phase(raw[0], motion.cutoff, motion.period)
        predicted[0][:, j] = measured[:, j] - left
        predicted[1][:, j] = predicted[0][:, j] + gone
        for part, share in zip(parts, shares, strict=True):
            own = share.get(key, np.zeros(shape[0]))
            part[:, j] = zero_phase(own, motion.cutoff, motion.period)
    return Traces(
        name=motion.recording.name,
        role=motion.recording.role,
        time=motion.time,
        clock=motion.recording.start + motion.time,
        q=motion.q,
        dq=motion.dq,
        load=motion.borne if prepared.body is not None else np.full(shape, np.nan),
        before=before,
        after=after,
        measured=measured,
        predicted_before=predicted[0],
        predicted_after=predicted[1],
        parts=tuple(parts),
    )


def _step(b: Balances, i: int) -> int:
    """Samples of the motion per row."""
    rows = b.time[b.starts[i] : b.starts[i + 1]]
    return round(float(rows[1] - rows[0]) / b.motions[i].period) if len(rows) > 1 else 1


def _added(b: Balances, i: int, weighted: Weighted) -> dict[Key, FloatArray]:
    """What the terms add to each balance of a motion, unfiltered, (T,)."""
    total: dict[Key, FloatArray] = {}
    for term, beta in weighted:
        effect = effect_of(term)
        columns = columns_of(effect, b.motions[i], term.place, term.shape)
        for key, column in b.freed(i, columns).items():
            total[key] = total.get(key, 0.0) + column @ beta
    return total


def _raw(b: Balances, i: int, key: Key) -> tuple[FloatArray, FloatArray] | None:
    """What was measured of a motion, and that less what the model says, (T,) each."""
    motion, (balance, j) = b.motions[i], key
    if balance == "torque" and motion.torque is not None:
        left = -motion.tau
        left[:, : motion.n] += motion.torque
        return motion.torque[:, j], b.freed(i, motion.on_rows(left))[key][:, 0]
    if balance == "drive" and motion.torque is not None and motion.command is not None:
        return motion.torque[:, j], motion.torque[:, j] - motion.command[:, j]
    if balance == "law" and motion.law is not None:
        return motion.given(j), motion.given(j) - motion.law[:, j]
    if balance == "velocity" and motion.measured_dq is not None:
        return motion.measured_dq[:, j], motion.measured_dq[:, j] - motion.dq[:, j]
    if balance == "servo" and motion.q_des is not None:
        return motion.q[:, j], motion.q[:, j] - motion.q_des[:, j]
    return None


def _sliding(unit: str) -> str:
    return {"N m": "N", "rad": "m", "rad/s": "m/s"}.get(unit, unit)
