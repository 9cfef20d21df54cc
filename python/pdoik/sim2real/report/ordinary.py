"""What every machine has, joint by joint, as the report's first table."""

from __future__ import annotations

from dataclasses import dataclass

from pdoik.sim2real.findings import Diagnosis, OrdinaryPart

from . import words

Cell = tuple[str, bool]  # what is said, and whether it is negligible


@dataclass(frozen=True, slots=True, kw_only=True)
class OrdinaryTable:
    """Columns are effects; a row is a joint. Bodies follow in a line."""

    columns: tuple[str, ...]
    joints: tuple[tuple[str, tuple[Cell, ...]], ...]
    bodies: tuple[tuple[str, str, bool], ...]


def ordinary_of(diagnosis: Diagnosis) -> OrdinaryTable | None:
    """The table; None where no joint's torque was judged."""
    of_joints = [part for part in diagnosis.ordinary if part.joints]
    if not of_joints:
        return None
    effects = tuple(dict.fromkeys(part.effect for part in of_joints))
    by_place = {(part.joints, part.effect): part for part in of_joints}
    units = {part.effect: part.estimate.unit for part in of_joints}
    names = [name for name in diagnosis.joints if any(part.joints == (name,) for part in of_joints)]
    return OrdinaryTable(
        columns=tuple(_heading(effect, units[effect]) for effect in effects),
        joints=tuple(
            (name, tuple(_cell(by_place.get(((name,), effect))) for effect in effects))
            for name in names
        ),
        bodies=tuple(
            (", ".join(part.links), *_cell(part)) for part in diagnosis.ordinary if part.links
        ),
    )


def _heading(effect: str, unit: str) -> str:
    return words.effect_name(effect) + (f" [{unit}]" if unit != "-" else "")


def _cell(part: OrdinaryPart | None) -> Cell:
    if part is None:
        return words.DASH, True
    value, low, high = words.estimate_numbers(part.estimate)
    return f"{value} ({low} to {high})", part.negligible
