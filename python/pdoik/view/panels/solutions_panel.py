"""All ways to meet the targets, one after the other."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np
import viser

from ..drawing.ghosts import Ghosts
from ..message import Message
from ..shown import AllSolutions, Shown

if TYPE_CHECKING:
    from ..page import Page

_LIMIT, _MOST = 32, 1000
_BACK, _ON = "previous", "next"


class SolutionsPanel:
    """A button that finds them, and a slider and buttons that click through them.

    Args:
        gui: Where; call it inside the container.
        page: Whose session is asked, and given the solution to show.
    """

    def __init__(self, gui: viser.GuiApi, page: Page) -> None:
        self._page = page
        self._lock = threading.RLock()  # hands have threads of their own, and so has the worker
        self.all: AllSolutions | None = None
        self._ghosts = Ghosts(page.server)
        self._folder = gui.add_folder("All solutions", order=-80.0, expand_by_default=False)
        with self._folder:
            self.limit: Any = gui.add_number("At most", _LIMIT, min=1, max=_MOST, step=1)
            self.find = gui.add_button("All solutions", icon=viser.Icon.LIST_NUMBERS)
            self._words = Message(gui)
            self.slider: Any = gui.add_slider("Solution", 1, 2, 1, 1, visible=False)
            self.buttons: Any = gui.add_button_group("Step", (_BACK, _ON), visible=False)
        self.find.on_click(lambda _: self.search())
        self.slider.on_update(self._slid)
        self.buttons.on_click(
            lambda event: self.pick(self.shown + (1 if event.target.value == _ON else -1))
        )

    @property
    def text(self) -> str:
        return self._words.text

    @property
    def shown(self) -> int:
        """The number of the solution that is shown, from 0."""
        return int(self.slider.value) - 1

    def search(self) -> None:
        """Find them, and show the nearest."""
        with self._page.complaints():
            self._words.say("looking ...")
            found = self._page.session.find_all(int(self.limit.value))
            with self._lock:
                self.all = found
                count = len(found.found)
                self.slider.max = max(count, 2)
                self._offer(count > 1)
                self.pick(0)
            return
        self._words.say("")

    def pick(self, number: int) -> None:
        """Show one, the first after the last."""
        with self._lock:
            if self.all is None:
                return
            count = len(self.all.found)
            self._words.say(solutions_text(self.all, number % count if count else 0))
            if count:
                self.slider.value = number % count + 1
                self._ghosts.show(self.all, self.shown)
                self._page.show_solution(np.asarray(self.all.found[self.shown].q))

    def show(self, shown: Shown) -> None:
        """Forget them once the robot does something else."""
        with self._lock:
            if self.all is not None and shown.origin != "solution":
                stale = len(self.all.found) > 0
                self.forget()
                if stale:
                    self._words.say("something has moved since")

    def forget(self) -> None:
        with self._lock:
            self.all = None
            self._offer(False)
            self._ghosts.remove()
            self._words.say("")

    def remove(self) -> None:
        self.forget()
        self._folder.remove()

    def _offer(self, several: bool) -> None:
        self.slider.visible = self.buttons.visible = several

    def _slid(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is not None:  # a hand, not `pick`
            self.pick(self.shown)


def solutions_text(all_solutions: AllSolutions, number: int) -> str:
    """How many there are, whether these are all, and what is to know of one."""
    found = all_solutions.found
    of = f" of {all_solutions.choice}" if all_solutions.choice else ""
    if not len(found):
        return f"no solution{of}: {found.status.replace('_', ' ')}"
    if found.complete:
        whether = "these are all"
    else:
        whether = f"perhaps not all (coverage {100 * found.coverage:.0f} %)"
    ways = found.turns[number]
    clearance = float(found[number].clearance)
    facts = [
        f"{1e3 * clearance:.1f} mm clear" if np.isfinite(clearance) else "no obstacles",
        f"{ways} ways by whole turns of joints" if ways > 1 else "no other way by whole turns",
    ]
    plural = "s" * (len(found) > 1)
    return f"{len(found)} solution{plural}{of}, {whether}. No. {number + 1}: {', '.join(facts)}."
