"""The menu of what there is to look at, and a line on what to do."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import viser

from ..examples import EXAMPLES, Example

if TYPE_CHECKING:
    from ..page import Page

OWN = "your own"
_MOUSE = (
    "Drag arrows: the robot follows, and gives way. Elsewhere the mouse turns the view, the wheel"
    " zooms."
)


class ExamplesMenu:
    """A dropdown above everything else in the panel.

    Args:
        gui: Where.
        page: Given what is chosen.
        shown: The example that the page begins with; None for a robot of the user's own.
    """

    def __init__(self, gui: viser.GuiApi, page: Page, shown: Example | None) -> None:
        names = (*(each.name for each in EXAMPLES), OWN)
        self._page = page
        self.menu: Any = gui.add_dropdown(
            "Example", names, initial_value=OWN if shown is None else shown.name
        )
        self.words = gui.add_html("")
        self.follow(shown)
        self.menu.on_update(self._chosen)

    def follow(self, shown: Example | None) -> None:
        """Name what is there now."""
        self.menu.value = OWN if shown is None else shown.name
        first = "" if shown is None else f"<b>{escape(shown.try_this)}</b> "
        self.words.content = (
            f'<div style="padding:0 1em 0.3em;font-size:0.8em;color:#4a5568">{first}{_MOUSE}</div>'
        )

    def _chosen(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is None:  # not a hand, but `follow`
            return
        for example in EXAMPLES:
            if example.name == self.menu.value:
                self._page.take_example(example)
