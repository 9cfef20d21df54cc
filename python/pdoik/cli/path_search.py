"""The search of pdoik path: in longer and longer goes, so that a stop finds something known."""

from __future__ import annotations

import queue
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from threading import Thread
from typing import Any

import pdoik

from .interrupts import noted
from .messages import err, tell

_FIRST_GO = 2.0  # of searches; what is whole by then is not searched for again [s]
_USED_UP = 0.5  # of its time: what ended sooner than that would say the same in a longer one
_LOOKS = 0.2  # how often the time is shown [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Searched:
    """What a search came to."""

    result: pdoik.PathResult | None  # None where it was stopped before anything was known
    seconds: float  # of all goes
    is_stopped: bool = False  # by Ctrl-C


def search(ask: Callable[[float], pdoik.PathResult], what: str, max_time: float) -> Searched:
    """Ask for a path, say how long it has been, and end at Ctrl-C with what is known by then.

    Args:
        ask: With a time [s]. What it raises comes out here.
        what: To say that is searched for.
        max_time: For all of it [s].
    """
    began = time.monotonic()
    found: pdoik.PathResult | None = None
    with noted() as stop:
        for share in _goes(max_time):
            outcome = _go(ask, share, stop, what, began, max_time)
            if outcome is None:
                return Searched(result=found, seconds=time.monotonic() - began, is_stopped=True)
            found = outcome
            if found.success or found.time < _USED_UP * share:
                break
    return Searched(result=found, seconds=time.monotonic() - began)


def _goes(max_time: float) -> Iterator[float]:
    """Times that add up to all of it, each twice the one before; the last has all that is left."""
    left, share = max_time, _FIRST_GO
    while left >= 3.0 * share:
        yield share
        left, share = left - share, 2.0 * share
    yield left


def _go(
    ask: Callable[[float], pdoik.PathResult],
    share: float,
    stop: queue.SimpleQueue[int],
    what: str,
    began: float,
    max_time: float,
) -> pdoik.PathResult | None:
    """One of them, in a thread, since nothing comes out of it before its end; None if stopped."""
    outcomes: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def work() -> None:
        try:
            outcomes.put(ask(share))
        except BaseException as error:
            outcomes.put(error)

    thread = Thread(target=work, daemon=True)
    thread.start()
    with err.status("") as line:
        line.stop()
        is_given = False
        while thread.is_alive():
            seconds = time.monotonic() - began
            if seconds > _FIRST_GO:
                text = f"{what}: {seconds:.0f} s of at most {max_time:g} s"
                line.update(text)
                if err.is_terminal:
                    line.start()
                elif not is_given and share <= _FIRST_GO * 2.0:
                    tell(f"{text}; Ctrl-C ends with what is known")
                    is_given = True
            thread.join(min(_LOOKS, 0.002 + 0.1 * seconds))
            try:
                stop.get_nowait()
            except queue.Empty:
                continue
            return None
    outcome = outcomes.get()
    if isinstance(outcome, BaseException):
        raise outcome
    result: pdoik.PathResult = outcome
    return result
