"""The most flexible model of a study: how many rows say something new once nothing is left to name.

A residual that nobody has explained yet is slow, and looks like few rows. Counted there, a cause
that is swept through once would never be seen. So rows are counted where smooth functions of
position, speed, load and time have taken what any cause might.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import hats
from ..motion import Balance, Balances, Columns, Motion, Place, Shape
from ..regression import Term
from .hypothesis import Hypothesis, ordinary, usual_size
from .linearisation import Linearisation
from .model import Model
from .ordinary import Ordinary

_KNOTS = 7
_ROUNDS = 4  # of coefficients and noise: nothing but the shape of what is left is asked
_BALANCES: tuple[Balance, ...] = ("torque", "drive", "law", "velocity", "servo")
_SOFT = (0.02, 0.2)  # speeds over which friction turns [rad/s]


class Smooth:
    """Smooth functions of one joint's variables, in all balances of the joint."""

    id = "smooth"

    def __init__(self, balances: Balances) -> None:
        self._ends = {}
        for j in range(balances.n):
            for name in ("q", "dq", "borne", "time"):
                x = np.concatenate([_variable(m, name, j) for m in balances.motions])
                self._ends[name, j] = np.quantile(x, (0.005, 0.995))

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Hat functions, steps of direction, acceleration, in the balance that the shape names."""
        (j,) = place.joints
        parts = [motion.sign(j, s)[:, None] for s in _SOFT] + [motion.ddq[:, j, None]]
        for name in ("q", "dq", "borne", "time"):
            low, high = self._ends[name, j]
            if high > low:
                parts.append(hats(_variable(motion, name, j), float(low), float(high), _KNOTS))
        return {(_BALANCES[int(shape[0])], j): np.hstack(parts)}


def _variable(motion: Motion, name: str, j: int) -> FloatArray:
    values: FloatArray = getattr(motion, name)
    return values if values.ndim == 1 else values[:, j]


def count_independent(balances: Balances, data: Linearisation) -> None:
    """Set how many rows of each series say something new: one of a block at least."""
    smooth = Smooth(balances)
    ordinary_part = Ordinary(balances=balances, bodies=1.0).hypotheses()
    hypotheses = [replace(each, positive=False) for each in ordinary_part]
    for j in range(balances.n):
        for number, balance in enumerate(_BALANCES):
            if (balance, j) in data.series:
                hypotheses += _of_balance(balances, data, smooth, j, (float(number),))
    model = Model(Linearisation(data.series), hypotheses, rounds=_ROUNDS)
    for key, series in data.series.items():
        blocks = len(np.unique(balances.block[series.rows]))
        series.independent = max(len(series.rows) / series.repeats(model.left(key)), blocks)


def _of_balance(
    balances: Balances, data: Linearisation, smooth: Smooth, j: int, shape: Shape
) -> list[Hypothesis]:
    """Smooth functions in one balance of a joint, of usual size each; none where none acts."""
    place, key = Place(joints=(j,)), (_BALANCES[int(shape[0])], j)
    columns = balances.compute(smooth, place, shape)
    if key not in columns:
        return []
    size = np.sqrt(np.mean(columns[key][data.series[key].rows] ** 2, axis=0))
    kept = size > 0.0
    if not kept.any():
        return []
    term = Term(
        effect=Smooth.id,
        place=place,
        shape=shape,
        columns={each: values[:, kept] for each, values in columns.items()},
        prior=np.ones(int(kept.sum())),
    )
    return [ordinary(term, max(usual_size(balances, key), 1e-9) / size[kept])]
