"""The CUSUM charts of all joints, with a threshold for a stated rate of false alarms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray

from ..model import Healthy
from ..thresholds import WatchThresholds
from .cusum import Cusum, threshold_for
from .residuals import CHART_EFFECTS, ResidualRows
from .today import OrdinaryToday

DAY = 86400.0  # [s]
_SIGNS = np.array([1.0, -1.0])
_LIKELY = 3.0  # times its root mean square that a healthy coefficient may be


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """A chart that has crossed the threshold."""

    joint: int
    effect: str  # of the column that the chart is held against
    onset: float  # when the chart was last at zero [s]
    time: float  # of the row that crossed [s]


class Charts:
    """Charts of three columns, up and down, for each joint that moves in healthy logs."""

    def __init__(self, healthy: Healthy, thresholds: WatchThresholds) -> None:
        """Raises ValueError where no joint can be watched."""
        self.healthy = healthy
        self._limits = thresholds
        self.watched = healthy.seconds >= thresholds.least_motion  # (n,)
        if not self.watched.any():
            raise ValueError("no joint moves long enough in the healthy logs to be watched")
        self.smallest, self.threshold = self._design()
        self.cusum = Cusum((*self.smallest.shape, 2))
        self.today = OrdinaryToday(healthy, thresholds)

    def _design(self) -> tuple[FloatArray, float]:
        """The smallest change that each chart looks for, (n, 3) [N m], and the threshold of all.

        A chart falls while a coefficient is below half of that change. So this is twice what a
        healthy coefficient may be, or what is just detected within the time that is asked for;
        where the model leaves so much that this is more than the joint's friction, it takes longer.
        """
        h, limits = self.healthy, self._limits
        per_square = h.power / (2.0 * h.density)  # information of a change of 1 N m [1/s]
        rate = limits.alarms_per_day / DAY
        doubled = np.where(h.friction > 0.0, h.friction, np.inf)[:, None]
        threshold = 10.0
        for _ in range(50):
            quick = np.sqrt(threshold / (limits.told_within * per_square))
            smallest = np.maximum(2.0 * _LIKELY * h.bias, np.minimum(quick, doubled))
            information = (smallest**2 * per_square)[self.watched]
            threshold = threshold_for(np.repeat(information, 2), rate)
        return smallest, threshold

    def update(self, rows: ResidualRows) -> tuple[int, Crossing | None, FloatArray]:
        """Add rows until a chart crosses.

        Returns:
            Rows that were added, the crossing, and the charts after each of them (N', n, 3, 2).
        """
        used, path = self.cusum.update(rows.time, self.increments(rows), self.threshold)
        if not used or path[-1].max() < self.threshold:
            if used:
                self.today.learn(rows, self.cusum.since.min(axis=(1, 2)))
            return used, None, path
        self.today.forget()
        joint, column, sign = np.unravel_index(int(np.argmax(path[-1])), path[-1].shape)
        onset = float(self.cusum.since[joint, column, sign])
        crossing = Crossing(
            joint=int(joint),
            effect=CHART_EFFECTS[int(column)][0],
            onset=onset if np.isfinite(onset) else float(rows.time[0]),
            time=float(rows.time[used - 1]),
        )
        return used, crossing, path

    def increments(self, rows: ResidualRows) -> FloatArray:
        """Log likelihood ratios of the rows, (N, n, 3, 2).

        Of what is healthy, the least favourable is meant (Huber, Ann. Math. Statist. 36, 1965):
        friction as far off in the residual's direction as what is known of it allows. Bounded, so
        that no crossing rests on less than a short time: what jumps for a sample is no change.
        """
        h = self.healthy
        sigma = np.sqrt(h.variance_at(rows.features))  # (N, n)
        x = rows.columns / (h.scale * sigma[:, :, None])
        score = x * (_beyond(rows) / sigma)[:, :, None]  # (N, n, 3)
        change = self.smallest * rows.step / h.density
        up_and_down = _SIGNS * score[..., None]
        ratio = change[..., None] * (up_and_down - 0.5 * (self.smallest * x**2)[..., None])
        most = self.threshold * rows.step / self._limits.shortest
        counted = (rows.moving & self.watched)[:, :, None, None]
        return np.where(counted, np.clip(ratio, -most, most), 0.0)


def _beyond(rows: ResidualRows) -> FloatArray:
    """What of the residual, (N, n), friction and known changes cannot be."""
    return np.asarray(np.sign(rows.residual) * np.maximum(np.abs(rows.residual) - rows.allowed, 0))
