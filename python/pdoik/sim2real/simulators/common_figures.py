"""One candidate in other coordinates: what joints have in common becomes one figure of all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from pdoik.recordings import FloatArray

from .candidates import ParameterId
from .climb import Climb
from .property import EVERY


class _Figures:
    """Values of all parameters, and what they are over the user's where these are not zero."""

    def __init__(
        self, values: Mapping[ParameterId, float], ratios: Mapping[ParameterId, float]
    ) -> None:
        self.values, self.ratios = values, ratios

    def of(self, name: str) -> dict[ParameterId, float]:
        """Values of a property by parameter, each joint's own."""
        return {k: v for k, v in self.values.items() if k.property == name and k.index != EVERY}


Change = Callable[[_Figures], dict[ParameterId, float] | None]


def with_common_figures(climb: Climb, x: FloatArray) -> FloatArray:
    """The likeliest coordinates, before the data, of the candidate that x is, or nearly is.

    A delay of all joints stands for what theirs have in common, a factor of all proportional gains
    or of all gains for theirs, a factor of one drive for its two gains.
    """
    each_drive = [partial(_with_factor, k=k) for k in range(len(climb.experiment.user.joints))]
    stages: tuple[tuple[Change, ...], ...] = (
        (_with_delay,),
        (_with_factor_of_kp, _with_factor_of_gains),
        *((change,) for change in each_drive),
    )
    for changes in stages:
        others = [_changed(climb, x, change) for change in changes]
        x = max((x, *others), key=lambda at: _log_prior(climb, at))
    return x


def _log_prior(climb: Climb, x: FloatArray) -> float:
    return -float((((x - climb.start) / climb.std) ** 2).sum())


def _changed(climb: Climb, x: FloatArray, change: Change) -> FloatArray:
    """The candidate with changed figures; x if there are none of that kind."""
    values = {
        each.parameter_id: each.value(float(at))
        for each, at in zip(climb.parameters, x, strict=True)
    }
    ratios = {
        each.parameter_id: values[each.parameter_id] / base
        for each in climb.parameters
        if (base := each.value(each.start)) > 0.0
    }
    changed = change(_Figures(values, ratios))
    if changed is None or not changed.keys() <= climb.place.keys():
        return x
    other = x.copy()
    for parameter_id, value in changed.items():
        i = climb.place[parameter_id]
        other[i] = climb.parameters[i].x_of(value)
    return other


def _with_delay(figures: _Figures) -> dict[ParameterId, float] | None:
    own = figures.of("delay")
    usual = float(np.median([*own.values()]))
    if usual <= 0.0 or len(own) < 2:
        return None
    shared = figures.values[ParameterId("delay", EVERY)] + usual
    rest = {
        parameter_id: max(value - usual, 0.0) for parameter_id, value in own.items()
    }  # none comes early
    return {ParameterId("delay", EVERY): shared, **rest}


def _with_factor_of_kp(figures: _Figures) -> dict[ParameterId, float] | None:
    own = figures.of("kp")
    if len(own) < 2:
        return None
    factor = float(np.median([figures.ratios[parameter_id] for parameter_id in own]))
    changed = {parameter_id: value / factor for parameter_id, value in own.items()}
    return {
        **changed,
        ParameterId("kp_factor", EVERY): figures.values[ParameterId("kp_factor", EVERY)] * factor,
    }


def _with_factor_of_gains(figures: _Figures) -> dict[ParameterId, float] | None:
    changed = _with_factor_of_kp(figures)
    if changed is None:
        return None
    before = figures.values[ParameterId("kp_factor", EVERY)]
    factor = changed.pop(ParameterId("kp_factor", EVERY))
    changed |= {
        parameter_id: value / (factor / before) for parameter_id, value in figures.of("kv").items()
    }
    shared = figures.values[ParameterId("gain_factor", EVERY)] * factor / before
    return {**changed, ParameterId("gain_factor", EVERY): shared}


def _with_factor(figures: _Figures, k: int) -> dict[ParameterId, float] | None:
    kp, kv, both = (ParameterId(name, k) for name in ("kp", "kv", "gain_factor"))
    if kp not in figures.values or both not in figures.values:
        return None
    factor = figures.ratios[kp]
    return {
        kp: figures.values[kp] / factor,
        kv: figures.values[kv] / factor,
        both: figures.values[both] * factor,
    }
