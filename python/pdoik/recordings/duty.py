"""Effort as pulse widths: the supply they are shares of, and numbers that can be none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pdoik.errors import LoadError

from .columns import SUPPLY, Table
from .recording import Recording
from .suspected_unit import SuspectedUnitError
from .units import Units

_MOST = 1.05  # of the supply: a little more is rounding


def with_supply(table: Table, joints: tuple[str, ...]) -> Table:
    """The table with the common supply as `voltage` of each joint that has a duty and none."""
    supply = table.columns.get(SUPPLY)
    if supply is None:
        return table
    columns = {name: values for name, values in table.columns.items() if name != SUPPLY}
    for joint in joints:
        if f"duty.{joint}" in columns:
            columns.setdefault(f"voltage.{joint}", supply)
    return replace(table, columns=columns)


def check_duty(recording: Recording, joints: tuple[str, ...], units: Units) -> None:
    """Check that duties are shares of the supply, and supplies positive.

    Raises:
        LoadError: they are not, with the line that settles it.
    """
    if recording.duty is not None:
        size = np.nan_to_num(np.nanmax(np.abs(np.nan_to_num(recording.duty)), axis=0))
        k = int(np.argmax(size))
        if size[k] > _MOST:
            unit = "%" if size[k] <= 100 * _MOST else "permille"
            said = units.named.get(f"duty.{joints[k]}", units.named.get("duty"))
            settle = (
                f"'units:' says it is in {said}"
                if said
                else f"if it is, say 'units: {{duty: {unit}}}'"
            )
            why = f"duty.{joints[k]} reaches {size[k]:.4g}"
            raise SuspectedUnitError(
                f"{recording.name}: is 'duty' in {unit}? Expected -1 to 1, but {why}; {settle}",
                "duty",
                unit,
                why,
            )
    if recording.voltage is not None:
        low = np.nan_to_num(recording.voltage, nan=1.0).min(axis=0)
        k = int(np.argmin(low))
        if low[k] <= 0.0:
            raise LoadError(
                f"{recording.name}: expected a supply of more than 0 V, but voltage.{joints[k]}"
                f" (or volts) is {low[k]:.4g}"
            )
