"""What one column's name says: quantity, role, unit, and what of it is not understood."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..logs import Column
from . import words
from .tokens import Token, spelling

Spellings = Mapping[str, tuple[tuple[str, ...], ...]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Meaning:
    """The meaning of a column that is a channel of some joint, or the time."""

    column: Column
    channel: str  # a channel of recordings, "time", or a vector of MuJoCo's actuators
    joint: str | None = None  # whose it is, if the name says so
    number: int | None = None  # of the joint in some order, if the name has one instead
    unit: str = ""  # of `units.KNOWN`, if the name says so
    counted_by: str = ""  # MuJoCo's order of the numbers: qpos, dof or actuator
    series: str = ""  # the name without its number: columns that are counted together


def meaning_of(column: Column, joints: Spellings, *, alone: bool = False) -> Meaning | str | None:
    """What a column means by its name.

    Args:
        column: As the log has it.
        joints: How the names of joints may be written.
        alone: Whether a name without a joint or a number may be of the only joint there is.

    Returns:
        Its meaning; or why it cannot be known, of a name that looks like a channel of a joint, in
        words; or None, of any other.
    """
    spelled = spelling(column.name if column.index is None else column.array)
    label = spelling(column.label)
    tokens = [*spelled.tokens]
    last = max((each.component for each in tokens), default=0) + 1
    tokens += [Token(each.text, last + each.component) for each in label.tokens]
    joint, whole = _joint(tokens, joints)
    rest = [each for k, each in enumerate(tokens) if k not in whole]
    written = column.unit or label.unit or spelled.unit
    said = quantity_of(rest, written, column.channel)
    if said is None:
        return None
    by_number = joint is not None and joint.isdigit() and column.index is None
    numbers = [joint] if by_number and joint is not None else _numbers(rest)
    quantity, unit = said.quantity, said.unit
    left = [rest[k] for k in said.left if not rest[k].text.isdigit()]
    places = {said.component} | {tokens[k].component for k in whole}
    unclear = [each.text for each in left if each.component in places]
    if quantity == "time":
        unclear = [each for each in unclear if each not in words.CLOCKS]
        return None if unclear or whole else Meaning(column=column, channel="time", unit=unit)
    channel = words.CHANNELS_OF.get((quantity, said.commanded), "")
    if quantity in ("ctrl", "actuator_force"):
        channel = quantity
    if joint is None and column.index is None and len(numbers) != 1:
        if not numbers and quantity == "voltage" and not left:
            return Meaning(column=column, channel="voltage", unit=unit)
        if numbers or left or not alone:
            return None
        numbers = ["1"]
    if not channel:
        return None
    if unclear or (written and not unit):
        return f"{unclear[0] if unclear else written!r} is not understood"
    series = f"{column.array}[]" if column.index is not None else _series(column.name, numbers)
    return Meaning(
        column=column,
        channel=channel,
        joint=joint,
        number=column.index if column.index is not None else _one(numbers),
        unit=unit,
        counted_by=next((words.MUJOCO[t.text] for t in rest if t.text in words.MUJOCO), ""),
        series=series,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """What the words of a name say that are of no joint."""

    quantity: str
    commanded: bool
    unit: str  # of `units.KNOWN`, "" where none is said
    component: int  # of the path, in which it stands; -1 where no word says it
    used: frozenset[int]  # places of its words
    left: tuple[int, ...]  # of those that say neither it nor a role or unit; numbers, too


def quantity_of(tokens: Sequence[Token], written: str, default: str = "") -> Quantity | None:
    """The quantity that a name's words say; None where they say none, or something else.

    Args:
        tokens: The words.
        written: The unit that stands apart from them.
        default: The channel where they say none.
    """
    if any(each.text in words.OTHER for each in tokens):
        return None
    at = [k for k, each in enumerate(tokens) if not each.text.isdigit()]
    found = _quantity([tokens[k] for k in at])
    base = default.removesuffix("_des").removesuffix("_cmd")
    quantity, component, places = found if found is not None else (base, -1, frozenset[int]())
    if not quantity:
        return None
    used = frozenset(at[place] for place in places)
    free = [k for k in at if k not in used]
    said = [k for k in free if not _is_said(tokens[k].text)]
    unit, left = _unit([tokens[k] for k in said], written, quantity)
    return Quantity(
        quantity=quantity,
        commanded=base != default or any(tokens[k].text in words.COMMANDED for k in free),
        unit=unit,
        component=component,
        used=used,
        left=tuple(k for k in range(len(tokens)) if k not in at or k in said[: len(left)]),
    )


def _joint(tokens: Sequence[Token], joints: Spellings) -> tuple[str | None, frozenset[int]]:
    """The joint whose longest spelling stands in the tokens, and where; None if two are alike."""
    texts = tuple(each.text for each in tokens)
    best: list[tuple[int, str, int]] = []
    for joint, spellings in joints.items():
        for each in spellings:
            starts = [k for k in range(len(texts)) if texts[k : k + len(each)] == each]
            if starts:
                best.append((len(each), joint, starts[-1]))
    length = max((each[0] for each in best), default=0)
    found = {each[1]: each[2] for each in best if each[0] == length}
    if len(found) != 1:
        return None, frozenset()
    joint, start = next(iter(found.items()))
    return joint, frozenset(range(start, start + length))


def _numbers(tokens: Sequence[Token]) -> list[str]:
    """Numbers among the words, but for that of the robot: `robot0_joint_pos_3` has 3."""
    return [
        each.text
        for k, each in enumerate(tokens)
        if each.text.isdigit() and not (k and tokens[k - 1].text in ("robot", "demo"))
    ]


def _one(numbers: Sequence[str]) -> int | None:
    return int(numbers[0]) if len(numbers) == 1 else None


def _series(name: str, numbers: Sequence[str]) -> str:
    """The name with a hole for its last number."""
    if not numbers:
        return name
    head, _, tail = name.rpartition(numbers[-1])
    return f"{head}#{tail}"


def _quantity(tokens: Sequence[Token]) -> tuple[str, int, frozenset[int]] | None:
    """The quantity, the path's component it stands in, and its words' places.

    The last component that names one counts: `/position_controller/elbow/velocity` is a speed.
    Where `current` stands next to another, it means now.
    """
    found: list[tuple[str, int, frozenset[int]]] = []
    k = 0
    while k < len(tokens):
        for length in (2, 1):
            phrase = tuple(each.text for each in tokens[k : k + length])
            if len(phrase) == length and phrase in words.QUANTITIES:
                places = frozenset(range(k, k + length))
                found.append((words.QUANTITIES[phrase], tokens[k].component, places))
                k += length - 1
                break
        k += 1
    if not found:
        return None
    last = max(each[1] for each in found)
    here = [each for each in found if each[1] == last]
    spare = frozenset(p for each in found if each[1] != last for p in each[2])
    if len({each[0] for each in here}) > 1:
        spare |= {p for each in here if each[0] == "current" for p in each[2]}
        here = [each for each in here if each[0] != "current"]
    if len({each[0] for each in here}) != 1:
        return None
    return here[0][0], last, here[0][2].union(spare, *(each[2] for each in here))


def _is_said(text: str) -> bool:
    return text in words.COMMANDED or text in words.MEASURED or text in words.EMPTY


def _unit(left: list[Token], written: str, quantity: str) -> tuple[str, list[Token]]:
    """The unit as it is written apart or else at the end, and the words left without it."""
    known = words.UNITS.get(quantity, {})
    if words.plain(written):
        return known.get(words.plain(written), ""), left
    for length in (3, 2, 1):
        tail = "".join(each.text for each in left[-length:])
        if len(left) >= length and tail in known:
            return known[tail], left[:-length]
    return "", left
