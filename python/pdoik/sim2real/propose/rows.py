"""Columns of causes on the rows that count, whitened, and their products."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from pdoik.recordings import FloatArray

from ..motion.balances import Balances
from ..motion.place import Key, Place, Shape
from ..regression.background import background
from ..regression.fit import Fit, term_of
from ..regression.repeats import repeats_of
from .questions import Cause

_RIDGE = 1e-9  # of a column's own power

Columns = Mapping[Key, FloatArray]  # (N, k) for each balance that changes


@dataclass(frozen=True, kw_only=True, eq=False)
class Noise:
    """What recordings leave where everything is explained."""

    sigma: Mapping[Key, float]
    repeats: Mapping[Key, float]  # rows that say the same

    def scale(self, balances: Balances, key: Key) -> float:
        """By which a row is multiplied to count as one of its own."""
        sigma = float(np.hypot(self.sigma[key], balances.sigma[key]))
        return float(1.0 / (sigma * np.sqrt(self.repeats[key])))


def noise_of(balances: Balances, causes: Sequence[Cause]) -> Noise:
    """Of recordings in which these causes act, beside all that is ordinary."""
    ordinary = background(balances)[1]
    terms = [
        term
        for cause in causes
        for place in cause.places
        if (term := term_of(balances, cause.effect, place, cause.shape)) is not None
    ]
    fit = Fit(balances, [*ordinary, *terms])
    sigma, same = dict(balances.floor), dict.fromkeys(balances.keys, 1.0)
    for key, rows in fit.rows.items():
        if len(rows) > fit.size / max(len(fit.rows), 1):
            left = fit.residual(key)
            rms = float(np.sqrt(np.mean(left**2))) * balances.sigma[key]
            sigma[key] = max(sigma[key], rms)
            same[key] = repeats_of(balances, rows, left)
    usual = float(np.median(list(same.values())))
    return Noise(sigma=sigma, repeats={key: max(each, usual) for key, each in same.items()})


@dataclass(kw_only=True, eq=False)
class Sheet:
    """Named columns side by side, and all their products."""

    balances: Balances
    noise: Noise
    _parts: list[FloatArray] = field(default_factory=list)
    _spans: dict[object, NDArray[np.intp]] = field(default_factory=dict)
    _priors: list[FloatArray] = field(default_factory=list)
    _gram: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    _width: int = 0

    def __post_init__(self) -> None:
        """Finds the rows."""
        b = self.balances
        self._rows = {key: np.flatnonzero(b.mask[key]) for key in b.keys}
        self._scale = {key: self.noise.scale(b, key) for key in b.keys}
        ends = np.cumsum([0, *(len(rows) for rows in self._rows.values())])
        self._first = dict(zip(self._rows, ends[:-1].tolist(), strict=True))
        self._count = int(ends[-1])
        self._whole = np.zeros((self._count, 0))

    def add(self, name: object, columns: Columns, prior: FloatArray | None = None) -> None:
        """Columns by a name of their own."""
        width = next((each.shape[1] for each in columns.values()), 0)
        part = np.zeros((self._count, width))
        for key, column in columns.items():
            rows, first = self._rows[key], self._first[key]
            part[first : first + len(rows)] = column[rows] * self._scale[key]
        self._spans[name] = np.arange(self._width, self._width + width)
        self._width += width
        self._parts.append(part)
        self._priors.append(np.zeros(width) if prior is None else prior)

    def knows(self, name: object) -> bool:
        """Whether columns of this name were added."""
        return name in self._spans

    @property
    def gram(self) -> FloatArray:
        """Products of all columns."""
        done = len(self._gram)
        if self._parts:
            new = np.hstack(self._parts)
            self._parts.clear()
            if self._width > self._whole.shape[1]:
                wider = np.zeros((self._count, 2 * self._width))
                wider[:, :done] = self._whole[:, :done]
                self._whole = wider
            self._whole[:, done : self._width] = new
            products = self._whole[:, : self._width].T @ new
            gram = np.zeros((self._width, self._width))
            gram[:done, :done] = self._gram
            gram[:, done:], gram[done:, :] = products, products.T
            self._gram = gram
        return self._gram

    def left_by_block(self, name: object, beside: Iterable[object]) -> FloatArray:
        """Sums of squares, by blocks of time, that others, refitted, leave of a single column."""
        (at,) = self._spans[name]
        index, taken = self._taken(at, beside)
        left = self._whole[:, at] - self._whole[:, index] @ taken
        blocks = np.concatenate([self.balances.block[rows] for rows in self._rows.values()])
        sums = np.bincount(blocks, left**2, minlength=int(self.balances.block.max()) + 1)
        acting = np.bincount(blocks, self._whole[:, at] ** 2, minlength=len(sums)) > 0.0
        return np.asarray(sums[acting], dtype=np.float64)

    def left(self, name: object, beside: Iterable[object]) -> float:
        """Sum of squares that others, refitted, leave of a single column; the prior's included."""
        (at,) = self._spans[name]
        index, taken = self._taken(at, beside)
        return float(max(self.gram[at, at] - self.gram[index, at] @ taken, 0.0))

    def _taken(self, at: int, beside: Iterable[object]) -> tuple[NDArray[np.intp], FloatArray]:
        """Columns that others have, by number, and their coefficients where they fit a column."""
        gram, prior = self.gram, np.concatenate(self._priors)
        parts = [self._spans[each] for each in beside if each in self._spans]
        index = np.concatenate(parts) if parts else np.zeros(0, dtype=np.intp)
        index = index[np.diag(gram)[index] > 0.0]
        if not len(index):
            return index, np.zeros(0)
        inside, cross = gram[np.ix_(index, index)] + np.diag(prior[index]), gram[index, at]
        size = 1.0 / np.sqrt(np.diag(inside))
        even = inside * np.outer(size, size) + _RIDGE * np.eye(len(index))
        return index, np.asarray(size * linalg.solve(even, size * cross, assume_a="pos"))

    def fitted(self, name: object, of: object, beside: Iterable[object]) -> FloatArray:
        """Coefficients of one name's columns where a column is fitted by them and others."""
        gram, prior = self.gram, np.concatenate(self._priors)
        (at,) = self._spans[of]
        own = self._spans[name]
        index = np.concatenate([own, *(self._spans[e] for e in beside if e in self._spans)])
        kept = np.diag(gram)[index] > 0.0
        index = index[kept]
        inside = gram[np.ix_(index, index)] + np.diag(prior[index])
        size = 1.0 / np.sqrt(np.diag(inside))
        even = inside * np.outer(size, size) + _RIDGE * np.eye(len(index))
        beta = size * linalg.solve(even, size * gram[index, at], assume_a="pos")
        result = np.zeros(len(own))
        result[kept[: len(own)]] = beta[: int(kept[: len(own)].sum())]
        return result

    def power(self, name: object) -> float:
        """Sum of squares of a single column."""
        (at,) = self._spans[name]
        return float(self.gram[at, at])

    def acting(self, name: object) -> float:
        """Rows that say something of their own, on which a single column acts."""
        (at,) = self._spans[name]
        column = self._whole[:, at] if self.gram.size else np.zeros(self._count)
        count = 0.0
        for key, rows in self._rows.items():
            part = column[self._first[key] : self._first[key] + len(rows)] ** 2
            if len(part) and part.any():
                count += float(np.sum(part > 0.05 * part.mean())) / self.noise.repeats[key]
        return count


def columns_at(
    balances: Balances, cause: Cause, shape: Shape, places: Sequence[Place] | None = None
) -> dict[Key, FloatArray]:
    """A cause's columns by key, those of several places side by side."""
    found = [
        balances.compute(cause.effect, place, shape)
        for place in (cause.places if places is None else places)
    ]
    widths = [next((c.shape[1] for c in each.values()), 0) for each in found]
    ends = np.cumsum([0, *widths])
    result: dict[Key, FloatArray] = {}
    for each, first, last in zip(found, ends[:-1], ends[1:], strict=True):
        for key, column in each.items():
            result.setdefault(key, np.zeros((balances.count, int(ends[-1]))))
            result[key][:, first:last] = column
    return result


def contribution(balances: Balances, cause: Cause) -> dict[Key, FloatArray]:
    """What a cause adds with its figures, one column for each key."""
    total: dict[Key, FloatArray] = {}
    for place in cause.places:
        for key, column in balances.compute(cause.effect, place, cause.shape).items():
            added = column @ cause.beta[: column.shape[1]]
            total[key] = total.get(key, 0.0) + added[:, None]
    return total
