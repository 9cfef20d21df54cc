"""What a motion is expected to settle: likelihood ratios, and the confidence after it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..findings import Support
from ..identify import confidence_of
from ..thresholds import Thresholds

Pair = tuple[str, str]  # a finding and its rival, in words

NOTHING = 1.0  # numerics:
"""Log likelihood ratio that says nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rivalry:
    """A cause and one that may be there instead, along one motion.

    A ratio is the expected log of the likelihood of the true cause over that of the other, whose
    figures are what fits best, as are those of all that is ordinary.
    """

    rival: str  # in words
    listed: bool  # by the diagnosis as explaining the same
    if_own: float  # ratio where the finding is true
    if_rival: float  # ratio where the rival is true; inf where its figures are not known
    level: float  # log odds within which the diagnosis lists the other together with the true one

    @property
    def ratio(self) -> float:
        """The less of the two."""
        return min(self.if_own, self.if_rival)

    @property
    def clear(self) -> float:
        """Times what is asked of a name, so that the diagnosis lists the other no more."""
        return self.ratio / self.level


@dataclass(frozen=True, slots=True, kw_only=True)
class Prospect:
    """What is expected of one finding after a motion."""

    finding: str  # in words
    why: str  # what is open
    confidence_before: float  # as stated, shared with the names that are listed with it
    gain: float  # share of what is left that it explains where it acts
    rivalries: tuple[Rivalry, ...]
    confidence: float  # expected after, on the careful side

    @property
    def ratio(self) -> float:
        """Ratio of the rival that is distinguished least well; inf without any."""
        return min((each.ratio for each in self.rivalries), default=np.inf)


def clarity(
    prospect: Prospect, limits: Thresholds, hopeless: frozenset[Pair] = frozenset()
) -> tuple[float, float]:
    """How far a motion settles a finding: 1 for just so, the least and the mean of its parts.

    What is more than enough counts by its logarithm. What is only often confused with the finding
    counts in the mean, and what no motion distinguishes from it counts nowhere.
    """
    asked = limits.propose
    seen = _odds(prospect.gain) / _odds(asked.gain)
    open_ = [each for each in prospect.rivalries if (prospect.finding, each.rival) not in hopeless]
    parts = np.log2(1.0 + np.array([seen, *(each.ratio / asked.decisive for each in open_)]))
    listed = np.array([True, *(each.listed for each in open_)])
    return float(parts[listed].min()), float(parts.mean())


def hopeless_of(motions: Sequence[tuple[Prospect, ...]]) -> frozenset[Pair]:
    """Pairs that no motion distinguishes: a rotor, and a link's inertia about its axis."""
    best: dict[Pair, float] = {}
    for prospects in motions:
        for prospect in prospects:
            for each in prospect.rivalries:
                pair = prospect.finding, each.rival
                best[pair] = max(best.get(pair, 0.0), each.ratio)
    return frozenset(pair for pair, ratio in best.items() if ratio < NOTHING)


def expected_confidence(
    support: Support | None, rivalries: tuple[Rivalry, ...], limits: Thresholds
) -> float:
    """Confidence of a name: that it is there, times the odds against every other name.

    Ratios are held to fall short by `propose.doubt` of their standard deviations: a log ratio of
    mean m has a variance of 2 m. A rival that stays level counts as likely as the finding.
    """
    odds = 0.0
    for each in rivalries:
        careful = max(each.ratio - limits.propose.doubt * np.sqrt(2.0 * each.ratio), 0.0)
        level = careful <= each.level
        odds += 1.0 if level and each.listed else float(np.exp(-min(careful, 500.0)))
    there = 0.0 if support is None else confidence_of(limits, support)
    return float(there / (1.0 + odds))


def _odds(share: float) -> float:
    return share / max(1.0 - share, 1e-9)
