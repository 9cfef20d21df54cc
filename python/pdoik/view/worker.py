"""One thread that does the latest thing asked for and skips what came between."""

from __future__ import annotations

import threading
from collections.abc import Callable


class Worker:
    """Calls `step` once after any number of wakes, never twice at a time.

    Args:
        step: What to do; it looks up the latest wish itself.
        on_error: Gets what `step` raised; the thread goes on.
    """

    def __init__(self, step: Callable[[], None], on_error: Callable[[Exception], None]) -> None:
        self._step = step
        self._on_error = on_error
        self._woken = threading.Event()
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name="pdoik view: solver", daemon=True)
        self._thread.start()

    def wake(self) -> None:
        """There is a new wish; returns at once."""
        self._woken.set()

    def stop(self) -> None:
        """End the thread after the step it is in."""
        self._stopped = True
        self._woken.set()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _run(self) -> None:
        while True:
            self._woken.wait()
            self._woken.clear()
            if self._stopped:
                return
            try:
                self._step()
            except Exception as error:  # whatever it is, the page must stay alive
                self._on_error(error)
