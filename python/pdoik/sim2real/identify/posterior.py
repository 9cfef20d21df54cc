"""Which causes, by their posterior: added, dropped, swapped and reshaped until nothing is worth it.

Ordinary physics is always in the model. An anomalous cause enters where the evidence for it, with
its prior odds, pays its price, and stays only as long as that is so with everything else.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ..effects import CATALOGUE
from ..regression import TermKey
from .hypothesis import Hypothesis
from .pool import Pool, Scored
from .proposals import begun, gated, harmonics, nameless, pushes
from .weighing import SERIOUS, State, Weighing, fits_with, of_torque

_LOOKS = 3  # numerics: at every cause, where nothing more is worth adding
_MOST = 40  # causes, where evidence has not ended it before


class Posterior(Weighing):
    """The moves from one set of causes to another."""

    def grown(self, state: State, most: int | None = None) -> State:
        """The state with all that is worth it, or with so many causes.

        What is likeliest is added and all that it bears upon tested again; then parts and moments,
        then torques without a name; at last every cause once more. What came and went is not
        tried again before that last look: every step makes the set likelier, or it is not taken.
        """
        most = _MOST if most is None else most
        gone: set[TermKey] = set()
        sources = (self._of_pool, self._of_parts, self._of_nameless)
        level = looks = 0
        while level < len(sources):
            added = None
            if len(state.chosen) < most:
                added = self._worth_adding(state, sources[level](state), gone)
            if added is None:
                level += 1
                if level == len(sources) and looks < _LOOKS:
                    gone.clear()
                    other, looks = self._another(state, gone), looks + 1
                    if other is not None:
                        state, level = other, 0
                continue
            wider = self.tuned(self.with_causes(state, [*state.chosen, added]), added)
            wider = self._polished(self._swept(wider, added, gone), added)
            if wider.log_posterior <= state.log_posterior:
                gone.add(added.key)
                continue
            here = {each.key for each in wider.chosen}
            gone |= {each.key for each in (*state.chosen, added) if each.key not in here}
            state, level = wider, 0
        return state

    def _worth_adding(
        self, state: State, scored: Sequence[Scored], gone: set[TermKey]
    ) -> Hypothesis | None:
        """The likeliest that is not there and was not; None if none is worth it."""
        gone = gone | {each.key for each in state.chosen}
        serious = [
            each
            for each in scored
            if each.hypothesis.key not in gone and fits_with(each.hypothesis, state.chosen)
        ]
        best = self.best(state.model, serious)
        if best is None or best.log_odds < self.balances.thresholds.diagnosis.worth:
            return None
        self.tell(f"{_words(best.hypothesis)}: log odds {best.log_odds:.0f}")
        return best.hypothesis

    def _another(self, state: State, gone: set[TermKey]) -> State | None:
        """Another set, by a last look at every cause and its shape; None where it is as it was."""
        before = [each.key for each in state.chosen]
        looked = self._polished(self._swept(state, None, gone), None)
        if [each.key for each in looked.chosen] != before:
            return looked
        simpler = self._instead(looked)
        if (
            simpler is None
            and looked.log_posterior
            > state.log_posterior + self.balances.thresholds.diagnosis.better
        ):
            return looked
        return simpler

    def _swept(self, state: State, added: Hypothesis | None, gone: set[TermKey]) -> State:
        """Causes tested again: out, or another in their place.

        Of those that share a balance with a new one, or of all where there is none. What came and
        went is not tried, and noted.
        """
        believed = self.balances.thresholds.diagnosis
        for each in state.chosen:
            if added is not None and (
                each is added or each.term.columns.keys().isdisjoint(added.term.columns)
            ):
                continue
            if all(each is not other for other in state.chosen):
                continue
            rest = [other for other in state.chosen if other is not each]
            without = self.possible(self.with_causes(state, rest))
            own = state.log_posterior - without.log_posterior
            best = self.best(without.model, self.rivals_of(without, each, gone))
            if best is not None and best.log_odds > max(own + believed.better, believed.worth):
                new = best.hypothesis
                self.tell(f"{_words(new)} in the place of {_words(each)}")
                state = self.tuned(self.with_causes(state, [*rest, new]), new)
                if all(other.key != new.key for other in state.chosen):
                    gone.add(new.key)
            elif own < believed.worth:
                self.tell(f"without {_words(each)}: log odds {own:.0f}")
                state = self.tuned(without, each)
        return state

    def _polished(self, state: State, added: Hypothesis | None) -> State:
        """Nonlinear parameters moved to their best again, where a new cause shares a balance.

        Of all causes where there is no new one.
        """
        for each in state.chosen:
            free = CATALOGUE[each.term.effect].free(each.term.shape)
            if each is added or not free or CATALOGUE[each.term.effect].costly:
                continue
            if added is not None and each.term.columns.keys().isdisjoint(added.term.columns):
                continue
            rest = [other for other in state.chosen if other is not each]
            fit = self.fit_of(self.with_causes(state, rest).model)
            moved = self.reshaped(fit, each, again=True)
            if moved is each:
                continue
            order = [moved if other is each else other for other in state.chosen]
            better = self.with_causes(state, order)
            if better.log_posterior > state.log_posterior:
                state = better
        return state

    def _instead(self, state: State) -> State | None:
        """The state with one cause for all that was taken at a joint, where that is likelier."""
        for j in range(self.balances.n):
            here = [h for h in state.chosen if h.term.place.joints[:1] == (j,) and of_torque(h)]
            if not here:
                continue
            rest = [h for h in state.chosen if all(h is not o for o in here)]
            bare = self.possible(self.with_causes(state, rest))
            fit = self.fit_of(bare.model)
            found = [
                *gated(self.balances, fit, (j,)),
                *begun(self.balances, fit, (j,)),
                *nameless(self.balances, fit, (j,)),
            ]
            taken = {h.key for h in here}
            other = self.pool.scored(bare.model) if len(here) > 1 else []
            scored = [
                each
                for each in (*Pool(self.data, found).scored(bare.model), *other)
                if each.hypothesis.key not in taken
                and each.hypothesis.term.place.joints[:1] == (j,)
                and fits_with(each.hypothesis, rest)
            ]
            scored.sort(key=lambda each: -each.log_odds)
            best = self.best(bare.model, scored[: 2 * SERIOUS])
            if (
                best is None
                or best.log_odds
                < state.log_posterior
                - bare.log_posterior
                + self.balances.thresholds.diagnosis.better
            ):
                continue
            new = best.hypothesis
            self.tell(f"{_words(new)} in the place of {', '.join(map(_words, here))}")
            return self.tuned(self.with_causes(bare, [*bare.chosen, new]), new)
        return None

    def _of_pool(self, state: State) -> list[Scored]:
        fit = self.fit_of(state.model)
        found = [*harmonics(self.balances, fit), *pushes(self.balances, fit)]
        more = Pool(self.data, found)
        scored = [*self.pool.scored(state.model), *more.scored(state.model)]
        return sorted(scored, key=lambda each: -each.log_odds)

    def _of_parts(self, state: State) -> list[Scored]:
        fit = self.fit_of(state.model)
        found = [*gated(self.balances, fit), *begun(self.balances, fit)]
        return Pool(self.data, found).scored(state.model)

    def _of_nameless(self, state: State) -> list[Scored]:
        fit = self.fit_of(state.model)
        return Pool(self.data, list(nameless(self.balances, fit))).scored(state.model)

    def rivals_of(
        self, without: State, each: Hypothesis, gone: Collection[TermKey] = ()
    ) -> list[Scored]:
        """What could stand in a cause's place, the likeliest first."""
        taken = {each.key, *gone, *(other.key for other in without.chosen)}
        return [
            scored
            for scored in self.pool.scored(without.model)
            if scored.hypothesis.key not in taken
            and not scored.hypothesis.term.columns.keys().isdisjoint(each.term.columns)
            and fits_with(scored.hypothesis, without.chosen)
        ][:SERIOUS]


def likeliest(states: Sequence[State]) -> State:
    """The likeliest of states of the same study."""
    return max(states, key=lambda state: state.log_posterior)


def _words(hypothesis: Hypothesis) -> str:
    place = hypothesis.term.place
    where = "".join(f" joint {j + 1}" for j in place.joints)
    where += "" if place.link is None else f" link {place.link + 1}"
    return f"{CATALOGUE[hypothesis.term.effect].words}{where}"
