"""What the study gives of a controller's gains, compared with what its effort shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..findings import ControllerEstimate
from ..study import Controller, Study
from ..thresholds import ControllerThresholds
from .estimate import JointLaw

SEEN_ITSELF = ("tau_cmd", "duty")
"""Efforts that are the law's own: a torque reported may differ from it by the drive's gain."""


def given_gains(study: Study, j: int) -> dict[str, float]:
    """Gains of joint j that the study gives, by name."""
    given, known = study.told, study.controller
    if given is not None:
        every = {name: float(values[j]) for name, values in given.gains.items()}
        return {name: value for name, value in every.items() if np.isfinite(value)}
    if isinstance(known, Controller) and known.type == "pd":
        return {"kp": float(known.kp[j]), "kd": float(known.kd[j])}
    return {}


def compared(
    law: JointLaw, gains: dict[str, float], limits: ControllerThresholds
) -> ControllerEstimate:
    """The estimate with the position gain given, if the effort contradicts it.

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
    shown = ((found.value, found.std), *law.each)
    same_way = len({value > kp for kp, _ in shown}) == 1
    far = all(abs(value - kp) > limits.given_off * abs(kp) for kp, _ in shown)
    differs = all(_log_odds(value, kp, std, limits) > limits.worth for kp, std in shown)
    wrong = same_way and far and differs
    return replace(estimate, given_wrong={"kp": value}) if wrong else estimate


def _log_odds(value: float, kp: float, std: float, limits: ControllerThresholds) -> float:
    """That a gain is another one than given, as usual errors of it are.

    The density of the gain at the value given before the data over that after them (Dickey, Annals
    of Mathematical Statistics 42, 1971).
    """
    usual = np.hypot(limits.given_usual * value, std)
    return float(0.5 * ((value - kp) / std) ** 2 + np.log(std / usual))
