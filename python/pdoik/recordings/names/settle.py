"""Which columns of a log are which channels, first as `columns:` says, then by their names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from pdoik.errors import LoadError

from ..columns import SUPPLY, channel_of, is_known
from ..logs import Column
from ..recording import CHANNELS
from ..units import parent
from . import words
from .inferred import joints_in
from .known import ALONG_THE_ARM, IN_THE_LOG, SHOWN, Known, Settled, listed
from .mapped import take_mapped
from .meaning import Meaning, meaning_of
from .mujoco_order import Entry
from .tokens import joint_spellings, spelling

BEYOND_SECONDS = "time.beyond"
"""Target of the column of nanoseconds that belongs to one of seconds."""

_PATHS = re.compile(r"[/.]")
_JOINT = re.compile(r"[./](pos|position|vel|velocity|effort|torque)$")


def settle(name: str, columns: Sequence[Column], known: Known) -> tuple[list[Settled], list[str]]:
    """The columns to read, and why others that look like channels are not read, in words.

    Raises:
        LoadError: `columns:` maps names that are not there, or two columns claim the same.
    """
    columns = [c for c in columns if not {c.name, c.array} & set(known.ignore)]
    found: dict[str, Settled] = {}
    take_mapped(name, columns, known, found)
    taken = {each.column.name for each in found.values()}
    for column in columns:
        if is_known(column.name) and column.name not in found and column.name not in taken:
            unit = words.UNITS.get(parent(column.name), {}).get(words.plain(column.unit), "")
            found[column.name] = Settled(column=column, target=column.name, unit=unit, exact=True)
    taken |= {each.column.name for each in found.values()}
    free = [each for each in columns if each.name not in taken and not each.aside]
    asides = {each.array or each.name: each.aside for each in columns if each.aside}
    reasons = [f"{array} not read by itself: {why}" for array, why in asides.items()]
    reasons += _take_meant(name, free, known, found)
    wanted = [
        each
        for each in found.values()
        if known.joints is None
        or (pair := channel_of(each.target)) is None
        or pair[1] in known.joints
        or (each.exact and pair[0] == "q")  # named where one is missing
    ]
    return wanted, reasons


def _take_meant(
    name: str, columns: Sequence[Column], known: Known, found: dict[str, Settled]
) -> list[str]:
    joints = known.joints if known.joints is not None else known.others or _labelled(columns)
    if known.numbered and not joints:
        joints = joints_in(columns)
    spellings = joint_spellings(joints)
    meant: list[Meaning] = []
    unclear: list[tuple[str, str]] = []
    for column in columns:
        meaning = meaning_of(column, spellings, alone=known.numbered)
        if isinstance(meaning, Meaning):
            meant.append(meaning)
        elif meaning is not None:
            unclear.append((column.name, meaning))
    claims: dict[str, list[Settled]] = {}
    reasons: list[str] = []
    for each in meant:
        for settled in _claims(each, meant, known, reasons):
            claims.setdefault(settled.target, []).append(settled)
    times = claims.pop("time", [])
    if times and "time" not in found:
        claims |= _clocks(times)
    for target, settled_ in claims.items():
        if target in found:
            continue
        if len(settled_) > 1:
            first, second = settled_[0].column.name, settled_[1].column.name
            raise LoadError(
                f"{name}: columns {first!r} and {second!r} may both be {target!r}; say which with"
                f" 'columns: {{{target}: \"{first}\"}}', or list the other under 'ignore:'"
            )
        found[target] = settled_[0]
    if unclear:
        shown = "; ".join(f"{column!r}: {why}" for column, why in unclear[:SHOWN])
        reasons.append(f"not read, unless 'columns:' maps it: {shown}")
    return list(dict.fromkeys(reasons))


def _clocks(times: Sequence[Settled]) -> dict[str, list[Settled]]:
    """Columns of time nearest the root, plainly called so rather than ticks.

    Seconds with a column of what is beyond them are one time.
    """
    names = [each.column.name for each in times]
    ranks = [
        (len(_PATHS.split(name)), bool(words.TICKS & {*spelling(name).texts})) for name in names
    ]
    first = [each for each, rank in zip(times, ranks, strict=True) if rank == min(ranks)]
    whole = [each for each in first if each.unit == "s"]
    beyond = [each for each in first if each.unit in ("us", "ns")]
    if len(first) == 2 and len(whole) == len(beyond) == 1:
        return {"time": whole, BEYOND_SECONDS: [replace(beyond[0], target=BEYOND_SECONDS)]}
    return {"time": first}


def _labelled(columns: Sequence[Column]) -> tuple[str, ...]:
    """What logs that label their numbers call the joints, where nothing else names them."""
    return tuple(dict.fromkeys(_JOINT.sub("", c.label) for c in columns if c.label))


def _claims(
    each: Meaning, all_: Sequence[Meaning], known: Known, reasons: list[str]
) -> list[Settled]:
    """What a column is, if its joint can be known; else why not is added to the reasons."""
    column = each.column
    if each.channel == "time":
        return [Settled(column=column, target="time", unit=each.unit)]
    if each.joint is None and each.number is None:
        return [Settled(column=column, target=SUPPLY, unit=each.unit)]
    numbers = sorted(e.number for e in all_ if e.series == each.series and e.number is not None)
    if each.joint is not None and _is_name(each, numbers, known):
        if each.channel not in CHANNELS:
            return []
        target = f"{each.channel}.{each.joint}"
        return [Settled(column=column, target=target, unit=each.unit)]
    count = column.count if column.index is not None else len(numbers)
    whole = column.index is not None or numbers in (list(range(count)), list(range(1, count + 1)))
    shown = column.array or each.series.replace("#", "{index}")
    assert each.number is not None
    if each.counted_by and whole and known.order.sizes.get(each.counted_by) == count:
        at = each.number - (0 if column.index is not None else numbers[0])
        entry = known.order.entries.get((each.counted_by, at))
        settled = None if entry is None else _of_entry(each, entry)
        return [] if settled is None else [settled]
    if each.channel not in CHANNELS:
        return []
    if column.label:
        labels = [e.column.label for e in all_ if e.series == each.series and e.joint is None]
        reasons.append(f"of {shown} not read, as they are no joints: {listed(labels)}")
        return []
    joints, order = known.joints, "the order of the joints that were named"
    if joints is None and whole and count == len(known.arm):
        joints, order = known.arm, ALONG_THE_ARM
    if joints is None and whole and known.numbered:
        joints, order = _numbered(all_, count), IN_THE_LOG
    if joints is None:
        reasons.append(
            f"{shown} not read: its {count} numbers are of no named joints; give"
            " 'joints:', in their order"
        )
        return []
    if not whole or count != len(joints):
        reasons.append(
            f"{shown} not read: it has {count} numbers for {len(joints)} joints;"
            f" say which is which with 'columns: {{{each.channel}.{joints[0]}: \"{column.name}\"}}'"
        )
        return []
    at = each.number - (0 if column.index is not None else numbers[0])
    target = f"{each.channel}.{joints[at]}"
    return [Settled(column=column, target=target, unit=each.unit, by_order=order)]


def _numbered(all_: Sequence[Meaning], count: int) -> tuple[str, ...] | None:
    """Names for as many joints as the positions are of, where a log names none; else None."""
    of_joints = [each for each in all_ if each.channel in CHANNELS]
    if any(each.joint is not None or each.column.label for each in of_joints):
        return None
    series: dict[str, list[Meaning]] = {}
    for each in of_joints:
        series.setdefault(each.series, []).append(each)
    positions = {len(each) for each in series.values() if each[0].channel == "q"}
    if (positions or {len(each) for each in series.values()}) != {count}:
        return None
    written = [
        each.number for each in of_joints if each.column.index is None and each.number is not None
    ]
    first = min(written, default=1)
    return tuple(f"joint{k}" for k in range(first, first + count))


def _is_name(meaning: Meaning, numbers: Sequence[int], known: Known) -> bool:
    """Whether the joint in a column's name is one; a number is not, if others count from 0."""
    if meaning.number is None or meaning.joint is None or not meaning.joint.isdigit():
        return True
    return set(numbers) <= {int(e) for e in known.joints or known.others if e.isdigit()}


def _of_entry(meaning: Meaning, entry: Entry) -> Settled | None:
    """An entry of one of MuJoCo's vectors."""
    channel, factor = meaning.channel, 1.0
    if meaning.counted_by == "actuator":
        channel, factor = entry.channel_and_factor(channel)
    if not channel:
        return None
    target = f"{channel}.{entry.joint}"
    return Settled(column=meaning.column, target=target, unit=meaning.unit, factor=factor)


def naming_notes(settled: Sequence[Settled]) -> list[str]:
    """How names were understood, a note for each channel."""
    by_channel: dict[tuple[str, str], list[str]] = {}
    for each in settled:
        if not each.exact:
            unit = f" in {each.unit}" if each.unit else ""
            said = f"{each.column.name} read as {each.target}{unit}"
            key = each.target.partition(".")[0], each.by_order
            by_channel.setdefault(key, []).append(said)
    return [
        f"column {', '.join(said)}" + (f", by {order}" if order else "")
        for (_, order), said in by_channel.items()
    ]
