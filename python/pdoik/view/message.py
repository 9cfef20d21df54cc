"""The line of the panel that says what happened last."""

from __future__ import annotations

from html import escape

import viser

_BAD, _PLAIN = "#b3261e", "#4a5568"


class Message:
    """Text, until the next one."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._html = gui.add_html("")
        self.text = ""

    def remove(self) -> None:
        self._html.remove()

    def say(self, text: str, *, bad: bool = False) -> None:
        self.text = text
        self._html.content = (
            f'<div style="padding:0 1em 0.5em;font-size:0.8em;color:{_BAD if bad else _PLAIN};'
            f'overflow-wrap:anywhere">{escape(text)}</div>'
        )
