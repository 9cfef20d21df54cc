"""Closing the loop: record, diagnose, feed the model forward, run again."""

import sys
from pathlib import Path

_BENCH = str(Path(__file__).parents[1])
if _BENCH not in sys.path:  # bench/*.py import one another by plain names
    sys.path.append(_BENCH)
