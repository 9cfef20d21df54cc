"""The tab of the numbers: every joint's residual now, and where the simulation is."""

from __future__ import annotations

from html import escape

import numpy as np
import viser

from pdoik.sim2real.evidence.motions import Motions
from pdoik.sim2real.report.words import number

from .timeline import Timeline

_HEAD = ("", "before", "after", "off before", "off after")


class NumbersTab:
    """A table with a row for each joint."""

    def __init__(self, gui: viser.GuiApi, motions: Motions) -> None:
        self._motions = motions
        self.table = gui.add_html("")

    def show(self, line: Timeline, elapsed: float) -> None:
        """At that time [s]."""
        before, after = (line.residual(which, elapsed) for which in ("before", "after"))
        recorded = line.q("recorded", elapsed)
        off = [1e3 * (line.q(which, elapsed) - recorded) for which in ("before", "after")]
        known = line.is_simulated(elapsed)
        rows = []
        for j, joint in enumerate(self._motions.joints):
            small = "mm" if self._motions.position_units[j] == "m" else "mrad"
            cells = [
                escape(joint),
                number(float(before[j])),
                f"{number(float(after[j]))} {escape(self._motions.units[j])}",
                *(number(float(np.round(each[j], 3))) if known else "" for each in off),
            ]
            cells[-1] += f" {small}" if known else ""
            rows.append(cells)
        self.table.content = _table([list(_HEAD), *rows])


def _table(rows: list[list[str]]) -> str:
    body = "".join(
        "<tr>"
        + "".join(
            f'<td style="padding:0.1em 0.6em 0.1em 0;text-align:{"left" if k == 0 else "right"};'
            f'overflow-wrap:anywhere">{cell}</td>'
            for k, cell in enumerate(row)
        )
        + "</tr>"
        for row in rows
    )
    return (
        '<div style="padding:0.3em 1em;font-size:0.8em;font-variant-numeric:tabular-nums">'
        "Residual, rms over 0.5 s about now, and by how much the simulated position is off."
        f'<table style="border-spacing:0;margin-top:0.4em">{body}</table></div>'
    )
