"""Models of a study's hypotheses, and the likeliest of many at the noise that they leave.

A finer law replaces an ordinary one; of a kind there is one law at a joint.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from ..effects import CATALOGUE
from ..effects.drives import TorqueGain
from ..motion import Balances
from ..regression import DAYS, Fit, Term, TermKey, refined
from .candidates import candidates, is_restless
from .flexible import count_independent
from .gates import sharpened
from .hypothesis import Hypothesis, anomalous
from .linearisation import Linearisation
from .model import Model
from .ordinary import OF_DAYS, OF_JOINTS, Ordinary
from .pool import Pool, Scored


def _takes_place(law: Hypothesis, part: Hypothesis) -> bool:
    """Whether a law is a finer one of an ordinary friction's kind, which is then not there."""
    return (
        part.ordinary
        and part.term.effect in (DAYS, OF_DAYS)
        and part.term.place == law.term.place
        and CATALOGUE[law.term.effect].one_of == CATALOGUE[OF_DAYS].one_of
    )


def with_ordinary(ordinary: Ordinary, chosen: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
    """Ordinary physics and what is chosen, but for parts whose place a finer law takes."""
    parts = [
        part for part in ordinary.hypotheses() if not any(_takes_place(law, part) for law in chosen)
    ]
    return (*parts, *chosen)


def wider(model: Model, law: Hypothesis) -> Model:
    """A model with a cause more, in the place of what it is a finer law of."""
    gone = [part for part in model.hypotheses if _takes_place(law, part)]
    return (model.without(*gone) if gone else model).with_(law)


def has_shape(hypothesis: Hypothesis) -> bool:
    term = hypothesis.term
    effect = CATALOGUE[term.effect]
    return term.place.gate is not None or bool(effect.free(term.shape))


def of_torque(hypothesis: Hypothesis) -> bool:
    return all(balance == "torque" for balance, _ in hypothesis.term.columns)


def is_ordinary(term: Term) -> bool:
    """Whether the model has it anyway: a torque's zero, but not that of the report alone."""
    if term.effect not in OF_JOINTS or term.effect == TorqueGain.id:
        return False
    return term.place.gate is None and not CATALOGUE[term.effect].variant(term.shape)


def fits_with(hypothesis: Hypothesis, chosen: Iterable[Hypothesis]) -> bool:
    """Whether a cause may join others: one law of a kind at a joint, one body at a link."""
    effect, place = CATALOGUE[hypothesis.term.effect], hypothesis.term.place
    for other in chosen:
        same = other.term.effect == effect.id and other.term.place.joints == place.joints
        if same and place.gate is not None and other.term.place.gate is not None:
            return False  # a law that comes and goes many times is another law
        if other.term.place != place:
            continue
        there = CATALOGUE[other.term.effect]
        if effect.one_of and effect.one_of == there.one_of:
            return False
        if effect.is_body and there.is_body:
            return False
        if there.id in effect.instead or effect.id in there.instead:
            return False
    return True


SERIOUS = 6  # numerics: hypotheses of a round that are compared at their own noise
_SHAPED = 3  # numerics: of these, whose nonlinear parameters are moved to their best
_SAME_LEVEL = 0.1  # numerics: relative change of a friction's level that is none
_TUNED = 3  # rounds of the ordinary part's choices

Tell = Callable[[str], None]


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """Ordinary physics, what is anomalous, and their model."""

    ordinary: Ordinary
    chosen: tuple[Hypothesis, ...]
    model: Model

    @property
    def log_posterior(self) -> float:
        """Logarithm of the posterior, up to a constant."""
        return self.model.log_posterior


@dataclass(kw_only=True, eq=False)
class Weighing:
    """A study's rows, candidates, and all hypotheses that were compared on them."""

    balances: Balances
    data: Linearisation
    pool: Pool
    tell: Tell = lambda text: None
    tried: dict[TermKey, Scored] = field(default_factory=dict)

    @classmethod
    def of(cls, balances: Balances, tell: Tell = lambda text: None) -> Self:
        """The rows and candidates of a study's balances."""
        data = Linearisation.of_balances(balances)
        count_independent(balances, data)
        terms = [t for t in candidates(balances) if not is_ordinary(t)]
        shapes: dict[TermKey, int] = {}
        for term in terms:
            shapes[term.key] = shapes.get(term.key, 0) + 1
        pool = [anomalous(balances, t, among=float(shapes[t.key])) for t in terms]
        return cls(balances=balances, data=data, pool=Pool(data, pool), tell=tell)

    def begun(self, bodies: float, chosen: Sequence[Hypothesis] = ()) -> State:
        """Ordinary physics, with bodies right to a share, and what is given."""
        ordinary = Ordinary(balances=self.balances, bodies=bodies)
        model = Model(self.data, with_ordinary(ordinary, chosen))
        return self.tuned(State(ordinary=ordinary, chosen=tuple(chosen), model=model))

    def tuned(self, state: State, added: Hypothesis | None = None) -> State:
        """The state with the choices of the ordinary part as they are likeliest now.

        Args:
            state: as it is.
            added: what changed in it: other joints' friction is as wide as it was.
        """
        joints = set(state.ordinary.joints)
        if added is not None:
            joints &= {j for balance, j in added.term.columns if balance == "torque"}
        for turn in range(_TUNED):
            now = state.ordinary
            other = now.fitted_to(state.model, joints if turn == 0 or added is None else ())
            model = Model(self.data, with_ordinary(other, state.chosen), state.model)
            settled = other.widths == now.widths and all(
                abs(other.levels[k] - now.levels.get(k, 0.0)) <= _SAME_LEVEL * other.levels[k]
                for k in other.levels
            )
            state = self.possible(replace(state, ordinary=other, model=model))
            if settled:
                break
        return state

    def possible(self, state: State) -> State:
        """The state without causes that cannot be in one model with the others."""
        while gone := state.model.impossible:
            state = self.with_causes(
                state, [h for h in state.chosen if all(h is not g for g in gone)]
            )
        return state

    def with_causes(self, state: State, chosen: Sequence[Hypothesis]) -> State:
        model = Model(self.data, with_ordinary(state.ordinary, chosen), state.model)
        return replace(state, chosen=tuple(chosen), model=model)

    def with_bodies(self, state: State, bodies: float) -> State:
        """The same causes with bodies that are right to another share."""
        ordinary = replace(state.ordinary, bodies=bodies)
        model = Model(self.data, with_ordinary(ordinary, state.chosen), state.model)
        return self.tuned(replace(state, ordinary=ordinary, model=model))

    def best(self, base: Model, scored: Sequence[Scored]) -> Scored | None:
        """The likeliest of the scored hypotheses, each at the noise that it leaves."""
        found: list[Scored] = []
        fit: Fit | None = None
        for number, each in enumerate(serious(scored)):
            hypothesis = each.hypothesis
            if not self.may_be(hypothesis, base):
                continue
            if number < _SHAPED and has_shape(hypothesis):
                fit = fit or self.fit_of(base)
                hypothesis = self.reshaped(fit, hypothesis)
            whole = wider(base, hypothesis)
            while (gone := whole.impossible) and all(each is not hypothesis for each in gone):
                whole = whole.without(*gone)
            if whole.size_of(hypothesis) < self.balances.thresholds.diagnosis.matters:
                continue
            found.append(Scored(hypothesis, whole.log_posterior - base.log_posterior))
            old = self.tried.get(hypothesis.key)
            if old is None or found[-1].log_odds > old.log_odds:
                self.tried[hypothesis.key] = found[-1]
        return max(found, key=lambda each: each.log_odds, default=None)

    def may_be(self, hypothesis: Hypothesis, base: Model) -> bool:
        """Whether nothing in the recordings contradicts it, and it acts where rows count.

        A link that swings by itself hardly follows its motor's noise, and so explains that: where
        no more than sensors' noise is left, nothing swings.
        """
        b, term = self.balances, hypothesis.term
        effect = CATALOGUE[term.effect]
        if not effect.plausible(b.motions, term.place, term.shape):
            return False
        if effect.shown_poorly:
            left = {key: variance**0.5 for key, variance in base.noise.items()}
            least = b.thresholds.diagnosis.restless
            if not is_restless(left, b.floor, term.place, least):
                return False
        inside = whole = 0.0
        for key, column in term.columns.items():
            inside += float(np.sum(column[b.mask[key]] ** 2)) / b.sigma[key] ** 2
            whole += float(np.sum(column**2)) / b.sigma[key] ** 2
        return inside > b.thresholds.diagnosis.nothing * whole

    def reshaped(self, fit: Fit, hypothesis: Hypothesis, *, again: bool = False) -> Hypothesis:
        """The hypothesis with gate and nonlinear parameters where they are likeliest given a fit.

        Args:
            fit: of all else.
            hypothesis: as it is.
            again: its parameters were moved before, and are paid for.
        """
        term = hypothesis.term
        moved = sharpened(fit, term) if term.place.gate is not None else refined(fit, term)
        if moved is term:
            return hypothesis
        effect = CATALOGUE[term.effect]
        free = len(effect.free(moved.shape))
        price = 0.0 if again else free * self.balances.thresholds.diagnosis.shape_price
        price += effect.log_prior(term.shape) - effect.log_prior(moved.shape)
        moved = replace(moved, prior=term.prior)
        return replace(hypothesis, term=moved, log_odds=hypothesis.log_odds - price)

    def fit_of(self, model: Model) -> Fit:
        """The model by least squares over rows, for what looks at rows."""
        return Fit(self.noisy(model), [each.term for each in model.hypotheses])

    def noisy(self, model: Model) -> Balances:
        """The balances with the noise that a model leaves."""
        return self.balances.with_noise({key: model.weight(key) ** -0.5 for key in model.noise})


def serious(scored: Sequence[Scored]) -> list[Scored]:
    """The likeliest of each name and place: the first few, and each balance's first."""
    found: list[Scored] = []
    seen: set[TermKey] = set()
    shown: set[object] = set()
    for each in scored:
        key = each.hypothesis.key
        if key in seen:
            continue
        fresh = not shown.issuperset(each.hypothesis.term.columns)
        if len(found) < SERIOUS or (fresh and len(each.hypothesis.term.columns) == 1):
            seen.add(key)
            shown.update(each.hypothesis.term.columns)
            found.append(each)
    return found
