"""A reachability map in the making, on a thread of its own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import pdoik

from .reach import ReachRequest


class ReachRun:
    """Computes a map in slices, between which it can be cancelled; begins at once.

    Args:
        request: What is computed.
        on_progress: Called with how many poses are done, of how many, and in how many seconds.
        on_end: Gets the map, or what was raised instead. Both are called by the run's thread, and
            not once it is cancelled.
    """

    def __init__(
        self,
        request: ReachRequest,
        on_progress: Callable[[int, int, float], None],
        on_end: Callable[[pdoik.Reachability | Exception], None],
    ) -> None:
        self._request = request
        self._on_progress = on_progress
        self._on_end = on_end
        self._lock = threading.Lock()
        self._over = False
        self._began = time.monotonic()
        self._thread = threading.Thread(target=self._run, name="pdoik view: reach", daemon=True)
        self._thread.start()

    @property
    def over(self) -> bool:
        """Whether it has ended or was cancelled."""
        return self._over

    def cancel(self) -> bool:
        """Report nothing any more, and end after the slice it is in; does not wait for that.

        Returns:
            Whether it was not over yet.
        """
        with self._lock:
            was_over, self._over = self._over, True
            return not was_over

    def wait(self) -> None:
        """Until its thread has ended, which a cancelled one does after its slice."""
        self._thread.join()

    def _run(self) -> None:
        outcome: pdoik.Reachability | Exception
        try:
            outcome = self._request.compute(self._tell)
        except Exception as error:  # whatever it is, the page must hear of it
            outcome = error
        with self._lock:
            if not self._over:
                try:
                    self._on_end(outcome)
                finally:
                    self._over = True

    def _tell(self, done: int) -> None:
        with self._lock:
            if self._over:
                raise _CancelledError
            self._on_progress(done, len(self._request.grid), time.monotonic() - self._began)


class _CancelledError(Exception):
    """Nobody waits for the map."""
