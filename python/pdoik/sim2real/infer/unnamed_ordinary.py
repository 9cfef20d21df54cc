"""What figures owe to what every joint has, where it is too small to be named.

Dry and viscous friction, a zero and a rotor look alike one by one. Those that are named take the
share of one that is not: a joint's dry friction seems a fifth larger than it is. Intervals hold
both, the figure as it is and the one beside all that may be there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..effects import CATALOGUE, Effect
from ..effects.inertial import Payload
from ..findings import Estimate
from ..motion.balances import Balances
from ..motion.place import Place
from ..regression.background import usual_torque
from ..regression.estimate import estimates
from ..regression.fit import Fit, Term, term_of
from ..select.candidates import same_kind
from .bodies import has_shape

Figures = dict[str, Estimate]


def beside_the_unnamed(fit: Fit, terms: tuple[Term, ...], seed: int) -> list[Figures]:
    """Estimates of each term with all that is ordinary and was not named.

    Of a payload whose mass may be nothing then, the mass alone.
    """
    found = estimates(fit.extended(*_unnamed(fit)), terms, seed)
    least = fit.balances.thresholds.figures.mass_t
    result = []
    for number, term in enumerate(terms):
        figures = found[number]
        if term.effect == Payload.id and not has_shape(figures, least):
            figures = {"mass": figures["mass"]}
        result.append(figures)
    return result


def holding(figures: Figures, before: Figures, beside: Figures) -> Figures:
    """Estimates whose intervals hold others too.

    Args:
        figures: the estimates, perhaps refined since.
        before: as they were of the same fit.
        beside: of the fit with what was not named, those that it tells.
    """
    return {
        name: _holding(each, before[name], beside[name]) if name in beside else each
        for name, each in figures.items()
    }


def _holding(each: Estimate, before: Estimate, beside: Estimate) -> Estimate:
    by = each.value - before.value
    low, high = (end + by for end in beside.interval95)
    away = float(np.hypot(beside.std, beside.value - before.value))
    return replace(
        each,
        std=max(each.std, away),
        interval95=(min(each.interval95[0], low), max(each.interval95[1], high)),
    )


def _unnamed(fit: Fit) -> list[Term]:
    """Plain terms of what every machine's joints have, where none of the kind was found."""
    b = fit.balances
    plain = [each for each in CATALOGUE.values() if each.is_plain]
    found: list[Term | None] = []
    for j in range(b.n):
        if not b.excited[j] or not len(fit.rows.get(("torque", j), ())):
            continue
        place = Place(joints=(j,))
        here = {t.effect for t in fit.terms if t.place == place and t.effect in CATALOGUE}
        found += [
            _term(b, effect, place)
            for effect in plain
            if effect.id not in here
            and not any(same_kind(effect.id, one) for one in here)
            and place in effect.places(b.motions)
        ]
    return [term for term in found if term is not None]


def _term(b: Balances, effect: Effect, place: Place) -> Term | None:
    """Its size is about that of other parts of the joint's friction."""
    (j,) = place.joints
    term = term_of(b, effect, place, effect.shapes(b.motions, place)[0])
    if term is None or ("torque", j) not in term.columns:
        return None
    column = term.columns["torque", j]
    size = b.thresholds.background.friction * usual_torque(b, j)
    prior = np.mean(column**2, axis=0) / max(size, 1e-9) ** 2
    return replace(term, prior=np.maximum(term.prior, prior))
