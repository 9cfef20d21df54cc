"""Does a diagnosis of recordings with the effect name it?"""

from __future__ import annotations

from pdoik.errors import PdoikError

from ..diagnose import diagnose
from ..findings import Finding
from .arm import JOINTS, Arm, noisy
from .outcome import Outcome, at_most, none_of, not_applicable
from .trial import Trial

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
