"""Which properties differ: terms taken up one by one by what they gain where they were not learnt.

All of it is algebra of normal equations about one candidate; `explain` simulates in between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.stats import norm

from ..study.recording import FloatArray
from ..thresholds.simulators import SimulatorThresholds
from .blocks import Blocks, t_of
from .candidates import Knob, Term
from .property import EVERY

ORDINARY = ("damping", "frictionloss", "armature", "delay")
"""What every machine has more of than its model: taken first unless another is clearly better."""

MOST = 60  # terms
_AGAIN = 3  # rounds of adding and trying anew
_UNLIKE = 0.3  # cosine below which two terms cannot stand for each other
_SAME = 0.999  # cosine from which two terms are one torque


@dataclass(frozen=True, slots=True, kw_only=True)
class Rival:
    """Another term that explains the same data as well as a chosen one."""

    term: Term
    probability: float  # of being the better one of the two
    same: bool  # the same torque under another name: no motion could decide


class Selection:
    """Chooses among terms in one linearisation."""

    def __init__(
        self,
        blocks: Blocks,
        knobs: Sequence[Knob],
        terms: Sequence[Term],
        limits: SimulatorThresholds,
    ) -> None:
        """Terms whose columns show nothing are left out."""
        self.blocks, self.limits = blocks, limits
        place = {knob: p for p, knob in enumerate(knobs)}
        seen = np.einsum("bpp->p", blocks.G) > 1.0
        self.terms = tuple(t for t in terms if all(seen[place[k]] for k in t.knobs))
        self._of = {term: tuple(place[k] for k in term.knobs) for term in terms}

    def places(self, terms: Sequence[Term]) -> list[int]:
        """Knobs of the terms, each once."""
        return list(dict.fromkeys(p for term in terms for p in self._of[term]))

    def choose(self, start: Sequence[Term]) -> tuple[Term, ...]:
        """What does not hold is dropped, terms are added one by one, then each is tried anew."""
        chosen = self._pruned([term for term in start if term in self.terms])
        for _ in range(_AGAIN):
            while len(chosen) < MOST and (better := self._added(chosen)) is not None:
                chosen = better
            swapped = self._pruned(self._swapped(chosen))
            if set(swapped) == set(chosen):
                break
            chosen = swapped
        return tuple(chosen)

    def rivals(self, chosen: Sequence[Term], term: Term) -> tuple[Rival, ...]:
        """Terms that in the place of a chosen one explain the blocks as well, best first."""
        others = [each for each in chosen if each != term]
        mine = self._loss(chosen)
        found = []
        for rival in self.terms:
            if rival in chosen or self._likeness(rival, term) < _UNLIKE:
                continue
            worse = t_of(self._loss([*others, rival]) - mine)
            if worse < self.limits.apart_t:
                same = self._likeness(rival, term) > _SAME
                found.append(Rival(term=rival, probability=float(norm.sf(worse)), same=same))
        return tuple(sorted(found, key=lambda each: -each.probability))

    def _likeness(self, rival: Term, term: Term) -> float:
        """The largest cosine between what their knobs show."""
        total = self.blocks.G.sum(axis=0)
        a, b = list(self._of[rival]), list(self._of[term])
        size = np.sqrt(np.outer(np.diag(total)[a], np.diag(total)[b]))
        return float((np.abs(total[np.ix_(a, b)]) / size).max())

    def _loss(self, chosen: Sequence[Term]) -> FloatArray:
        return self.blocks.foreseen(self.places(chosen))

    def _added(self, chosen: list[Term]) -> list[Term] | None:
        before = self._loss(chosen)
        total = float(before.sum())
        best: dict[bool, tuple[float, Term]] = {}  # whether it is ordinary
        for term in self.terms:
            if term in chosen or set(self._of[term]) <= set(self.places(chosen)):
                continue
            if _is_redundant([*chosen, term]):
                continue
            if not self._is_shared(chosen, term):
                continue
            gains = before - self._loss([*chosen, term])
            gain = float(gains.sum()) / len(term.knobs)
            if t_of(gains) < self._least_t or float(gains.sum()) < self.limits.least_gain * total:
                continue
            kind = term.name in ORDINARY
            if kind not in best or gain > best[kind][0] * (1.0 + 1e-3):  # of two alike the first
                best[kind] = (gain, term)
        if not best:
            return None
        first = max(best.values(), key=lambda each: each[0])[1]
        if first.name not in ORDINARY and True in best:
            usual = best[True][1]
            if (
                t_of(self._loss([*chosen, usual]) - self._loss([*chosen, first]))
                < self.limits.apart_t
            ):
                first = usual
        return [*chosen, first]

    def _is_shared(self, chosen: list[Term], term: Term) -> bool:
        """Whether what all joints have alike does about as much as each joint's own figure."""
        if term.indices != {EVERY}:
            return True
        others = [each for each in chosen if each.name != term.name]
        apart = [each for each in self.terms if each.name == term.name and each != term]
        without = float(self._loss(others).sum())
        together = without - float(self._loss([*others, term]).sum())
        most = without - float(self._loss([*others, *apart]).sum())
        return together >= self.limits.alike_in_all * most

    def _one_for_all(self, chosen: list[Term]) -> list[Term] | None:
        """One figure of all joints in the place of several joints' own, unless clearly worse."""
        now = self._loss(chosen)
        for term in self.terms:
            own = [each for each in chosen if each.name == term.name]
            if term.indices != {EVERY} or term in own or len(own) < 2:
                continue
            fewer = [*(each for each in chosen if each not in own), term]
            worse = t_of(self._loss(fewer) - now)
            if worse < self.limits.apart_t and self._is_shared(fewer, term):
                return fewer
        return None

    def _one_for_two(self, chosen: list[Term]) -> list[Term] | None:
        """A factor of gains, or one of the gains, in the place of two terms, unless clearly worse.

        kp and damping of one drive may stand for the factor, the factor and damping for kp.
        """
        now = self._loss(chosen)
        for a, b in combinations(chosen, 2):
            others = [each for each in chosen if each not in (a, b)]
            for one in self.terms:
                if one in chosen or not _is_of_one_drive(one, a, b):
                    continue
                if min(self._likeness(one, a), self._likeness(one, b)) < _UNLIKE:
                    continue
                if t_of(self._loss([*others, one]) - now) < self.limits.apart_t:
                    return [*others, one]
        return None

    @property
    def _least_t(self) -> float:
        """As many hypotheses are tried, the best of them must be better than chance's best."""
        return float(norm.isf(self.limits.false_alarms / max(len(self.terms), 1)))

    def _swapped(self, chosen: list[Term]) -> list[Term]:
        """Each term against those like it; only a clearly better one takes its place."""
        shared = [term for term in chosen if self._is_shared(chosen, term)]
        if len(shared) < len(chosen):
            return shared
        if (fewer := self._one_for_all(chosen) or self._one_for_two(chosen)) is not None:
            return fewer
        now = self._loss(chosen)
        for term in chosen:
            others = [each for each in chosen if each != term]
            for rival in self.terms:
                if rival in chosen or self._likeness(rival, term) < _UNLIKE:
                    continue
                if len(rival.knobs) > len(term.knobs) or _is_redundant([*others, rival]):
                    continue
                loss = self._loss([*others, rival])
                gained = float((now - loss).sum()) / float(now.sum())
                if gained > self.limits.least_gain and t_of(now - loss) > self.limits.apart_t:
                    now, chosen = loss, [*others, rival]
                    break
        return chosen

    def _pruned(self, chosen: list[Term]) -> list[Term]:
        while chosen:
            with_all = self._loss(chosen)
            gains = {
                term: self._loss([each for each in chosen if each != term]) - with_all
                for term in chosen
            }
            weakest = min(chosen, key=lambda term: t_of(gains[term]))
            if t_of(gains[weakest]) >= self.limits.apart_t:
                break
            chosen = [each for each in chosen if each != weakest]
        return chosen


def _is_redundant(terms: Sequence[Term]) -> bool:
    """Whether a factor is among them with a gain that it turns: kp and kv say the same alone."""
    return any(one.is_made_of(other) for one in terms for other in terms)


def _is_of_one_drive(*terms: Term) -> bool:
    """Whether one of them is a factor of another's gain, all at one joint."""
    if len({term.indices for term in terms}) > 1:
        return False
    return any(one.is_made_of(other) for one in terms for other in terms)
