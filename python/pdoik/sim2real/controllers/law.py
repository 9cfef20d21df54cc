"""Laws that a joint's effort may obey, with all their figures fitted together, and their evidence.

Gains are linear in the effort. Delay, filter and the ratio of a cascade are not: they are fitted by
their derivatives together with the gains (Gauss and Newton), and have errors and priors like these.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from pdoik.recordings import FloatArray

from ..motion import lagged, shifted
from ..thresholds import ControllerThresholds
from .linear_law import LinearModel, Parameter, parts_of
from .rows import Piece

Kind = Literal["pd", "pid", "cascade", "table"]
Late = Literal["effort", "command", "speed"]
_LATE: tuple[Late, ...] = ("effort", "command", "speed")

_RATIOS = (0.5, 200.0)  # gains of a position loop around a speed loop [1/s]
_FREE = ("kp", "kd", "ki", "travel")
_STEP = 2e-4  # numerics: by which times are moved for their slopes [s]
_TIMES = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)  # that are tried first, in samples
_ROUNDS = 8  # of Gauss and Newton
_SHARES = (1.0, 0.5, 0.25)  # of a step
_VAGUE = 100.0  # standard deviation of a constant, in those of the effort
_SETTLED = 1e-6  # numerics: of the sum of squares, that is no gain
_SCALES = {"delay": 0.1, "lag": 0.1, "ratio": 100.0}  # standard deviations beforehand [s], [1/s]


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
        """Names of the coefficients, the constants left out."""
        base: dict[Kind, tuple[str, ...]] = {
            "pd": ("kp", "kd"),
            "pid": ("kp", "kd", "ki"),
            "cascade": ("kv", "ki"),
            "table": ("kp", "kd", *(f"knee {knee:.6g}" for knee in self.knees)),
        }
        return (*base[self.kind], *self.extras)

    @property
    def nonlinear(self) -> tuple[str, ...]:
        """Names of its nonlinear figures, those that it has."""
        return tuple(name for name in _SCALES if getattr(self, name) > 0.0)

    def moved(self, values: Mapping[str, float]) -> Form:
        """The form with other times, or another ratio."""
        delay, lag, ratio = (values.get(name, getattr(self, name)) for name in _SCALES)
        return replace(self, delay=delay, lag=lag, ratio=ratio)

    @property
    def integrates(self) -> bool:
        """Whether its constant is another one in each recording: what was integrated before."""
        return self.kind in ("pid", "cascade")


@dataclass(frozen=True, kw_only=True, eq=False)
class Fitted:
    """A law fitted to the samples of some recordings that count."""

    form: Form
    pieces: tuple[Piece, ...]
    rows: float = 0.0  # that say something new at least: those that a more flexible law leaves

    @cached_property
    def linear(self) -> LinearModel:
        """Gains and constants, times and ratio as the form has them."""
        rows = np.concatenate([columns(p, self.form)[p.use] for p in self.pieces])
        effort = np.concatenate([piece.effort[piece.use] for piece in self.pieces])
        counts = [int(piece.use.sum()) for piece in self.pieces]
        constants = np.ones((len(effort), 1))
        if self.form.integrates:
            constants = np.repeat(np.eye(len(counts)), counts, axis=0)
        names = zip(self.form.names, rows.T, strict=True)
        parameters = [Parameter(name=name, columns=column) for name, column in names]
        vague = _VAGUE * float(np.std(effort))
        parameters.append(Parameter(name="bias", columns=constants, std=vague))
        return LinearModel(
            target=effort,
            parameters=tuple(parameters),
            parts=parts_of(counts),
            rows=float(len(effort)),  # to compare times, nobody need count those that say more
        )

    @cached_property
    def whole(self) -> LinearModel:
        """All figures, times and ratio by the law's slopes: about the best ones the same law."""
        effort, slopes = self.linear.target, []
        for name in self.form.nonlinear:
            value = getattr(self.form, name)
            sides = [max(value + step, 0.0) for step in (_STEP, -_STEP)]
            ahead, behind = (
                np.concatenate([columns(p, self.form.moved({name: x}))[p.use] for p in self.pieces])
                for x in sides
            )
            slope = (ahead - behind) @ self.gains / (sides[0] - sides[1])
            effort = effort + value * slope
            slopes.append(Parameter(name=name, columns=slope, std=_SCALES[name], positive=True))
        parameters = (*self.linear.parameters, *slopes)
        return replace(self.linear, target=effort, parameters=parameters, rows=0.0)

    @property
    def rss(self) -> float:
        """Sum of squares that it leaves."""
        return self.linear.rss

    @property
    def gains(self) -> FloatArray:
        """The gains, in the order of `Form.names`."""
        return np.array([self.linear.value(name) for name in self.form.names])

    def over(self, other: Fitted) -> float:
        """Log evidence beyond another law of the same samples."""
        return self.whole.over(other.whole, self.rows)

    def constant(self, number: int = 0) -> float:
        """The constant of the recording of that number, where each has its own."""
        return float(self.linear.of("bias")[number if self.form.integrates else 0])


def columns(piece: Piece, form: Form) -> FloatArray:
    """What the law is made of, as it acts, (T, p) as `Form.names`."""
    if form.late == "command":
        piece = piece.commanded_late(form.delay)
    if form.late == "speed" and form.delay > 0.0:
        piece = replace(piece, dq=shifted(piece.dq, -form.delay, piece.period))
    if form.kind == "cascade":
        asked = form.ratio * piece.error + piece.speed_error
        parts = [asked, form.ratio * piece.column("integral") + piece.column("travel")]
    else:
        parts = [piece.error, piece.speed_error]
        if form.kind == "pid":
            parts.append(piece.column("integral"))
        parts += [piece.column(f"knee {knee:.6g}") for knee in form.knees]
    acting = np.stack([*parts, *(piece.column(name) for name in form.extras)], axis=1)
    if form.late == "effort" and form.delay > 0.0:
        acting = shifted(acting, form.delay, piece.period)
    return lagged(acting, form.lag, piece.period) if form.lag > _STEP / 2.0 else acting


def tuned(law: Fitted, limits: ControllerThresholds) -> Fitted:
    """A law with the ratio that fits best, and a delay and a filter where evidence asks."""
    # Times that another kind of law was given may only have made up for what it lacked.
    best = replace(law, form=replace(law.form, delay=0.0, lag=0.0, late="effort"))
    if law.form.kind == "cascade":
        best = _improved(_with_ratio(best), limits)
    period = float(np.median([piece.period for piece in law.pieces]))
    times = [each * period for each in _TIMES if each * period <= limits.longest_delay]
    for _ in range(2):  # a delay, a filter
        new = {"delay", "lag"} - set(best.form.nonlinear)
        forms = [
            [replace(best.form.moved({name: time}), late=late) for time in times for late in kinds]
            for name, kinds in (("lag", (best.form.late,)), ("delay", _LATE))
            if name in new and times
        ]
        likely = [min((replace(best, form=f) for f in each), key=_rss) for each in forms]
        later = min((_improved(each, limits) for each in likely), key=_rss, default=best)
        clear = any(getattr(later.form, name) > limits.trifle * period for name in new)
        if not clear or later.over(best) < limits.worth:
            break
        best = later
    return best


def _with_ratio(law: Fitted) -> Fitted:
    """A cascade with a likely ratio.

    It fits well within a narrow range only, near which a law with four free factors leads: of
    error, speed, the error's integral and the way travelled, kp is the first over the second, and
    the third over the fourth.
    """
    form = law.form
    free = replace(law, form=replace(form, kind="pid", extras=(*form.extras, "travel"), ratio=0.0))
    kp, kd, ki, travel = (free.linear.value(name) for name in _FREE)
    near = [a / b for a, b in ((kp, kd), (ki, travel)) if a * b > 0.0]
    low, high = _RATIOS
    ratios = [*(float(np.clip(each, low, high)) for each in near), *np.geomspace(low, high, 14)]
    tried = [replace(law, form=replace(form, ratio=float(each))) for each in ratios]
    return min(tried, key=_rss)


def _improved(law: Fitted, limits: ControllerThresholds) -> Fitted:
    """The law with times and ratio where it fits best."""
    ends = {"delay": (0.0, limits.longest_delay), "lag": (0.0, limits.longest_delay)}
    ends["ratio"] = _RATIOS
    for _ in range(_ROUNDS):
        here = {name: float(getattr(law.form, name)) for name in law.form.nonlinear}
        there = {name: float(np.clip(law.whole.value(name), *ends[name])) for name in here}
        steps = ({n: x + share * (there[n] - x) for n, x in here.items()} for share in _SHARES)
        moved = (replace(law, form=law.form.moved(step)) for step in steps)
        best = next((each for each in moved if each.rss < law.rss), law)
        settled = best.rss >= (1.0 - _SETTLED) * law.rss
        law = best
        if settled:
            break
    return law


def _rss(law: Fitted) -> float:
    return law.rss
