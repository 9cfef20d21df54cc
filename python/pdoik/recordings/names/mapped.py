"""Columns that `columns:` maps."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from ..logs import Column
from ..recording import CHANNELS
from ..units import KNOWN, parent
from .columns_key import Match
from .known import Known, Settled, listed
from .meaning import Meaning, meaning_of
from .tokens import joint_spellings, spelling


def take_mapped(
    name: str, columns: Sequence[Column], known: Known, found: dict[str, Settled]
) -> None:
    """Add the mapped columns to those found, by target.

    Raises:
        LoadError: `columns:` maps a name that is not there, or two to the same.
    """
    there = {each.name for each in columns}
    for target, matches in known.key.matches(columns).items():
        if not matches and not known.key.optional and not _is_there(target, there):
            source = known.key.sources[target]
            labelled = [f"{each.array}.{each.label}" for each in columns if each.label]
            near = nearest(source, [*there, *labelled])
            has = near or f"; it has {listed([each.name for each in columns])}"
            raise LoadError(f"{name}: columns: {target}: no column {source!r}{has}")
        first = min((each.index for each in matches if each.index is not None), default=0)
        for match in matches:
            joint, factor = _joint_and_factor(name, match, known, min(first, 1))
            if target in CHANNELS and joint is None:
                continue
            aim = f"{target}.{joint}" if target in CHANNELS else target
            if aim in found:
                raise LoadError(
                    f"{name}: columns: {found[aim].column.name!r} and {match.column.name!r} are"
                    f" both mapped to {aim!r}"
                )
            found[aim] = Settled(
                column=match.column, target=aim, unit=_unit(match.column, target), factor=factor
            )


def _is_there(target: str, names: Collection[str]) -> bool:
    """Whether a log has it under pdoik's own name: then it needs no mapping."""
    if target in CHANNELS:
        return any(each.startswith(f"{target}.") for each in names)
    return target in names


def _unit(column: Column, target: str) -> str:
    """The unit that the column's name says, if it is one of the target's; else ""."""
    said = meaning_of(column, {})
    unit = said.unit if isinstance(said, Meaning) else ""
    return unit if unit in KNOWN.get(parent(target), {}) else ""


def _joint_and_factor(
    name: str, match: Match, known: Known, first: int
) -> tuple[str | None, float]:
    """Whose a mapped column is, None if it is of no joint; joints are counted from `first`."""
    if match.joint is not None:
        return _named(match.joint, known), 1.0
    if match.index is None:
        return None, 1.0
    said = meaning_of(match.column, {})
    if isinstance(said, Meaning) and said.counted_by and known.order.entries:
        size = known.order.sizes[said.counted_by]
        if match.column.count in (1, size):
            entry = known.order.entries.get((said.counted_by, match.index))
            if entry is None:
                return None, 1.0
            channel, factor = entry.channel_and_factor(said.channel)
            mine = said.counted_by == "actuator" and channel == match.target
            return entry.joint, factor if mine else 1.0
    if known.joints is None:
        raise LoadError(
            f"{name}: columns: {match.target}: '{{index}}' counts joints in the order of"
            " 'joints:', which is missing"
        )
    at = match.index - first
    return (known.joints[at] if at < len(known.joints) else None), 1.0


def _named(text: str, known: Known) -> str | None:
    """The joint of this name, or of one of its spellings; any, where none is known."""
    joints = known.joints if known.joints is not None else known.others
    if not joints or text in joints:
        return text
    texts = spelling(text).texts
    said = [joint for joint, each in joint_spellings(joints).items() if texts in each]
    return said[0] if len(said) == 1 else None
