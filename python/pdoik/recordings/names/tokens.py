"""A column's name in words: `/arm/joint1/posDes [rad]` is arm; joint 1; pos des, in rad."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from . import words

_BRACKETS = re.compile(r"[\[({]\s*([^\])}]*?)\s*[\])}]")
_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-zµ°]+|[0-9]+|%")
_PATHS = re.compile(r"[/.:]")


@dataclass(frozen=True, slots=True)
class Token:
    """A word or number."""

    text: str  # lower case
    component: int  # of the path, in which it stands


@dataclass(frozen=True, slots=True)
class Spelling:
    """A name taken apart."""

    tokens: tuple[Token, ...]
    unit: str = ""  # in brackets, as it was written

    @property
    def texts(self) -> tuple[str, ...]:
        """The tokens' words."""
        return tuple(each.text for each in self.tokens)


def spelling(name: str) -> Spelling:
    """The words of a name; numbers are words; what stands in brackets is a unit if it is one."""
    unit = ""

    def opened(match: re.Match[str]) -> str:
        nonlocal unit
        inside = match.group(1)
        if words.plain(inside) in words.ANY_UNIT or (not inside and match.group(0) == "[]"):
            unit = inside
            return " "
        return f" {inside} "

    text = _BRACKETS.sub(opened, name.lstrip("%# "))
    tokens: list[Token] = []
    for component, part in enumerate(_PATHS.split(text)):
        for found in _WORDS.findall(part):
            said = words.JOINED.get(found.lower(), (found.lower(),))
            tokens += [Token(word, component) for word in said]
    return Spelling(tuple(tokens), unit)


def joint_spellings(joints: Sequence[str]) -> dict[str, tuple[tuple[str, ...], ...]]:
    """How each joint's name may be written, in words.

    Besides all its words: those that not all joints begin with (`joint1` of `panda_joint1`), and
    those without the word joint (`shoulder_pan` of `shoulder_pan_joint`), where that still
    distinguishes the joints.
    """
    full = {joint: spelling(joint).texts for joint in joints}
    shared = 0
    if len(joints) > 1:
        shortest = min(len(each) for each in full.values())
        firsts = list(full.values())
        while shared < shortest - 1 and len({each[shared] for each in firsts}) == 1:
            shared += 1
    while shared and any(each[shared].isdigit() for each in full.values()):
        shared -= 1  # a number alone names no joint
    found: dict[str, list[tuple[str, ...]]] = {joint: [each] for joint, each in full.items()}
    shorter = {joint: each[shared:] for joint, each in full.items()}
    for changed in (shorter, _without_joint(full), _without_joint(shorter)):
        if _tell_apart(changed.values()):
            for joint, each in changed.items():
                if each not in found[joint]:
                    found[joint].append(each)
    return {joint: tuple(each) for joint, each in found.items()}


def _without_joint(spellings: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    return {
        joint: tuple(each for each in texts if each != "joint")
        for joint, texts in spellings.items()
    }


def _tell_apart(spellings: Collection[tuple[str, ...]]) -> bool:
    """Whether each names one joint, by more than a number."""
    each_said = all(any(not text.isdigit() for text in each) for each in spellings)
    return each_said and len(set(spellings)) == len(spellings)
