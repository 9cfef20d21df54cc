"""The robots whose simulators are wrong, and what scripts on real recordings share."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from bench.common.descriptions import MissingDescriptionError, go2_urdf, shipped
from bench.common.markdown import markdown_table
from pdoik.sim2real.simulators import Comparison, compare


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """A description, its gains and the posture about which it moves."""

    urdf: Path
    kp: tuple[float, ...]
    kv: tuple[float, ...]
    rest: tuple[float, ...]
    damping: tuple[float, ...]
    joints: int


def robots() -> dict[str, Robot]:
    """Robots by name; the quadruped only where example-robot-data is installed."""
    found = {
        "panda": Robot(
            urdf=shipped("panda"),
            kp=(400.0, 400.0, 300.0, 300.0, 120.0, 120.0, 60.0),
            kv=(40.0, 40.0, 30.0, 30.0, 8.0, 8.0, 3.0),
            rest=(0.0, 0.3, 0.0, -1.8, 0.0, 2.0, 0.5),
            damping=(1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.3),
            joints=7,
        )
    }
    with suppress(MissingDescriptionError):
        found["go2"] = Robot(
            urdf=go2_urdf(),
            kp=(20.0,) * 12,
            kv=(1.5,) * 12,
            rest=(0.0, 0.9, -1.6) * 4,
            damping=(0.1,) * 12,
            joints=12,
        )
    return found


def compared(simulator: str | Path, study: Mapping[str, Any]) -> Comparison:
    """A study as a user would write it, compared.

    Args:
        simulator: MJCF as text, or a URDF's file.
        study: the other keys of its YAML.
    """
    with TemporaryDirectory() as home:
        given = {"urdf": str(simulator)}
        if isinstance(simulator, str):
            given = {"mjcf": "simulator.xml"}
            (Path(home) / "simulator.xml").write_text(simulator)
        path = Path(home) / "study.yaml"
        path.write_text(yaml.safe_dump({"simulator": given, **study}))
        return compare(path)


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
        others = f", or {', '.join(alike)}" if alike else ""
        lines.append(f"suspected: {finding.statement} {finding.confidence:.2f}{others}")
    return "\n".join(lines)


def told_of(comparison: Comparison) -> str:
    """Errors as the simulator is and patched, and what was found."""
    assert comparison.machine is not None
    explained = comparison.machine.explained
    sides = {"as it is [mrad]": explained.before, "patched": explained.after}
    return f"{errors_by_joint(comparison, sides)}\n{found_in(comparison)}"


def position_servos(
    joints: Iterable[str], kp: Iterable[float], kv: Iterable[float], **more: str
) -> list[dict[str, str]]:
    """Actuators of an MJCF."""
    return [
        {
            "name": joint,
            "joint": joint,
            "gainprm": f"{p:g}",
            "biastype": "affine",
            "biasprm": f"0 {-p:g} {-v:g}",
            **more,
        }
        for joint, p, v in zip(joints, kp, kv, strict=True)
    ]
