"""What is shown of a reachability map: its numbers, its colours, and where it is cut open."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import viser

import pdoik

from ..drawing.reach_scene import ReachScene
from ..reach_cells import Cut, ReachCells, share_colors

if TYPE_CHECKING:
    from ..page import Page

AXES = ("x", "y", "z")
WHOLE = "nothing"


class MapPanel:
    """Legend, facts, the cut, loading and saving."""

    def __init__(self, gui: viser.GuiApi, page: Page) -> None:
        self._page = page
        self._scene = ReachScene(page.server)
        self._cells: ReachCells | None = None
        self.result: pdoik.Reachability | None = None
        self.legend = gui.add_html(legend_html(), visible=False)
        self.facts = gui.add_markdown("No map.")
        self.shown = gui.add_checkbox("Show", True, visible=False)
        self.axis = gui.add_dropdown("Cut along", (*AXES, WHOLE), initial_value="y", visible=False)
        self.at: Any = gui.add_slider("Cut at [m]", -1.0, 1.0, 0.05, 0.0, visible=False)
        self.other_side = gui.add_checkbox("Other side", False, visible=False)
        self.load = gui.add_upload_button("Map (.npz)", icon=viser.Icon.UPLOAD)
        self.load.on_upload(lambda event: page.take_map(event.target.value))
        self.save = gui.add_button("Save", icon=viser.Icon.DOWNLOAD, visible=False)
        self.save.on_click(self._send)
        self.axis.on_update(lambda _: self._axis_chosen())
        for control in (self.shown, self.at, self.other_side):
            control.on_update(lambda _: self._draw())

    @property
    def cut(self) -> Cut | None:
        """Cut that the controls say; None for the whole map."""
        if self.axis.value == WHOLE:
            return None
        side = not self.other_side.value
        return Cut(axis=AXES.index(self.axis.value), at=self.at.value, keep_above=side)

    def show(self, result: pdoik.Reachability, origin: str) -> None:
        """Draw a map of the robot that is there.

        Args:
            result: The map.
            origin: Where it is from, in a few words.
        """
        self.result, self._cells = result, ReachCells(result)
        self.facts.content = facts(result, origin)
        self._axis_chosen()

    def forget(self) -> None:
        """Take the map away: it was of another robot."""
        self.result = self._cells = None
        self.facts.content = "No map."
        self._axis_chosen()

    def _axis_chosen(self) -> None:
        there = self.result is not None
        for control in (self.legend, self.shown, self.axis, self.save):
            control.visible = there
        self.at.visible = self.other_side.visible = there and self.axis.value != WHOLE
        if self.result is not None and self.axis.value != WHOLE:
            along = self.result.grid.positions[:, AXES.index(self.axis.value)]
            self.at.min, self.at.max = float(along.min()), float(along.max())
            self.at.value = float(np.clip(self.at.value, along.min(), along.max()))
        self._draw()

    def _draw(self) -> None:
        self._scene.show(self._cells if self.shown.value else None, self.cut)

    def _send(self, event: viser.GuiEvent[Any]) -> None:
        """Let the browser that asked for it download the map."""
        if self.result is None or event.client is None:
            return
        with self._page.complaints(), tempfile.TemporaryDirectory(prefix="pdoik-view-") as folder:
            path = Path(folder) / f"{self._page.session.robot.name}_reach.npz"
            self.result.save(path)
            event.client.send_file_download(path.name, path.read_bytes(), save_immediately=True)


def facts(result: pdoik.Reachability, origin: str) -> str:
    """How many poses there are, how many are reached, and how fast that was found, as Markdown."""
    reached, grid = result.reached, result.grid
    places = int(reached.any(axis=1).sum())
    rate = f", {reached.size / result.seconds:,.0f} poses/s" if result.seconds > 0 else ""
    return (
        f"**{reached.sum():,} of {reached.size:,} poses reached** ({reached.mean():.1%}), "
        f"at {places:,} of {len(grid.positions):,} positions; "
        f"{result.seconds:.1f} s{rate}; {origin}"
    )


def legend_html() -> str:
    """The colours as a bar from 0 to 100 %."""
    stops = ", ".join(
        f"rgb({red},{green},{blue})" for red, green, blue in share_colors(np.linspace(0, 1, 11))
    )
    numbers = "".join(f"<span>{percent} %</span>" for percent in range(0, 101, 25))
    return (
        '<div style="padding:0 1em 0.4em;font-size:0.85em">share of orientations reached'
        f'<div style="height:1em;border-radius:3px;background:linear-gradient(to right,{stops})">'
        '</div><div style="display:flex;justify-content:space-between;'
        f'font-variant-numeric:tabular-nums">{numbers}</div></div>'
    )
