"""What was identified, as the next stages take it: nothing in it changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from ..findings import Support
from ..motion import Balances
from ..regression import Fit, Term, TermKey


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Weighed:
    """A cause that was compared, by itself or in the place of another."""

    term: Term
    log_odds: float  # over nothing there, at its best


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Part:
    """One ordinary part of a joint or a body, whether or not it is large enough to be named."""

    term: Term
    value: float  # of its first coefficient
    std: float
    negligible: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class Identified:
    """Causes that are claimed, with all else that is in the model as nuisance terms."""

    balances: Balances  # with the noise that the model leaves
    nuisance: tuple[Term, ...]  # what is in the model and not claimed
    fit: Fit  # of these, then of the claimed ones
    start: Fit  # of nothing
    bodies: float = 0.0  # share within which the model's inertial figures were adjusted
    support: Mapping[TermKey, Support] = field(default_factory=dict)
    rivals: Mapping[TermKey, tuple[Weighed, ...]] = field(default_factory=dict)
    tried: tuple[Weighed, ...] = ()
    ordinary: tuple[Part, ...] = ()
    doubtful: tuple[Term, ...] = ()  # likely, but too little to be claimed
    simulated: Mapping[TermKey, dict[str, float]] = field(default_factory=dict)  # figures
    confirmed: frozenset[TermKey] = frozenset()  # by simulations

    @property
    def accepted(self) -> tuple[Term, ...]:
        """Terms that are claimed."""
        return self.fit.terms[len(self.nuisance) :]

    @property
    def figures_simulated(self) -> list[dict[str, float]] | None:
        """Figures of all that is claimed as simulations have them; None where some have none."""
        known = [self.simulated[t.key] for t in self.accepted if t.key in self.simulated]
        return known if len(known) == len(self.accepted) else None

    @property
    def contacts(self) -> tuple[Term, ...]:
        """The claimed terms that are events."""
        return tuple(t for t in self.accepted if t.place.window is not None)

    def fitted(self, terms: Sequence[Term]) -> Identified:
        """The same with these terms, the nuisance's among them, and no others."""
        return replace(self, fit=Fit(self.balances, terms))

    def without(self, *terms: Term) -> Identified:
        """The same without some of the claimed terms."""
        return replace(self, fit=self.fit.without(*terms))
