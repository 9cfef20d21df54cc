"""The smallest size of every effect that would be seen at every place of a study."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE, Effect
from ..effects.effect import Parameter
from ..identify.candidates import same_kind
from ..motion.place import Key, Place, Shape
from ..motion.prepare import Prepared
from ..regression.background import (
    background,
    has_its_like,
    usual_torque,
    without_its_like,
)
from ..regression.fit import Term, term_of
from ..regression.repeats import repeats_of
from ..regression.trusted_bodies import TRUST, trusted
from .amounts import bisected
from .beside import Beside, Contribution, Noise
from .sight import Asks, Sight, sight_of

_BEYOND = 1e6  # a figure at which an effect does nothing, from which it is without end
_SHARE = 0.02  # of the time, the amount to begin with of what is told by a share
_MOST_SHARE = 0.5
_NEXT_TO_NOTHING = 1e-9  # of a time or an angle
_ANY_BODY = 1.0  # trust in bodies that leaves their masses open


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
    """Of a study whose channels are as they should be."""

    def __init__(self, prepared: Prepared) -> None:
        """Along the recordings to fit."""
        self.prepared = prepared
        self.balances = b = prepared.fit
        self._noisy, self._ordinary = background(b)
        self._trusted = trusted(b, prepared.study.trust.rigid_body)
        free = [*(t for t in self._ordinary if t.effect != TRUST), *trusted(b, _ANY_BODY)]
        self._noise = Noise(flexible=Beside(b, free))
        self._whole: dict[tuple[str, Place], Beside] = {}
        self._sets: dict[Key, tuple[float, float]] = {}
        self._none: dict[tuple[str, Place, str], dict[Key, FloatArray]] = {}
        self._simple = {j: self._simple_at(j) for j in range(b.n)}
        self._clear = self._clear_figures()

    def of(self, effect: Effect, place: Place) -> Iterator[Size]:
        """Of each variant of an effect that has something to be seen by; none of others."""
        for shape in effect.asked(self.balances.motions, place):
            found = self._size(effect, place, shape)
            if found is not None:
                yield found

    def _simple_at(self, j: int) -> list[Term]:
        """Of each simple ordinary effect, where joint j is judged."""
        if not self.balances.excited[j]:
            return []
        motions, place, found = self.balances.motions, Place(joints=(j,)), []
        for each in CATALOGUE.values():
            if not each.is_plain or place not in each.places(motions):
                continue
            for shape in each.asked(motions, place)[:1]:
                term = term_of(self.balances, each, place, shape)
                found += [] if term is None or term.width > 1 else [term]
        return found

    def _beside(self, effect: Effect, place: Place) -> Beside:
        """What an effect is found beside: simple ordinary ones of other kinds, trusted bodies."""
        others = [
            term
            for terms in self._simple.values()
            for term in terms
            if not (term.place == place and _same_name(term.effect, effect.id))
        ]
        bodies = [t for t in self._trusted if not (effect.is_body and t.place.link == place.link)]
        return Beside(self.balances, [*bodies, *others])

    def _stands_beside(
        self, effect: Effect, place: Place, contribution: Contribution
    ) -> Beside | None:
        """What an effect that no ordinary machine has is held against."""
        of_torque = all(balance == "torque" for balance, _ in contribution)
        if effect.costly or not of_torque or has_its_like(effect) or not self._ordinary:
            return None
        name = (effect.id, place)
        if name not in self._whole:
            own = Term(effect=effect.id, place=place, shape=(), columns={}, prior=np.zeros(0))
            terms = without_its_like(self._ordinary, own, self.balances.thresholds)
            plain = terms is self._ordinary
            name = ("", Place()) if plain else name
            if name not in self._whole:
                self._whole[name] = Beside(self._noisy, terms)
        return self._whole[name]

    def _size(self, effect: Effect, place: Place, shape: Shape) -> Size | None:
        limits, begin = self.balances.thresholds, _begin(effect)
        linear = self._is_linear(effect, place, shape)
        tried = [] if linear else self._amounts(effect, place, shape)
        begin = min(tried, key=lambda each: abs(each - begin)) if tried else begin
        one = self._contribution(effect, place, shape, begin)
        if one is None:
            return None
        beside = self._beside(effect, place)

        def sight(made: tuple[dict[Key, FloatArray], int]) -> Sight:
            contribution, width = made
            asks = Asks(width=width, least_of_rest=effect.least_of_rest)
            key = next(iter(contribution))
            if effect.ordinary and len(contribution) == 1:
                price, noise = self._of_sets(key)
                asks = replace(asks, price=(width + len(shape)) * price, noise=noise)
            whole = self._stands_beside(effect, place, contribution)
            return sight_of(contribution, asks, beside, self._noise, whole, self._clear)

        def clarity(amount: float) -> float:
            made = self._contribution(effect, place, shape, amount)
            return 0.0 if made is None else sight(made).clarity(1.0, limits)

        first = sight(one)
        if linear:
            times = first.smallest(limits)
            amount, of_usual = times * begin, times * self._of_usual(one[0])
            low, high = (float(bound[0]) for bound in effect.bounds)
            amount = amount if amount <= max(-low, high) else np.inf
        else:
            most = _MOST_SHARE if _of_share(effect) else effect.parameters[0].upper
            amount, of_usual = bisected(clarity, tried, begin, most), 0.0
        amount = self._told(effect, place, shape, amount)
        figure, below = self._figure(effect, place, shape, amount)
        return Size(
            effect=effect.id,
            variant=effect.variant(shape),
            place=place,
            parameter=effect.parameters[0],
            figure=figure,
            below=below,
            left=first.share,
            of_usual=of_usual,
        )

    def _of_sets(self, key: Key) -> tuple[float, float]:
        """Price of a figure by the Bayesian criterion of joints' sets, and the noise there."""
        if key not in self._sets:
            b, flexible = self.balances, self._noise.flexible
            rows, left = flexible.fit.rows[key], flexible.left(key) / self.balances.sigma[key]
            same = repeats_of(b, rows, left)
            noise = max(float(np.mean(left**2)), 1.0) * same if len(rows) else 1.0
            self._sets[key] = float(np.log(max(len(rows) / same, 8.0))), noise
        return self._sets[key]

    def _clear_figures(self) -> int:
        """How many simple effects these recordings show clearly, so that the search has them."""
        limits = self.balances.thresholds.search
        terms = [term for some in self._simple.values() for term in some]
        found = 0
        for term in terms:
            beside = Beside(self.balances, [t for t in terms if t is not term])
            own = {key: column[:, 0] for key, column in term.columns.items()}
            error = sight_of(own, Asks(width=1, least_of_rest=0.0), beside, self._noise).error
            level = float(beside.fit.extended(term).beta[-1])
            found += abs(level) > limits.still_needed * limits.least_t * error
        return found

    def _is_linear(self, effect: Effect, place: Place, shape: Shape) -> bool:
        """Whether contributions are in proportion to the amount."""
        return not effect.fixed and self._at(effect, place, shape, _begin(effect))[0] == shape

    def _amounts(self, effect: Effect, place: Place, shape: Shape) -> list[float]:
        """Those that the search tries, rising; none where it has them from the data."""
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
        """Of the first columns there are; 1 of what is fixed, whatever its shape."""
        if effect.fixed:
            return 1
        columns = self.balances.columns(effect, place, shape)
        return next((each.shape[1] for each in columns.values()), 1)

    def _contribution(
        self, effect: Effect, place: Place, shape: Shape, amount: float
    ) -> tuple[dict[Key, FloatArray], int] | None:
        """What an amount adds to the balances, (N,) each, and by how many figures; or None."""
        at, beta, width = self._at(effect, place, shape, amount)
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
        added = {key: values for key, values in added.items() if np.any(values)}
        return (added, width) if added else None

    def _added(
        self, effect: Effect, place: Place, shape: Shape, beta: FloatArray
    ) -> dict[Key, FloatArray]:
        columns = self.balances.compute(effect, place, shape)
        return {key: column @ beta for key, column in columns.items()}

    def _told(self, effect: Effect, place: Place, shape: Shape, amount: float) -> float:
        """No less than is claimed, however clear: sampling and differentiation may look like it."""
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

    def _of_usual(self, contribution: Contribution) -> float:
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


def _same_name(one: str, other: str) -> bool:
    return one == other or same_kind(one, other)


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
