"""More targets for a tip, any one of which will do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import viser

from ..message import Message

if TYPE_CHECKING:
    from ..page import Page
    from ..shown import Shown

_ADD, _DROP = "add", "remove last"


class AlternativesPanel:
    """Buttons that add and remove targets of a tip, and which one is met.

    Args:
        gui: Where; call it inside the container.
        page: Given what is pressed.
    """

    def __init__(self, gui: viser.GuiApi, page: Page) -> None:
        tips = list(page.session.targets)
        self._page = page
        self._folder = gui.add_folder("Alternative targets", order=-90.0, expand_by_default=False)
        with self._folder:
            self._tip: Any = gui.add_dropdown("Of", tips, visible=len(tips) > 1)
            self.buttons = gui.add_button_group(
                "Targets", (_ADD, _DROP), hint="Any one will do: the robot goes to one it can reach"
            )
            self._words = Message(gui)
        self.buttons.on_click(self._pressed)

    @property
    def text(self) -> str:
        return self._words.text

    def show(self, shown: Shown) -> None:
        """Say which are met."""
        text = ""
        if shown.choice:
            text = shown.choice + (" is met" if shown.met_to_tolerance else " is nearest")
        if text != self.text:
            self._words.say(text)

    def remove(self) -> None:
        self._folder.remove()

    def _pressed(self, event: viser.GuiEvent[Any]) -> None:
        if event.target.value == _ADD:
            self._page.add_target(self._tip.value)
        else:
            self._page.drop_target(self._tip.value)
