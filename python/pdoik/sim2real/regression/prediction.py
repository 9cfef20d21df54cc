"""What the findings are worth on recordings that nothing was fitted to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray

from ..findings import Evidence
from ..motion import Balances, Key
from .fit import Fit, Term, TermKey
from .trusted_bodies import effect_of

_ACTS = 0.05  # numerics: of a part's mean square, from which it acts in a row
_DRAWS = 300


class Prediction:
    """A fit's terms evaluated on other balances; their columns are computed once."""

    def __init__(self, balances: Balances) -> None:
        """Predicts on these balances."""
        self.balances = balances
        self.events: list[tuple[Term, FloatArray]] = []  # found in these recordings themselves
        self.apart: set[TermKey] = set()  # terms that are not predicted with
        self._kept: dict[tuple[object, ...], dict[Key, FloatArray]] = {}

    def residual(self, fit: Fit) -> dict[Key, FloatArray]:
        """What the fit leaves, (N,) per key, all rows."""
        b = self.balances
        left = {key: b.residual[key].copy() for key in b.keys}
        for term, beta in fit.weighted:
            if term.key in self.apart:
                continue
            for key, column in self._columns(term).items():
                left[key] -= column @ beta
        for term, beta in self.events:
            for key, column in term.columns.items():
                left[key] -= column @ beta
        return left

    def rest(self, fit: Fit) -> Fit:
        """A fit of nothing yet to what another leaves."""
        return Fit(self.balances.with_residual(self.residual(fit)), ())

    def spread(self, changes: Sequence[tuple[Term, FloatArray]]) -> dict[Key, FloatArray]:
        """How far a session may be from the mean, as a standard deviation, (N,) per key."""
        squares: dict[Key, FloatArray] = {}
        for term, of_another in changes:
            for key, column in self._columns(term).items():
                part = np.sum((column * of_another) ** 2, axis=1)
                squares[key] = squares.get(key, np.zeros(len(part))) + part
        return {key: np.sqrt(square) for key, square in squares.items()}

    def _columns(self, term: Term) -> dict[Key, FloatArray]:
        name = (term.effect, term.place, term.shape)
        if name not in self._kept:
            self._kept[name] = self.balances.compute(effect_of(term), term.place, term.shape)
        return self._kept[name]

    def evidence(self, fit: Fit, term: Term, channels: tuple[str, ...], seed: int) -> Evidence:
        """How much of the mean square residual is the term's, all else as it is.

        What is left without it, the others' coefficients not fitted anew, less what is left.
        """
        b = self.balances
        with_it = self.residual(fit)
        beta, without = fit.beta_of(term), dict(with_it)
        for key, column in self._columns(term).items():
            without[key] = with_it[key] + column @ beta
        count = int(b.block.max()) + 1
        gained, began, other = np.zeros(count), np.zeros(count), np.zeros(count)
        acting = left_there = 0.0
        for key in term.columns:
            if key not in without:
                continue
            rows, scale = b.mask[key], b.sigma[key] ** -2
            block = b.block[rows]
            difference = (without[key][rows] ** 2 - with_it[key][rows] ** 2) * scale
            gained += np.bincount(block, difference, minlength=count)
            square = b.residual[key][rows] ** 2 * scale
            began += np.bincount(block, square, minlength=count)
            other += np.bincount(block, without[key][rows] ** 2 * scale, minlength=count)
            there = (without[key] - with_it[key])[rows] ** 2
            acts = there > _ACTS * max(float(there.mean()), 1e-300)
            acting += float(difference[acts].sum())
            left_there += float(np.sum(without[key][rows][acts] ** 2)) * scale
        with_others = acting / max(left_there, 1e-12)
        if other.sum() > began.sum():  # the rest alone make it worse than it was
            began = other
        seen = share_by_blocks(gained, began, seed)
        return replace(seen, channels=channels, with_others=with_others)


def share_by_blocks(gained: FloatArray, began: FloatArray, seed: int) -> Evidence:
    """Share that was gained of what began, of all blocks, and its interval by their bootstrap."""
    rng = np.random.default_rng(seed)
    count = len(gained)
    draws = []
    for _ in range(_DRAWS):
        picked = rng.integers(0, count, count)
        draws.append(gained[picked].sum() / max(began[picked].sum(), 1e-12))
    low, high = np.quantile(draws, (0.025, 0.975))
    return Evidence(
        validation_gain=float(gained.sum() / max(float(began.sum()), 1e-12)),
        interval95=(float(low), float(high)),
    )
