"""Causes of a study's mismatch by one posterior, linearised again where a cause asks for it.

A base that is tilted changes the direction of unknown bodies' weight; what feet take follows from
all torques.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import STANDARD_GRAVITY, Balances, Motion, Prepared, columns_of, with_ground
from ..regression import TRUST, Fit, Weighted, effect_of, term_of
from .claims import identified
from .hypothesis import Hypothesis, anomalous
from .identified import Identified
from .posterior import Posterior, likeliest
from .weighing import State

_GRAVITY = "gravity"  # of a motion's cache, under which its bodies are


def relinearised(prepared: Prepared, fit: Fit) -> Prepared | None:
    """The study linearised at a fit's terms; None where it is linear enough as it is."""
    return _with_gravity(prepared, fit) or _with_feet(prepared, fit)


def _with_gravity(prepared: Prepared, fit: Fit) -> Prepared | None:
    level = np.array([0.0, 0.0, -STANDARD_GRAVITY])
    found = _gravity_of(fit)
    there = level if found is None else found
    now = prepared.fit.motions[0].cache.get(_GRAVITY, level)
    matters = prepared.study.thresholds.diagnosis.tilt * STANDARD_GRAVITY
    if np.linalg.norm(there - now) < matters:
        return None
    held_out = prepared.validate
    return replace(
        prepared,
        fit=prepared.fit.pulled_by(there),
        validate=None if held_out is None else held_out.pulled_by(there),
    )


def _gravity_of(fit: Fit) -> FloatArray | None:
    """Gravity in the frame of the base, if that was found to be tilted, (3,) [m/s^2]."""
    for term, beta in fit.weighted:
        effect = effect_of(term)
        if effect.on == "base":
            gravity = effect.gravity(effect.values(term.shape, beta))
            if gravity is not None:
                return gravity
    return None


def _with_feet(prepared: Prepared, fit: Fit) -> Prepared | None:
    """The study with refitted foot forces; None where nothing gives these, or none matters."""
    if not prepared.fit.loads_are_inferred:
        return None
    found = fit.weighted
    again = _moved(prepared, prepared.fit, found)
    if not _matters(fit, found, again):
        return None
    held_out = prepared.validate
    return replace(
        prepared,
        fit=again,
        validate=None if held_out is None else _moved(prepared, held_out, found),
    )


def _moved(prepared: Prepared, balances: Balances, found: Weighted) -> Balances:
    base, limits = prepared.study.base, prepared.study.thresholds
    assert base is not None
    motions = [
        with_ground(motion, base.ground, limits.noise, limits.feet, _torques(motion, found))
        for motion in balances.motions
    ]
    return Balances(motions, balances.thresholds)


def _torques(motion: Motion, found: Weighted) -> FloatArray:
    """What terms add to a motion's torques, (T, rows)."""
    rows = {motion.row_key(i): i for i in range(motion.rows)}
    total = np.zeros_like(motion.tau)
    for term, beta in found:
        for key, column in columns_of(effect_of(term), motion, term.place, term.shape).items():
            if key in rows:
                total[:, rows[key]] += column @ beta
    return total


def _matters(fit: Fit, found: Weighted, again: Balances) -> bool:
    """Whether a term says another thing by as much as would be a term of its own."""
    least = again.thresholds.diagnosis.linear
    for term, beta in found:
        if term.effect == TRUST:
            continue
        other = term_of(again, effect_of(term), term.place, term.shape)
        for key, column in term.columns.items():
            rows = fit.rows.get(key)
            if rows is None or not len(rows):
                continue
            moved = -column if other is None else other.columns[key] - column
            change = moved[rows] @ beta / again.sigma[key]
            if float(np.sqrt(np.mean(change**2))) > least:
                return True
    return False


_ROUNDS = 4  # numerics: of linearisation
_BEGIN, _END, _STEP = 0.18, 0.76, 0.06  # of the work reported as done
_FEW = 6  # causes after which one beginning is left

Tell = Callable[[str, str, float], None]


@dataclass(slots=True)
class _Progress:
    """Says what is taken, with a share of the work that grows: the rest is never known."""

    say: Tell
    share: float = _BEGIN

    def __call__(self, text: str) -> None:
        self.share += _STEP * (_END - self.share)
        self.say("name", text, self.share)


def identify(prepared: Prepared, say: Tell) -> tuple[Prepared, Identified]:
    """The causes, and the study as it is linearised at them."""
    chosen: list[Hypothesis] = []
    progress, rounds = _Progress(say), 0
    while True:
        posterior = Posterior.of(prepared.fit, progress)
        state = _likeliest(posterior, prepared, chosen)
        rounds += 1
        fit = posterior.fit_of(state.model)
        other = relinearised(prepared, fit) if rounds < _ROUNDS else None
        if other is None:
            return prepared, identified(posterior, state)
        progress("once more, linearised at what was found")
        prepared = other
        chosen = _anew(prepared, state)
        del posterior, state, fit  # room for the next


def _likeliest(posterior: Posterior, prepared: Prepared, chosen: list[Hypothesis]) -> State:
    """The likeliest state from two starts: a model as wrong as drawings are, and one nearly right.

    The likelier after a few causes goes on; at its end the other share is asked again.
    """
    believed = prepared.study.thresholds.priors
    given = prepared.study.trust.rigid_body
    most = believed.bodies if given is None else given
    shares = [most]
    if prepared.body is not None and most > believed.good_bodies:
        shares.append(believed.good_bodies)
    few = len(chosen) + _FEW
    begun = [posterior.grown(posterior.begun(share, chosen), few) for share in shares]
    state = posterior.grown(likeliest(begun))
    for share in shares:
        other = posterior.with_bodies(state, share)
        if share != state.ordinary.bodies and other.log_posterior > state.log_posterior:
            return posterior.grown(other)
    return state


def _anew(prepared: Prepared, state: State) -> list[Hypothesis]:
    """What was chosen, on other balances."""
    found = []
    for each in state.chosen:
        effect = CATALOGUE[each.term.effect]
        term = term_of(prepared.fit, effect, each.term.place, each.term.shape)
        if term is not None:
            fresh = anomalous(prepared.fit, term)
            found.append(replace(fresh, log_odds=each.log_odds))
    return found
