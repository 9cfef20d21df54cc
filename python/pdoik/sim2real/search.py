"""Which effects, where: forward selection by what is gained on rows that were held out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, optimize

from .balances import Balances
from .effects import CATALOGUE, Key, Place
from .nuisance import inertial_scale
from .recording import FloatArray
from .regression import Fit, Term, term_of
from .ripple import ripple_terms

_SCREENED = 12  # candidates of the highest training gain that are cross-validated, a round
_HOPELESS = 60  # candidates of no significance after which a round gives up
_LEAST_TRAINING_GAIN = 20.0  # in squared sigmas
LEAST_T = 3.5  # held-out gain over its standard error, by blocks
_LEAST_SIZE = 0.5  # root mean square of an effect in sigmas, where it acts
_LEAST_SHARE = 0.002  # of the mean square residual that the effect's channels began with
_LEAST_OF_REST = 0.12  # of what is left: what explains less of it is its own model's misfit
_SHARP = 0.4  # of a hump's speed, within which dry friction must turn for the hump to count
_LEAST_RELIEF = 12.0  # of the prior's penalty: a log evidence of six that figures are beyond trust
_TIE_SIZE = 0.2  # root mean square in sigmas by which a candidate may be worse than one level
_TIE = 0.03  # or the share of the gain, where blocks differ as much
_MOST = 40  # terms
_FIXED_WITHIN = (0.6, 1.6)  # where a coefficient that should be 1 may lie when it is set free

Tell = Callable[[Term, float], None]


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial:
    """A hypothesis and how it did on held-out rows."""

    term: Term
    gain: float  # sum over held-out rows, in squared sigmas, the prior's relief included
    t: float  # its mean over blocks by the standard error
    size: float  # root mean square in sigmas on the rows where it acts
    share: float  # of the mean square that its channels began with
    of_rest: float  # of the mean square that was left where it acts
    rows: int  # on which it acts
    blocks: FloatArray  # gain of each block
    accepted: bool = False
    why_not: str = ""

    @property
    def significant(self) -> bool:
        """Whether the gain is real and large enough to matter."""
        explains = max(_LEAST_OF_REST, CATALOGUE[self.term.effect].least_of_rest)
        return (
            self.t >= LEAST_T
            and self.size >= _LEAST_SIZE
            and self.share >= _LEAST_SHARE
            and self.of_rest >= explains
        )

    @property
    def needed(self) -> bool:
        """Whether an accepted term still earns its place beside those accepted after it."""
        return self.t >= 0.7 * LEAST_T and self.size >= 0.7 * _LEAST_SIZE


@dataclass(kw_only=True)
class Search:
    """The state of a search: what is accepted, and all that was tried."""

    balances: Balances
    nuisance: tuple[Term, ...]
    fit: Fit
    start: Fit
    contacts: tuple[Term, ...] = ()
    dropped: Counter[tuple[str, Place]] = field(
        default_factory=Counter
    )  # how often, needless later
    tried: list[Trial] = field(default_factory=list)
    level: dict[int, list[Trial]] = field(default_factory=dict)  # by id of the accepted term

    @property
    def accepted(self) -> tuple[Term, ...]:
        """Terms accepted so far."""
        return self.fit.terms[len(self.nuisance) :]


def candidates(balances: Balances) -> list[Term]:
    """Every effect at every plausible place and first shape."""
    terms: list[Term] = []
    for effect in CATALOGUE.values():
        if effect.id == "unknown":
            continue  # tried last
        for place in effect.places(balances.motions):
            if effect.per_joint_moving and not all(balances.excited[j] for j in place.joints):
                continue
            if effect.costly and not any(_restless(balances, j) for j in place.joints):
                continue
            for shape in effect.shapes(balances.motions, place):
                term = term_of(balances, effect, place, shape)
                if term is not None:
                    terms.append(term)
    return terms


def search(
    balances: Balances,
    nuisance: tuple[Term, ...],
    tell: Tell = lambda term, share: None,
    contacts: tuple[Term, ...] = (),
) -> Search:
    """Accept the best candidate until none is worth it; drop those no longer needed.

    Args:
        balances: of the recordings to fit.
        nuisance: terms that are always there (the model's inertias within the user's trust).
        tell: called with the term accepted and how far the search is, 0 to 1.
        contacts: found in what an earlier search left, accepted beforehand.
    """
    start = Fit(balances, nuisance)
    state = Search(balances=balances, nuisance=nuisance, fit=start, start=start, contacts=contacts)
    if contacts:
        state.fit = start.extended(*contacts)
    pool = candidates(balances)
    while len(state.accepted) < _MOST:
        best = _round(state, pool)
        if best is None:
            break
        term = refined(state.fit, best.term)
        state.fit = state.fit.extended(term)
        tell(term, min(0.9, 0.1 * len(state.accepted)))
        polish(state, {*term.place.joints})
        _drop(state)
    polish(state)
    return state


def _restless(balances: Balances, j: int) -> bool:
    """Whether something is left in joint j's torque, or in the tip's pose."""
    keys: list[Key] = [("torque", j), *(("tip", axis) for axis in range(6))]
    return any(balances.rms(k) > 1.5 * balances.sigma[k] for k in keys if k in balances.residual)


def _round(state: Search, pool: list[Term]) -> Trial | None:
    """The best significant candidate, the simplest where data cannot tell; None if none is."""
    taken = {(t.effect, t.place) for t in state.accepted}
    gone = taken | {name for name, times in state.dropped.items() if times > 1}
    fresh = [t for t in pool if (t.effect, t.place) not in gone and has_company(t, taken)]
    fresh = [t for t in fresh if not blurred(t, state.accepted)]
    fresh += [t for t in ripple_terms(state.fit) if (t.effect, t.place) not in gone]
    screened = screen(state.fit, fresh)
    held = held_out_squares(state.fit)
    trials: list[Trial] = []
    best = 0.0  # gain of the best significant trial
    hopeless = 0
    for term, training_gain in screened:
        coarse = CATALOGUE[term.effect].costly  # its grid is: refined it may do far better
        if training_gain < (0.2 if coarse else 0.5) * best and len(trials) > 3:
            continue
        tried = refined(state.fit, term) if coarse else term
        trial = cross_validated(state, tried, held)
        trials.append(trial)
        if trial.significant:
            best = max(best, trial.gain)
        hopeless += not trial.significant
        if (len(trials) >= _SCREENED and best > 0.0) or hopeless >= _HOPELESS:
            break
    trials.sort(key=lambda each: -each.gain)
    state.tried.extend(trials)
    good = [each for each in trials if each.significant]
    if not good:
        return None
    near = [each for each in good if level(good[0], each)]
    return min(near, key=lambda each: _simplicity(state, each))


def _simplicity(state: Search, trial: Trial) -> tuple[float, float]:
    """Order among candidates that data cannot tell apart."""
    complexity = float(CATALOGUE[trial.term.effect].complexity)
    return complexity + implausibility(state.fit, trial.term), -trial.gain


def implausibility(fit: Fit, term: Term) -> float:
    """0 to 1: how large a link's error is beside the link; 0 for all other effects."""
    body = fit.balances.motions[0].body
    if term.effect != "link_inertial_error" or body is None or term.place.link is None:
        return 0.0
    scale = inertial_scale(body.inertial_parameters()[term.place.link])
    beta = fit.extended(term).beta[-term.width :]
    size = float(np.sqrt(np.sum((beta / scale)[:4] ** 2)))
    return size / (1.0 + size)


def has_company(term: Term, taken: set[tuple[str, Place]]) -> bool:
    """Whether what the effect only comes beside was found at its place."""
    beside = CATALOGUE[term.effect].beside
    if any((effect, term.place) in taken for effect in CATALOGUE[term.effect].instead):
        return False
    return not beside or any((effect, term.place) in taken for effect in beside)


def blurred(term: Term, others: tuple[Term, ...]) -> bool:
    """Whether a Stribeck hump is only the edge of dry friction that is smooth about rest."""
    return term.effect == "stribeck_friction" and any(
        t.effect == "coulomb_friction"
        and t.place == term.place
        and t.shape[0] > _SHARP * term.shape[0]
        for t in others
    )


def level(best: Trial, other: Trial) -> bool:
    """Whether held-out rows cannot tell the other from the best."""
    if other is best:
        return True
    difference = best.blocks - other.blocks
    total = float(difference.sum())
    if total < _TIE_SIZE**2 * max(best.rows, other.rows):
        return True
    used = difference[(best.blocks != 0.0) | (other.blocks != 0.0)]
    error = float(np.std(used) * np.sqrt(len(used))) if len(used) > 1 else np.inf
    return total < _TIE * best.gain and total < 1.5 * error


def screen(fit: Fit, terms: list[Term]) -> list[tuple[Term, float]]:
    """Admissible candidates by training gain, the best shape of each effect and place."""
    best: dict[tuple[str, Place], tuple[Term, float]] = {}
    factor = linalg.cho_factor(fit.regular(fit.gram)) if fit.size else None  # of the training fit
    left = {key: fit.residual(key) for key in fit.design}
    for term in terms:
        gain = _training_gain(fit, term, factor, left)
        name = (term.effect, term.place)
        if gain > _LEAST_TRAINING_GAIN and (name not in best or gain > best[name][1]):
            best[name] = (term, gain)
    return sorted(best.values(), key=lambda each: -each[1])


def _training_gain(
    fit: Fit,
    term: Term,
    factor: tuple[FloatArray, bool] | None,
    left: dict[Key, FloatArray],
) -> float:
    """Decrease of the cost where the term is added and all else refitted; -1 if inadmissible."""
    width = term.width
    moment, gram = np.zeros(width), np.zeros((width, width))
    cross = np.zeros((fit.size, width))
    for key, column in term.columns.items():
        rows = fit.rows[key]
        part = column[rows] / fit.balances.sigma[key]
        moment += part.T @ left[key]
        gram += part.T @ part
        if fit.size:
            cross[fit.index[key]] += fit.design[key].T @ part
    if not np.diag(gram).max() > 0.0:
        return -1.0
    reduced = gram + np.diag(term.prior + 1e-9 * np.diag(gram).max())
    if factor is not None:
        reduced = reduced - cross.T @ linalg.cho_solve(factor, cross)
    if term.fixed:
        return float(2 * moment[0] - reduced[0, 0])
    values, vectors = np.linalg.eigh(reduced)
    keep = values > 1e-8 * np.diag(gram).max()
    along = vectors[:, keep].T @ moment
    beta = vectors[:, keep] @ (along / values[keep])
    effect = CATALOGUE[term.effect]
    if not effect.admissible(beta):
        beta = np.clip(beta, *[bound[: len(beta)] for bound in effect.bounds])
        if not effect.admissible(beta):
            return -1.0
        return float(2 * beta @ moment - beta @ reduced @ beta)
    return float(along @ (along / values[keep]))


def held_out_squares(fit: Fit) -> dict[Key, FloatArray]:
    """Squared held-out residuals of a fit by key."""
    return {key: left**2 for key, left in fit.held_out().items()}


def cross_validated(
    state: Search, term: Term, held: dict[Key, FloatArray], base: Fit | None = None
) -> Trial:
    """Gain of a term on rows held out."""
    base = state.fit if base is None else base
    wider = base.extended(term)
    squares = held_out_squares(wider)
    blocks = base.by_block({key: held[key] - squares[key] for key in squares})
    relief = base.penalty() - (wider.penalty() - _own_penalty(wider, term))
    active_rows, acting = activity(base, term)
    t, coefficient = wider.wald(term)
    effect = CATALOGUE[term.effect]
    if not term.fixed and not effect.admissible(wider.beta[-term.width :]):
        t = 0.0
    if not effect.plausible(base.balances.motions, term.place, term.shape):
        t = 0.0
    if term.fixed and not _FIXED_WITHIN[0] < coefficient < _FIXED_WITHIN[1]:
        t = 0.0  # the data want another multiple of it: it is something else
    gain = float(blocks.sum())
    if relief > _LEAST_RELIEF and gain > -0.2 * relief:  # the prior asks for it
        gain, t = gain + relief, max(t, LEAST_T)
    began = sum(float(np.sum(state.start.target[key][acting[key]] ** 2)) for key in term.columns)
    rest = sum(float(np.sum(held[key][acting[key]])) for key in term.columns)
    return Trial(
        term=term,
        gain=gain,
        t=t,
        size=float(np.sqrt(max(gain, 0.0) / max(active_rows, 1))),
        share=gain / max(began, 1e-12),
        of_rest=gain / max(rest, 1e-12),
        rows=active_rows,
        blocks=blocks,
    )


def _own_penalty(fit: Fit, term: Term) -> float:
    if term.fixed:
        return 0.0
    beta = fit.beta[-term.width :]
    return float(np.sum(term.prior * beta**2))


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


def refined(base: Fit, term: Term) -> Term:
    """The term with its nonlinear parameters moved to where the training cost is lowest."""
    effect = CATALOGUE[term.effect]
    free = [i for i, (low, high) in enumerate(effect.shape_bounds(term.shape)) if high - low > 1e-9]
    if not free:
        return term
    bounds = effect.shape_bounds(term.shape)

    def at(values: FloatArray) -> tuple[float, Term]:
        shape = list(term.shape)
        for i, value in zip(free, values, strict=True):
            shape[i] = float(np.clip(value, *bounds[i]))
        columns = base.balances.compute(effect, term.place, tuple(shape))
        new = Term(
            effect=term.effect,
            place=term.place,
            shape=tuple(shape),
            columns=columns,
            prior=term.prior,
        )
        if not columns:
            return 2.0 * base.cost() + 1.0, new  # worse than without it; infinity upsets SciPy
        return base.extended(new).cost(), new

    if effect.costly:
        here = term.shape[0]
        tries = [here * 1.06**power for power in range(-6, 7)]  # simulated along with one another
        costs = [at(np.array([value]))[0] for value in tries]
        best, cost = np.array([tries[int(np.argmin(costs))]]), float(min(costs))
    elif len(free) == 1:
        low, high = bounds[free[0]]
        found = optimize.minimize_scalar(
            lambda x: at(np.array([x]))[0],
            bounds=(low, high),
            method="bounded",
            options={"xatol": 2e-3 * (high - low), "maxiter": 18},
        )
        best, cost = np.array([found.x]), float(found.fun)
    else:
        start = np.array([term.shape[i] for i in free])
        result = optimize.minimize(  # type: ignore[call-overload]  # its stubs know no fatol
            lambda x: at(x)[0],
            start,
            method="Nelder-Mead",
            bounds=[bounds[i] for i in free],
            options={"maxfev": 60, "xatol": 1e-3, "fatol": 1.0},
        )
        best, cost = result.x, float(result.fun)
    return at(best)[1] if cost < base.extended(term).cost() else term


def _drop(state: Search) -> None:
    """Leave out accepted terms that the later ones have made needless."""
    while len(state.accepted) > 1:
        worst, weakest = None, np.inf
        for term in state.accepted[:-1]:
            if term in state.contacts:
                continue
            if blurred(term, state.accepted):
                worst, weakest = term, -np.inf
                continue
            trial = without(state, term)
            if not trial.needed and trial.t < weakest:
                worst, weakest = term, trial.t
        if worst is None:
            return
        state.dropped[worst.effect, worst.place] += 1  # twice, and it would come and go for ever
        kept = [t for t in state.fit.terms if t is not worst]
        state.fit = Fit(state.balances, kept)


def without(state: Search, term: Term) -> Trial:
    """What an accepted term gains on held-out rows beside all the others."""
    others = Fit(state.balances, [t for t in state.fit.terms if t is not term])
    return cross_validated(state, term, held_out_squares(others), others)


def polish(state: Search, joints: set[int] | None = None) -> None:
    """Move nonlinear parameters once more with all terms there; of these joints, or of all.

    A shape found before its neighbours were there may have stood in for them.
    """
    for term in state.accepted:
        if not CATALOGUE[term.effect].shape_bounds(term.shape):
            continue
        if joints is not None and joints.isdisjoint(term.place.joints):
            continue
        others = Fit(state.balances, [t for t in state.fit.terms if t is not term])
        better = refined(others, term)
        state.fit = Fit(state.balances, [better if t is term else t for t in state.fit.terms])
