"""What a log has beyond a simulator: properties fitted by simulating candidates, and judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit
from scipy.stats import t as student

from ..simulation.stepper import SimulationError
from ..study.recording import FloatArray, Recording
from ..thresholds.simulators import SimulatorThresholds
from .blocks import t_of
from .candidates import Knob, Term, Values, baseline, terms_of
from .experiment import Experiment
from .fits import cost, fitted, lines, noise_of
from .follows import check_follows
from .rounds import is_unreal, searched
from .selection import Rival, Selection
from .sensitivities import Sensitivities, knobs_of
from .user_model import UserModel
from .vocabulary import PROPERTIES

Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Explained:
    """What was chosen and how well it does; arrays of channels are (C,)."""

    user: UserModel
    terms: tuple[Term, ...]  # all that differ, or may
    kept: tuple[Term, ...]  # those that hold on held-out data, be it under another name
    values: dict[Knob, float]  # of all terms, fitted together
    patch: dict[Knob, float]  # of those kept, fitted without the others
    alone: dict[Knob, float]  # of those whose names are believed, fitted without the others
    std: dict[Knob, float]
    rivals: dict[Term, tuple[Rival, ...]]
    gains: dict[Term, FloatArray]  # of each held-out block, (B,): less loss than without it
    share: dict[Term, float]  # of the squared held-out error that it takes away, where most
    shows: dict[Term, float]  # what it changes over the least that counts, where most
    sigma: FloatArray  # by which errors are weighed
    noise: FloatArray  # white noise of each channel
    of_step: FloatArray  # root mean square of what the simulator's own step does to each
    blocks: int  # of time that figures were fitted to
    held_out: Experiment
    before: FloatArray  # (R, C) held-out, of the user's model
    after: FloatArray  # (R, C) held-out, with the patch

    def there(self, term: Term) -> float:
        """Probability that held-out data are better explained with a term than without."""
        gains = self.gains[term]
        if not np.isfinite(gains).all():
            return 1.0  # the model is unstable without it
        return float(student.cdf(t_of(gains), max(len(gains) - 1, 1)))

    def holds(self, term: Term, limits: SimulatorThresholds) -> bool:
        """Whether it is believed to be there, and matters; by whatever name."""
        return self.there(term) >= limits.least_confidence and self.shows[term] >= 1.0

    def claims(self, term: Term, limits: SimulatorThresholds) -> bool:
        """Whether its name is believed too."""
        sure = self.confidence(term, limits) >= limits.least_confidence
        return sure and self.holds(term, limits)

    def confidence(self, term: Term, limits: SimulatorThresholds) -> float:
        """Probability that a term is there, and none of its rivals in its place.

        It is no larger than the share of findings that were true of machines with more to them
        than their simulator has words for, at the same gain: what takes away little of the error
        may stand for a part of what is left.
        """
        rivals = [each for each in self.rivals[term] if not each.same]
        odds = sum(each.probability / (1.0 - min(each.probability, 0.99)) for each in rivals)
        gain = float(np.clip(self.share[term], 1e-4, 1.0 - 1e-4))
        log_odds = limits.base + limits.per_gain * np.log(gain / (1.0 - gain))
        return min(self.there(term) / (1.0 + odds), float(expit(log_odds)))


def explain(
    user: UserModel,
    fit: Sequence[Recording],
    validate: Sequence[Recording],
    limits: SimulatorThresholds,
    tell: Tell | None = None,
    *,
    same_step: bool = False,
) -> Explained:
    """Find what must be changed in a model so that it does what the recordings show.

    Args:
        user: the model.
        fit: recordings to choose and fit by.
        validate: recordings that only judge.
        limits: what is believed.
        tell: called with what was found so far, in words.
        same_step: whether the recordings were simulated with the model's own step.

    Raises:
        SimulationError: the model as it is is unstable under the commands.
        ValueError: commands are missing.
    """
    say = tell or (lambda text: None)
    experiment, held_out = Experiment(user, fit), Experiment(user, validate)
    noise = noise_of(experiment)
    if not same_step:
        experiment.allow_for_step({})
    check_follows(experiment, limits)
    found = searched(experiment, noise, limits, say, same_step=same_step)
    chosen, values, scales = found.chosen, found.values, found.scales
    knobs = knobs_of(terms_of(user))
    if not same_step:
        experiment.allow_for_step(values)
        held_out.allow_for_step(values)
    about, sigma, blocks = lines(experiment, values, knobs, scales, noise)
    selection = Selection(blocks, knobs, found.terms, limits)
    seen = tuple(term for term in chosen if term in selection.terms)
    if seen != chosen:  # beside the others it shows nothing any more, so it is in no patch
        chosen, values = seen, fitted(experiment, about, blocks, seen, sigma, scales)
    judged = _judged(selection, about, chosen, values, sigma, noise, experiment, held_out)
    kept = tuple(t for t in chosen if judged.holds(t, limits) and not is_unreal(t, values))
    if len(kept) < len(chosen):
        say(f"{len(chosen) - len(kept)} of them do not hold on held-out data")
        values = fitted(experiment, about, blocks, kept, sigma, scales)
        after = held_out.run(values, as_it_is=True)
        judged = replace(judged, kept=kept, patch=values, alone=values, after=after)
    sure = tuple(term for term in kept if judged.claims(term, limits))
    if len(sure) == len(kept):
        return judged
    return replace(judged, alone=fitted(experiment, about, blocks, sure, sigma, scales))


def _share(measured: FloatArray, without: FloatArray, with_it: FloatArray) -> float:
    """Of a channel's squared error that a term takes away, of the channel where it is most."""
    if not np.isfinite(without).all():
        return 1.0
    left = ((measured - with_it) ** 2).sum(axis=0)
    before = np.maximum(((measured - without) ** 2).sum(axis=0), 1e-300)
    return float(np.max(1.0 - left / before))


def _shows(
    change: FloatArray,
    noise: FloatArray,
    term: Term,
    values: Values,
    user: UserModel,
    limits: SimulatorThresholds,
) -> float:
    """How much a term changes, over the least that counts, where most.

    It must be seen above noise, and be larger than what a step feigns: a torque that is held for a
    period T acts T/2 late, which looks like damping of -kp T/2 and an armature of -kd T/2.

    Args:
        change: of the motion, (R, C); infinite where the model is unstable without the term.
        noise: of each channel, (C,).
        term: what is judged.
        values: of its knobs, and of others.
        user: whose model.
        limits: what counts.
    """
    if not np.isfinite(change).all():
        return np.inf
    seen = np.sqrt(np.mean(change**2, axis=0)) / (limits.shows * noise)
    sizes = [
        abs(values[knob] - baseline(user, knob)) / (limits.of_step * feigned)
        for knob in term.knobs
        if knob in values and (feigned := PROPERTIES[knob.property].feigned(user, knob.index)) > 0.0
    ]
    return float(min([seen.max(), *sizes]))


def _judged(
    selection: Selection,
    about: Sensitivities,
    chosen: tuple[Term, ...],
    values: Values,
    sigma: FloatArray,
    noise: FloatArray,
    experiment: Experiment,
    held_out: Experiment,
) -> Explained:
    """Errors, rivals, and each term left out in turn on data that nothing was learnt from.

    Without it the others are as straight lines have them, or as they were with it: whatever does
    better on what was learnt from, for a poor fit of the others is no merit of the term.
    """
    blocks = selection.blocks
    places = selection.places(chosen)
    x = np.zeros(len(about.knobs))
    x[places] = about.at[places]
    covariance = blocks.covariance(places, x)
    std = {
        about.knobs[p]: about.std_of(p, float(np.sqrt(covariance[i, i])))
        for i, p in enumerate(places)
    }
    before = held_out.run({}, as_it_is=True)
    after = held_out.run(values, as_it_is=True)
    with_values = held_out.run(values)
    of_step = np.sqrt(np.mean((with_values - after) ** 2, axis=0))
    user, limits = held_out.user, selection.limits
    count = int(held_out.block.max()) + 1

    def loss(shown: FloatArray) -> FloatArray:
        squares = (((held_out.measured - shown) / sigma) ** 2).sum(axis=1)
        return np.bincount(held_out.block, squares, minlength=count).astype(np.float64)

    with_all = loss(with_values)
    gains, share, shows = {}, {}, {}
    for term in chosen:
        others = [each for each in chosen if each != term]
        lines = about.values(blocks.solve(selection.places(others)))
        fewer = {k: v for k, v in values.items() if any(k in each.knobs for each in others)}
        without = min(lines, fewer, key=lambda each: cost(experiment, each, sigma))
        try:
            shown = held_out.run(without)
        except SimulationError:
            shown = np.full_like(with_values, np.inf)
        left = loss(shown)
        shows[term] = _shows(shown - with_values, noise, term, values, user, limits)
        gains[term], share[term] = left - with_all, _share(held_out.measured, shown, with_values)
    return Explained(
        user=held_out.user,
        terms=chosen,
        kept=chosen,
        values=dict(values),
        patch=dict(values),
        alone=dict(values),
        std=std,
        rivals={term: selection.rivals(chosen, term) for term in chosen},
        gains=gains,
        share=share,
        shows=shows,
        sigma=sigma,
        noise=noise,
        of_step=of_step,
        blocks=len(blocks.c),
        held_out=held_out,
        before=before,
        after=after,
    )
