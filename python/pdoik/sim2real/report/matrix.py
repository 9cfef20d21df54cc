"""A diagnosis at a glance: what joints share as a matrix, what is anomalous by itself."""

from __future__ import annotations

from dataclasses import dataclass

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.findings import Diagnosis, Finding

from .words import effect_name, estimate_numbers, number, place

_SURE = 0.95  # a confidence that a table need not show
_SHARED = 2  # joints with an effect, from which it is a column


@dataclass(frozen=True, slots=True, kw_only=True)
class Matrix:
    """Joints by effects that several of them have; cells hold findings."""

    effects: tuple[str, ...]
    cells: dict[str, dict[str, Finding]]  # by joint, then by effect
    others: tuple[Finding, ...]  # findings that are no cell, in the diagnosis's order

    def by_effect(self) -> dict[str, list[Finding]]:
        """The cells of each effect, in the order of the joints."""
        rows = self.cells.values()
        return {name: [row[name] for row in rows if name in row] for name in self.effects}


def matrix_of(diagnosis: Diagnosis) -> Matrix:
    """Effects of single joints found at two joints or more are columns, families side by side."""
    single = [f for f in diagnosis.findings if len(f.joints) == 1 and not f.links and not f.gate]
    names = [f.effect for f in single if f.effect in CATALOGUE and _is_sized(f)]
    order = list(CATALOGUE)
    shared = sorted({n for n in names if names.count(n) >= _SHARED}, key=order.index)
    shared.sort(key=lambda name: CATALOGUE[name].family)
    cells: dict[str, dict[str, Finding]] = {joint: {} for joint in diagnosis.joints}
    inside = []
    for finding in single:
        row = cells.get(finding.joints[0])
        if row is not None and finding.effect in shared and finding.effect not in row:
            row[finding.effect] = finding
            inside.append(finding)
    others = tuple(f for f in diagnosis.findings if not any(f is each for each in inside))
    return Matrix(effects=tuple(shared), cells=cells, others=others)


def _is_sized(finding: Finding) -> bool:
    """Whether its first figure says how large it is."""
    return CATALOGUE[finding.effect].sought != "last" and bool(finding.parameters)


def heading(effect: str) -> str:
    """A column's: the effect, and the unit of its first figure."""
    unit = CATALOGUE[effect].parameters[0].unit
    return effect_name(effect) + (f"\n[{unit}]" if unit != "-" else "")


def cell(finding: Finding | None) -> str:
    """Size, half its 95 % interval, and its confidence where that is below 0.95."""
    if finding is None:
        return ""
    estimate = next(iter(finding.parameters.values()))
    half = (estimate.interval95[1] - estimate.interval95[0]) / 2.0
    size = number(estimate.value)
    if half > 0.0:
        size += f"\N{PLUS-MINUS SIGN}{number(half, 2)}"
    return size if finding.confidence >= _SURE else f"{size} ({finding.confidence:.2f})"


def line(finding: Finding) -> str:
    """A finding in one line: what, where, and up to two figures with their intervals."""
    start = f"{effect_name(finding.effect)} at {place(finding)}"
    known = CATALOGUE.get(finding.effect)
    if known is not None and known.sought == "last":
        return f"{start}: {finding.statement.rpartition('; ')[2].rstrip('.')}"
    said = []
    for name, estimate in list(finding.parameters.items())[:2]:
        value, low, high = estimate_numbers(estimate)
        unit = "" if estimate.unit == "-" else f" {estimate.unit}"
        said.append(f"{name.replace('_', ' ')} {value}{unit} ({low} to {high})")
    return start + (f": {', '.join(said)}" if said else "")
