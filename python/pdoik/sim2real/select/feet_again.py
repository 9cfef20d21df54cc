"""Forces on the feet by the model and what was found, and the search made again with these.

What a foot takes follows from all torques: a motor that gives less than its drive says presses
less. What goes by a joint's torque (a gain, friction by the load) is first found with forces that
do not know of it, and is off by the square of its size; the rest would be named as other things.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..motion.balances import Balances, columns_of
from ..motion.foot_forces import with_ground
from ..motion.motion import Motion
from ..motion.prepare import Prepared
from ..regression.fit import Weighted
from ..regression.trial import Search
from ..regression.trusted_bodies import effect_of
from ..study.recording import FloatArray
from .base_tilt import Tell, anew, searched_again

_ROUNDS = 3


def with_feet_again(prepared: Prepared, state: Search, say: Tell) -> tuple[Prepared, Search]:
    """The study and its search with the feet's forces as they are beside what was found."""
    for _ in range(_ROUNDS):
        again = _with_forces(prepared, state.fit.weighted)
        if again is None or not _matters(state, again.fit):
            break
        say("name", "once more, with the feet's forces by what was found", 0.6)
        prepared, state = again, searched_again(again, state, say)
    return prepared, state


def _with_forces(prepared: Prepared, found: Weighted) -> Prepared | None:
    """The study with other forces on the feet; None where nothing says what these are."""
    if not any(foot.load is not None for motion in prepared.fit.motions for foot in motion.feet):
        return None
    held_out = prepared.validate
    return replace(
        prepared,
        fit=_moved(prepared, prepared.fit, found),
        validate=None if held_out is None else _moved(prepared, held_out, found),
    )


def _moved(prepared: Prepared, balances: Balances, found: Weighted) -> Balances:
    base, limits = prepared.study.base, prepared.study.thresholds
    assert base is not None
    motions = [
        with_ground(motion, base.ground, limits.noise, limits.feet, _torques(motion, found))
        for motion in balances.motions
    ]
    return Balances(motions, balances.thresholds).less(balances.taken_off)


def _torques(motion: Motion, found: Weighted) -> FloatArray:
    """What terms add to a motion's torques, (T, rows)."""
    rows = {motion.row_key(i): i for i in range(motion.rows)}
    total = np.zeros_like(motion.tau)
    for term, beta in found:
        for key, column in columns_of(effect_of(term), motion, term.place, term.shape).items():
            if key in rows:
                total[:, rows[key]] += column @ beta
    return total


def _matters(state: Search, again: Balances) -> bool:
    """Whether an accepted term says another thing by as much as would be a term of its own."""
    least = state.balances.thresholds.search.least_size
    for term, beta in state.fit.weighted[len(state.nuisance) :]:
        other = anew(again, term)
        for key, column in term.columns.items():
            rows = state.fit.rows[key]
            moved = -column if other is None else other.columns[key] - column
            change = moved[rows] @ beta / again.sigma[key]
            if len(rows) and float(np.sqrt(np.mean(change**2))) > least:
                return True
    return False
