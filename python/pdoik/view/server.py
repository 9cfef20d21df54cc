"""The page's server: on loopback unless set otherwise, and nothing leaves the machine."""

from __future__ import annotations

import contextlib
import io
import socket
import threading
import webbrowser

import viser

DEFAULT_PORT = 8080


class PageServer(viser.ViserServer):
    """viser's server without its tunnel to the Internet, and silent."""

    def __init__(self, host: str, port: int) -> None:
        with contextlib.redirect_stdout(io.StringIO()):  # its banner
            super().__init__(host=host, port=port, label="pdoik view", verbose=False)
        self.gui.configure_theme(
            show_logo=False, show_share_button=False, brand_color=(47, 93, 158)
        )

    @property
    def url(self) -> str:
        host = self.get_host()
        if host in ("0.0.0.0", "::"):
            host = "127.0.0.1"
        return f"http://{f'[{host}]' if ':' in host else host}:{self.get_port()}"

    def request_share_url(self, verbose: bool = True) -> str | None:
        """No."""
        return None

    def stop(self) -> None:
        with contextlib.redirect_stdout(io.StringIO()):  # its farewell
            super().stop()


def start_server(host: str, port: int | None) -> PageServer:
    """A server that listens.

    Args:
        host: Address of the interface to listen on.
        port: 0 for any that is free; None for the first free one from 8080 on.

    Raises:
        OSError: The address is not this machine's, or the port is taken.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as trial:  # viser would look for ports for ever
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        trial.bind((host, port or 0))
    return PageServer(host, DEFAULT_PORT if port is None else port)


def open_browser(url: str) -> None:
    """Open a browser in the background: some browsers return only when they are closed."""
    threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()
