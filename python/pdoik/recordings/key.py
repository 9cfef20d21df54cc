"""A key that says how a log is read, or of a study: checked by its reader, shown on a page."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Key:
    """What may stand behind a key."""

    kind: str  # of value, in words
    words: str  # what it says
    example: str  # the value as YAML has it
    default: str = ""  # what holds without the key, in words; "" where it is needed


Keys = dict[str, Key]
