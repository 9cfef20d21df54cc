"""Hypotheses, and what they gain on rows that were held out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..effects import CATALOGUE
from ..findings import Support
from ..motion.balances import Balances
from ..motion.place import Key
from ..study.recording import FloatArray
from ..thresholds.search import SearchThresholds
from .fit import Fit, Term, TermKey
from .wald import wald


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial:
    """A hypothesis and how it did on held-out rows."""

    term: Term
    gain: float  # sum over held-out rows, in squared sigmas, the prior's relief included
    t: float  # its mean over blocks by the standard error
    size: float  # root mean square in sigmas on the rows where it acts, see `_of_balances`
    share: float  # of the mean square that its channels began with, likewise
    of_rest: float  # of the mean square that was left where it acts, likewise
    rows: int  # on which it acts
    blocks: FloatArray  # gain of each block
    thresholds: SearchThresholds

    @property
    def significant(self) -> bool:
        """Whether the gain is real and large enough to matter."""
        least = self.thresholds
        return (
            self.t >= least.least_t
            and self.size >= least.least_size
            and self.share >= least.least_share
            and self.of_rest >= least_of_rest(least, self.term)
            and (self.rows >= least.few_rows or self.gain >= least.least_in_few)
        )

    @property
    def needed(self) -> bool:
        """Whether an accepted term still earns its place beside those accepted after it."""
        least, share = self.thresholds, self.thresholds.still_needed
        return self.t >= share * least.least_t and self.size >= share * least.least_size


def least_of_rest(thresholds: SearchThresholds, term: Term) -> float:
    """Share of what is left that a term must explain where it acts."""
    return max(thresholds.least_of_rest, CATALOGUE[term.effect].least_of_rest)


@dataclass(frozen=True, kw_only=True, eq=False)
class Search:
    """What a stage hands to the next: what is accepted, and all that was tried.

    Nothing in it changes: a stage returns another.
    """

    balances: Balances
    nuisance: tuple[Term, ...]
    fit: Fit
    start: Fit
    contacts: tuple[Term, ...] = ()
    dropped: Mapping[TermKey, int] = field(default_factory=dict)  # how often, needless later
    tried: tuple[Trial, ...] = ()
    level: Mapping[TermKey, tuple[Trial, ...]] = field(default_factory=dict)  # rivals of accepted
    simulated: Mapping[TermKey, dict[str, float]] = field(default_factory=dict)  # figures
    confirmed: frozenset[TermKey] = frozenset()  # by simulations
    support: Mapping[TermKey, Support] = field(default_factory=dict)  # by left-out sessions
    peculiar: Search | None = None  # what was found beside the background, with it

    @property
    def accepted(self) -> tuple[Term, ...]:
        """Terms accepted so far."""
        return self.fit.terms[len(self.nuisance) :]

    def fitted(self, terms: Sequence[Term]) -> Search:
        """With these terms, the nuisance's among them, and no others."""
        return replace(self, fit=Fit(self.balances, terms))

    def without(self, *terms: Term) -> Search:
        """Without some of the accepted terms."""
        return replace(self, fit=self.fit.without(*terms))


def level(best: Trial, other: Trial) -> bool:
    """Whether held-out rows cannot tell the other from the best."""
    if other is best:
        return True
    difference = best.blocks - other.blocks
    total = float(difference.sum())
    least = best.thresholds
    if total < least.tie_size**2 * max(best.rows, other.rows):
        return True
    used = difference[(best.blocks != 0.0) | (other.blocks != 0.0)]
    error = float(np.std(used) * np.sqrt(len(used))) if len(used) > 1 else np.inf
    return total < least.tie * best.gain and total < least.tie_error * error


def held_out_squares(fit: Fit) -> dict[Key, FloatArray]:
    """Squared held-out residuals of a fit by key."""
    return {key: left**2 for key, left in fit.held_out().items()}


def cross_validated(
    state: Search, term: Term, held: dict[Key, FloatArray], base: Fit | None = None
) -> Trial:
    """Gain of a term on rows held out."""
    base = state.fit if base is None else base
    least = base.balances.thresholds.search
    wider = base.extended(term)
    squares = held_out_squares(wider)
    blocks = base.by_block({key: held[key] - squares[key] for key in squares})
    relief = base.penalty() - (wider.penalty() - _own_penalty(wider, term))
    active_rows, acting = activity(base, term)
    t, coefficient = wald(wider, term)
    gain = float(blocks.sum())
    if not _may_be(base, wider, term, coefficient):
        t = 0.0
    elif relief > least.least_relief * base.balances.repeats and gain > -0.2 * relief:
        gain, t = gain + relief, max(t, least.least_t)  # the prior asks for it
    own = {key: float(np.sum(held[key] - squares[key])) for key in term.columns}
    rows = {key: float(np.sum(each)) for key, each in acting.items()}
    began = {key: float(np.sum(state.start.target[key][acting[key]] ** 2)) for key in own}
    rest = {key: float(np.sum(held[key][acting[key]])) for key in own}
    return Trial(
        term=term,
        gain=gain,
        t=t,
        size=float(np.sqrt(max(_of_balances(gain, own, rows), 0.0))),
        share=_of_balances(gain, own, began),
        of_rest=_of_balances(gain, own, rest),
        rows=active_rows,
        blocks=blocks,
        thresholds=least,
    )


def _of_balances(gain: float, gains: dict[Key, float], of: dict[Key, float]) -> float:
    """A gain over what there is of something, each balance by what is gained there.

    An IMU's zero is plain in its gyro, whatever friction is left in torques where it hardly shows.
    """
    better = {key: each for key, each in gains.items() if each > 0.0}
    whole = sum(better.values())
    if whole <= 0.0:
        return gain / max(sum(of.values()), 1e-12)
    return gain * sum(each**2 / max(of[key], 1e-12) for key, each in better.items()) / whole**2


def _own_penalty(fit: Fit, term: Term) -> float:
    if term.fixed:
        return 0.0
    beta = fit.beta[-term.width :]
    return float(np.sum(term.prior * beta**2))


def _may_be(base: Fit, wider: Fit, term: Term, coefficient: float) -> bool:
    """Whether a term may be what it is said to be, however much it gains."""
    effect, least = CATALOGUE[term.effect], base.balances.thresholds.search
    if term.fixed:  # where the data want another multiple of it, it is something else
        possible = least.fixed_from < coefficient < least.fixed_to
    else:
        possible = effect.admissible(wider.beta[-term.width :])
    # Where it acts on rows that do not count, it only rings into those that do.
    inside = _inside(base, term) >= least.least_inside
    return possible and inside and effect.plausible(base.balances.motions, term.place, term.shape)


def _inside(fit: Fit, term: Term) -> float:
    """Share of a term's squared column on the rows that count."""
    inside = whole = 0.0
    for key, column in term.columns.items():
        if len(fit.rows[key]):
            inside += float(np.sum(column[fit.rows[key]] ** 2)) / fit.balances.sigma[key] ** 2
            whole += float(np.sum(column**2)) / fit.balances.sigma[key] ** 2
    return inside / max(whole, 1e-300)


def activity(fit: Fit, term: Term) -> tuple[int, dict[Key, NDArray[np.bool_]]]:
    """On how many rows a term acts, and which."""
    count = 0
    acting: dict[Key, NDArray[np.bool_]] = {}
    for key, column in term.columns.items():
        part = column[fit.rows[key]]
        if not len(part):  # a joint at rest throughout
            acting[key] = np.zeros(0, dtype=np.bool_)
            continue
        scale = np.sqrt(np.mean(part**2, axis=0)) + 1e-300
        energy = np.sum((part / scale) ** 2, axis=1)
        acting[key] = energy > 0.05 * energy.mean()
        count += int(acting[key].sum())
    return count, acting


def without(state: Search, term: Term) -> Trial:
    """What an accepted term gains on held-out rows beside all the others."""
    others = state.without(term).fit
    return cross_validated(state, term, held_out_squares(others), others)
