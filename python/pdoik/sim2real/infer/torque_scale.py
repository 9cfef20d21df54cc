"""What a torque's own scale leaves open of every figure that comes from torques.

Currents and torque constants are known to a few percent. No recording shows it: all that is in
newtons or kilograms grows with them.
"""

from __future__ import annotations

import re

from ..findings import Estimate
from ..study import Study

OF_TORQUE = re.compile(r"\b(N|kg)\b")


def with_torque_scale(study: Study, values: dict[str, Estimate]) -> dict[str, Estimate]:
    """Estimates with the error of the torque's scale: of forces, torques and masses."""
    given = study.trust.torque
    share = study.thresholds.priors.torque_scale if given is None else given
    return {
        name: each.wider(share * abs(each.value)) if OF_TORQUE.search(each.unit) else each
        for name, each in values.items()
    }
