"""Which causes, by their posterior: added, dropped, swapped and reshaped until nothing is worth it.

Ordinary physics is always in the model. A peculiar cause enters where the evidence for it, with its
prior odds, pays its price, and stays only as long as that is so beside everything else.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..effects import CATALOGUE
from ..effects.torque_gain import TorqueGain
from ..motion.balances import Balances
from ..regression.fit import Fit, Term, TermKey
from ..regression.refine import refined
from .candidates import candidates
from .flexible import count_independent
from .gates import sharpened
from .hypothesis import Hypothesis, peculiar
from .linearisation import Linearisation
from .model import Model
from .ordinary import DAYS, OF_DAYS, OF_JOINTS, Ordinary, days_of
from .pool import Pool, Scored
from .proposals import begun, gated, harmonics, nameless, pushes

_SERIOUS = 6  # hypotheses of a round that are weighed at their own noise
_SHAPED = 3  # of these, whose nonlinear parameters are moved to their best
_TUNED = 3  # rounds of the ordinary part's choices
_BETTER = 1.0  # log odds by which a swap must be better

Tell = Callable[[str], None]


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """Ordinary physics, what is peculiar, and their model."""

    ordinary: Ordinary
    chosen: tuple[Hypothesis, ...]
    model: Model

    @property
    def log_posterior(self) -> float:
        """Up to a constant."""
        return self.model.log_posterior


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A hypothesis weighed in the place of a cause."""

    hypothesis: Hypothesis
    log_odds: float  # over nothing in the cause's place


@dataclass(kw_only=True, eq=False)
class Posterior:
    """The search of one study."""

    balances: Balances
    data: Linearisation
    pool: Pool
    tell: Tell = lambda text: None
    tried: dict[TermKey, tuple[Hypothesis, float]] = field(default_factory=dict)

    @classmethod
    def of(cls, balances: Balances, tell: Tell = lambda text: None) -> Posterior:
        """Of a study's balances."""
        data = Linearisation.of_balances(balances)
        count_independent(balances, data)
        terms = [t for t in candidates(balances) if not _is_ordinary(t)]
        shapes: dict[TermKey, int] = {}
        for term in terms:
            shapes[term.key] = shapes.get(term.key, 0) + 1
        pool = [peculiar(balances, t, among=float(shapes[t.key])) for t in terms]
        return cls(balances=balances, data=data, pool=Pool(data, pool), tell=tell)

    def begun(self, bodies: float, chosen: Sequence[Hypothesis] = ()) -> State:
        """Ordinary physics, with bodies right to a share, and what is given."""
        ordinary = Ordinary(balances=self.balances, bodies=bodies)
        model = Model(self.data, _beside(ordinary, chosen))
        return self._tuned(State(ordinary=ordinary, chosen=tuple(chosen), model=model))

    def _tuned(self, state: State) -> State:
        """With the choices of the ordinary part as they are likeliest now."""
        for _ in range(_TUNED):
            now = state.ordinary
            other = now.fitted_to(state.model)
            model = Model(self.data, _beside(other, state.chosen), state.model.noise)
            settled = other.widths == now.widths and all(
                abs(other.levels[k] - now.levels.get(k, 0.0)) <= 0.1 * other.levels[k]
                for k in other.levels
            )
            state = self._possible(replace(state, ordinary=other, model=model))
            if settled:
                break
        return state

    def _possible(self, state: State) -> State:
        """Without causes that cannot be beside the others."""
        while gone := state.model.impossible:
            state = self._with(state, [h for h in state.chosen if all(h is not g for g in gone)])
        return state

    def _with(self, state: State, chosen: Sequence[Hypothesis]) -> State:
        model = Model(self.data, _beside(state.ordinary, chosen), state.model.noise)
        return replace(state, chosen=tuple(chosen), model=model)

    def with_bodies(self, state: State, bodies: float) -> State:
        """The same causes beside bodies that are right to another share."""
        ordinary = replace(state.ordinary, bodies=bodies)
        model = Model(self.data, _beside(ordinary, state.chosen), state.model.noise)
        return self._tuned(replace(state, ordinary=ordinary, model=model))

    def grown(self, state: State, most: int | None = None) -> State:
        """The state with all that is worth it, or with so many causes."""
        believed = self.balances.thresholds.identify
        most = believed.most if most is None else most
        dropped: dict[TermKey, int] = {}
        sources = (self._of_pool, self._of_parts, self._of_nameless)
        level = 0
        while len(state.chosen) < most and level < len(sources):
            taken = {each.key for each in state.chosen}
            serious = [
                each
                for each in sources[level](state)
                if each.hypothesis.key not in taken
                and dropped.get(each.hypothesis.key, 0) < 2
                and _fits_beside(each.hypothesis, state.chosen)
            ]
            best = self._best(state, state.model, serious)
            if best is None or best[1] < believed.worth:
                simpler = self._instead(state) if level == len(sources) - 1 else None
                if simpler is None:
                    level += 1
                else:
                    state, level = simpler, 0
                continue
            added, odds = best
            self.tell(f"{_words(added)}: log odds {odds:.0f}")
            before = state
            state = self._tuned(self._with(state, [*state.chosen, added]))
            state = self._polished(self._swept(state, added), added)
            for each in before.chosen:
                if all(each.key != other.key for other in state.chosen):
                    dropped[each.key] = dropped.get(each.key, 0) + 1
            level = 0
        return state

    def _instead(self, state: State) -> State | None:
        """With one cause in the place of all that was taken at a joint, where that is likelier."""
        for j in range(self.balances.n):
            here = [h for h in state.chosen if h.term.place.joints[:1] == (j,) and _of_torque(h)]
            if not here:
                continue
            rest = [h for h in state.chosen if all(h is not o for o in here)]
            bare = self._possible(self._with(state, rest))
            fit = self.fit_of(bare.model)
            found = [
                *gated(self.balances, fit, (j,)),
                *begun(self.balances, fit, (j,)),
                *nameless(self.balances, fit, (j,)),
            ]
            taken = {h.key for h in here}
            scored = [
                each
                for each in Pool(self.data, found).scored(bare.model)
                if each.hypothesis.key not in taken
            ]
            best = self._best(bare, bare.model, scored[: 2 * _SERIOUS])
            if best is None or best[1] < state.log_posterior - bare.log_posterior + _BETTER:
                continue
            self.tell(f"{_words(best[0])} in the place of {', '.join(map(_words, here))}")
            return self._tuned(self._with(bare, [*bare.chosen, best[0]]))
        return None

    def _of_pool(self, state: State) -> list[Scored]:
        fit = self.fit_of(state.model)
        found = [*harmonics(self.balances, fit), *pushes(self.balances, fit)]
        more = Pool(self.data, found)
        scored = [*self.pool.scored(state.model), *more.scored(state.model)]
        return sorted(scored, key=lambda each: -each.log_odds)

    def _of_parts(self, state: State) -> list[Scored]:
        fit = self.fit_of(state.model)
        found = [
            *gated(self.balances, fit),
            *begun(self.balances, fit),
        ]
        return Pool(self.data, found).scored(state.model)

    def _of_nameless(self, state: State) -> list[Scored]:
        fit = self.fit_of(state.model)
        return Pool(self.data, list(nameless(self.balances, fit))).scored(state.model)

    def _best(
        self, state: State, beside: Model, scored: Sequence[Scored]
    ) -> tuple[Hypothesis, float] | None:
        """The likeliest at the noise that it leaves, and its log odds."""
        found: list[tuple[Hypothesis, float]] = []
        fit: Fit | None = None
        for number, each in enumerate(_serious(scored)):
            hypothesis = each.hypothesis
            if not self._may_be(hypothesis):
                continue
            if number < _SHAPED and _has_shape(hypothesis):
                fit = fit or self.fit_of(beside)
                hypothesis = self.reshaped(fit, hypothesis)
            wider = _wider(beside, hypothesis)
            while (gone := wider.impossible) and all(each is not hypothesis for each in gone):
                wider = wider.without(*gone)
            odds = wider.log_posterior - beside.log_posterior
            old = self.tried.get(hypothesis.key)
            if old is None or odds > old[1]:
                self.tried[hypothesis.key] = hypothesis, odds
            found.append((hypothesis, odds))
        return max(found, key=lambda each: each[1]) if found else None

    def _may_be(self, hypothesis: Hypothesis) -> bool:
        """Whether nothing in the recordings contradicts it, and it acts where rows count."""
        b, term = self.balances, hypothesis.term
        effect = CATALOGUE[term.effect]
        if not effect.plausible(b.motions, term.place, term.shape):
            return False
        inside = whole = 0.0
        for key, column in term.columns.items():
            inside += float(np.sum(column[b.mask[key]] ** 2)) / b.sigma[key] ** 2
            whole += float(np.sum(column**2)) / b.sigma[key] ** 2
        return inside > b.thresholds.identify.inside * whole

    def reshaped(self, fit: Fit, hypothesis: Hypothesis, *, again: bool = False) -> Hypothesis:
        """With gate and nonlinear parameters where they are likeliest beside a fit.

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
        price = 0.0 if again else free * self.balances.thresholds.identify.shape_price
        price += effect.log_prior(term.shape) - effect.log_prior(moved.shape)
        precision = hypothesis.precision
        return replace(
            hypothesis,
            term=replace(moved, prior=term.prior),
            precision=precision,
            log_odds=hypothesis.log_odds - price,
        )

    def fit_of(self, model: Model) -> Fit:
        """The same by least squares over rows, for what looks at rows."""
        sigma = {key: model.weight(key) ** -0.5 for key in model.noise}
        terms = [each.term for each in model.hypotheses]
        return Fit(self.balances.with_noise(sigma), terms)

    def _swept(self, state: State, added: Hypothesis) -> State:
        """Every cause that shares a balance with a new one, again: out, or another in its place."""
        worth = self.balances.thresholds.identify.worth
        for each in state.chosen:
            if each is added or each.term.columns.keys().isdisjoint(added.term.columns):
                continue
            if all(each is not other for other in state.chosen):
                continue
            rest = [other for other in state.chosen if other is not each]
            without = self._possible(self._with(state, rest))
            own = state.log_posterior - without.log_posterior
            best = self._best(without, without.model, self._rivals_of(without, each))
            if best is not None and best[1] > max(own + _BETTER, worth):
                self.tell(f"{_words(best[0])} in the place of {_words(each)}")
                state = self._tuned(self._with(state, [*rest, best[0]]))
            elif own < worth:
                self.tell(f"without {_words(each)}: log odds {own:.0f}")
                state = self._tuned(without)
        return state

    def _polished(self, state: State, added: Hypothesis) -> State:
        """Nonlinear parameters moved to their best again, where a new cause shares a balance."""
        for each in state.chosen:
            free = CATALOGUE[each.term.effect].free(each.term.shape)
            if each is added or not free or CATALOGUE[each.term.effect].costly:
                continue
            if each.term.columns.keys().isdisjoint(added.term.columns):
                continue
            rest = [other for other in state.chosen if other is not each]
            moved = self.reshaped(self.fit_of(self._with(state, rest).model), each, again=True)
            if moved is each:
                continue
            order = [moved if other is each else other for other in state.chosen]
            better = self._with(state, order)
            if better.log_posterior > state.log_posterior:
                state = better
        return state

    def _rivals_of(self, without: State, each: Hypothesis) -> list[Scored]:
        taken = {other.key for other in without.chosen} | {each.key}
        return [
            scored
            for scored in self.pool.scored(without.model)
            if scored.hypothesis.key not in taken
            and not scored.hypothesis.term.columns.keys().isdisjoint(each.term.columns)
            and _fits_beside(scored.hypothesis, without.chosen)
        ][:_SERIOUS]

    def judged(self, state: State) -> list[tuple[Hypothesis, float, list[Candidate]]]:
        """Every cause with its log odds beside all others, and the names that come near it."""
        level = self.balances.thresholds.identify.level
        found = []
        for each in state.chosen:
            rest = [other for other in state.chosen if other is not each]
            without = self._possible(self._with(state, rest))
            own = state.log_posterior - without.log_posterior
            rivals = []
            for scored in _serious(self._rivals_of(without, each))[:4]:
                if scored.log_odds < own - 5.0 * level or not self._may_be(scored.hypothesis):
                    continue
                odds = _wider(without.model, scored.hypothesis).log_posterior
                odds -= without.log_posterior
                apart = scored.hypothesis.log_odds - each.log_odds  # what was believed before
                if max(odds, odds - apart) > own - level:
                    rivals.append(Candidate(hypothesis=scored.hypothesis, log_odds=odds))
            found.append((each, own, sorted(rivals, key=lambda each: -each.log_odds)))
        return found

    def _days(self, state: State, part: Hypothesis) -> list[Hypothesis]:
        """What a part differs by in each session."""
        hypotheses = state.model.hypotheses
        own = days_of([h.term for h in hypotheses], part.term)
        return [h for h in hypotheses if any(h.term is day for day in own)]

    def in_place_of(self, state: State, part: Hypothesis) -> list[Candidate]:
        """Causes that would explain what an ordinary part does, nearly as well; prior odds apart.

        What every machine has is the name; that rows do not tell it from another is said.
        """
        level = self.balances.thresholds.identify.level
        without = state.model.without(part, *self._days(state, part))
        own = state.model.log_evidence - without.log_evidence
        found = []
        for scored in _serious(
            [
                each
                for each in self.pool.scored(without)
                if each.hypothesis.term.place == part.term.place
                and each.hypothesis.term.effect != part.term.effect
                and each.hypothesis.term.columns.keys() == part.term.columns.keys()
                and _fits_beside(each.hypothesis, state.chosen)
            ]
        )[:4]:
            hypothesis = scored.hypothesis
            if scored.log_odds - hypothesis.log_odds < own - 2.0 * level:
                continue
            if not self._may_be(hypothesis):
                continue
            wider = without.with_(hypothesis)
            gain = wider.log_evidence - without.log_evidence
            if wider.admissible and gain > own - level:
                found.append(Candidate(hypothesis=hypothesis, log_odds=gain))
        return sorted(found, key=lambda each: -each.log_odds)


def likeliest(states: Sequence[State]) -> State:
    """Of states of the same study."""
    return max(states, key=lambda state: state.log_posterior)


def _takes_place(law: Hypothesis, part: Hypothesis) -> bool:
    """Whether a law is a finer one of an ordinary friction's kind, which is then not there."""
    if not part.ordinary or law.term.place.gate is not None:
        return False
    kind = CATALOGUE[law.term.effect].one_of
    own = CATALOGUE.get(OF_DAYS if part.term.effect == DAYS else part.term.effect)
    return (
        bool(kind)
        and own is not None
        and own.family == "friction"
        and own.one_of == kind
        and part.term.place == law.term.place
        and _is_dry(part)
    )


def _is_dry(part: Hypothesis) -> bool:
    return part.term.effect in (DAYS, OF_DAYS)


def _beside(ordinary: Ordinary, chosen: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
    """Ordinary physics and what is chosen, but for parts whose place a finer law takes."""
    parts = [
        part for part in ordinary.hypotheses() if not any(_takes_place(law, part) for law in chosen)
    ]
    return (*parts, *chosen)


def _wider(model: Model, law: Hypothesis) -> Model:
    """A model with a cause more, in the place of what it is a finer law of."""
    gone = [part for part in model.hypotheses if _takes_place(law, part)]
    return (model.without(*gone) if gone else model).with_(law)


def _serious(scored: Sequence[Scored]) -> list[Scored]:
    """The likeliest of each name and place: the first few, and each balance's first."""
    found: list[Scored] = []
    seen: set[TermKey] = set()
    shown: set[object] = set()
    for each in scored:
        key = each.hypothesis.key
        if key in seen:
            continue
        fresh = not shown.issuperset(each.hypothesis.term.columns)
        if len(found) < _SERIOUS or (fresh and len(each.hypothesis.term.columns) == 1):
            seen.add(key)
            shown.update(each.hypothesis.term.columns)
            found.append(each)
    return found


def _has_shape(hypothesis: Hypothesis) -> bool:
    term = hypothesis.term
    effect = CATALOGUE[term.effect]
    return (
        term.place.gate is not None
        or bool(effect.free(term.shape))
        or bool(effect.variant(term.shape))
    )


def _of_torque(hypothesis: Hypothesis) -> bool:
    return all(balance == "torque" for balance, _ in hypothesis.term.columns)


def _is_ordinary(term: Term) -> bool:
    """Whether the model has it anyway: a torque's zero, but not that of the report alone."""
    if term.effect not in OF_JOINTS or term.effect == TorqueGain.id:
        return False
    return term.place.gate is None and not CATALOGUE[term.effect].variant(term.shape)


def _fits_beside(hypothesis: Hypothesis, chosen: Iterable[Hypothesis]) -> bool:
    """Whether a cause may stand beside others: one law of a kind at a joint, one body at a link."""
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


def _words(hypothesis: Hypothesis) -> str:
    place = hypothesis.term.place
    where = "".join(f" joint {j + 1}" for j in place.joints)
    where += "" if place.link is None else f" link {place.link + 1}"
    return f"{CATALOGUE[hypothesis.term.effect].words}{where}"
