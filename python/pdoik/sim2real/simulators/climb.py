"""The likeliest values of parameters that are fitted together by simulating candidates.

Lines are laid by finite differences, the kernel's `Model` solves them with the noise of each
channel, and a step counts where the posterior of true rollouts grows (Levenberg, Marquardt).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..identify import Hypothesis, Linearisation, Model, Series
from ..motion import Place
from ..regression import Term, repeats
from ..simulation import SimulationError
from .candidates import ParameterId
from .experiment import Experiment
from .parameters import Parameter
from .property import EVERY

Mask = NDArray[np.bool_]

_OLDEST = 3  # steps with the same lines
_TRIES = 7  # of a step's length
_LEAST_DAMPED = 1e-9  # of what lines say: else what only priors know would never move
_FARTHEST = 1.5  # that one step moves a coordinate
_DIFFERENCE = 5e-3  # of a coordinate
_FOLLOWS = 0.03  # time in which drives follow, and rows say the same [s]
_BELOW = (0.9, 0.75, 0.6, 0.45, 0.3)  # of the torque that is used, where limits are tried
_OCTAVES = 6  # that gains may be off by, up or down
_BETTER = 8.0  # numerics: log posterior that what is tried from afar must gain
_FLOORS = {"q": 2e-4, "tau": 1e-2}  # what is not explained, at least [rad], [N m]


class Climb:
    """Parameters of one experiment; x (P,) are their coordinates."""

    def __init__(self, experiment: Experiment, parameters: Sequence[Parameter]) -> None:
        self.experiment, self.parameters = experiment, tuple(parameters)
        self.start = np.array([each.start for each in parameters])
        self.std = np.array([each.std for each in parameters])
        self.place = {each.parameter_id: i for i, each in enumerate(parameters)}
        self.floor = np.array([_FLOORS[channel] for channel, _ in experiment.channels])
        self._trees = np.array(experiment.user.trees())
        self._of_column = self._trees[[k for _, k in experiment.channels]]
        # Rows that say something new: one in a time that drives take to follow.
        rows = len(experiment.measured) * min(1.0, experiment.spacing / _FOLLOWS)
        self.rows = np.full(len(experiment.channels), rows)

    def values(self, x: FloatArray) -> dict[ParameterId, float]:
        """Values of the parameters that are not the user's."""
        both = zip(self.parameters, x, strict=True)
        return {each.parameter_id: each.value(at) for each, at in both if at != each.start}

    def x_of(self, values: Mapping[ParameterId, float]) -> FloatArray:
        """Coordinates of a candidate."""
        x = self.start.copy()
        for parameter_id, value in values.items():
            x[self.place[parameter_id]] = self.parameters[self.place[parameter_id]].x_of(value)
        return x

    def run(self, x: FloatArray) -> FloatArray:
        """(R, C); NaN where a candidate is unstable."""
        try:
            return self.experiment.run(self.values(x))
        except SimulationError:
            return np.full_like(self.experiment.measured, np.nan)

    def log(self, x: FloatArray, shown: FloatArray) -> float:
        """Log posterior, the noise of each channel at its likeliest; -inf where it is unstable."""
        if not np.isfinite(shown).all():
            return -np.inf
        size = np.mean((self.experiment.measured - shown) ** 2, axis=0)
        likely = -0.5 * float(self.rows @ np.log(np.maximum(size, self.floor**2)))
        return likely - 0.5 * float((((x - self.start) / self.std) ** 2).sum())

    def to_top(self, x: FloatArray, active: Mask, rounds: int, enough: float) -> FloatArray:
        """Coordinates at which no step gains as much as `enough`, or rounds are over.

        Lines are laid anew where a step with old ones gains little.
        """
        shown, damped = self.run(x), 0.01
        J = np.zeros((len(x), *shown.shape))
        age = 0  # of the lines, in steps
        for _ in range(rounds):
            now = self.log(x, shown)
            if age == 0:
                J = self.lines(x, shown, active)
            best: tuple[float, FloatArray, FloatArray] | None = None
            for _ in range(_TRIES):
                there = self._solved(x, shown, J, active, damped)
                there = x + np.clip(there - x, -_FARTHEST, _FARTHEST)
                shows = self.run(there)
                value = self.log(there, shows)
                if value > now and (best is None or value > best[0]):
                    best, damped = (value, there, shows), max(damped / 10.0, _LEAST_DAMPED)
                    if damped <= _LEAST_DAMPED:
                        break
                else:
                    damped *= 4.0
                    if best is not None:
                        break
            gained = 0.0 if best is None else best[0] - now
            if best is not None:
                _, x, shown = best
            if gained < enough and age == 0:
                break
            age = 0 if gained < enough else (age + 1) % _OLDEST
        return x

    def lines(self, x: FloatArray, shown: FloatArray, active: Mask) -> FloatArray:
        """Derivatives (P, R, C); parameters of trees that do not touch are turned in one run."""
        J = np.zeros((len(x), *shown.shape))
        for group in self._together(active):
            moved = x.copy()
            moved[group] += _DIFFERENCE
            change = (self.run(moved) - shown) / _DIFFERENCE
            if not np.isfinite(change).all():
                continue
            for i in group:
                index = self.parameters[i].parameter_id.index
                mine = index == EVERY or self._of_column == self._trees[index]
                J[i] = np.where(mine, change, 0.0)
        return J

    def _together(self, active: Mask) -> list[list[int]]:
        """Active parameters, grouped so that none of a group moves what another of it moves."""
        queues: dict[int, list[int]] = {}
        alone = []
        for i in map(int, np.flatnonzero(active)):
            index = self.parameters[i].parameter_id.index
            if index == EVERY:
                alone.append([i])
            else:
                queues.setdefault(int(self._trees[index]), []).append(i)
        turns = max(map(len, queues.values()), default=0)
        return alone + [[q[k] for q in queues.values() if k < len(q)] for k in range(turns)]

    def _solved(
        self, x: FloatArray, shown: FloatArray, J: FloatArray, active: Mask, damped: float
    ) -> FloatArray:
        """Likeliest coordinates by the kernel's model of these lines, not far where damped."""
        at = np.flatnonzero(active)
        size = np.maximum(np.mean((self.experiment.measured - shown) ** 2, axis=0), self.floor**2)
        data = linearised(self, shown, np.einsum("prc,p->rc", J[at], x[at]), self.rows)
        hypotheses = []
        for i in at:
            each = self.parameters[i]
            own = each.std**-2
            more = damped * (own + float((np.mean(J[i] ** 2, axis=0) / size) @ self.rows))
            mean = (own * each.start + more * x[i]) / (own + more)
            positive = each.kind == "gap"
            hypotheses.append(hypothesis(each, J[i], mean, own + more, positive=positive))
        found = x.copy()
        found[at] = Model(data, hypotheses).beta
        return found

    def with_gains(self) -> FloatArray:
        """Gains of all drives that are likelier than the user's, by factors of two.

        About gains that are many times too high, positions hardly change with anything.
        """
        x = self.start.copy()
        best = self.log(x, self.run(x))
        names = ("kp",), ("kv",), ("kp", "kv")
        for some in (*names, *names):
            mine = [
                i for i, each in enumerate(self.parameters) if each.parameter_id.property in some
            ]
            tried = []
            for k in (k for k in range(-_OCTAVES, _OCTAVES + 1) if k):
                other = x.copy()
                for i in mine:
                    each = self.parameters[i]
                    value = max(each.value(float(x[i])), each.scale)
                    other[i] = each.x_of(value * 2.0**k)
                tried.append((self.log(other, self.run(other)), other))
            value, other = max(tried, key=lambda pair: pair[0])
            if value > best + _BETTER:
                best, x = value, other
        return x

    def with_limits(self, x: FloatArray) -> FloatArray:
        """Limits of torque that are not reached show nothing: some below what is used are tried."""
        best = self.log(x, self.run(x))
        for i, each in enumerate(self.parameters):
            if each.parameter_id.property != "force_limit":
                continue
            used = self.experiment.largest_torque(self.values(x), each.parameter_id.index)
            for share in _BELOW:
                other = x.copy()
                other[i] = each.x_of(share * used)
                value = self.log(other, self.run(other))
                if value > best + _BETTER:
                    best, x = value, other
        return x

    def independent(self, shown: FloatArray) -> FloatArray:
        """Rows of each channel that say something new, by what is left of it, (C,).

        What is left below the floor is nothing that a property need explain: it counts as less.
        """
        left = self.experiment.measured - shown
        parts = self.experiment.parts
        rows = [len(c) / max(repeats(c[part] for part in parts), 1.0) for c in left.T]
        trusted = np.minimum(np.mean(left**2, axis=0) / self.floor**2, 1.0)
        return np.asarray(np.array(rows) * trusted)


def linearised(
    climb: Climb, shown: FloatArray, explained: FloatArray, rows: FloatArray
) -> Linearisation:
    """The kernel's rows: what is measured beyond what is shown, and what lines explain of it."""
    target = climb.experiment.measured - shown + explained
    return Linearisation(
        {
            ("servo", c): Series(
                rows=np.arange(len(shown)),
                target=np.ascontiguousarray(target[:, c]),
                floor=float(climb.floor[c]),
                parts=climb.experiment.parts,
                independent=float(rows[c]),
            )
            for c in range(shown.shape[1])
        }
    )


def hypothesis(
    parameter: Parameter, J: FloatArray, mean: float, precision: float, *, positive: bool
) -> Hypothesis:
    """The kernel's, of one parameter with its lines (R, C)."""
    each = np.array([precision])
    term = Term(
        effect=parameter.parameter_id.property,
        place=Place(joints=(max(parameter.parameter_id.index, 0),)),
        shape=(),
        columns={("servo", c): J[:, c][:, None] for c in range(J.shape[1]) if J[:, c].any()},
        prior=each,
    )
    return Hypothesis(
        term=term, mean=np.array([mean]), precision=each, ordinary=True, positive=positive
    )
