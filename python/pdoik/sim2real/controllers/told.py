"""What the study tells of a controller, beside what its effort shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..findings import ControllerEstimate
from ..study.study import Controller, Study
from ..thresholds.controllers import ControllerThresholds
from .estimate import JointLaw

SEEN_ITSELF = ("tau_cmd", "duty")
"""Efforts that are the law's own: a torque reported may differ from it by the drive's gain."""


def told_gains(study: Study, j: int) -> dict[str, float]:
    """Gains of joint j that the study tells, by name."""
    told, known = study.told, study.controller
    if told is not None:
        every = {name: float(values[j]) for name, values in told.gains.items()}
        return {name: value for name, value in every.items() if np.isfinite(value)}
    if isinstance(known, Controller) and known.type == "pd":
        return {"kp": float(known.kp[j]), "kd": float(known.kd[j])}
    return {}


def compared(
    law: JointLaw, gains: dict[str, float], limits: ControllerThresholds
) -> ControllerEstimate:
    """With the position gain told, if the effort contradicts it.

    Only where the law's own effort was logged and is explained, and in every recording by itself:
    what one of them has is no gain. Dampings and integrals are not judged: a speed that is logged
    late, or with noise of the log's own, changes what they seem.
    """
    estimate = law.estimate
    seen = estimate.effort in SEEN_ITSELF and estimate.explained >= limits.used
    if not seen or "kp" not in gains or "kp" not in estimate.gains:
        return estimate
    value, found = gains["kp"], estimate.gains["kp"]
    if "kv" in gains and estimate.law == "pd":  # what a cascade without an integral is
        value *= gains["kv"]
    elif ("kv" in gains) != (estimate.law == "cascade") or estimate.law == "table":
        return estimate
    above = value > found.value
    wrong = all(
        (value - kp if above else kp - value) > max(limits.told_off * abs(kp), limits.told_t * std)
        for kp, std in ((found.value, found.std), *law.each)
    )
    return replace(estimate, told_wrong={"kp": value}) if wrong else estimate
