"""What a log has beyond a simulator: all that a drive has fitted together, what differs judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit
from scipy.stats import norm
from scipy.stats import t as student

from pdoik.recordings import FloatArray, Recording

from ..findings import Estimate
from ..simulation import SimulationError
from ..thresholds import SimulatorThresholds
from .candidates import ParameterId, Term, Values, baseline, terms_of
from .choice import Choice, Rival, is_ordinary
from .climb import Climb, Mask
from .common_figures import with_common_figures
from .experiment import Experiment
from .follows import check_follows
from .parameters import Parameter, parameters_of
from .scales import noise_of, scales_of
from .user_model import UserModel
from .vocabulary import PROPERTIES

Tell = Callable[[str], None]

_SHORT, _BRIEF, _FEW = 0.6, 30.0, 3000  # of runs, of all of them [s], their rows: to begin with
_LATE = ("filter", "delay")  # about none of which lines are of little use
_NOTHING = 1e-3  # numerics: of what is believed of a coordinate, that is no change
_ROUNDS = 4  # of choosing, and of fitting what was chosen
_BEGIN, _ALL, _CHOSEN, _LAST = (10, 5.0), (16, 1.0), (8, 0.5), (4, 0.5)
"""Steps of a climb at most, and what one of them must gain in log posterior: in short runs, of all
ordinary parameters, of what was chosen, and of what is kept."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Explained:
    """What was chosen and how well it does; arrays of channels are (C,)."""

    user: UserModel
    terms: tuple[Term, ...]  # all that differ, or may
    kept: tuple[Term, ...]  # those that the patch has
    values: dict[ParameterId, float]  # of all terms, fitted together
    patch: dict[ParameterId, float]  # of those kept, fitted without the others
    alone: dict[ParameterId, float]  # of those whose names are believed, fitted without the others
    parameters: dict[ParameterId, Parameter]  # of all terms
    std: dict[ParameterId, float]  # of their coordinates
    rivals: dict[Term, tuple[Rival, ...]]
    gains: dict[Term, FloatArray]  # of each held-out block, (B,): less loss than without it
    share: dict[Term, float]  # of the squared held-out error that it takes away, where most
    shows: dict[Term, float]  # what it changes over the least that counts, where most
    sigma: FloatArray  # by which errors are weighted
    noise: FloatArray  # white noise of each channel
    of_step: FloatArray  # root mean square of what the simulator's own step does to each
    blocks: int  # of time that figures were fitted to
    held_out: Experiment
    before: FloatArray  # (R, C) held-out, of the user's model
    after: FloatArray  # (R, C) held-out, with the patch

    def left(self, shown: FloatArray) -> float:
        """Squared error on held-out data, over what is expected."""
        return float(_squares(self.held_out, shown, self.sigma).sum())

    def there(self, term: Term) -> float:
        """Probability that held-out data are better explained with a term than without."""
        gains = self.gains[term]
        if not np.isfinite(gains).all():
            return 1.0  # the model is unstable without it
        return float(student.cdf(_t_of(gains), max(len(gains) - 1, 1)))

    def is_likely(self, term: Term, limits: SimulatorThresholds) -> bool:
        """Whether it is seen, and held-out data do not speak against it."""
        return self.there(term) >= limits.least_suspected and self.shows[term] >= 1.0

    def holds(self, term: Term, limits: SimulatorThresholds) -> bool:
        """Whether it is believed to be there, and matters; by whatever name."""
        return self.there(term) >= limits.least_confidence and self.shows[term] >= 1.0

    def claims(self, term: Term, limits: SimulatorThresholds) -> bool:
        """Whether its name is believed too, and its interval leaves out what the simulator has."""
        sure = self.confidence(term, limits) >= limits.least_confidence
        return sure and self._differs(term) >= limits.clear and self.holds(term, limits)

    def confidence(self, term: Term, limits: SimulatorThresholds) -> float:
        """Probability that a term is there, as a change to its side, and none of its rivals.

        It is no larger than the share of findings that were true of machines with more to them
        than their simulator has words for, at the same gain: what takes away little of the error
        may stand for a part of what is left.
        """
        rivals = [each for each in self.rivals[term] if not each.same]
        odds = sum(each.probability / (1.0 - min(each.probability, 0.99)) for each in rivals)
        gain = float(np.clip(self.share[term], 1e-4, 1.0 - 1e-4))
        log_odds = limits.base + limits.per_gain * np.log(gain / (1.0 - gain))
        known = min(self.there(term) / (1.0 + odds), float(expit(log_odds)))
        return min(known, self._differs(term))

    def error_of(self, parameter_id: ParameterId) -> float:
        """Standard error of a coordinate, with its change where what is not sure is left out."""
        parameter, value = self.parameters[parameter_id], self.values.get(parameter_id)
        if value is None:
            return self.std.get(parameter_id, 0.0)
        change = parameter.x_of(self.alone.get(parameter_id, value)) - parameter.x_of(value)
        return float(np.hypot(self.std.get(parameter_id, 0.0), change))

    def estimate(self, parameter_id: ParameterId, value: float, width: float) -> Estimate:
        """A figure with its interval, `width` standard errors of its coordinate to either side."""
        parameter, error = self.parameters[parameter_id], self.error_of(parameter_id)
        x = parameter.x_of(value)
        low, high = (parameter.value(x + side * width * error) for side in (-1.0, 1.0))
        if parameter.kind == "gap":
            low = max(low, 0.0)
        return Estimate(
            value=value,
            std=error * abs(parameter.slope(x)),
            interval95=(low, high),
            unit=PROPERTIES[parameter_id.property].unit,
        )

    def _differs(self, term: Term) -> float:
        """Probability that one of its figures lies on that side of the user's."""
        sides = (
            float(
                norm.cdf(abs(parameter.x_of(self.values[parameter_id]) - parameter.start) / error)
            )
            for parameter_id in term.parameter_ids
            if parameter_id in self.values and (error := self.error_of(parameter_id)) > 0.0
            for parameter in (self.parameters[parameter_id],)
        )
        return max(sides, default=1.0)  # what rests on a bound has no error


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

    What every drive has is fitted together, from short runs in which nothing drifts far. About the
    likeliest candidate, evidence says which properties differ from the user's at all, and which
    anomalous ones do in addition; these are fitted again, and judged by held-out data.

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
    terms = terms_of(user)
    climb, x = _together(experiment, fit, terms, say)
    chosen = tuple(
        term
        for term in terms
        if is_ordinary(user, term)
        or (len(term.parameter_ids) == 1 and _moved(climb, x)[climb.place[term.parameter_ids[0]]])
    )
    choice, chosen, x = _chosen(climb, x, chosen, terms, limits, say, same_step=same_step)
    if not same_step:
        held_out.allow_for_step(climb.values(x))
    judged = _judged(choice, x, chosen, noise, held_out)
    judged, x = _patch_of(judged, choice, x, limits)
    sure = tuple(term for term in judged.kept if judged.claims(term, limits))
    if len(sure) == len(judged.kept):
        return judged
    return replace(judged, alone=climb.values(_fitted(choice, x, sure, _LAST)))


def _patch_of(
    judged: Explained, choice: Choice, x: FloatArray, limits: SimulatorThresholds
) -> tuple[Explained, FloatArray]:
    """The patch that leaves least of held-out data, of four; of equals the smallest.

    It has nothing, what held-out data are sure of, what they do not speak against, or all that
    matters: what depends on others may look needless with them.
    """
    matters = tuple(term for term in judged.terms if judged.shows[term] >= 1.0)
    likely = tuple(term for term in judged.terms if judged.is_likely(term, limits))
    holds = tuple(term for term in judged.terms if judged.holds(term, limits))
    tried = []
    for kept in dict.fromkeys(((), holds, likely, matters)):
        at = x if kept == judged.terms else _fitted(choice, x, kept, _CHOSEN)
        values = choice.climb.values(at)
        try:
            after = judged.held_out.run(values, as_it_is=True)
        except SimulationError:
            continue
        patched = replace(judged, kept=kept, patch=values, alone=values, after=after)
        tried.append((patched, at))
    return min(tried, key=lambda pair: pair[0].left(pair[0].after))


def _chosen(
    climb: Climb,
    x: FloatArray,
    chosen: tuple[Term, ...],
    terms: Sequence[Term],
    limits: SimulatorThresholds,
    say: Tell,
    *,
    same_step: bool,
) -> tuple[Choice, tuple[Term, ...], FloatArray]:
    """What differs, with the likeliest coordinates and lines about them.

    Lines lead astray where much moves: what they choose is fitted by simulating, and where the
    evidence of that is worse, half of what was left out is taken back, what moves most.
    """

    def about(x: FloatArray) -> Choice:
        if not same_step:
            climb.experiment.allow_for_step(climb.values(x))
        return Choice(climb, x, terms, limits)

    choice = about(x)
    back: tuple[Term, ...] = ()
    for k in range(1, _ROUNDS + 1):
        wanted = choice.without_doubles((*choice.chosen(chosen), *back))
        say(f"round {k}: {len(wanted)} properties differ")
        if set(wanted) == set(chosen):
            break
        there = _fitted(choice, x, wanted, _CHOSEN)
        moved = _moved(climb, there)
        there = np.where(moved, there, climb.start)
        wanted = tuple(term for term in wanted if moved[choice.places([term])].any())
        refitted = about(there)
        if refitted.evidence(wanted) >= choice.evidence(chosen):
            choice, chosen, x, back = refitted, wanted, there, ()
            continue
        left_out = [term for term in chosen if term not in wanted]
        left_out.sort(key=lambda term: -choice.moves(term))
        back = tuple(left_out[: (len(left_out) + 1) // 2])
    return choice, chosen, x


def _moved(climb: Climb, x: FloatArray) -> Mask:
    """Which parameters are not the user's, (P,)."""
    return np.asarray(np.abs(x - climb.start) > _NOTHING * climb.std)


def _climb(experiment: Experiment, values: Values) -> Climb:
    """All that may be changed, its sizes by a candidate's gains."""
    user = experiment.user
    parameter_ids = [parameter_id for term in terms_of(user) for parameter_id in term.parameter_ids]
    return Climb(experiment, parameters_of(user, parameter_ids, scales_of(experiment, values)))


def _together(
    experiment: Experiment, recordings: Sequence[Recording], terms: Sequence[Term], say: Tell
) -> tuple[Climb, FloatArray]:
    """The likeliest coordinates with all ordinary parameters fitted together."""
    user = experiment.user
    short = Experiment(
        user, recordings, length=_SHORT, warm=0.2, most_rows=_FEW, most_seconds=_BRIEF
    )
    scan = _climb(short, {})
    values = scan.values(scan.with_gains())
    climb = _climb(experiment, values)
    active = np.zeros(len(climb.start), dtype=bool)
    active[[climb.place[term.parameter_ids[0]] for term in terms if is_ordinary(user, term)]] = True
    begun = Climb(short, climb.parameters)
    prompt = active & [each.parameter_id.property not in _LATE for each in climb.parameters]
    from_afar = begun.x_of(values)
    smooth = begun.to_top(from_afar, prompt, *_BEGIN)
    tried = [begun.to_top(at, active, *_BEGIN) for at in (from_afar, smooth)]
    x = max((smooth, *tried), key=lambda at: begun.log(at, begun.run(at)))
    x = climb.to_top(x, prompt, *_ALL) if x is smooth else climb.to_top(x, active, *_ALL)
    limited = climb.with_limits(x)
    if not np.array_equal(limited, x):
        active |= limited != x
        x = climb.to_top(limited, active, *_ALL)
    size = np.std(climb.experiment.measured, axis=0)
    left = [
        float(np.mean(np.sqrt(np.mean((climb.experiment.measured - shown) ** 2, axis=0)) / size))
        for shown in (climb.run(climb.start), climb.run(x))
    ]
    say(f"all of every drive fitted together: {left[0]:.2g} of the motion left, now {left[1]:.2g}")
    return climb, with_common_figures(climb, x)


def _fitted(
    choice: Choice, x: FloatArray, chosen: Sequence[Term], steps: tuple[int, float]
) -> FloatArray:
    """The likeliest coordinates where chosen terms alone are not the user's."""
    climb = choice.climb
    if not chosen:
        return climb.start
    active = np.zeros(len(x), dtype=bool)
    active[choice.places(chosen)] = True
    begins = (np.where(active, x, climb.start), choice.x_of(chosen))
    return climb.to_top(max(begins, key=lambda at: climb.log(at, climb.run(at))), active, *steps)


def _squares(held_out: Experiment, shown: FloatArray, sigma: FloatArray) -> FloatArray:
    """What is not shown, over what is expected, squared, (R,)."""
    squares: FloatArray = (((held_out.measured - shown) / sigma) ** 2).sum(axis=1)
    return squares


def _share(measured: FloatArray, without: FloatArray, with_it: FloatArray) -> float:
    """The share of a channel's squared error that a term takes away, where it is most."""
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
        values: of its parameters, and of others.
        user: whose model.
        limits: what counts.
    """
    if not np.isfinite(change).all():
        return np.inf
    seen = np.sqrt(np.mean(change**2, axis=0)) / (limits.shows * noise)
    sizes = [
        abs(values[parameter_id] - baseline(user, parameter_id)) / (limits.of_step * feigned)
        for parameter_id in term.parameter_ids
        if parameter_id in values
        and (feigned := PROPERTIES[parameter_id.property].feigned(user, parameter_id.index)) > 0.0
    ]
    return float(min([seen.max(), *sizes]))


def _judged(
    choice: Choice,
    x: FloatArray,
    chosen: tuple[Term, ...],
    noise: FloatArray,
    held_out: Experiment,
) -> Explained:
    """Errors, rivals, and each term left out in turn on data that nothing was learnt from.

    Without it the others are as straight lines have them, or as they were with it: whatever does
    better on what was learnt from, for a poor fit of the others is no merit of the term.
    """
    climb, limits, user = choice.climb, choice.limits, held_out.user
    values, std = climb.values(x), choice.std_of(chosen)
    sigma = np.maximum(
        np.sqrt(np.mean((climb.experiment.measured - climb.run(x)) ** 2, axis=0)), noise
    )
    before = held_out.run({}, as_it_is=True)
    after = held_out.run(values, as_it_is=True)
    with_values = held_out.run(values)
    of_step = np.sqrt(np.mean((with_values - after) ** 2, axis=0))
    count = int(held_out.block.max()) + 1

    def loss(shown: FloatArray) -> FloatArray:
        squares = _squares(held_out, shown, sigma)
        return np.bincount(held_out.block, squares, minlength=count).astype(np.float64)

    with_all = loss(with_values)
    gains, share, shows = {}, {}, {}
    for term in chosen:
        others = [each for each in chosen if each != term]
        own = [i for i in choice.places([term]) if i not in choice.places(others)]
        fewer = x.copy()
        fewer[own] = climb.start[own]
        without = max((choice.x_of(others), fewer), key=lambda at: climb.log(at, climb.run(at)))
        try:
            shown = held_out.run(climb.values(without))
        except SimulationError:
            shown = np.full_like(with_values, np.inf)
        left = loss(shown)
        shows[term] = _shows(shown - with_values, noise, term, values, user, limits)
        gains[term], share[term] = left - with_all, _share(held_out.measured, shown, with_values)
    return Explained(
        user=user,
        terms=chosen,
        kept=chosen,
        values=values,
        patch=values,
        alone=values,
        parameters={each.parameter_id: each for each in climb.parameters},
        std={climb.parameters[i].parameter_id: float(std[i]) for i in choice.places(chosen)},
        rivals={term: choice.rivals(chosen, term) for term in chosen},
        gains=gains,
        share=share,
        shows=shows,
        sigma=sigma,
        noise=noise,
        of_step=of_step,
        blocks=int(climb.experiment.block.max()) + 1,
        held_out=held_out,
        before=before,
        after=after,
    )


def _t_of(gains: FloatArray) -> float:
    """Mean of the blocks' gains over its standard error."""
    error = float(np.std(gains, ddof=1)) / np.sqrt(len(gains)) if len(gains) > 1 else np.inf
    return float(np.mean(gains)) / max(error, 1e-300)
