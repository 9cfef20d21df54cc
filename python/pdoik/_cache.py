"""The user's folder of what was made once and is taken from there the next time."""

from __future__ import annotations

import os
from pathlib import Path

_MOVED = "PDOIK_CACHE"  # another folder; empty for none


def cache_folder() -> Path:
    """`PDOIK_CACHE`, or pdoik in `XDG_CACHE_HOME` or ~/.cache."""
    if moved := os.environ.get(_MOVED):
        return Path(moved).expanduser()
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "pdoik"


def is_turned_off() -> bool:
    """Whether the user wants nothing kept that can be made anew: `PDOIK_CACHE` is empty."""
    return os.environ.get(_MOVED) == ""
