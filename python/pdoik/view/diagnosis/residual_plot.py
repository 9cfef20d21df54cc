"""One joint's residual over the recording, before and with the findings, with a mark at now."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
import numpy.typing as npt
import viser
from viser import uplot

from pdoik.sim2real.evidence import Motions

from .timeline import Timeline

FloatArray = npt.NDArray[np.float64]

_POINTS = 400
_BEFORE, _AFTER, _NOW = "#c9542c", "#1a6fb5", "#1c2127"


class ResidualPlot:
    """Plot of the residual of the joint that is chosen."""

    def __init__(self, gui: viser.GuiApi) -> None:
        nothing = np.zeros(2)
        self._time = np.linspace(0.0, 1.0, 2)
        self._lines: list[FloatArray] = [nothing, nothing]
        self._end = 1.0
        self.plot: Any = gui.add_uplot(
            data=(self._time, nothing, nothing, nothing),
            series=_series(""),
            height=150,
            scales={"x": uplot.Scale(time=False, auto=True), "y": uplot.Scale(auto=True)},
            axes=(uplot.Axis(space=40), uplot.Axis(space=22, size=44)),  # pixels
            legend=uplot.Legend(show=False),
            padding=(8, 8, 0, 0),
        )
        self.key: Any = gui.add_html("")

    def show(self, line: Timeline, joint: int, motions: Motions) -> None:
        """Draw joint number `joint`'s."""
        both = [values[:, joint] for values in (line.motion.before, line.motion.after)]
        known = np.flatnonzero(np.isfinite(both).all(axis=0))
        if len(known) < 2:  # the joint was not judged
            known, both = np.array([0, len(line.time) - 1]), [np.zeros(len(line.time))] * 2
        rows = known[np.unique(np.linspace(0, len(known) - 1, _POINTS).astype(int))]
        self._time = line.time[rows]
        self._lines = [values[rows] for values in both]
        self._end = 1.05 * max(float(np.abs(np.array(self._lines)).max()), 1e-12)
        self.plot.series = _series(motions.units[joint])
        self.key.content = _key(motions.joints[joint], motions.units[joint])

    def mark(self, elapsed: float) -> None:
        """A line at that time [s]; elsewhere it is the zero line."""
        k = int(np.searchsorted(self._time, elapsed))
        now = np.zeros(len(self._time))
        at = min(max(k, 1), len(self._time) - 1)
        now[at - 1 : at + 1] = self._end, -self._end
        self.plot.data = (self._time, *self._lines, now)


def _series(unit: str) -> tuple[uplot.Series, ...]:
    return (
        uplot.Series(label="time [s]"),
        uplot.Series(label=f"before [{unit}]", stroke=_BEFORE, width=1),
        uplot.Series(label=f"with the findings [{unit}]", stroke=_AFTER, width=1),
        uplot.Series(label="now", stroke=_NOW, width=1),
    )


def _key(joint: str, unit: str) -> str:
    """What the lines are."""
    lines = "".join(
        f'<span style="color:{color};white-space:nowrap;margin-left:0.8em">&#9644; {words}</span>'
        for color, words in ((_BEFORE, "before"), (_AFTER, "with the findings"))
    )
    return (
        '<div style="padding:0 1em 0.4em;font-size:0.75em">'
        f"residual of {escape(joint)} [{escape(unit)}] over time [s]{lines}</div>"
    )
