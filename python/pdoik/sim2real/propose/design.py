"""The search for a motion: many recipes at random, then the best of them changed part by part."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from .clear import Clear
from .excitation import Frame, Recipe, changed, first_recipes, motion_of, random_recipe
from .expected import Pair, Prospect, hopeless_of
from .figures import Figure, known_better
from .limits import Limits
from .path import Path
from .predict import Predict, Run
from .weigh import Weigher

_FIRST = 0.4  # numerics: of the effort, for recipes at random
_KEPT = 4  # recipes that are changed
_CLOSER = 3  # of the best that are looked at with what is costly
_SHRINKS = 6
_FELL = 1.3  # excess of a motion that is not possible at all

Say = Callable[[str, float], None]


@dataclass(frozen=True, kw_only=True, eq=False)
class Design:
    """A motion and what it is expected to settle."""

    drawn: Path  # in the coordinates that motions are drawn in
    run: Run
    prospects: tuple[Prospect, ...]
    figures: tuple[Figure, ...] = ()  # of all joints, where these are what is asked
    looked_at: int = 1  # motions
    hopeless: frozenset[Pair] = frozenset()  # pairs that none of these distinguishes


@dataclass(frozen=True, kw_only=True, eq=False)
class Bounds:
    """What every motion must hold, and how a motion is made to."""

    weigher: Weigher
    predict: Predict
    limits: Limits  # of the joints, to design within
    frame: Frame  # that motions are drawn in
    clear: Clear | None

    def made(self, drawn: Path, *, costly: bool = False) -> Design | None:
        """A path within all limits, with what it would show; None where shrinking does not help."""
        if self.clear is not None and self.predict.may_be_led:
            drawn = self.clear.fitted(drawn, self.frame.start)
        for _ in range(_SHRINKS):
            run = self.predict.run(drawn)
            excess = self._excess(run)
            if excess <= 1.0 and run.balances is not None:
                if not self.weigher.questions:
                    known = self.weigher.figures(run.balances)
                    return Design(drawn=drawn, run=run, prospects=(), figures=known)
                prospects = self.weigher.prospects(run.balances, costly=costly)
                return Design(drawn=drawn, run=run, prospects=prospects)
            drawn = drawn.toward(self.frame.start, max(0.5, 0.9 / excess))
        return None

    def _excess(self, run: Run) -> float:
        """Largest part of what it may be of anything; more than 1 where the robot would fall."""
        if run.balances is None:
            return _FELL
        if self.clear is not None and not self.predict.may_be_led and self.clear.is_near(run.path):
            return _FELL
        return self.limits.excess(run.path, run.torque)


def designed(
    bounds: Bounds, rng: np.random.Generator, effort: int, seconds: float, say: Say
) -> Design | None:
    """The best motion found; None where none holds the limits.

    Args:
        bounds: of every motion.
        rng: of the recipes.
        effort: motions that are looked at, at most.
        seconds: that the search may take, about.
        say: called with words and the share of the effort that is done.
    """
    planned, ranking = first_recipes(rng), _Ranking(weigher=bounds.weigher)
    begin, count = time.perf_counter(), 0
    while count < effort and time.perf_counter() - begin < seconds:
        share = max(count / effort, (time.perf_counter() - begin) / seconds)
        first = bool(planned)
        if first:
            recipe = planned.pop(0)
        elif share < _FIRST or not ranking.best:
            recipe = random_recipe(rng)
        else:
            place = min(int(rng.exponential(1.0)), len(ranking.best) - 1)
            recipe = changed(ranking.best[place][1], rng)
        made = bounds.made(motion_of(recipe, bounds.frame))
        count += 1
        if made is not None and ranking.add(recipe, made, first=first):
            say(f"{count} motions looked at, clarity {ranking.best[0][0]:.2f}", share)
    looked = [
        found
        for _, _, made in ranking.best[:_CLOSER]
        if (found := bounds.made(made.drawn, costly=True))
    ]
    if not looked:
        return None
    chosen = max(looked, key=lambda each: ranking.score(each))
    for each in looked:
        ranking.note(each)
    return replace(chosen, looked_at=count, hopeless=ranking.hopeless | ranking.still_listed)


@dataclass(kw_only=True, eq=False)
class _Ranking:
    """The best motions so far, by what is not hopeless: pairs no planned recipe distinguishes."""

    weigher: Weigher
    best: list[tuple[float, Recipe, Design]] = field(default_factory=list)
    hopeless: frozenset[Pair] = frozenset()
    clearest: dict[Pair, float] = field(default_factory=dict)

    def score(self, design: Design) -> float:
        """Score of one design; higher is better."""
        if not self.weigher.questions:
            return known_better(design.figures)
        return self.weigher.score(design.prospects, self.hopeless)

    def add(self, recipe: Recipe, design: Design, *, first: bool) -> bool:
        """Whether a motion is the best so far; `first` for one of the planned recipes."""
        found = [*self.best, (0.0, recipe, design)]
        if first:  # as different as can be: what none of them distinguishes, no motion does
            self.hopeless = hopeless_of([each.prospects for _, _, each in found])
        self.note(design)
        scored = [(self.score(each), name, each) for _, name, each in found]
        scored.sort(key=lambda each: -each[0])
        self.best = scored if first else scored[:_KEPT]
        return scored[0][2] is design

    def note(self, design: Design) -> None:
        """Note how clearly a motion distinguishes what the diagnosis lists together."""
        for prospect in design.prospects:
            for each in prospect.rivalries:
                if each.listed:
                    pair = prospect.finding, each.rival
                    self.clearest[pair] = max(self.clearest.get(pair, 0.0), each.clear)

    @property
    def still_listed(self) -> frozenset[Pair]:
        """Pairs that the diagnosis would list side by side after each of these motions, too."""
        return frozenset(pair for pair, clear in self.clearest.items() if clear <= 1.0)
