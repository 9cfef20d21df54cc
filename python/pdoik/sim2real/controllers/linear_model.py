"""One series of rows explained by named columns: the kernel's model of it.

Every coefficient has a prior; noise, rows that say the same, evidence and errors are the kernel's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from pdoik.recordings import FloatArray

from ..identify import Hypothesis, Linearisation, Model, Series
from ..motion import Key, Place
from ..regression import Term

_KEY: Key = ("law", 0)
_LARGE = 10.0  # standard deviation of a coefficient's part, in root mean squares of the target
_FLOOR = 1e-6  # noise at least, as a share of the target


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Parameter:
    """Coefficients of one name, normal about `mean`; or of a part as large as the target."""

    name: str
    columns: FloatArray  # (N,) or (N, k)
    mean: float = 0.0
    std: float | None = None  # None: by the size of the target
    positive: bool = False  # of one column alone

    def hypothesis(self, size: float) -> Hypothesis:
        """The kernel's; `size` is the target's root mean square."""
        columns = self.columns.reshape(len(self.columns), -1)
        varied = np.std(columns, axis=0)  # a constant takes up the mean
        varied = np.where(varied > 0.0, varied, np.sqrt(np.mean(columns**2, axis=0)))
        usual = _LARGE * size / np.where(varied > 0.0, varied, 1.0)
        precision = (usual if self.std is None else np.full(len(usual), self.std)) ** -2
        return Hypothesis(
            term=Term(
                effect=self.name,
                place=Place(),
                shape=(),
                columns={_KEY: columns},
                prior=precision,
            ),
            mean=np.full(len(usual), self.mean),
            precision=precision,
            ordinary=True,
            positive=self.positive,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearModel:
    """Parameters fitted together to one target."""

    target: FloatArray  # (N,)
    parameters: tuple[Parameter, ...]
    parts: tuple[slice, ...]  # rows of one recording each
    rows: float = 0.0  # that say something new; 0: by what the model leaves
    kernel: Model = field(init=False)

    def __post_init__(self) -> None:
        """Fits at once."""
        size = max(float(np.sqrt(np.mean(self.target**2))), 1e-300)
        series = Series(
            rows=np.arange(len(self.target)),
            target=self.target,
            floor=_FLOOR * size,
            parts=self.parts,
            independent=self.rows,
        )
        hypotheses = [each.hypothesis(size) for each in self.parameters]
        model = Model(Linearisation({_KEY: series}), hypotheses)
        if not self.rows:
            series.independent = len(series.rows) / series.repeats(model.left(_KEY))
            model = Model(model.data, hypotheses, model)
        object.__setattr__(self, "kernel", model)
        object.__setattr__(self, "rows", series.independent)

    @property
    def left(self) -> FloatArray:
        """What it leaves, (N,)."""
        return self.kernel.left(_KEY)

    @property
    def rss(self) -> float:
        """Sum of squares that it leaves."""
        return float(self.left @ self.left)

    def of(self, name: str) -> FloatArray:
        """Coefficients of a parameter, (k,)."""
        return np.asarray(self.kernel.beta[self._span(name)])

    def value(self, name: str) -> float:
        """The first coefficient of a parameter."""
        return float(self.of(name)[0])

    def std(self, name: str) -> float:
        """Standard error of the first coefficient of a parameter."""
        return float(np.sqrt(self.kernel.variances[self._span(name)][0]))

    def with_prior(self, name: str, mean: float, std: float) -> LinearModel:
        """The model with another prior of one name, if it is there."""
        parameters = tuple(
            replace(each, mean=mean, std=std) if each.name == name else each
            for each in self.parameters
        )
        return replace(self, parameters=parameters)

    def over(self, other: LinearModel, least: float = 0.0) -> float:
        """Log evidence beyond another model of the same rows.

        As many of them say something new as this one leaves, or as are known to at least.
        """
        rows = max(self.rows, least)
        mine, others = (replace(each, rows=rows).kernel for each in (self, other))
        return mine.log_evidence - others.log_evidence

    def _span(self, name: str) -> slice:
        return next(span for each, span in self.kernel.placed if each.term.effect == name)


def parts_of(lengths: Sequence[int]) -> tuple[slice, ...]:
    """Neighbouring stretches of such lengths."""
    ends = np.cumsum([0, *lengths])
    return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))
