"""A question to a solver and its answer in one file, for who is to find out what went wrong.

`write_report` writes it, `replay_report` asks again and judges: whether the answer is the same to
the bit, and whether what it claims holds by code of its own (`judge`), which takes no word of the
compiled library. The files are JSON, every number to the bit (`values`).
"""

from .replay import Replay, replay_report
from .write import ending_of, write_report

__all__ = ["Replay", "ending_of", "replay_report", "write_report"]
