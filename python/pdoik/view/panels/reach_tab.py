"""The tab that computes and shows which poses the robot reaches."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import viser

import pdoik

from ..reach import ReachRequest, box_grid, default_box
from ..reach_run import ReachRun
from .map_panel import MapPanel

if TYPE_CHECKING:
    from ..page import Page

_STEPS = 20  # of the default grid along the box's longest edge
_ORIENTATIONS = 30
_COARSE_STEP, _COARSE_ORIENTATIONS = 100.0, 8  # [mm]


class ReachTab:
    """The grid, a button that computes its map in the background, and the map."""

    def __init__(self, gui: viser.GuiApi, page: Page) -> None:
        self._page = page
        self._lock = threading.Lock()  # two hands may press at once
        self._run: ReachRun | None = None
        with gui.add_folder("Grid"):
            self.low: Any = gui.add_vector3("Lowest corner [m]", (-1.0, -1.0, -1.0), step=0.01)
            self.high: Any = gui.add_vector3("Highest corner [m]", (1.0, 1.0, 1.0), step=0.01)
            self.step: Any = gui.add_number("Grid step [mm]", 100.0, step=1.0)
            self.orientations: Any = gui.add_number(
                "Orientations", _ORIENTATIONS, step=1, hint="At each position, spread evenly"
            )
            self.obstacles = gui.add_checkbox(
                "Obstacles", True, hint="Keep off the cloud and the ball as they are at the start"
            )
            self.progress = gui.add_markdown("")
            self.bar: Any = gui.add_progress_bar(0.0, visible=False)
            self.compute = gui.add_button("Compute", icon=viser.Icon.PLAYER_PLAY)
            self.cancel = gui.add_button("Cancel", icon=viser.Icon.X, visible=False)
        with gui.add_folder("Map"):
            self.map = MapPanel(gui, page)
        self.compute.on_click(lambda _: self.start())
        self.cancel.on_click(lambda _: self.stop())
        for control in (self.low, self.high, self.step, self.orientations):
            control.on_update(self._grid_changed)

    @property
    def computing(self) -> bool:
        return self._run is not None and not self._run.over

    def follow_robot(self) -> None:
        """Propose a grid for the robot that is there now; what was of another one goes."""
        robot = self._page.session.robot
        self.stop()
        self.map.forget()
        low, high = default_box(robot)
        self.low.value, self.high.value = tuple(low.tolist()), tuple(high.tolist())
        longest = 1e3 * float((high - low).max())  # [mm]
        self.step.value = max(5.0 * round(longest / _STEPS / 5), 5.0)
        self.obstacles.visible = len(robot.occupancy) > 0
        self._show_size()

    def start_coarse(self) -> None:
        """Compute a map in seconds, to see what one is."""
        self.step.value, self.orientations.value = _COARSE_STEP, _COARSE_ORIENTATIONS
        self.start()

    def start(self) -> None:
        """Compute the map of the grid; the map that is there stays until then."""
        with self._page.complaints(), self._lock:
            if self.computing:
                return
            request = ReachRequest.of(
                self._page.session, self._grid(), with_obstacles=self.obstacles.value
            )
            origin = "without obstacles" if request.obstacles is None else "clear of the obstacles"
            self._show_running(True)
            self._run = ReachRun(
                request, self._show_progress, lambda outcome: self._take(outcome, origin)
            )

    def stop(self) -> None:
        """Cancel what is being computed, if anything is; the map that is there stays."""
        if self._run is not None and self._run.cancel():
            self._show_running(False)
            self.progress.content = "cancelled"

    def close(self) -> None:
        """Cancel what is being computed, and wait for its end."""
        self.stop()
        if self._run is not None:
            self._run.wait()

    def _grid(self) -> pdoik.Grid:
        return box_grid(
            self.low.value, self.high.value, self.step.value / 1e3, int(self.orientations.value)
        )

    def _take(self, outcome: pdoik.Reachability | Exception, origin: str) -> None:
        """What a run ended with."""
        self._show_running(False)
        self._show_size()
        with self._page.complaints():
            if isinstance(outcome, Exception):
                raise outcome
            self.map.show(outcome, origin)

    def _grid_changed(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is not None and not self.computing:  # a hand, not `follow_robot`
            self._show_size()

    def _show_size(self) -> None:
        """How much the grid is, or why it is none."""
        try:
            grid = self._grid()
        except ValueError as error:
            self.progress.content = str(error)
        else:
            self.progress.content = f"{len(grid.positions):,} positions, {len(grid):,} poses"

    def _show_running(self, running: bool) -> None:
        self.compute.visible = not running
        self.cancel.visible = self.bar.visible = running
        self.bar.value = 0.0
        if running:
            self.progress.content = "begins ..."

    def _show_progress(self, done: int, total: int, seconds: float) -> None:
        rate = done / max(seconds, 1e-3)
        self.bar.value = 100.0 * done / total
        self.progress.content = (
            f"{done:,} of {total:,} poses, {rate:,.0f} /s, {(total - done) / rate:.0f} s to go"
        )
