"""What a joint's torque has of all that machines have, chosen as a set and not one by one.

Dry and viscous friction, Stribeck's, one that grows with the load, an offset and a rotor look alike
one by one: which is taken first decides what is left for the others. Here all sets of them are
weighed for each joint, beside everything else that was found, by the Bayesian information
criterion with as many rows as say something new (Schwarz, Annals of Statistics 6(2), 1978).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from scipy import linalg

from ..effects import CATALOGUE
from ..motion.place import Key, Place
from ..regression.background import repeats
from ..regression.fit import Fit, Term, term_of
from ..regression.one_more import OneMore
from ..regression.refine import polished
from ..regression.trial import Search, without
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
    key: Key = ("torque", j)
    now = [t for t in state.accepted if _is_ordinary(t, place)]
    base = state.without(*now).fit
    pool = _pool(base, now, place)
    weights = _Weights(base, pool, key)
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
    """Whether it is of the joint's torque alone, and of every machine."""
    key: Key = ("torque", place.joints[0])
    of_torque = key in term.columns and {each[0] for each in term.columns} <= {"torque", "base"}
    return of_torque and term.place == place and CATALOGUE[term.effect].ordinary


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
        if each.ordinary and each.complexity <= 1 and each.id != terms[0].effect
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

    def __init__(self, base: Fit, pool: Sequence[Term], key: Key) -> None:
        rows, sigma = base.rows[key], base.balances.sigma[key]
        columns = [t.columns[key][rows] / sigma for t in pool]
        ends = np.cumsum([0, *(column.shape[1] for column in columns)])
        self.spans = [np.arange(a, b) for a, b in pairwise(ends.tolist())]
        C, left = np.hstack(columns), base.residual(key)
        gram, self.moment = C.T @ C, C.T @ left
        index = base.index[key]
        if len(index):
            cross = np.zeros((base.size, C.shape[1]))
            cross[index] = base.design[key].against(C)
            factor = linalg.cho_factor(base.regular(base.gram))
            taken = linalg.cho_solve(factor, cross)  # by what was there, fitted anew
            gram = gram - cross.T @ taken
            C = C - base.design[key] @ taken[index]
        prior = np.concatenate([t.prior for t in pool])
        self.gram = gram + np.diag(prior + 1e-6 * np.diag(gram) + 1e-12)
        rest = left - C @ np.linalg.solve(self.gram, self.moment)
        same = repeats(base.balances, key, rows, rest)
        self.noise = max(float(np.mean(rest**2)), 1.0) * same
        self.price = float(np.log(max(len(rows) / same, 8.0)))

    def cost(self, pool: Sequence[Term], chosen: Sequence[int]) -> float:
        """What a set leaves, by the noise, and its price; infinite where it cannot be."""
        if not chosen:
            return 0.0
        index = np.concatenate([self.spans[i] for i in chosen])
        beta = np.linalg.solve(self.gram[np.ix_(index, index)], self.moment[index])
        first, figures = 0, 0
        for i in chosen:
            effect, width = CATALOGUE[pool[i].effect], len(self.spans[i])
            if not effect.admissible(beta[first : first + width]):
                return np.inf
            figures += width + len(effect.free(pool[i].shape))
            first += width
        return float(-beta @ self.moment[index]) / self.noise + self.price * figures
