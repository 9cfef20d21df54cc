"""Laws that a joint's effort may obey, fitted by least squares, and what they leave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from pdoik.recordings import FloatArray

from ..motion.signals import shifted
from ..regression.clusters import clustered
from .rows import Piece

Kind = Literal["pd", "pid", "cascade", "table"]
Late = Literal["effort", "command", "speed"]

_FOLDS = 5
_RATIOS = (0.5, 200.0)  # gains of a position loop around a speed loop [1/s]
_NEAR = 0.15  # of a ratio's logarithm, within which it is moved
_FREE = ("kp", "kd", "ki", "travel")
_TRIFLE = 0.15  # of a sample: times that the logging of one channel after the other makes
_SHORT = 1e-4  # delay or time constant that is none [s]
_STEP = 2e-4  # by which both are moved for their slopes [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Form:
    """Which law: its kind, what is fed forward, and how late it acts.

    pd: kp error + kd speed; pid: + ki integral; cascade: kv (kp error + speed) + ki times that
    one's integral; table: pd with knees. All with a constant, and `extras` with factors of their
    own.
    """

    kind: Kind = "pd"
    extras: tuple[str, ...] = ()
    knees: tuple[float, ...] = ()  # of a table [rad]
    delay: float = 0.0  # [s]
    lag: float = 0.0  # [s]
    late: Late = "effort"  # what the delay is of: all of it, the command alone, the logged speed
    ratio: float = 0.0  # kp of a cascade [1/s]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the coefficients, those that begin anew in each recording left out."""
        base: dict[Kind, tuple[str, ...]] = {
            "pd": ("kp", "kd"),
            "pid": ("kp", "kd", "ki"),
            "cascade": ("kv", "ki"),
            "table": ("kp", "kd", *(f"knee {knee:.6g}" for knee in self.knees)),
        }
        return (*base[self.kind], *self.extras)

    @property
    def size(self) -> int:
        """Number of figures."""
        extra = (self.delay > _SHORT) + (self.lag > _SHORT) + (self.kind == "cascade")
        return len(self.names) + 1 + extra


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fitted:
    """A law with its figures, on the samples that count."""

    form: Form
    beta: FloatArray  # in the order of `Form.names`, then constants
    left: FloatArray  # residual of the samples, one recording after the other
    block: NDArray[np.intp]
    rows: FloatArray  # (N, p)

    @property
    def rss(self) -> float:
        """Sum of squares."""
        return float(self.left @ self.left)

    def bic(self) -> float:
        """Bayes's criterion, for as many independent samples as the residual's memory leaves."""
        left = self.left - self.left.mean()
        power = float(left @ left)
        rho = float(np.clip(left[1:] @ left[:-1] / max(power, 1e-300), 0.0, 0.999))
        count = max(len(left) * (1.0 - rho) / (1.0 + rho), 2.0 * self.form.size)
        return count * float(np.log(max(self.rss / len(left), 1e-300))) + self.form.size * float(
            np.log(count)
        )


def columns(piece: Piece, form: Form) -> FloatArray:
    """What the law is made of, as it acts, (T, p); p as `Form.names`, and a constant."""
    command = form.delay if form.late == "command" else 0.0
    if command > _SHORT:
        late = piece.acting(piece.error + piece.q, command, 0.0)
        aim = piece.acting(piece.aim, command, 0.0)
        piece = replace(
            piece,
            error=late - piece.q,
            speed=piece.speed + aim - piece.aim,
            rate=piece.acting(piece.rate, command, 0.0),
        )
    if form.late == "speed" and form.delay > _SHORT:
        seen = shifted(piece.speed - piece.aim, -form.delay, piece.period)
        piece = replace(piece, speed=seen + piece.aim)
    if form.kind == "cascade":
        asked = form.ratio * piece.error + piece.speed
        parts = [asked, form.ratio * piece.column("integral") + piece.column("travel")]
    else:
        parts = [piece.error, piece.speed]
        if form.kind == "pid":
            parts.append(piece.column("integral"))
        parts += [piece.column(f"knee {knee:.6g}") for knee in form.knees]
    parts += [piece.column(name) for name in form.extras]
    delay = form.delay if form.late == "effort" else 0.0
    acting = [piece.acting(np.asarray(each), delay, form.lag) for each in parts]
    return np.stack([*acting, np.ones(len(piece.q))], axis=1)


def design(pieces: Sequence[Piece], form: Form) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Rows (N, p), efforts (N,) and blocks; what integrates begins anew in each recording."""
    own = form.kind in ("pid", "cascade")
    parts = []
    for k, piece in enumerate(pieces):
        rows = columns(piece, form)
        if own:
            starts = np.zeros((len(rows), len(pieces)))
            starts[:, k] = 1.0
            rows = np.hstack([rows[:, :-1], starts])
        parts.append(rows[piece.use])
    effort = np.concatenate([piece.effort[piece.use] for piece in pieces])
    block = np.concatenate([piece.block[piece.use] for piece in pieces])
    return np.concatenate(parts), effort, block


def solved(rows: FloatArray, effort: FloatArray) -> FloatArray:
    """Least squares with columns of even size and a trace of ridge."""
    scale = np.sqrt(np.mean(rows**2, axis=0))
    scale[scale < 1e-12] = 1.0
    even = rows / scale
    gram = even.T @ even + 1e-9 * len(rows) * np.eye(rows.shape[1])
    return np.asarray(np.linalg.solve(gram, even.T @ effort) / scale)


def fitted(pieces: Sequence[Piece], form: Form) -> Fitted:
    """The law with the figures that fit best; times as the form has them."""
    rows, effort, block = design(pieces, form)
    beta = solved(rows, effort)
    return Fitted(form=form, beta=beta, left=effort - rows @ beta, block=block, rows=rows)


def tuned(pieces: Sequence[Piece], form: Form, longest: float) -> Fitted:
    """The same with the delay, time constant and ratio that fit best."""
    # Times that another kind of law was given may only have made up for what it lacked.
    plain = replace(form, delay=0.0, lag=0.0)
    begins = [fitted(pieces, form), fitted(pieces, plain)]
    if form.kind == "cascade":
        begins = [_with_ratio(pieces, each) for each in (form, plain)]
    best = min(begins, key=lambda each: each.rss)
    times = np.array([0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0]) * float(
        np.median([piece.period for piece in pieces])
    )
    times = times[times <= longest]
    tried = [
        fitted(pieces, replace(best.form, delay=time, late=late))
        for late in ("effort", "command", "speed")
        for time in times
    ]
    tried += [fitted(pieces, replace(best.form, lag=time)) for time in times]
    best = min([best, *tried], key=lambda each: each.rss)
    return polished(pieces, best, longest)


def _with_ratio(pieces: Sequence[Piece], form: Form) -> Fitted:
    """A cascade with the ratio that fits best, its times kept.

    It fits well within a narrow range only, near which a law with four free factors leads: of
    error, speed, the error's integral and the way travelled, kp is the first over the second, and
    the third over the fourth.
    """
    free = fitted(pieces, replace(form, kind="pid", extras=(*form.extras, "travel"), ratio=0.0))
    kp, kd, ki, travel = (float(free.beta[free.form.names.index(n)]) for n in _FREE)
    near = [a / b for a, b in ((kp, kd), (ki, travel)) if a * b > 0.0]
    low, high = _RATIOS
    ratios = [*(float(np.clip(each, low, high)) for each in near), *np.geomspace(low, high, 14)]
    best = min(
        (fitted(pieces, replace(form, ratio=float(each))) for each in ratios),
        key=lambda each: each.rss,
    )
    found = optimize.minimize_scalar(
        lambda x: fitted(pieces, replace(form, ratio=float(np.exp(x)))).rss,
        bounds=(np.log(best.form.ratio) - _NEAR, np.log(best.form.ratio) + _NEAR),
        method="bounded",
    )
    closer = fitted(pieces, replace(form, ratio=float(np.exp(found.x))))
    return min(best, closer, key=lambda each: each.rss)


def polished(pieces: Sequence[Piece], start: Fitted, longest: float) -> Fitted:
    """Delay, time constant and ratio moved to where the law fits best (Nelder and Mead)."""
    unit = float(np.median([piece.period for piece in pieces]))

    def form_at(x: FloatArray) -> Form:
        ratio = float(np.exp(x[2])) if start.form.kind == "cascade" else 0.0
        delay, lag = (float(np.clip(each * unit, 0.0, longest)) for each in x[:2])
        return replace(start.form, delay=delay, lag=lag, ratio=ratio)

    x0 = [start.form.delay / unit, start.form.lag / unit, np.log(max(start.form.ratio, 1e-3))]
    size = 3 if start.form.kind == "cascade" else 2
    simplex = np.vstack([x0[:size]] + [np.array(x0[:size]) + 0.4 * row for row in np.eye(size)])
    found = optimize.minimize(  # type: ignore[call-overload]  # its stubs know no fatol
        lambda x: fitted(pieces, form_at(x)).rss,
        np.array(x0[:size], dtype=np.float64),
        method="Nelder-Mead",
        options={
            "maxfev": 60,
            "xatol": 1e-2,
            "fatol": 1e-5 * start.rss,
            "initial_simplex": simplex,
        },
    )
    best = fitted(pieces, form_at(np.asarray(found.x)))
    best = best if best.rss < start.rss else start
    delay, lag = (
        each if each > _TRIFLE * unit else 0.0 for each in (best.form.delay, best.form.lag)
    )
    if (delay, lag) == (best.form.delay, best.form.lag):
        return best
    return fitted(pieces, replace(best.form, delay=delay, lag=lag))


def held_out(pieces: Sequence[Piece], form: Form) -> FloatArray:
    """Sums of squares by block of samples that the figures were not fitted to; (blocks,).

    Left out in turn are parts of all recordings; times are the form's.
    """
    rows, effort, block = design(pieces, form)
    numbers = np.unique(block)
    fold = np.minimum(np.searchsorted(numbers, block) * _FOLDS // len(numbers), _FOLDS - 1)
    squares = np.zeros(int(block.max()) + 1)
    for each in range(_FOLDS):
        out = fold == each
        if out.any() and not out.all():
            left = effort[out] - rows[out] @ solved(rows[~out], effort[~out])
            squares += np.bincount(block[out], left**2, minlength=len(squares))
    return squares


def errors(pieces: Sequence[Piece], law: Fitted) -> dict[str, float]:
    """Standard errors of the figures, times and ratio among them, blocks as clusters."""
    form = law.form
    slopes: list[FloatArray] = [law.rows]
    names = [*form.names]
    extra = []
    for name in ("delay", "lag", "ratio"):
        value = getattr(form, name)
        if value > _SHORT:
            step = _STEP if name != "ratio" else 1e-3 * value
            ahead = design(pieces, replace(form, **{name: value + step}))[0]
            behind = design(pieces, replace(form, **{name: max(value - step, 0.0)}))[0]
            width = step + min(step, value)
            slopes.append(((ahead - behind) @ law.beta / width)[:, None])
            extra.append(name)
    rows = np.hstack(slopes)
    scale = np.sqrt(np.mean(rows**2, axis=0)) + 1e-12
    even = rows / scale
    inverse = np.linalg.pinv(even.T @ even, rcond=1e-10, hermitian=True)
    covariance, count = clustered(inverse, even, law.left, law.block)
    covariance *= count / max(count - rows.shape[1], 1)
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0)) / scale
    result = {name: float(std[k]) for k, name in enumerate(names)}
    result["bias"] = float(std[len(names)])
    wide = law.rows.shape[1]
    result |= {name: float(std[wide + k]) for k, name in enumerate(extra)}
    return result
