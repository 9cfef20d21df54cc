"""The HTML page: everything the report says, in one file that needs no network."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from pdoik.sim2real.findings import Diagnosis, Estimate, Finding

from . import words
from .data import Hypothesis, ReportData
from .matrix import cell, heading, line, matrix_of
from .ordinary import ordinary_of
from .style import Picture


@dataclass(frozen=True, slots=True, kw_only=True)
class Pictures:
    """The page's figures by section."""

    joints: Picture
    regimes: Picture
    by_joint: tuple[Picture, ...]  # in the order of the joints
    opened: tuple[bool, ...]  # whether the page shows it without a click
    drives: Picture | None  # limits of drives
    hypotheses: Picture | None
    replays: tuple[Picture, ...]
    cutoff: Picture | None

    @property
    def all(self) -> tuple[Picture, ...]:
        """Every figure, as they stand on the page."""
        alone = (self.joints, self.regimes, self.drives, self.hypotheses, self.cutoff)
        return (*(each for each in alone if each is not None), *self.by_joint, *self.replays)


def page(diagnosis: Diagnosis, data: ReportData, pictures: Pictures) -> str:
    """Text of report.html."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters.update(
        number=words.number,
        percent=words.percent,
        effect=words.effect_name,
        place=words.place,
        sentence=words.sentence,
    )
    matrix = matrix_of(diagnosis)
    return environment.get_template("page.html.j2").render(
        title=data.title,
        verdict=diagnosis.verdict,
        headline=words.VERDICTS[diagnosis.verdict][0],
        summary=words.summary(diagnosis),
        findings=[_card(finding, diagnosis) for finding in matrix.others],
        shared=[
            (
                words.sentence(f"{words.effect_name(effect)} in {len(found)} joints"),
                [_card(finding, diagnosis) for finding in found],
            )
            for effect, found in matrix.by_effect().items()
        ],
        ordinary=ordinary_of(diagnosis),
        suspected=[(finding, line(finding).partition(": ")[2]) for finding in diagnosis.suspected],
        effects=[heading(effect) for effect in matrix.effects],
        joints=[
            (
                name,
                fit,
                [cell(matrix.cells[name].get(effect)) for effect in matrix.effects],
                words.residue_words(fit) or words.joint_state(fit),
            )
            for name, fit in diagnosis.joints.items()
        ],
        recordings=data.recordings,
        data=data,
        pictures=pictures,
        details=list(zip(data.joints, pictures.by_joint, pictures.opened, strict=True)),
        hypotheses=[_row(each) for each in data.hypotheses],
        notes=[*diagnosis.notes, *data.notes],
    )


def _card(finding: Finding, diagnosis: Diagnosis) -> dict[str, object]:
    evidence = finding.evidence
    changed = words.changes(finding, diagnosis.thresholds.get("diagnosis", {}))
    return {
        "finding": finding,
        "number": diagnosis.findings.index(finding) + 1,
        "confidence": f"{finding.confidence:.2f}",
        "gain": words.percent(evidence.validation_gain),
        "low": words.percent(evidence.interval95[0]),
        "high": words.percent(evidence.interval95[1]),
        "width": round(100 * _within(evidence.validation_gain), 1),
        "parameters": [
            (name, estimate, *words.estimate_numbers(estimate), _bar(estimate))
            for name, estimate in words.parameters_of(finding).items()
        ],
        "window": _window(finding),
        "changes": ", ".join(f"{name.replace('_', ' ')} by {by}" for name, by in changed.items()),
    }


def _window(finding: Finding) -> str:
    if finding.positions is not None:
        return f"{finding.positions[0]:.3g} to {finding.positions[1]:.3g}, of the joint's position"
    if finding.window is None:
        return ""
    return f"{finding.window[0]:.2f} s to {finding.window[1]:.2f} s"


def _bar(estimate: Estimate) -> tuple[float, float, float, float] | None:
    """Zero, low, value and high on a scale from 0 to 100, for a small picture."""
    ends = (0.0, *estimate.interval95, estimate.value)
    if not all(map(math.isfinite, ends)) or max(ends) == min(ends):
        return None
    low, high = min(ends), max(ends)
    span = high - low

    def x(value: float) -> float:
        return round(4 + 92 * (value - low) / span, 2)

    return x(0.0), x(estimate.interval95[0]), x(estimate.value), x(estimate.interval95[1])


def _row(hypothesis: Hypothesis) -> dict[str, object]:
    low, high = hypothesis.interval95
    return {
        "tried": hypothesis,
        "score": words.percent(hypothesis.score),
        "interval": f"{words.percent(low)} to {words.percent(high)}",
    }


def _within(share: float) -> float:
    return min(max(share, 0.0), 1.0) if math.isfinite(share) else 0.0


def opened_joints(diagnosis: Diagnosis, joints: Sequence[str]) -> tuple[bool, ...]:
    """The joints that findings name, or else those above their noise; at most four."""
    named = {name for finding in diagnosis.findings for name in finding.joints}
    loud = {name for name, fit in diagnosis.joints.items() if fit.before > 1.25 * fit.noise_floor}
    wanted = [name for name in joints if name in (named or loud)][:4]
    return tuple(name in wanted for name in joints)
