"""What a torque's own scale leaves open of every figure that torques tell.

Currents and torque constants are known to a few percent. No recording shows it: all that is in
newtons or kilograms grows with them.
"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from ..findings import Estimate
from ..study.study import Study

OF_TORQUE = re.compile(r"\b(N|kg)\b")


def with_torque_scale(study: Study, values: dict[str, Estimate]) -> dict[str, Estimate]:
    """Estimates with the error of the torque's scale: of forces, torques and masses."""
    told = study.trust.torque
    share = study.thresholds.figures.torque_scale if told is None else told
    return {
        name: wider(each, share * abs(each.value)) if OF_TORQUE.search(each.unit) else each
        for name, each in values.items()
    }


def wider(each: Estimate, by: float) -> Estimate:
    """An estimate with one more standard error beside its own, each end as far as it was."""
    below, above = (abs(end - each.value) for end in each.interval95)
    wide = [float(np.hypot(half, 1.96 * by)) for half in (below, above)]
    interval = (each.value - wide[0], each.value + wide[1])
    return replace(each, std=float(np.hypot(each.std, by)), interval95=interval)
