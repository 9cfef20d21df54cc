"""The tab of the findings: a click says all of one and points at its joint."""

from __future__ import annotations

from collections.abc import Callable

import viser

from pdoik.sim2real import Diagnosis, Finding
from pdoik.sim2real.report import effect_name, estimate_numbers, parameters_of, percent, place

NONE = "Nothing was found."


class FindingsTab:
    """A button for each finding, and what the last one that was clicked says.

    Args:
        gui: Where; call it inside the tab.
        diagnosis: What was found.
        point_at: Called with the joint of the finding that was clicked.
        ring_link: Called with the link of one that is at no joint.
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        diagnosis: Diagnosis,
        point_at: Callable[[str], None],
        ring_link: Callable[[str], None],
    ) -> None:
        self._joints = tuple(diagnosis.joints)
        self._point_at, self._ring_link = point_at, ring_link
        self.buttons = []
        for finding in diagnosis.findings:
            name = f"{effect_name(finding.effect)} at {place(finding)}"
            button = gui.add_button(name, color=(70, 88, 112), hint=finding.statement)
            button.on_click(self._callback(finding))
            self.buttons.append(button)
        self.words = gui.add_markdown(
            "A click on a finding says more and rings its joint." if self.buttons else NONE
        )

    def _callback(self, finding: Finding) -> Callable[[object], None]:
        return lambda _: self.choose(finding)

    def choose(self, finding: Finding) -> None:
        """Say all of a finding."""
        self.words.content = finding_words(finding)
        joint = next((each for each in finding.joints if each in self._joints), None)
        if joint is not None:
            self._point_at(joint)
        elif finding.links:
            self._ring_link(finding.links[0])


def finding_words(finding: Finding) -> str:
    """A finding as Markdown."""
    lines = [f"**{finding.statement}**"]
    for name, estimate in parameters_of(finding).items():
        value, low, high = estimate_numbers(estimate)
        unit = "" if estimate.unit == "-" else f" {estimate.unit}"
        lines.append(f"- {name.replace('_', ' ')}: {value}{unit} ({low} to {high})")
    lines.append(
        f"\nconfidence {finding.confidence:.2f}; lowers the held-out mean square by"
        f" {percent(finding.evidence.validation_gain)}"
    )
    if finding.equivalents:
        others = "; ".join(f"{effect_name(e.effect)} at {place(e)}" for e in finding.equivalents)
        lines.append(f"\nWould explain the same: {others}.")
        if finding.decided_by:
            lines.append(f"\nWhat would decide: {finding.decided_by}.")
    return "\n".join(lines)
