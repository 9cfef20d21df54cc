"""What Ctrl-C does to a command, from its first import to its last thread.

A handler runs in the main thread between any two steps of Python, in the code of others as well.
One that raises KeyboardInterrupt is at the mercy of that code: a weak reference's callback prints
it and goes on, a compiled module that is being imported makes another error of it. So none raises
here. Either the command leaves at once, which hurts no file because all are renamed when they are
whole, or, while it serves a page, the signal is noted.
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

from pdoik._files import unfinished

STOPPED = 128 + signal.SIGINT  # the status that shells give a command which Ctrl-C ended
_SHOW_CURSOR = b"\r\x1b[K\x1b[?25h"  # in place of a progress bar


def take_over() -> None:
    """Make Ctrl-C say so in a line and end the process with status 130.

    Not where it was to be ignored, as in the background of a script.
    """
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, _leave)


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
    leave(0)


def leave(status: int) -> NoReturn:
    """The same with another status."""
    with contextlib.suppress(OSError, ValueError):  # nobody reads it any more
        sys.stdout.flush()
    os._exit(status)


def _leave(number: int, frame: FrameType | None) -> NoReturn:
    for path in list(unfinished):
        with contextlib.suppress(OSError):
            path.unlink()
    with contextlib.suppress(OSError):  # straight to the file: print may be what was interrupted
        os.write(2, (_SHOW_CURSOR if os.isatty(2) else b"") + b"stopped\n")
    os._exit(STOPPED)
