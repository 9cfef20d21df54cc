"""What is fitted and never named: bodies within the user's trust, drives as calibrated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..effects import CATALOGUE, Effect
from ..effects.bodies import LinkInertials
from ..effects.drives import OF_DRIVE, TorqueGain, TorqueOffset
from ..motion import Balances, Columns, Motion, Place, Shape
from .fit import Term, term_of

ZERO, SCALE, SPEED = 0.0, 1.0, 2.0
"""Shapes: a drive's zero, its scale, a speed's scale."""

_OF_DRIVES = {ZERO: TorqueOffset(), SCALE: TorqueGain()}


class Tolerance(Effect):
    """Error of a joint's drive against its command or law, of its speed against its position."""

    id = "tolerance"
    on = "drive"

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Per newton metre, per one, per one."""
        (j,) = place.joints
        if shape[0] == SPEED:
            return {} if motion.measured_dq is None else {("velocity", j): motion.dq[:, j, None]}
        return _OF_DRIVES[shape[0]].columns(motion, place, (OF_DRIVE,))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """The tolerance in words."""
        return f"{where} is as exact as its calibration."


_BODY = CATALOGUE[LinkInertials.id]

TRUST = "trust"
"""Effect id of the terms; none of the catalogue."""

DAYS = "days"
"""Effect id of what friction differs by in a session; none of the catalogue."""


class _OfThatDay(Effect):
    """What was so in the recorded sessions alone: nothing is known of it elsewhere."""

    id = DAYS
    on = "joint"

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """No columns."""
        return {}

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """The effect in words."""
        return f"The friction of {where} differs from day to day."


_OTHER = {TRUST: _BODY, DAYS: _OfThatDay(), Tolerance.id: Tolerance()}


def effect_of(term: Term) -> Effect:
    """The effect of a term, those of no catalogue included."""
    return _OTHER.get(term.effect) or CATALOGUE[term.effect]


def trusted(balances: Balances, trust: float | None) -> tuple[Term, ...]:
    """Ten parameters of every link, kept near the model's by the user's trust.

    The standard deviation of a mass is `trust` times the mass; of a first moment `trust` times
    mass times the larger of the centre's distance and the radius of gyration; of an inertia
    `trust` times the largest inertia.
    """
    body = balances.motions[0].body
    if not trust or body is None:
        return ()
    terms = []
    for link in range(len(body.links)):
        term = term_of(balances, _BODY, Place(link=link), ())
        if term is not None:
            prior = 1.0 / (trust * body.inertial_scale(link)) ** 2
            terms.append(replace(term, effect=TRUST, prior=prior))
    return tuple(terms)
