"""Readings that jump and come back within a few samples: no body with inertia moves like that.

An encoder that loses a bit, a bus that mixes two words: one such sample of 0.1 rad is a hundred
thousand rad/s^2, and every filter smears it over what is around.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .recording import FloatArray

_LONGEST = 4  # samples that a glitch lasts
_AROUND = 8  # samples on either side by which steps are judged, their usual pace taken off
_BEYOND = 6.0  # times the steps there, two of them apart
_STEPS = 8.0  # times the smallest change that was ever logged: a last digit is no jump
_USUAL = 12.0  # times the usual change of the step from one sample to the next
_BACK = 0.4  # of the jump, within which it comes back


def glitches(values: FloatArray) -> NDArray[np.bool_]:
    """Which of a column's readings are such jumps, (R,); what is not a number is none.

    A glitch goes in and comes back by steps that are far larger than those around it, than the
    column's resolution, and than its usual changes.
    """
    found = np.zeros(len(values), dtype=np.bool_)
    there = np.flatnonzero(np.isfinite(values))
    x = values[there]
    if len(x) < 2 * _AROUND:
        return found
    steps = np.diff(x)
    size = np.abs(steps)
    if not size.any():
        return found
    bends = np.abs(np.diff(steps))  # of what moves evenly nothing
    # Float noise and interpolated logs have no resolution: there the other bounds decide.
    resolution = float(np.quantile(size[size > 0.0], 0.02))
    least = max(_STEPS * resolution, _USUAL * float(np.median(bends)))
    large, back = size > 0.5 * least, np.zeros(len(steps), dtype=np.bool_)
    for width in range(1, min(_LONGEST, len(steps) - 1) + 1):
        back[:-width] |= (steps[:-width] * steps[width:] < 0.0) & large[width:]
    last = -1
    for k in map(int, np.flatnonzero(large & back)):
        if k <= last:
            continue
        for width in range(1, _LONGEST + 1):
            if _is_glitch(x, steps, k, width, least):
                found[there[k + 1 : k + 1 + width]] = True
                last = k + width
                break
    return found


def _is_glitch(x: FloatArray, steps: FloatArray, k: int, width: int, least: float) -> bool:
    """Whether x[k + 1 : k + 1 + width] jumped in by step k and back by step k + width."""
    out = k + width
    if out >= len(steps) or steps[k] * steps[out] >= 0.0:
        return False
    before, after = steps[max(k - _AROUND, 0) : k], steps[out + 1 : out + 1 + _AROUND]
    if min(len(before), len(after)) < _AROUND // 2:
        return False
    near = np.concatenate([before, steps[k + 1 : out], after])
    pace = float(np.median(near))
    jump = min(abs(steps[k] - pace), abs(steps[out] - pace))
    around = np.sort(np.abs(near - pace))
    comes_back = abs(x[out + 1] - x[k] - (width + 1) * pace) < _BACK * jump
    # Another glitch nearby has two such steps of its own.
    return bool(comes_back and jump > max(least, _BEYOND * around[-3]))
