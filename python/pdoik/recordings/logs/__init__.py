"""Logs of every kind, one file each: what columns they hold, and the rows of those wanted.

Comes in: a file or folder. Goes out: its columns as it names them, then rows of some of them. What
the names mean is asked in `names`, next.

Another kind of log is a file like these in this folder, found by being there; or a class of
another package, named by an entry point of the group `pdoik.logs`.
"""

import importlib
import importlib.metadata
import pkgutil

from .arrow_numbers import numbers
from .csv_form import CsvForm, is_number
from .kinds import GROUP, KINDS, entry_keys, open_log, register
from .log import Column, Log
from .part import MAX_ROWS, Part, check_size

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
for _entry in importlib.metadata.entry_points(group=GROUP):
    register(_entry.load())

__all__ = [
    "KINDS",
    "MAX_ROWS",
    "Column",
    "CsvForm",
    "Log",
    "Part",
    "check_size",
    "entry_keys",
    "is_number",
    "numbers",
    "open_log",
    "register",
]
