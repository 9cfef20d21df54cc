"""How small every effect at every place may be and still be seen, or why it cannot be seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..diagnose import Tell
from ..effects import CATALOGUE, Effect
from ..motion import Place, Prepared
from .missing import Missing
from .sizes import Size, Sizes


@dataclass(frozen=True, slots=True, kw_only=True)
class Visible:
    """An effect at a place of the study, of one variant."""

    effect: str
    variant: str  # what it is of, where the effect may be of several
    joint: str  # where it acts, or the joint that moves its link; "" for the base
    place: str  # joints, link or base, in words
    parameter: str
    unit: str
    smallest: float | None  # of the parameter, from where the effect does nothing; None: unseen
    below: bool  # the parameter must be smaller than that, not larger
    reason: str  # why it cannot be seen; "" where it can


def visible_effects(prepared: Prepared, say: Tell) -> tuple[Visible, ...]:
    """The size at which each effect is seen, in the catalogue's order, joints in the study's."""
    sizes = Sizes(prepared)
    missing = Missing(prepared)
    found: list[Visible] = []
    for k, effect in enumerate(CATALOGUE.values()):
        say("see", "", 0.2 + 0.8 * k / len(CATALOGUE))
        if effect.sought == "last":
            continue  # it is whatever has no name
        places = missing.places(effect)
        if not places:
            found.append(_unseen(prepared, effect, Place(), missing.reason(effect, None)))
        for place in places:
            found += _at(prepared, effect, place, sizes, missing)
    return tuple(found)


def _at(
    prepared: Prepared, effect: Effect, place: Place, sizes: Sizes, missing: Missing
) -> list[Visible]:
    reason = missing.motion(effect, place)
    if reason:
        return [_unseen(prepared, effect, place, reason)]
    found = list(sizes.of(effect, place))
    if not found:
        return [_unseen(prepared, effect, place, missing.reason(effect, place))]
    return [_seen(prepared, effect, each, missing) for each in found]


def _seen(prepared: Prepared, effect: Effect, size: Size, missing: Missing) -> Visible:
    reason = "" if _is_possible(effect, size) else missing.hidden(effect, size)
    shown = _unseen(prepared, effect, size.place, reason)
    return Visible(
        effect=effect.id,
        variant=size.variant,
        joint=shown.joint,
        place=shown.place,
        parameter=size.parameter.name,
        unit=size.parameter.unit,
        smallest=None if reason else size.figure,
        below=size.below,
        reason=reason,
    )


def _is_possible(effect: Effect, size: Size) -> bool:
    """Whether the parameter may be as large, by its own bounds and by what a joint's torque is."""
    low, high = size.parameter.lower, size.parameter.upper
    within = size.figure <= max(abs(low) if np.isfinite(low) else np.inf, high)
    return bool(np.isfinite(size.figure) and within and size.of_usual <= 1.0)


def _unseen(prepared: Prepared, effect: Effect, place: Place, reason: str) -> Visible:
    joints, body = prepared.study.joints, prepared.body
    at = place.joints[0] if place.joints else place.link
    said = " and ".join(joints[j] for j in place.joints)
    if place.link is not None and body is not None:
        said = body.links[place.link]
    if place.foot is not None and prepared.study.base is not None:
        said = prepared.study.base.feet[place.foot].link
    if place.held is not None:
        said = place.held.label
    return Visible(
        effect=effect.id,
        variant="",
        joint="" if at is None or at == len(joints) else joints[at],
        place=said or "base",
        parameter=effect.parameters[0].name,
        unit=effect.parameters[0].unit,
        smallest=None,
        below=False,
        reason=reason,
    )
