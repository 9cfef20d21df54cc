"""Playing a log: where it is, and a thread that moves it on."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

_PERIOD = 1 / 60  # [s]


class Player:
    """The time of a replay, in seconds after its first row.

    Args:
        on_tick: Called with the elapsed time by a thread of the player's while it plays.
    """

    def __init__(self, on_tick: Callable[[float], None]) -> None:
        self._on_tick = on_tick
        self._lock = threading.Lock()
        self._elapsed = 0.0
        self._duration = 0.0
        self._speed = 1.0
        self._playing = threading.Event()
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name="pdoik view: replay", daemon=True)
        self._thread.start()

    @property
    def playing(self) -> bool:
        return self._playing.is_set()

    @property
    def elapsed(self) -> float:
        with self._lock:
            return self._elapsed

    def load(self, duration: float) -> None:
        """Stand at the start of another log."""
        self.pause()
        with self._lock:
            self._elapsed, self._duration = 0.0, duration

    def play(self) -> None:
        """Go on; from the start if it stands at the end."""
        with self._lock:
            if self._elapsed >= self._duration:
                self._elapsed = 0.0
        self._playing.set()

    def pause(self) -> None:
        self._playing.clear()

    def seek(self, elapsed: float) -> None:
        with self._lock:
            self._elapsed = min(max(elapsed, 0.0), self._duration)

    def set_speed(self, speed: float) -> None:
        with self._lock:
            self._speed = speed

    def advance(self, seconds: float) -> float:
        """Let so much time pass by the clock; pauses at the end. Returns the elapsed time."""
        with self._lock:
            self._elapsed += seconds * self._speed
            if self._elapsed >= self._duration:
                self._elapsed = self._duration
                self._playing.clear()
            return self._elapsed

    def stop(self) -> None:
        """End the thread."""
        self._stopped = True
        self._playing.set()
        self._thread.join()

    def _run(self) -> None:
        while True:
            self._playing.wait()
            last = time.monotonic()
            while self._playing.is_set() and not self._stopped:
                time.sleep(_PERIOD)
                now = time.monotonic()
                self._on_tick(self.advance(now - last))
                last = now
            if self._stopped:
                return
