"""Which law a joint obeys: terms are added to a PD law as long as their evidence is worth it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..thresholds import ControllerThresholds
from .law import Fitted, Form, columns, tuned
from .rows import Piece

_MOST = 5  # terms that are added
_KNEES = (0.1, 0.25, 0.5, 0.75)  # quantiles of the position error at which a table may bend
_FED = ("rate", "gravity", "inertia")  # forward
_NOISES = 4.0  # within which a noisy top is flat
_FIRST = 1.0  # numerics: by which a recording's own constant is learnt where it is judged [s]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chosen:
    """A law, the level that cuts it off, and what it leaves."""

    law: Fitted
    pieces: tuple[Piece, ...]  # with the samples that it was fitted to
    limit: float  # inf where none was reached
    top: float  # highest effort
    spread: float  # what the law usually leaves


def chosen(pieces: Sequence[Piece], limits: ControllerThresholds) -> Chosen | None:
    """The law of these pieces; None where there are too few samples."""
    top = max(float(np.max(np.abs(piece.effort))) for piece in pieces)
    silent = [_silent(piece, limits, top) for piece in pieces]
    level, within = _flat_top(pieces, limits)
    clear = [
        replace(piece, use=piece.use & ~off & ~_near(piece.effort, level, within))
        for piece, off in zip(pieces, silent, strict=True)
    ]
    if sum(int(piece.use.sum()) for piece in clear) < limits.least_rows:
        return None
    law = searched(clear, limits)
    spread = max(float(np.sqrt(law.rss / len(law.linear.left))), 0.01 * top)
    # A level is a limit where the law asks for more there, not where it merely peaks.
    over = [
        np.abs(_plain(piece, law, k))[_near(piece.effort, level, within) & ~off]
        for k, (piece, off) in enumerate(zip(pieces, silent, strict=True))
    ]
    beyond = np.concatenate(over)
    is_limit = len(beyond) >= limits.flat_rows and np.median(beyond) > level + within
    return Chosen(
        law=law,
        pieces=tuple(clear),
        limit=level if is_limit else np.inf,
        top=top,
        spread=spread,
    )


def let_go(piece: Piece, found: Chosen, limits: ControllerThresholds) -> NDArray[np.bool_]:
    """Samples at which the drive has let go: no effort for a while, though the law asks for some.

    (T,) of any piece of the joint.
    """
    asked = np.abs(predicted(piece, found.law, np.inf))
    released = np.zeros(len(asked), dtype=np.bool_)
    for run in _runs(_silent(piece, limits, found.top)):
        released[run] = np.median(asked[run]) > limits.let_go_over * found.spread
    return released


def searched(pieces: Sequence[Piece], limits: ControllerThresholds) -> Fitted:
    """Terms added to a PD law one after the other, the likeliest first."""
    extras = tuple(name for name in _FED if any(np.ptp(getattr(p, name)) > 0.0 for p in pieces))
    knees = tuple(f"knee {knee:.6g}" for knee in _knees(pieces))
    # What a law misses is slow, and looks like few samples: they are counted with all terms in.
    flexible = Form(kind="pid", extras=("travel", *extras, *knees))
    count = Fitted(form=flexible, pieces=tuple(pieces)).whole.rows
    best = tuned(Fitted(form=Form(), pieces=tuple(pieces), rows=count), limits)
    for _ in range(_MOST):
        trials = []
        for form in _wider(pieces, best.form, extras):
            wide = replace(best, form=form)
            wide = wide if form.kind == best.form.kind else tuned(wide, limits)
            if wide.rss < (1.0 - limits.least_gain) * best.rss:
                trials.append((wide.over(best), wide))
        odds, likeliest = max(trials, key=lambda each: each[0], default=(-np.inf, best))
        if odds < limits.worth:
            break
        best = tuned(likeliest, limits)
    return best


def predicted(piece: Piece, law: Fitted, limit: float) -> FloatArray:
    """The effort of a recording that the law was not fitted to, (T,).

    What has been integrated before it began is a constant of its first second.
    """
    asked = columns(piece, law.form) @ law.gains
    if law.form.integrates:
        first = piece.use & (np.arange(len(asked)) * piece.period < 2.0 * _FIRST)
        asked = asked + (float(np.mean((piece.effort - asked)[first])) if first.any() else 0.0)
    else:
        asked = asked + law.constant()
    return np.clip(asked, -limit, limit)


def _wider(pieces: Sequence[Piece], form: Form, extras: Sequence[str]) -> list[Form]:
    """The law with one term more."""
    there = [name for name in extras if name not in form.extras]
    forms = [replace(form, extras=(*form.extras, name)) for name in there]
    if form.kind == "pd":
        forms.append(replace(form, kind="pid"))
        if "rate" in extras:
            # One that gets the desired speed is the same as a PID law.
            forms.append(replace(form, kind="cascade"))
        knees = _knees(pieces)
        forms += [replace(form, kind="table", knees=knees)] if len(set(knees)) > 1 else []
    return forms


def _knees(pieces: Sequence[Piece]) -> tuple[float, ...]:
    """Position errors at which a table may bend."""
    size = np.concatenate([np.abs(piece.error[piece.use]) for piece in pieces])
    return tuple(float(each) for each in np.quantile(size, _KNEES) if each > 0.0)


def _plain(piece: Piece, law: Fitted, number: int) -> FloatArray:
    """What the law asks of the piece of that number, no level cutting it off; (T,)."""
    return np.asarray(columns(piece, law.form) @ law.gains + law.constant(number))


def _silent(piece: Piece, limits: ControllerThresholds, top: float) -> NDArray[np.bool_]:
    """Where there is no effort for so long that the drive may have let go, (T,)."""
    off = np.abs(piece.effort) <= limits.no_effort * top
    silent = np.zeros(len(off), dtype=np.bool_)
    for run in _runs(off):
        if (run.stop - run.start) * piece.period >= limits.let_go:
            silent[run] = True
    return silent


def _runs(at: NDArray[np.bool_]) -> list[slice]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], at.astype(int), [0]])))
    return [slice(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _flat_top(pieces: Sequence[Piece], limits: ControllerThresholds) -> tuple[float, float]:
    """The highest effort where it is kept for some samples, and how flat it is; inf elsewhere."""
    top = max(float(np.max(np.abs(piece.effort[piece.use]), initial=0.0)) for piece in pieces)
    bends = np.concatenate([np.abs(np.diff(piece.effort, 2)) for piece in pieces])
    noise = float(np.median(bends)) / (0.6745 * np.sqrt(6.0))  # of white noise
    within = max(limits.flat * top, _NOISES * noise)
    rows = []
    for piece in pieces:
        size = np.abs(piece.effort)
        runs = _runs(size >= top - 2.0 * within)
        rows += [size[run] for run in runs if run.stop - run.start >= 3]
    if top <= 0.0 or sum(map(len, rows)) < limits.flat_rows:
        return np.inf, within
    return float(np.median(np.concatenate(rows))), within


def _near(effort: FloatArray, level: float, within: float) -> NDArray[np.bool_]:
    """Samples at the level, (T,)."""
    if not np.isfinite(level):
        return np.zeros(len(effort), dtype=np.bool_)
    return np.asarray(np.abs(effort) >= level - max(within, 0.01 * level))
