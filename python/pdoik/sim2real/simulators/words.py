"""The patch in words: a table for MuJoCo, Isaac and Gazebo, and what the two steps say."""

from __future__ import annotations

from collections.abc import Sequence

from ..findings import Finding, Verdict
from .findings import Step, place_of
from .vocabulary import PROPERTIES

VERDICTS: dict[Verdict, str] = {
    "no_mismatch": "no difference beyond noise",
    "mismatch_explained": "what differs is explained",
    "mismatch_partly_explained": "what differs is explained in part",
    "mismatch_unexplained": "what differs is not explained by any property of the simulator",
    "cannot_tell": "no joint moves, so nothing can be found",
}


def patch_table(step: Step, left_out: Sequence[str]) -> str:
    """Markdown: every changed property under the names of three simulators."""
    user = step.explained.user
    lines = [
        f"# What {user.name} needs to do as the {step.log} does",
        "",
        "| joint or link | MuJoCo | before | after | unit | Isaac | Gazebo (SDF) |",
        "| --- | --- | ---: | ---: | --- | --- | --- |",
    ]
    for change in step.changed:
        kind = PROPERTIES[change.parameter_id.property]
        cells = (
            place_of(user, change.parameter_id),
            kind.mujoco or kind.name,
            f"{change.before:.4g}",
            f"{change.after:.4g}",
            kind.unit,
            kind.isaac,
            kind.gazebo,
        )
        lines.append(f"| {' | '.join(cells)} |")
    unsure = [f for f in step.suspected if _is_kept(step, f)]
    if unsure:
        lines += ["", "Under another name these would do as well on this motion:", ""]
        lines += [f"- {finding.statement} {or_else(finding)}" for finding in unsure]
    if left_out:
        lines += ["", "Not in patched.xml:", "", *(f"- {each}" for each in left_out)]
    return "\n".join(lines) + "\n"


def or_else(finding: Finding) -> str:
    """The finding's equivalents, in parentheses; "" where it has none."""
    names = [
        f"{each.effect} of {', '.join(each.joints or each.links)}" for each in finding.equivalents
    ]
    return f"(or {', or '.join(names)})" if names else ""


def finding_line(finding: Finding) -> str:
    """A finding in one line."""
    return (
        f"{finding.statement}; gain {100 * finding.evidence.validation_gain:.0f} %,"
        f" confidence {finding.confidence:.2f} {or_else(finding)}".rstrip()
    )


def headline(step: Step) -> str:
    """The verdict of a step in words."""
    return f"{step.log.capitalize()} beyond {step.model}: {VERDICTS[step.verdict]}."


def _is_kept(step: Step, finding: Finding) -> bool:
    changed = {
        (each.parameter_id.property, place_of(step.explained.user, each.parameter_id))
        for each in step.changed
    }
    places = (*finding.joints, *finding.links, "all joints")
    return any((name, place) in changed for name in finding.parameters for place in places)
