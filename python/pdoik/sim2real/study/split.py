"""Parting recordings into those to learn from and those that only judge."""

from __future__ import annotations

from dataclasses import replace

from pdoik.errors import LoadError
from pdoik.recordings import Recording

HELD_OUT = 0.3  # of each recording's end, where there are too few to hold out whole ones
_BETWEEN = 0.5  # left out between the blocks, since neighbouring samples resemble each other [s]


def split(recordings: tuple[Recording, ...]) -> tuple[tuple[Recording, ...], str]:
    """The recordings with held-out data among them, and how they were parted, in words.

    As the study says, if it holds out any; else the last third of the recordings; with fewer than
    three, the last 30 % of each.

    Raises:
        LoadError: none is left to fit.
    """
    if not any(recording.role == "fit" for recording in recordings):
        raise LoadError(
            "recordings: none has 'role: fit', so there is nothing to learn from; expected one"
            " at least"
        )
    if any(recording.role == "validate" for recording in recordings):
        return recordings, "by the study"
    if len(recordings) >= 3:
        held = len(recordings) // 3
        late = tuple(replace(each, role="validate") for each in recordings[-held:])
        names = ", ".join(each.name for each in late)
        return recordings[:-held] + late, f"by recording: the study holds out none, so {names}"
    blocks = [block for each in recordings for block in _blocks(each)]
    return tuple(blocks), (
        f"by blocks: the study holds out none and has {len(recordings)} recording(s), so the last"
        f" {100 * HELD_OUT:.0f} % of each"
    )


def _blocks(recording: Recording) -> tuple[Recording, Recording]:
    """The recording's first part to fit, its last to validate."""
    count = len(recording.time)
    cut = round(count * (1 - HELD_OUT))
    between = min(round(_BETWEEN / recording.period), count // 50)
    late = replace(
        part(recording, cut, count),
        name=f"{recording.name} (last {100 * HELD_OUT:.0f} %)",
        file=recording.name,
        role="validate",
    )
    return replace(part(recording, 0, cut - between), role="fit"), late


def part(recording: Recording, first: int, last: int) -> Recording:
    """The samples `first` to `last`, exclusive, copied; their time is from 0 again."""
    names = [*recording.channels, "valid"]
    if recording.released is not None:
        names.append("released")
    arrays = {name: getattr(recording, name)[first:last].copy() for name in names}
    offset = float(recording.time[first])
    return replace(
        recording,
        start=recording.start + offset,
        time=recording.time[first:last] - offset,
        **arrays,
    )
