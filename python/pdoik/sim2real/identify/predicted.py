"""What rows would show of a cause that is not in them, by a model of all else at known noise.

Used of a motion that is only planned (`propose`) and of one that was made (`study_check`). With r
what the model leaves of one amount of the cause, its own hypotheses refitted to it under their
priors, and w a row's weight, as many rows as are independent over their variance,

    E = sum of w r^2 + what the refitted coefficients cost

is the Fisher information of the amount: its standard error is 1 / sqrt(E). By how much evidence
falls where the model must do without it is the expected log likelihood ratio (T-optimality,
Atkeson and Fedorov, Biometrika 62(1), 1975), the variance of n independent rows integrated out as
in `model`: n log(1 + E / n) / 2 of each balance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..findings import HadBy, Support
from ..motion import Balances, Key, Place
from ..regression import TRUST, Term
from ..thresholds import Thresholds
from .candidates import same_kind
from .confidence import confidence_of
from .flexible import count_independent
from .hypothesis import Hypothesis
from .linearisation import Linearisation
from .model import Model, unexplained
from .pool import Pool
from .support import TRUSTED, acting, machines_with
from .weighing import Weighing, is_ordinary

Contribution = Mapping[Key, FloatArray]
"""What one amount of a cause adds to balances, (N,) on all rows for each key."""

SEEN = 0.9
"""Probability with which a cause of the smallest size is found."""

_Z = float(stats.norm.ppf(SEEN))
_NONE = 1e-9  # numerics: share of a contribution that is left of it where nothing is
_LARGEST = 1e30  # numerics: amount that is tried


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Noise:
    """What a model leaves of recordings, by balance."""

    variance: Mapping[Key, float]  # of a row
    repeats: Mapping[Key, float]  # rows that count as one

    @classmethod
    def of(cls, model: Model) -> Noise:
        """The noise that a model of recorded rows estimates; none of a balance without rows."""
        series = model.data.series
        return cls(
            variance=dict(model.noise),
            repeats={key: len(each.rows) / each.independent for key, each in series.items()},
        )

    def model(self, balances: Balances, hypotheses: Sequence[Hypothesis]) -> Model:
        """Hypotheses on the rows of other balances, at this noise."""
        data = Linearisation.of_balances(balances)
        usual = float(np.median(list(self.repeats.values()))) if self.repeats else 1.0
        for key, series in data.series.items():
            series.independent = len(series.rows) / self.repeats.get(key, usual)
        variance = {
            key: self.variance.get(key, 0.0) + balances.sigma[key] ** 2 for key in data.series
        }
        return Model(data, hypotheses, noise=variance)


def recorded(balances: Balances, bodies: float, causes: Sequence[Hypothesis] = ()) -> Model:
    """Ordinary physics with causes, fitted to recordings; then kept at the noise that it leaves.

    Args:
        balances: of the recordings.
        bodies: share within which the model's inertial figures are right.
        causes: that were found in them.
    """
    data = Linearisation.of_balances(balances)
    count_independent(balances, data)
    weighing = Weighing(balances=balances, data=data, pool=Pool(data, ()))
    model = weighing.begun(bodies, causes).model
    free = [replace(each, positive=False) for each in model.hypotheses]
    return Model(data, free, noise=model.noise)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Remainder:
    """What a model leaves of one amount of a contribution."""

    rows: Mapping[Key, FloatArray]  # (N,) of what is left, on the rows that count
    information: float  # E: of the amount
    whole: float  # the same with nothing refitted
    log_ratio: float  # of the likelihoods with the contribution and without, expected
    coefficients: FloatArray  # (size,) that the model's hypotheses take

    @property
    def share(self) -> float:
        """Share of the contribution that nothing else explains."""
        return self.information / self.whole if self.whole > 0.0 else 0.0

    @property
    def error(self) -> float:
        """Standard error of the amount; inf where nothing is left of it."""
        return float(self.information**-0.5) if self.share > _NONE else np.inf


def remainder(model: Model, contribution: Contribution) -> Remainder:
    """What a model leaves of a contribution.

    Args:
        model: of all else, at its noise.
        contribution: of one amount.
    """
    data = model.data
    own = {
        key: values[data.series[key].rows]
        for key, values in contribution.items()
        if key in data.series
    }
    right = model.precision * model.mean
    whole = 0.0
    for key, values in own.items():
        weight, (index, there) = model.weight(key), model.index[key]
        whole += weight * float(values @ values)
        right[index] += weight * (data.series[key].columns[:, there].T @ values)
    taken = model.solved(right)
    cost = float(model.precision @ model.mean**2)
    information = max(whole + cost - float(right @ taken), 0.0)
    rows, squares, log_ratio = {}, 0.0, 0.0
    for key, (index, there) in model.index.items():
        series = data.series[key]
        fitted = series.columns[:, there] @ taken[index]
        if key in own or np.any(fitted):
            rows[key] = own.get(key, 0.0) - fitted
            square = model.weight(key) * float(rows[key] @ rows[key])
            squares += square
            log_ratio += _evidence(series.independent, square)
    return Remainder(
        rows=rows,
        information=information,
        whole=whole,
        log_ratio=log_ratio + 0.5 * max(information - squares, 0.0),
        coefficients=taken,
    )


def _evidence(rows: float, square: float) -> float:
    """Evidence lost to a sum of squares more, in the noise's variances, on independent rows."""
    return 0.5 * rows * float(np.log1p(square / rows))


def all_else(model: Model, *causes: tuple[str, Sequence[Place]]) -> Model:
    """A model without what is one of some causes, or a law of the same kind at its place.

    Args:
        model: at known noise.
        causes: effects by id, and where each acts.
    """
    kept = [h for h in model.hypotheses if not any(_is_of(h.term, *each) for each in causes)]
    return model if len(kept) == len(model.hypotheses) else Model(model.data, kept, model)


def _is_of(term: Term, effect: str, places: Sequence[Place]) -> bool:
    if term.effect == TRUST:
        return CATALOGUE[effect].is_body and term.place.link in {each.link for each in places}
    if term.effect not in CATALOGUE:
        return False
    alike = term.effect == effect or same_kind(term.effect, effect)
    return alike and replace(term.place, gate=None) in [replace(p, gate=None) for p in places]


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Figures of one balance, per unit of the amount."""

    rows: float  # that are independent
    information: float
    size: float  # root mean square over what nothing explains


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Expected:
    """What a diagnosis is expected to find of a cause, by its amount."""

    parts: tuple[Part, ...]
    information: float
    ratio: float  # of what is left of it to what nothing explains where it acts, mean squares
    figures: int  # that are fitted for it
    precision: float  # of its amount, before any data
    log_odds: float  # before any data
    ordinary: bool  # every machine has it: no odds are asked
    had_by: HadBy

    def support(self, amount: float, short: float = 0.0) -> Support:
        """What would speak for an amount.

        Args:
            amount: of the cause.
            short: standard errors by which it comes out smaller.
        """
        t = abs(amount) * np.sqrt(self.information)
        seen = max(abs(amount) * (1.0 - short / max(t, 1e-12)), 0.0)
        if self.ordinary:
            odds = 0.5 * (seen**2 * self.information) - 1.0
        else:
            odds = sum(_evidence(each.rows, seen**2 * each.information) for each in self.parts)
            odds -= 0.5 * self.figures * np.log1p(self.information / self.precision)
        explained = seen**2 * self.ratio
        return Support(
            weight=0.0,
            gain=float(explained / (1.0 + explained)),
            t=float(seen * np.sqrt(self.information)),
            size=float(abs(amount) * max((each.size for each in self.parts), default=0.0)),
            agree=0,
            sessions=0,
            blocks=0,
            left=1.0,
            rivals=0,
            log_odds=float(odds + self.log_odds),
            had_by=self.had_by,
        )

    def clarity(self, amount: float, limits: Thresholds) -> float:
        """How many times what a diagnosis asks an amount is found with SEEN: 1 for just so."""
        asked, support = limits.diagnosis, self.support(amount, _Z)
        least = {"few": asked.matters_more, "many": asked.matters_common, "all": asked.matters}
        clear = support.t / asked.sure if self.ordinary else max(support.odds, 0.0) / asked.worth
        sure = confidence_of(limits, support) / asked.suspected
        return float(min(clear, support.size / least[self.had_by], sure))

    def smallest(self, limits: Thresholds) -> float:
        """The amount of clarity 1, where contributions are in proportion to it; inf for none."""
        if not self.information > 0.0:
            return np.inf
        low, high = 0.0, float(self.information**-0.5)
        while self.clarity(high, limits) < 1.0:
            low, high = high, 2.0 * high
            if high > _LARGEST:
                return np.inf
        for _ in range(30):
            middle = 0.5 * (low + high)
            found = self.clarity(middle, limits) >= 1.0
            low, high = (low, middle) if found else (middle, high)
        return high


def expected(
    model: Model,
    contribution: Contribution,
    cause: Hypothesis,
    precision: float,
    limits: Thresholds,
) -> Expected:
    """What a diagnosis is expected to find of a cause.

    Args:
        model: of all else, at its noise.
        contribution: of one amount of it.
        cause: what is believed of it before any data.
        precision: inverse variance of the amount before any data.
        limits: of the diagnosis.
    """
    kept = [each for each in model.hypotheses if each.term.effect not in TRUSTED]
    firm = remainder(Model(model.data, kept, model), contribution)
    left, parts, shown, hidden = remainder(model, contribution), [], 0.0, 0.0
    for key, rest in left.rows.items():
        series, variance = model.data.series[key], model.noise[key]
        values = contribution[key][series.rows] if key in contribution else np.zeros(len(rest))
        nothing = unexplained(variance, series.floor**2)
        size = float(np.sqrt(np.mean(values**2) / nothing))
        information = model.weight(key) * float(rest @ rest)
        parts.append(Part(rows=series.independent, information=information, size=size))
        if values.any():
            at = acting(values[:, None])
            seen = firm.rows[key][at]
            shown += float(seen @ seen) / variance
            hidden += float(at.sum()) * nothing / variance
    return Expected(
        parts=tuple(parts),
        information=left.information if left.share > _NONE else 0.0,
        ratio=shown / hidden if hidden > 0.0 else 0.0,
        figures=cause.width,
        precision=max(precision, 1e-300),
        log_odds=0.0 if is_ordinary(cause.term) else cause.log_odds,
        ordinary=is_ordinary(cause.term),
        had_by=machines_with(cause.term, limits.diagnosis),
    )
