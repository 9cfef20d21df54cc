"""What scripts on real recordings share: errors by joint as a table, and what was found."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bench.common.markdown import markdown_table
from pdoik.sim2real.simulators.compare import Comparison


def errors_by_joint(comparison: Comparison, sides: Mapping[str, NDArray[np.float64]]) -> str:
    """Root mean square errors [mrad] over the held-out runs.

    Args:
        comparison: with a machine's step.
        sides: positions by heading, (R, n), where the held-out ones were measured.
    """
    assert comparison.machine is not None
    measured = comparison.machine.explained.held_out.measured
    errors = [1e3 * np.sqrt(np.mean((measured - side) ** 2, axis=0)) for side in sides.values()]
    rows = [
        (joint, *(f"{e[k]:.1f}" for e in errors)) for k, joint in enumerate(comparison.study.joints)
    ]
    rows.append(("all", *(f"{np.sqrt(np.mean(e**2)):.1f}" for e in errors)))
    return markdown_table(("joint", *sides), rows)


def found_in(comparison: Comparison) -> str:
    """What is claimed and what is suspected, a line each, with sizes and equivalents."""
    assert comparison.machine is not None
    lines = []
    for finding in comparison.machine.findings:
        low, high = next(iter(finding.parameters.values())).interval95
        lines.append(f"{finding.statement} ({low:.3g} to {high:.3g}) {finding.confidence:.2f}")
    for finding in comparison.machine.suspected:
        alike = [f"{e.effect} of {' '.join((*e.joints, *e.links))}" for e in finding.equivalents]
        told = f", or {', '.join(alike)}" if alike else ""
        lines.append(f"suspected: {finding.statement} {finding.confidence:.2f}{told}")
    return "\n".join(lines)
