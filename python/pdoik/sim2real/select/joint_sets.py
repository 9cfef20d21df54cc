"""What a joint's torque has of all that machines have, chosen as a set and not one by one.

Dry and viscous friction, Stribeck's, one that grows with the load, an offset and a rotor look alike
one by one: which is taken first decides what is left for the others. Here all sets of them are
weighed for each joint, beside everything else that was found, by the Bayesian information
criterion with as many rows as say something new (Schwarz, Annals of Statistics 6(2), 1978). The
zero of a report stands in the balance of its drive too: both balances are weighed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from ..effects import CATALOGUE
from ..motion.place import Key, Place
from ..regression.background import repeats
from ..regression.fit import Fit, Term, term_of
from ..regression.one_more import OneMore
from ..regression.refine import polished
from ..regression.trial import Search, without
from ..study.recording import FloatArray
from .candidates import same_kind

_SHAPES = 2  # of an effect that are weighed, those that explain most beside the plain ones
_TRIES = 4  # sets that are fitted, the best first, until all that is new in one is clear


def with_joint_sets(state: Search) -> Search:
    """With the best set at every joint that is judged."""
    for j in range(state.balances.n):
        key: Key = ("torque", j)
        if key in state.fit.design and state.balances.excited[j] and len(state.fit.rows[key]):
            state = _at_joint(state, j)
    return state


def _at_joint(state: Search, j: int) -> Search:
    b, place = state.balances, Place(joints=(j,))
    now = [t for t in state.accepted if _is_ordinary(t, place)]
    base = state.without(*now).fit
    pool = _pool(base, now, place)
    weights = _Weights(base, pool, j)
    here, least = {t.key for t in now}, b.thresholds.search.better_set
    limit = weights.cost(pool, [pool.index(t) for t in now]) - least
    costs = [(weights.cost(pool, chosen), chosen) for chosen in _sets(pool)]
    better = sorted((each for each in costs if each[0] < limit), key=lambda each: each[0])
    for chosen in _plain_first(pool, better, least)[:_TRIES]:
        changed = state.fitted([*base.terms, *(pool[i] for i in chosen)])
        changed = polished(changed, {j})
        added = [t for t in changed.accepted if _is_ordinary(t, place) and t.key not in here]
        if all(_is_clear(changed, term) for term in added):
            return changed
    return state


def _plain_first(
    pool: Sequence[Term], better: Sequence[tuple[float, list[int]]], least: float
) -> list[list[int]]:
    """Sets from the best on; of those that nothing tells from the best, the plainest is first."""

    def order(each: tuple[float, list[int]]) -> tuple[float, float]:
        cost, chosen = each
        if cost >= better[0][0] + least:
            return np.inf, cost
        return sum(CATALOGUE[pool[i].effect].complexity for i in chosen), cost

    return [chosen for _, chosen in sorted(better, key=order)]


def _is_clear(state: Search, term: Term) -> bool:
    """Whether the search too would keep it, by its statistic."""
    least = state.balances.thresholds.search
    return without(state, term).t >= least.still_needed * least.least_t


def _is_ordinary(term: Term, place: Place) -> bool:
    """Whether it is of the joint's torque alone, or of what gives it, and of every machine."""
    own = term.columns.keys() & _own(place.joints[0])
    elsewhere = {key[0] for key in term.columns.keys() - own}
    ordinary = CATALOGUE[term.effect].ordinary
    return bool(own) and elsewhere <= {"torque", "base"} and term.place == place and ordinary


def _own(j: int) -> set[Key]:
    """A joint's balances in which its torque stands."""
    return {("torque", j), ("drive", j), ("law", j)}


def _pool(base: Fit, now: Sequence[Term], place: Place) -> list[Term]:
    """What is there, and of every ordinary effect the shapes that explain most."""
    b = base.balances
    pool = list(now)
    for effect in CATALOGUE.values():
        if not effect.ordinary or place not in effect.places(b.motions):
            continue
        terms = [term_of(b, effect, place, shape) for shape in effect.shapes(b.motions, place)]
        made = [t for t in terms if t is not None and _is_ordinary(t, place)]
        if len(made) > _SHAPES:
            made = _clearest(base, made, place)
        shapes = {t.shape for t in pool if t.effect == effect.id}
        pool += [t for t in made if t.shape not in shapes]
    return pool


def _clearest(base: Fit, terms: list[Term], place: Place) -> list[Term]:
    b = base.balances
    plain = [
        term_of(b, each, place, each.shapes(b.motions, place)[0])
        for each in CATALOGUE.values()
        if each.is_plain and each.id != terms[0].effect
    ]
    beside = OneMore(base.extended(*(t for t in plain if t is not None)))
    return sorted(terms, key=beside.gain, reverse=True)[:_SHAPES]


def _sets(pool: Sequence[Term]) -> Iterator[list[int]]:
    """Every set with one shape of an effect at most, and no two that stand for one another."""
    by_effect: dict[str, list[int]] = {}
    for i, term in enumerate(pool):
        by_effect.setdefault(term.effect, []).append(i)

    def grown(effects: list[str], chosen: list[int]) -> Iterator[list[int]]:
        if not effects:
            names = {pool[i].effect for i in chosen}
            if all(_has_company(name, names) for name in names):
                yield chosen
            return
        first, *rest = effects
        yield from grown(rest, chosen)
        if not any(same_kind(first, pool[i].effect) for i in chosen):
            for i in by_effect[first]:
                yield from grown(rest, [*chosen, i])

    yield from grown(list(by_effect), [])


def _has_company(name: str, names: set[str]) -> bool:
    beside = CATALOGUE[name].beside
    return not beside or bool(names & set(beside))


class _Weights:
    """Costs of sets beside a fit whose coefficients stay free."""

    def __init__(self, base: Fit, pool: Sequence[Term], j: int) -> None:
        ends = np.cumsum([0, *(term.width for term in pool)])
        self.spans = [np.arange(a, b) for a, b in pairwise(ends.tolist())]
        keys = sorted(key for key in _own(j) & base.design.keys() if len(base.rows[key]))
        columns = {key: _columns(base, pool, key) for key in keys}
        cross = np.zeros((base.size, ends[-1]))
        for key, C in columns.items():
            if len(base.index[key]):
                cross[base.index[key]] += base.design[key].against(C)
        taken = np.zeros_like(cross)  # by what was there, fitted anew
        if base.size:
            taken = linalg.cho_solve(linalg.cho_factor(base.regular(base.gram)), cross)
        left = {key: base.residual(key) for key in keys}
        gram = np.sum([C.T @ C for C in columns.values()], axis=0) - cross.T @ taken
        self.moment = np.sum([C.T @ left[key] for key, C in columns.items()], axis=0)
        prior = np.concatenate([t.prior for t in pool])
        self.gram = gram + np.diag(prior + 1e-6 * np.diag(gram) + 1e-12)
        whole = np.linalg.solve(self.gram, self.moment)
        self.balances: dict[Key, _Balance] = {}
        for key, C in columns.items():
            if len(base.index[key]):
                C = C - base.design[key] @ taken[base.index[key]]
            rest = left[key] - C @ whole
            same = repeats(base.balances, key, base.rows[key], rest)
            self.balances[key] = _Balance(
                moment=C.T @ left[key],
                gram=C.T @ C,
                noise=max(float(np.mean(rest**2)), 1.0) * same,
                new=len(rest) / same,
            )
        self.prices = [float(np.log(max(self._new(term), 8.0))) for term in pool]

    def _new(self, term: Term) -> float:
        """Rows that say something new, of all balances where a term stands."""
        return sum(each.new for key, each in self.balances.items() if key in term.columns)

    def cost(self, pool: Sequence[Term], chosen: Sequence[int]) -> float:
        """What a set leaves, by the noise, and its price; infinite where it cannot be."""
        if not chosen:
            return 0.0
        index = np.concatenate([self.spans[i] for i in chosen])
        beta = np.linalg.solve(self.gram[np.ix_(index, index)], self.moment[index])
        first, price = 0, 0.0
        for i in chosen:
            effect, width = CATALOGUE[pool[i].effect], len(self.spans[i])
            if not effect.admissible(beta[first : first + width]):
                return np.inf
            price += self.prices[i] * (width + len(effect.free(pool[i].shape)))
            first += width
        here = [each.gain(index, beta) for each in self.balances.values()]
        noise = [each.noise for each in self.balances.values()]
        elsewhere = float(beta @ self.moment[index]) - sum(here)
        return price - float(np.sum(np.divide(here, noise))) - elsewhere / max(noise)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Balance:
    """A joint's own balance, beside what else was found, fitted anew."""

    moment: FloatArray  # (w,) of the pool's columns with what is left
    gram: FloatArray  # (w, w)
    noise: float  # of a row that says something new, squared, in sigmas
    new: float  # rows that do

    def gain(self, index: NDArray[np.intp], beta: FloatArray) -> float:
        """By how much the sum of squares falls with some of the columns."""
        gram = self.gram[np.ix_(index, index)]
        return float(2.0 * beta @ self.moment[index] - beta @ gram @ beta)


def _columns(base: Fit, pool: Sequence[Term], key: Key) -> FloatArray:
    """A pool's columns at a balance, in sigmas, (N, w); zero where a term does not stand."""
    rows, sigma = base.rows[key], base.balances.sigma[key]
    parts = [
        term.columns[key][rows] / sigma
        if key in term.columns
        else np.zeros((len(rows), term.width))
        for term in pool
    ]
    return np.hstack(parts)
