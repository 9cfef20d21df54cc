"""All checks of one effect, and whether a diagnosis of recordings with it names it."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from pdoik.errors import PdoikError

from ..diagnose import diagnose
from ..effects import Effect
from ..findings import Finding
from .against_simulation import COLUMNS, against_simulation
from .algebra import BOUNDS, NOTHING, THERE_AND_BACK, bounds, nothing, there_and_back
from .arm import JOINTS, Arm, noisy
from .gradients import GRADIENTS, STIFFNESS, gradients, stiffness
from .load import tried
from .outcome import Outcome, at_most, none_of, not_applicable
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


FOUND = "found"
NEAR = 0.3  # of the first figure, where that is the effect's size
_LATE = 13.0  # where in the motion the held-out recording begins [s]


def found(trial: Trial, arm: Arm) -> Outcome:
    """Whether a diagnosis of two recordings with modest noise names it at its place.

    Where its first figure is its size, that has to be near the example's. Or it names one that it
    says it is confused with, or another of which the diagnosis says that data cannot distinguish
    the two.

    Args:
        trial: of the effect.
        arm: with a longer motion.
    """
    place, effect = trial.place, trial.effect
    if place is None:
        return not_applicable(FOUND, "it has no place on the arm")
    try:
        first = noisy(trial.log(arm), "fit", 1)
        second = noisy(trial.log(arm, name="held out", late=_LATE), "validate", 2)
        diagnosis = diagnose(arm.study(first, second))
    except (PdoikError, ValueError) as error:
        return none_of(FOUND, [f"it cannot be diagnosed: {error}"], "")
    names = {effect.id, *effect.confused_with} - set(trial.example.beside)
    joints = tuple(JOINTS[j] for j in place.joints)
    for each in sorted(diagnosis.findings, key=lambda each: each.effect != effect.id):
        here = not joints or not each.joints or set(joints) & set(each.joints)
        said = {each.effect, *(other.effect for other in each.equivalents)}
        if here and each.effect == effect.id and effect.size_first:
            name = effect.parameters[0].name
            true = trial.example.values[name]
            off = abs(each.values[name] - true) / max(abs(true), 1e-12)
            return at_most(FOUND, off, NEAR, f"{name} off by this share; {_words(each, effect.id)}")
        if here and (effect.id in said or each.effect in names):
            return none_of(FOUND, [], _words(each, effect.id))
    others = ", ".join(f"{f.effect} of {', '.join(f.joints + f.links)}" for f in diagnosis.findings)
    return none_of(FOUND, [f"the diagnosis names {others or 'nothing'}"], "")


def _words(finding: Finding, name: str) -> str:
    if finding.effect == name:
        return f"named: {finding.statement}"
    return f"{finding.effect} is named, which it may be confused with"


_LONGER = 24.0  # recordings that are diagnosed [s]
_CHECKS: dict[str, Callable[[Trial], Outcome]] = {
    COLUMNS: against_simulation,
    THERE_AND_BACK: there_and_back,
    BOUNDS: bounds,
    NOTHING: nothing,
    GRADIENTS: gradients,
    STIFFNESS: stiffness,
    UNITS: units_and_words,
}


def check_effect(
    effect: Effect, *, diagnose: bool = False, arm: Arm | None = None
) -> tuple[Outcome, ...]:
    """One outcome per check; a check that the effect makes raise has failed.

    Args:
        effect: in the catalogue or not.
        diagnose: whether to simulate recordings and diagnose them too, which takes longer.
        arm: to try it on; a new one if None.
    """
    example = effect.example
    if example is None:
        words = "it has no `example`: figures to try it with, such as Example(values={...})"
        return (Outcome(check="example", status="fail", words=words),)
    with TemporaryDirectory() as folder, tried([effect]):
        arm = arm or Arm(Path(folder))
        try:
            trial = Trial(effect, example, arm)
        except Exception as error:  # whatever an effect of somebody else's does
            return (_raised("example", error),)
        outcomes = []
        for name, check in _CHECKS.items():
            try:
                outcomes.append(check(trial))
            except Exception as error:
                outcomes.append(_raised(name, error))
        if diagnose:
            longer = Path(folder) / "longer"
            longer.mkdir()
            outcomes.append(found(trial, Arm(longer, _LONGER, example.held)))
    return tuple(outcomes)


def _raised(check: str, error: Exception) -> Outcome:
    words = f"it raises {type(error).__name__}: {error}"
    return Outcome(check=check, status="fail", words=words)
