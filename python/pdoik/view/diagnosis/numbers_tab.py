"""The tab of the numbers: every joint's residual now, and where the simulation is."""

from __future__ import annotations

from html import escape

import numpy as np
import viser

from pdoik.sim2real.evidence import Motions
from pdoik.sim2real.report import number

from .timeline import Timeline

_NOW = ("", "before", "after", "off before", "off after")
_WHOLE = ("", "before", "after")


class NumbersTab:
    """A table with a row for each joint at the time that is shown, and one of the recording."""

    def __init__(self, gui: viser.GuiApi, motions: Motions) -> None:
        self._motions = motions
        self._small = ["mm" if unit == "m" else "mrad" for unit in motions.position_units]
        self.table = gui.add_html("")
        self.departures = gui.add_html("")

    def show(self, line: Timeline, elapsed: float) -> None:
        """Show the numbers at a time [s]."""
        before, after = (line.residual(which, elapsed) for which in ("before", "after"))
        recorded = line.q("recorded", elapsed)
        off = [1e3 * (line.q(which, elapsed) - recorded) for which in ("before", "after")]
        known = line.is_simulated(elapsed)
        rows = []
        for j, joint in enumerate(self._motions.joints):
            cells = [
                escape(joint),
                number(float(before[j])),
                f"{number(float(after[j]))} {escape(self._motions.units[j])}",
                *(number(float(np.round(each[j], 3))) if known else "" for each in off),
            ]
            cells[-1] += f" {self._small[j]}" if known else ""
            rows.append(cells)
        self.table.content = _table(
            "Residual, rms over 0.5 s about now, and by how much the simulated position is off.",
            [list(_NOW), *rows],
        )

    def follow(self, line: Timeline) -> None:
        """Show another recording: how far its simulation goes off."""
        self.departures.visible = line.simulated
        rows = [
            [
                escape(joint),
                number(1e3 * float(line.departures["before"][j])),
                f"{number(1e3 * float(line.departures['after'][j]))} {self._small[j]}",
            ]
            for j, joint in enumerate(self._motions.joints if line.simulated else ())
        ]
        self.departures.content = _table(departures_words(line), [list(_WHOLE), *rows])


def departures_words(line: Timeline) -> str:
    """What `Timeline.departures` are."""
    if line.horizon is None:
        return "By how much the simulated position is off, rms over the recording."
    return f"How far a prediction of {line.horizon:g} s goes off, median over the recording."


def _table(title: str, rows: list[list[str]]) -> str:
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
        f'{title}<table style="border-spacing:0;margin-top:0.4em">{body}</table></div>'
    )
