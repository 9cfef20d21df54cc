"""A study's balances again where what was found changes what they are linear in.

A base that is tilted changes the direction of unknown bodies' weight; what feet take follows from
all torques.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray

from ..motion import STANDARD_GRAVITY, Balances, Motion, Prepared, columns_of, with_ground
from ..regression import TRUST, Fit, Weighted, effect_of, term_of

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
