"""The smallest size of every effect that would be seen at every place of a study."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import Effect, Parameter
from ..identify import Expected, Model, all_else, anomalous, expected, recorded, remainder
from ..motion import Key, Place, Prepared, Shape
from ..regression import Term, usual_torque

_STEPS = 12  # from amount to amount at most


def bisected(
    clarity: Callable[[float], float], tried: Sequence[float], begin: float, most: float
) -> float:
    """The amount of clarity 1, of what is not in proportion to its amount; inf for none.

    Goes along the amounts that are tried, else by factors of two, and below them by these.
    """
    amount, here = begin, clarity(begin)
    up = here < 1.0
    for _ in range(_STEPS):
        other = _next(tried, amount, up)
        if other is None or other > most:
            return np.inf
        there = clarity(other)
        if (there < 1.0) != up:
            return _between(amount, here, other, there)
        amount, here = other, there
    return np.inf if up else amount


def _next(tried: Sequence[float], amount: float, up: bool) -> float | None:
    """The next amount, larger or smaller; None beyond the largest that is tried."""
    if up:
        return min((each for each in tried if each > amount), default=None if tried else 2 * amount)
    return max((each for each in tried if each < amount), default=0.5 * amount)


def _between(one: float, at_one: float, other: float, at_other: float) -> float:
    """The amount of clarity 1 between two, on a line over logarithms."""
    low, high = np.log(max(at_one, 1e-6)), np.log(max(at_other, 1e-6))
    share = 0.0 if high == low else -low / (high - low)
    return float(one * (other / one) ** share)


_BEYOND = 1e6  # numerics: a figure at which an effect does nothing, from which it is without end
_SHARE = 0.02  # of the time, the amount to begin with where the amount is a share
_MOST_SHARE = 0.5
_NEXT_TO_NOTHING = 1e-9  # of a time or an angle


@dataclass(frozen=True, slots=True, kw_only=True)
class Size:
    """The smallest figure of an effect at a place that would be seen."""

    effect: str
    variant: str
    place: Place
    parameter: Parameter
    figure: float  # of the parameter, from where the effect does nothing; inf for none
    below: bool  # seen where the parameter is below the figure
    left: float  # share of the contribution's sum of squares that simple effects leave
    of_usual: float  # its root mean square over what the joint's torque usually is; 0 elsewhere


class Sizes:
    """The smallest sizes that are seen in a study whose channels are as they should be."""

    def __init__(self, prepared: Prepared) -> None:
        """Uses the recordings to fit, whose noise is what ordinary physics leaves of them."""
        self.balances = b = prepared.fit
        given, believed = prepared.study.trust.rigid_body, b.thresholds.priors
        self._model = recorded(b, believed.bodies if given is None else given)
        self._none: dict[tuple[str, Place, str], dict[Key, FloatArray]] = {}
        self._others: dict[tuple[str, Place], Model] = {}

    def of(self, effect: Effect, place: Place) -> Iterator[Size]:
        """The size of each variant of an effect that changes something; none of others."""
        for shape in effect.asked(self.balances.motions, place):
            found = self._size(effect, place, shape)
            if found is not None:
                yield found

    def _all_else(self, effect: Effect, place: Place) -> Model:
        name = effect.one_of or ("body" if effect.is_body else effect.id), place
        if name not in self._others:
            self._others[name] = all_else(self._model, (effect.id, (place,)))
        return self._others[name]

    def _expected(
        self, effect: Effect, place: Place, shape: Shape, amount: float
    ) -> tuple[dict[Key, FloatArray], Expected] | None:
        """What an amount adds, and what a diagnosis would find of it; None where nothing."""
        added, limits = self._contribution(effect, place, shape, amount), self.balances.thresholds
        if added is None:
            return None
        at, beta, width = self._at(effect, place, shape, amount)
        columns = self.balances.columns(effect, place, at)
        prior = effect.prior_at(self.balances.motions[0], place, width)
        term = Term(effect=effect.id, place=place, shape=at, columns=columns, prior=prior)
        tried = len(effect.shapes(self.balances.motions, place))
        cause = anomalous(self.balances, term, among=float(max(tried, 1)))
        precision = float(np.sum(cause.precision * beta**2))
        model = self._all_else(effect, place)
        return added, expected(model, added, cause, precision, limits)

    def _size(self, effect: Effect, place: Place, shape: Shape) -> Size | None:
        limits, begin = self.balances.thresholds, _begin(effect)
        linear = self._is_linear(effect, place, shape)
        tried = [] if linear else self._amounts(effect, place, shape)
        begin = min(tried, key=lambda each: abs(each - begin)) if tried else begin
        first = self._expected(effect, place, shape, begin)
        if first is None:
            return None

        def clarity(amount: float) -> float:
            made = self._expected(effect, place, shape, amount)
            return 0.0 if made is None else made[1].clarity(1.0, limits)

        if linear:
            times = first[1].smallest(limits)
            amount, of_usual = times * begin, times * self._of_usual(first[0])
            low, high = (float(bound[0]) for bound in effect.bounds)
            amount = amount if amount <= max(-low, high) else np.inf
        else:
            most = _MOST_SHARE if _of_share(effect) else effect.parameters[0].upper
            amount, of_usual = bisected(clarity, tried, begin, most), 0.0
        amount = self._claimed(effect, place, shape, amount)
        figure, below = self._figure(effect, place, shape, amount)
        return Size(
            effect=effect.id,
            variant=effect.variant(shape),
            place=place,
            parameter=effect.parameters[0],
            figure=figure,
            below=below,
            left=remainder(self._all_else(effect, place), first[0]).share,
            of_usual=of_usual,
        )

    def _is_linear(self, effect: Effect, place: Place, shape: Shape) -> bool:
        """Whether contributions are in proportion to the amount."""
        return not effect.fixed and self._at(effect, place, shape, _begin(effect))[0] == shape

    def _amounts(self, effect: Effect, place: Place, shape: Shape) -> list[float]:
        """Amounts that the search tries, rising; none where it has them from the data."""
        if _of_share(effect):
            return []
        name, variant, motions = (
            effect.parameters[0].name,
            effect.variant(shape),
            self.balances.motions,
        )
        figures = {
            effect.values(each, np.ones(1))[name]
            for each in effect.shapes(motions, place)
            if effect.variant(each) == variant
        }
        falls = _nothing(effect) >= _BEYOND  # a stiffness: its amount is a compliance
        return sorted(1.0 / each if falls else each for each in figures if each > 0.0)

    def _at(
        self, effect: Effect, place: Place, shape: Shape, amount: float
    ) -> tuple[Shape, FloatArray, int]:
        motions = self.balances.motions
        width = self._width(effect, place, shape)
        at, beta = effect.of_amount(amount, motions, place, shape, width)
        return at, beta, width

    def _width(self, effect: Effect, place: Place, shape: Shape) -> int:
        """Number of coefficients, by the first columns there are; 1 for a fixed effect."""
        if effect.fixed:
            return 1
        columns = self.balances.columns(effect, place, shape)
        return next((each.shape[1] for each in columns.values()), 1)

    def _contribution(
        self, effect: Effect, place: Place, shape: Shape, amount: float
    ) -> dict[Key, FloatArray] | None:
        """What an amount adds to the balances, (N,) each; None where nothing."""
        at, beta, _ = self._at(effect, place, shape, amount)
        added = self._added(effect, place, at, beta)
        if not _of_share(effect) and not self._is_linear(effect, place, shape):
            # A link between flanks gives a little without any play: that is not what is sought.
            none = (effect.id, place, effect.variant(shape))
            if none not in self._none:
                self._none[none] = self._added(
                    effect, place, *self._at(effect, place, shape, _NEXT_TO_NOTHING)[:2]
                )
            off = self._none[none]
            added = {key: values - off.get(key, 0.0) for key, values in added.items()}
        return {key: values for key, values in added.items() if np.any(values)} or None

    def _added(
        self, effect: Effect, place: Place, shape: Shape, beta: FloatArray
    ) -> dict[Key, FloatArray]:
        columns = self.balances.compute(effect, place, shape)
        return {key: column @ beta for key, column in columns.items()}

    def _claimed(self, effect: Effect, place: Place, shape: Shape, amount: float) -> float:
        """At least what is claimed, however clear: sampling and derivatives may look like it."""
        motions = self.balances.motions
        for _ in range(60):
            if not np.isfinite(amount) or _of_share(effect):
                break
            at, beta, _ = self._at(effect, place, shape, amount)
            values = effect.values(at, beta)
            if not (effect.negligible(motions, at) or effect.trifling(values, motions[0], place)):
                break
            amount *= 1.1
        return amount

    def _of_usual(self, contribution: Mapping[Key, FloatArray]) -> float:
        """The least share of a joint's usual torque that it is in any of them."""
        b = self.balances
        return min(
            (
                b.rms(key, values) / usual_torque(b, key[1])
                for key, values in contribution.items()
                if key[0] == "torque" and b.mask[key].any()
            ),
            default=0.0,
        )

    def _figure(
        self, effect: Effect, place: Place, shape: Shape, amount: float
    ) -> tuple[float, bool]:
        """The first parameter of an amount less what it is of nothing, and whether it falls."""
        name, nothing = effect.parameters[0].name, _nothing(effect)
        if not np.isfinite(amount):
            return np.inf, False
        at, beta, _ = self._at(effect, place, shape, amount)
        value = effect.values(at, beta)[name]
        if nothing >= _BEYOND:
            return float(value), True
        return abs(float(value) - nothing), False


def _nothing(effect: Effect) -> float:
    """The first parameter where the effect does nothing."""
    nothing = {} if effect.example is None else effect.example.nothing or {}
    return float(nothing.get(effect.parameters[0].name, 0.0))


def _of_share(effect: Effect) -> bool:
    """Whether an amount is a share of the time: of a limit that lies without end otherwise."""
    return effect.of_commands and _nothing(effect) >= _BEYOND


def _begin(effect: Effect) -> float:
    """An amount to begin with."""
    if _of_share(effect):
        return _SHARE
    name, nothing = effect.parameters[0].name, _nothing(effect)
    if effect.example is None:
        return 1.0
    size = abs(effect.example.values[name] - nothing)
    return 1e-3 if nothing >= _BEYOND or size == 0.0 else size
