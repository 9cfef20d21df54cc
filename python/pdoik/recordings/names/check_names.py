"""Columns that look like a channel of the joints with a typing error in it."""

from __future__ import annotations

import difflib
from collections.abc import Collection

from pdoik.errors import LoadError

from ..columns import Table
from ..recording import CHANNELS
from . import words
from .meaning import Spellings
from .tokens import joint_spellings, spelling

_SHORTEST = 3  # letters in which an error can be seen


def check_names(table: Table, joints: Collection[str], ignore: Collection[str]) -> None:
    """Ask about columns that probably are channels with a typing error.

    Raises:
        LoadError: a column is probably misnamed.
    """
    spellings = joint_spellings(tuple(joints))
    for column in table.others:
        if column in ignore:
            continue
        meant = _meant(column, spellings)
        if meant is not None and meant not in table.columns:
            raise LoadError(
                f"{table.name}: column {column!r} is none that pdoik knows; if {meant!r} is meant,"
                f" rename it or say so with 'columns: {{{meant}: \"{column}\"}}', else"
                f" leave it out with 'ignore: [{column}]'"
            )


def _meant(column: str, joints: Spellings) -> str | None:
    """The channel and joint that a column may be, where all its words but one are the joint's."""
    texts = spelling(column).texts
    for joint, spellings in joints.items():
        for each in spellings:
            for rest in (texts[: -len(each)], texts[len(each) :]):
                if len(rest) == 1 and {rest + each, each + rest} & {texts}:
                    channel = _channel(rest[0])
                    return None if channel is None else f"{channel}.{joint}"
    return None


def _channel(word: str) -> str | None:
    """The channel whose name is a letter off, or has two that changed places."""
    if len(word) < _SHORTEST or word in words.OTHER or (word,) in words.QUANTITIES:
        return None
    names = {each: each for each in CHANNELS} | {
        phrase[0]: channel
        for phrase, channel in words.QUANTITIES.items()
        if len(phrase) == 1 and channel in CHANNELS
    }
    close = difflib.get_close_matches(word, names, n=1, cutoff=0.8)
    if close:
        return names[close[0]]
    return next((c for n, c in names.items() if sorted(n) == sorted(word)), None)
