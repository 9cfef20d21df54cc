"""How effects and findings enter a simulation, within their part of time or positions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from ..findings import Finding
from ..motion import Gate
from ..simulation import (
    DofChange,
    DriveChange,
    GatedMemory,
    HardFriction,
    JointTorque,
    Part,
    StatefulLaw,
    constant,
    gated,
    of_speed,
)
from .catalogue import known
from .site import Site


def parts_of(
    effect: str,
    joints: Sequence[str],
    links: Sequence[str] = (),
    window: tuple[float, float] | None = None,
    values: Mapping[str, float] = {},
    *,
    recordings: Sequence[str] = (),
    variant: str = "",
) -> tuple[Part, ...]:
    """What an effect adds to the simulation.

    Args:
        effect: its id, such as "coulomb_friction".
        joints: it acts on each; of joint_coupling the moved one, then the one whose motor moves it;
            of unknown the joint, then the one it depends on if another.
        links: for payload and contact; the last joint's if there is none.
        window: of external_contact [s].
        values: its parameters by name.
        recordings: where external_contact acts; () for all.
        variant: what it is of, where it may be of several: see `Effect.variant`.

    Raises:
        ValueError: there is no such effect, or a parameter is missing.
    """
    site = Site(
        joints=tuple(joints),
        links=tuple(links),
        window=window,
        recordings=tuple(recordings),
        variant=variant,
        values=values,
    )
    try:
        return known(effect).parts(site)
    except KeyError as error:
        raise ValueError(
            f"{effect} needs the parameter {error}, got {', '.join(values) or 'none'}"
        ) from None


def parts_of_finding(finding: Finding) -> tuple[Part, ...]:
    """What a finding adds to the simulation; nothing where it is `not_simulated`."""
    if not_simulated(finding):
        return ()
    parts = _everywhere(finding)
    gate = finding.gate
    return parts if gate is None else tuple(_behind(part, gate) for part in parts)


def not_simulated(finding: Finding) -> str:
    """Why no part of the simulation is what was found, in words; "" where there is one.

    Raises:
        ValueError: there is no such effect.
    """
    effect = known(finding.effect)
    if reason := effect.not_simulated(finding.values):
        return reason
    gate = finding.gate
    if gate is not None and not all(_can_be_gated(part) for part in _everywhere(finding)):
        where = "a part of the time" if gate.of == "time" else "some positions"
        return f"{effect.words} in {where} only is not simulated"
    return ""


def _everywhere(finding: Finding) -> tuple[Part, ...]:
    return parts_of(
        finding.effect,
        finding.joints,
        finding.links,
        finding.window,
        finding.values,
        recordings=finding.recordings,
        variant=finding.variant,
    )


def _can_be_gated(part: Part) -> bool:
    if isinstance(part, DofChange):
        return not (part.armature or part.stiffness)
    if isinstance(part, DriveChange):
        return part == DriveChange(joint=part.joint, offset=part.offset)
    return isinstance(part, HardFriction | JointTorque)


def _behind(part: Part, gate: Gate) -> Part:
    """The part within a part of time or of positions only."""
    if isinstance(part, DofChange):
        return JointTorque(joint=part.joint, law=gated(of_speed(constant(part.damping)), gate))
    if isinstance(part, DriveChange):
        return JointTorque(joint=part.joint, law=gated(constant(part.offset), gate))
    if isinstance(part, HardFriction):
        level = part.level if callable(part.level) else constant(part.level)
        return replace(part, level=gated(level, gate))
    assert isinstance(part, JointTorque)
    if isinstance(part.law, StatefulLaw):
        return replace(part, law=GatedMemory(part.law, gate))
    return replace(part, law=gated(part.law, gate))
