"""What Ctrl-C does to a command, from its first import to its last thread.

    leave_at_once     while there is nothing to lose: modules load, threads wind up
    stop_properly     while a command works: files are taken away or finished on the way out
    noted             while it serves: what runs goes on, and the command looks when it likes

Handlers run in the main thread between any two steps of Python, in other libraries' code as well:
one that raises is for code that can bear it.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from queue import SimpleQueue
from types import FrameType
from typing import NoReturn

STOPPED = 128 + signal.SIGINT  # the status that shells give a command which Ctrl-C ended


def take_over() -> None:
    """From now on Ctrl-C is this module's, and leaves at once.

    Not where it was to be ignored, as in the background of a script.
    """
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, _leave)


def leave_at_once() -> None:
    """From now on Ctrl-C says so in a line and ends the process with status 130, if taken over."""
    if signal.getsignal(signal.SIGINT) is _raise:
        signal.signal(signal.SIGINT, _leave)


def stop_properly() -> None:
    """From now on Ctrl-C raises KeyboardInterrupt, a second one leaves at once, if taken over."""
    if signal.getsignal(signal.SIGINT) is _leave:
        signal.signal(signal.SIGINT, _raise)


@contextmanager
def noted() -> Iterator[SimpleQueue[int]]:
    """Inside, Ctrl-C and SIGTERM only put their number into the queue that this gives.

    `get` waits for one. An Event would not do: its lock may be held where the handler runs.
    """
    stop: SimpleQueue[int] = SimpleQueue()
    before = {
        number: signal.signal(number, lambda number, _: stop.put(number))
        for number in (signal.SIGINT, signal.SIGTERM)
    }
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def end_now() -> NoReturn:
    """End the process with status 0, whatever its threads are doing.

    An ordinary end would wait for them, and a Ctrl-C in the meantime would change the status.
    """
    with contextlib.suppress(OSError, ValueError):  # nobody reads it any more
        sys.stdout.flush()
    os._exit(0)


def stopped_by(error: BaseException | None) -> bool:
    """Whether Ctrl-C is what ended a command, seen from what came out of it.

    Typer makes it an exit, and a compiled module that it meets while loading another error.
    """
    if isinstance(error, SystemExit) and error.code == STOPPED:
        return True
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


def say_stopped() -> None:
    """The line on stderr."""
    with contextlib.suppress(OSError):
        os.write(2, b"stopped\n")  # print may be what was interrupted


def _leave(number: int, frame: FrameType | None) -> NoReturn:
    say_stopped()
    os._exit(STOPPED)


def _raise(number: int, frame: FrameType | None) -> NoReturn:
    leave_at_once()
    raise KeyboardInterrupt
