"""Ids and numbers in the words of the report."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.findings import Diagnosis, Equivalent, Estimate, Finding, JointFit, Verdict
from pdoik.sim2real.thresholds import DiagnosisThresholds

_LIMITS = DiagnosisThresholds()

MINUS, DASH = "\N{MINUS SIGN}", "\N{EN DASH}"
VERDICTS: dict[Verdict, tuple[str, str]] = {
    "no_mismatch": (
        "Model and machine agree",
        "The residual is no larger than the recordings' own noise.",
    ),
    "mismatch_explained": (
        "Model and machine differ; the findings explain it",
        "With the findings below, the model predicts held-out recordings down to their noise.",
    ),
    "mismatch_partly_explained": (
        "Model and machine differ; the findings explain a part of it",
        "The findings below explain a part of the residual; the rest of it has no known cause.",
    ),
    "mismatch_unexplained": (
        "Model and machine differ; no known effect explains it",
        "Every effect that was tried failed on data it was not fitted to. The place of the mismatch"
        " is known, its cause is not.",
    ),
    "cannot_tell": (
        "These recordings cannot answer the question",
        "They hold too little motion, or too few channels, to judge the model by.",
    ),
}


def effect_name(effect: str) -> str:
    """`coulomb_friction` as Coulomb friction."""
    return CATALOGUE[effect].words if effect in CATALOGUE else effect.replace("_", " ")


def place(thing: Finding | Equivalent) -> str:
    """The link that has it, or else the joints."""
    if thing.effect in CATALOGUE and CATALOGUE[thing.effect].on == "base":
        return "the base"
    return ", ".join(thing.links or thing.joints) or "the whole robot"


def sentence(text: str) -> str:
    """Text with a capital first letter."""
    return text[:1].upper() + text[1:]


def number(value: float, digits: int = 3) -> str:
    """Number to `digits` significant digits; a dash for what is not finite."""
    if not math.isfinite(value):
        return DASH
    if value == 0:
        return "0"
    size = abs(value)
    if size >= 1e5 or size < 1e-4:
        mantissa, power = f"{value:.{digits - 1}e}".split("e")
        return f"{mantissa}e{int(power)}".replace("-", MINUS)
    decimals = max(digits - 1 - math.floor(math.log10(size)), 0)
    return f"{value:.{decimals}f}".replace("-", MINUS)


def estimate_numbers(estimate: Estimate) -> tuple[str, str, str]:
    """Value and both ends of the interval, all to the decimals that the error allows."""
    entries = (estimate.value, *estimate.interval95)
    spread = estimate.std
    if not (math.isfinite(spread) and spread > 0) or not all(map(math.isfinite, entries)):
        low, middle, high = (number(entry) for entry in (entries[1], entries[0], entries[2]))
        return middle, low, high
    if spread < 1e-7 or max(abs(entry) for entry in entries) >= 1e6:
        middle, low, high = (number(entry, 4) for entry in entries)
        return middle, low, high
    decimals = max(1 - math.floor(math.log10(spread)), 0)
    middle, low, high = (f"{entry:.{decimals}f}".replace("-", MINUS) for entry in entries)
    return middle, low, high


def parameters_of(finding: Finding) -> dict[str, Estimate]:
    """Estimates as a reader wants them: of an unnamed torque, its values at the knots."""
    if finding.effect not in CATALOGUE:
        return finding.parameters
    shown = CATALOGUE[finding.effect].shown(finding.values)
    return {said: finding.parameters[name] for name, said in shown.items()}


def percent(share: float) -> str:
    """A share as a percentage."""
    if not math.isfinite(share):
        return DASH
    value = 100 * share
    text = f"{value:.1f}" if abs(value) < 9.95 else f"{value:.0f}"
    return f"{text.removesuffix('.0')} %".replace("-", MINUS)


def slug(name: str) -> str:
    """What of a name can stand in a file's name."""
    return re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:40] or "x"


def joint_state(fit: JointFit) -> str:
    """How a joint stands after the findings: quiet, better, left or still."""
    if not fit.excited:
        return "not moved enough to judge"
    if fit.before <= 1.3 * fit.noise_floor:
        return "agrees within noise"
    floor = math.hypot(fit.noise_floor, fit.spread)
    if fit.after <= max(_LIMITS.near_floor * floor, _LIMITS.little * fit.before):
        return "explained"
    return "partly explained" if fit.after < 0.9 * fit.before else "not explained"


def residue_words(fit: JointFit) -> str:
    """Variable that shows the unexplained residual most; "" where a joint is explained."""
    if fit.residue is None:
        return ""
    of = fit.residue
    said = f"unexplained, {percent(of.share)} by {of.of}" if of.of else "unexplained"
    if of.outstanding:
        said += f"; {number(of.outstanding, 2)} times what other joints keep: no known effect"
    return said


def suspected_words(diagnosis: Diagnosis) -> str:
    """What is suspected and not claimed, in one line; "" for nothing."""
    if not diagnosis.suspected:
        return ""
    said = [f"{effect_name(f.effect)} at {place(f)}" for f in diagnosis.suspected[:3]]
    more = f" and {len(diagnosis.suspected) - 3} more" if len(diagnosis.suspected) > 3 else ""
    return f"Suspected only, with too little evidence: {'; '.join(said)}{more}."


def changes(finding: Finding, thresholds: Mapping[str, float]) -> dict[str, str]:
    """Changes of figures from session to session, in words, where that is clear."""
    said: dict[str, str] = {}
    known = CATALOGUE.get(finding.effect)
    if known is not None and known.sought == "last":
        return said
    for name, estimate in finding.parameters.items():
        spread, p = estimate.spread, estimate.spread_p
        least = thresholds.get("nothing", _LIMITS.nothing) * abs(estimate.value)
        if spread is None or p is None or spread <= least:
            continue
        if p > thresholds.get("spread_p", _LIMITS.spread_p):
            continue
        unit = "" if estimate.unit == "-" else f" {estimate.unit}"
        share = spread / max(abs(estimate.value), 1e-300)
        said[name] = percent(share) if share < 1.0 else f"{number(spread, 2)}{unit}"
    return said


def changes_words(diagnosis: Diagnosis) -> list[str]:
    """What changes from session to session, a line for each effect and figure; [] for nothing."""
    groups: dict[tuple[str, str], list[str]] = {}
    for finding in diagnosis.findings:
        for name, by in changes(finding, diagnosis.thresholds.get("diagnosis", {})).items():
            groups.setdefault((finding.effect, name), []).append(f"{place(finding)} by {by}")
    return [
        f"From session to session {effect_name(effect)} changes"
        f" ({name.replace('_', ' ')}): {', '.join(where)}."
        for (effect, name), where in groups.items()
    ]


def parted(diagnosis: Diagnosis) -> tuple[list[Finding], list[Finding]]:
    """Findings that are anomalous to this machine, and those of what every machine has."""
    parts = {(part.effect, part.joints) for part in diagnosis.ordinary}
    usual = [each for each in diagnosis.findings if (each.effect, each.joints) in parts]
    usual = [each for each in usual if each.gate is None and not each.variant]
    return [each for each in diagnosis.findings if each not in usual], usual


def _usual_words(findings: list[Finding]) -> str:
    """How many joints have how much of what every machine has to be said, in one line."""
    joints: dict[str, list[str]] = {}
    for each in findings:
        joints.setdefault(each.effect, []).append(place(each))
    said = [
        f"{effect_name(effect)} at {where[0] if len(where) == 1 else f'{len(where)} joints'}"
        for effect, where in joints.items()
    ]
    return f"Of what every machine has, these are large enough to matter: {', '.join(said)}."


def summary(diagnosis: Diagnosis) -> list[str]:
    """The verdict's reasons, a sentence each."""
    lines = [VERDICTS[diagnosis.verdict][1]]
    findings, usual = parted(diagnosis)
    if findings:
        count = "One cause was" if len(findings) == 1 else f"{len(findings)} causes were"
        named = "; ".join(f"{effect_name(each.effect)} at {place(each)}" for each in findings[:4])
        more = f"; and {len(findings) - 4} more" if len(findings) > 4 else ""
        lines.append(f"{count} found: {named}{more}.")
    if usual:
        lines.append(_usual_words(usual))
    lines += changes_words(diagnosis)
    if diagnosis.suspected:
        lines.append(suspected_words(diagnosis))
    still = [name for name, fit in diagnosis.joints.items() if not fit.excited]
    if still:
        lines.append(f"Nothing can be said of {', '.join(still)}: too little motion.")
    return lines
