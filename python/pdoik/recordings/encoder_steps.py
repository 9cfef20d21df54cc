"""How fine encoders are, by the positions that they gave."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .recording import FloatArray

_OFF = 0.05  # of a step by which positions may miss its multiples: they are printed
_FEWEST = 20  # positions that show a step
_NEAREST = 1.5  # times the least distance of two positions, within which it is one step


def encoder_steps(columns: Sequence[FloatArray]) -> FloatArray | None:
    """The step of each joint's positions, (n,) in their unit.

    Args:
        columns: of each joint, as they were logged: between samples there are no steps.

    Returns:
        None where a joint's are not on a grid that can be seen.
    """
    steps = [_step(column) for column in columns]
    return np.array(steps) if all(step > 0.0 for step in steps) else None


def _step(values: FloatArray) -> float:
    """The number of which all differences are multiples; 0 where there is none."""
    apart = np.diff(np.unique(values[np.isfinite(values)]))
    if len(apart) < _FEWEST:
        return 0.0
    step = float(np.median(apart[apart < _NEAREST * apart.min()]))
    multiples = apart / step
    off = float(np.median(np.abs(multiples - np.round(multiples))))
    return step if off < _OFF else 0.0
