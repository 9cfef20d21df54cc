"""Units and sentences."""

from __future__ import annotations

import re

from .outcome import Outcome, none_of
from .trial import Trial

UNITS = "units and words"
WITHOUT = ("-", "cycles per turn", "unit of the channel")
"""What is written where there is no unit, or that of something else."""

_ONE = r"(?:kg|rad|Hz|N|m|s|A|V|W|J|K)(?:\^[2-9])?"
_UNIT = re.compile(rf"(?:1|{_ONE}(?: {_ONE})*)(?:/(?:{_ONE}|\({_ONE}(?: {_ONE})+\)))?")
_NUMBER = re.compile(r"\bnan\b|\binf\b")
_WHERE = "Joint seven"


def units_and_words(trial: Trial) -> Outcome:
    """How many parameters have no SI unit, and sentences no place or no figures."""
    effect, wrong = trial.effect, []
    for p in effect.parameters:
        if p.unit not in WITHOUT and not _UNIT.fullmatch(p.unit):
            said = f"unit {p.unit!r}" if p.unit else "no unit"
            wrong.append(f"{p.name} has {said}, expected SI such as 'N m s/rad', or '-'")
    try:
        statement, regime = effect.statement(_WHERE, trial.example.values), effect.regime(_WHERE)
    except Exception as error:  # whatever an effect of somebody else's does
        return none_of(UNITS, [*wrong, f"its statement fails: {type(error).__name__}: {error}"], "")
    if effect.on != "base" and _WHERE not in statement:
        wrong.append("its statement does not say where")
    if _NUMBER.search(statement):
        wrong.append(f"its statement has no numbers: {statement}")
    if not regime:
        wrong.append("it does not say when it shows")
    for what in ("equation", "source", "decided_by"):
        wrong += [] if getattr(effect, what, "") else [f"it has no {what}"]
    return none_of(UNITS, wrong, "units are SI, the statement says where")
