"""Rows of some balances with all that is fitted beside the causes that are weighed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..effects import CATALOGUE, Effect
from ..identify.candidates import same_kind
from ..motion.balances import Balances
from ..motion.place import Place, Shape
from ..motion.prepare import Prepared
from ..regression.trusted_bodies import trusted
from .questions import Cause
from .rows import Columns, Noise, Sheet, columns_at, contribution

Name = tuple[object, ...]  # of columns: what kind they are, and whose

FOUND = "found"
_SHAPES = 4  # of a rival that are tried


class Beside:
    """Friction, offset and rotor of every joint, other findings, and bodies within trust."""

    def __init__(
        self,
        prepared: Prepared,
        balances: Balances,
        noise: Noise,
        causes: Sequence[Cause],
        *,
        bodies: bool,
    ) -> None:
        """Adds their columns to a new sheet.

        Args:
            prepared: the study.
            balances: whose rows they are.
            noise: of the rows.
            causes: all that was found.
            bodies: whether these may be off where the study says nothing of them.
        """
        self.sheet = Sheet(balances=balances, noise=noise)
        self._names: dict[Name, Cause | None] = {}  # with causes where any
        self._add_ordinary(balances)
        for found in causes:
            columns = columns_at(balances, found, found.shape)
            if columns and not found.is_costly:
                self._add((FOUND, *found.key), columns, found)
        limits = prepared.study.thresholds.priors
        trust = prepared.study.trust.rigid_body or (limits.bodies if bodies else 0.0)
        for term in trusted(balances, trust):
            body = ("body", term.place.link)
            self.sheet.add(body, term.columns, term.prior)
            self._names[body] = None

    def _add(self, name: Name, columns: Columns, cause: Cause) -> None:
        self.sheet.add(name, columns)
        self._names[name] = cause

    def _add_ordinary(self, balances: Balances) -> None:
        """The plain laws of every joint's torque."""
        for j in range(balances.n):
            place = Place(joints=(j,))
            for effect in CATALOGUE.values():
                if not effect.is_plain or place not in effect.places(balances.motions):
                    continue
                for shape in effect.asked(balances.motions, place)[:1]:
                    columns = balances.compute(effect, place, shape)
                    if columns:
                        cause = Cause(
                            effect=effect, places=(place,), shape=shape, beta=np.ones(1), words=""
                        )
                        self._add(("ordinary", effect.id, place), columns, cause)

    def added(self, cause: Cause) -> Name:
        """The name of a cause's contribution, which is added where it is new."""
        name = ("true", *cause.key)
        if not self.sheet.knows(name):
            self.sheet.add(name, contribution(self.sheet.balances, cause))
        return name

    def names(self, one: Cause, other: Cause | None) -> list[Name]:
        """Names of what is fitted beside two causes: nothing that is either of them."""
        kept = []
        for name, cause in self._names.items():
            if cause is not None and any(
                _is_the_same(cause, each) for each in (one, other) if each is not None
            ):
                continue
            if cause is None and one.effect.is_body and name[1] in _links(one):
                continue
            kept.append(name)
        return kept


def shapes_of(balances: Balances, cause: Cause) -> list[Shape]:
    """The one it was found with, and others."""
    effect = cause.effect
    if effect.costly:
        return [cause.shape]
    variant = effect.variant(cause.shape)
    shapes = [
        shape
        for shape in effect.shapes(balances.motions, cause.places[0])
        if effect.variant(shape) == variant
    ]
    step = max(1, -(-len(shapes) // _SHAPES))
    return list(dict.fromkeys([cause.shape, *shapes[::step], *_ends(effect, shapes)]))


def _ends(effect: Effect, shapes: Sequence[Shape]) -> list[Shape]:
    """The lowest and highest of a single nonlinear parameter: the diagnosis goes as far."""
    if not shapes or len(shapes[0]) != 1:
        return []
    low, high = min(shapes), max(shapes)
    ends = effect.shape_bounds(low)[0][0], effect.shape_bounds(high)[0][1]
    return [(end,) for end in ends if np.isfinite(end)]


def _is_the_same(plain: Cause, cause: Cause) -> bool:
    """Whether what is ordinary at a joint is a cause itself, or a coarser name for it."""
    alike = plain.effect.id == cause.effect.id or same_kind(plain.effect.id, cause.effect.id)
    return alike and plain.places[0] in [replace(p, gate=None) for p in cause.places]


def _links(cause: Cause) -> set[int | None]:
    return {place.link for place in cause.places}
