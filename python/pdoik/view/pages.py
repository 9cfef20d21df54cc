"""How many pages are open: all show and move the same robot."""

from __future__ import annotations

import viser


class PagesLine:
    """A line of the panel that is there while there are two pages or more."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self.line = server.gui.add_html("", visible=False)
        server.on_client_connect(lambda _: self._count())
        server.on_client_disconnect(lambda _: self._count())

    def _count(self) -> None:
        n = len(self._server.get_clients())
        if not n:  # nobody looks, or the server ends
            return
        self.line.content = (
            f'<div style="padding:0 1em 0.5em;font-size:0.8em;color:#8a5a00">{n} pages are open.'
            " They share one robot: what is done on one is seen on all.</div>"
        )
        self.line.visible = n > 1
