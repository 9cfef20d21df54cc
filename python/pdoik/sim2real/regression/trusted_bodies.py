"""The model's inertial figures within the user's trust: always fitted, never named."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..effects import CATALOGUE, Effect
from ..effects.bodies import LinkInertials
from ..motion import Balances, Columns, Motion, Place, Shape
from .fit import Term, term_of
from .tolerances import Tolerance

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
