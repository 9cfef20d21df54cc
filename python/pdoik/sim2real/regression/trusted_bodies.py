"""The model's inertial figures within the user's trust: always fitted, never named."""

from __future__ import annotations

from ..effects import CATALOGUE, Effect
from ..effects.inertial import LinkInertials
from ..motion.balances import Balances
from ..motion.place import Place
from .fit import Term

_BODY = CATALOGUE[LinkInertials.id]

TRUST = "trust"
"""Effect id of the terms; none of the catalogue."""


def effect_of(term: Term) -> Effect:
    """The effect of a term, one of these included."""
    return _BODY if term.effect == TRUST else CATALOGUE[term.effect]


def trusted(balances: Balances, trust: float | None) -> tuple[Term, ...]:
    """Ten parameters of every link, held near the model's by the user's trust.

    The standard deviation of a mass is `trust` times the mass; of a first moment `trust` times
    mass times the larger of the centre's distance and the radius of gyration; of an inertia
    `trust` times the largest inertia.
    """
    body = balances.motions[0].body
    if not trust or body is None:
        return ()
    terms = []
    for link in range(len(body.links)):
        scale = trust * body.inertial_scale(link)
        columns = balances.columns(_BODY, Place(link=link), ())
        if columns:
            prior = 1.0 / scale**2
            place = Place(link=link)
            terms.append(
                Term(
                    effect=TRUST,
                    place=place,
                    shape=(),
                    columns=columns,
                    prior=prior,
                    beneath=_BODY.beneath(balances.motions[0], place),
                )
            )
    return tuple(terms)
